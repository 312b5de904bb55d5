//! The values of a colour as text for tables.

use abbe_spectra::colour::{ColourReport, LightDifference};

/// Returns the figures of a colour report, or "undefined". Colour temperature, colour rendering and
/// efficacy belong only to lights.
pub fn report_rows(report: &ColourReport) -> Vec<(&'static str, String)> {
    let ColourReport { xyz, xy, linear_srgb, srgb_hex, dominant, temperature, .. } = report;
    let ColourReport { rendering, rendition, melanopic_ratio, efficacy_lm_per_w, .. } = report;
    let three = |values: &[f64; 3], decimals: usize| values.map(|value| format!("{value:.decimals$}")).join("  ");
    let undefined = || "undefined".to_string();
    let dominant = dominant.map_or_else(undefined, |dominant| {
        let complementary = if dominant.complementary { " (complementary: a purple)" } else { "" };
        format!("{:.2} nm{complementary}, purity {:.4}", dominant.nm, dominant.purity)
    });
    let mut rows = vec![
        ("XYZ", three(xyz, 4)),
        ("xy", format!("{:.6}  {:.6}", xy[0], xy[1])),
        ("linear sRGB", three(linear_srgb, 6)),
        ("sRGB", srgb_hex.clone()),
        ("dominant", dominant),
    ];
    if let Some(efficacy) = efficacy_lm_per_w {
        rows.push(("CCT", temperature.map_or_else(undefined, |found| format!("{:.1} K", found.cct_k))));
        rows.push(("Duv", temperature.map_or_else(undefined, |found| format!("{:+.5}", found.duv))));
        rows.push(("Ra", rendering.as_ref().map_or_else(undefined, |found| format!("{:.1}", found.ra))));
        rows.push(("R9", rendering.as_ref().map_or_else(undefined, |found| format!("{:.1}", found.special[8]))));
        rows.push(("Rf", rendition.as_ref().map_or_else(undefined, |found| format!("{:.1}", found.rf))));
        rows.push(("Rg", rendition.as_ref().map_or_else(undefined, |found| format!("{:.1}", found.rg))));
        rows.push(("melanopic", melanopic_ratio.map_or_else(undefined, |ratio| format!("{ratio:.3}"))));
        rows.push(("efficacy", format!("{efficacy:.2} lm/W")));
    }
    rows
}

pub fn difference_text(lights: LightDifference) -> String {
    format!("Δxy {:.5}, ΔE2000 {:.2}", lights.delta_xy, lights.delta_e_2000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::spectrum::{Observer, SpectralLine, Spectrum, library};

    #[test]
    fn only_a_light_has_a_temperature() {
        let d65 = library::find("D65").unwrap().spectrum;
        let light = report_rows(&ColourReport::of_light(&d65, Observer::cie1931()).unwrap());
        assert!(light.iter().any(|(name, value)| *name == "CCT" && value.starts_with("650")), "{light:?}");
        let laser = Spectrum::lines(&[SpectralLine { nm: 532.0, power: 1.0, fwhm_nm: None }]).unwrap();
        let laser = report_rows(&ColourReport::of_light(&laser, Observer::cie1931()).unwrap());
        assert!(laser.contains(&("CCT", "undefined".to_string())), "{laser:?}");
        let grey = ColourReport::of_reflectance(&Spectrum::constant(0.5), &d65, Observer::cie1931()).unwrap();
        assert!(report_rows(&grey).iter().all(|(name, _)| !["CCT", "Ra", "efficacy"].contains(name)));
    }
}
