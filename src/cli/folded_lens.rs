//! The text of `abbe lens` for a system with mirrors, tilts or surfaces that no camera lens has.

use crate::reports::folded_lens::{FoldedFieldReport, FoldedLensReport};

pub(super) fn text(report: &FoldedLensReport<'_>, lines: &[&str]) -> String {
    let FoldedLensReport { name, surfaces, mirrors, .. } = report;
    let mut text = format!("{name} ({surfaces} surfaces, {mirrors} of them mirrors)\n");
    let one = |value: Option<f64>| value.map_or("none".to_string(), |mm| format!("{mm:.4} mm"));
    let pair = |along_y: Option<f64>, along_x: Option<f64>| match (along_y, along_x) {
        (Some(y), Some(x)) if (y - x).abs() <= 1e-5 * y.abs() => one(along_y),
        (None, None) => "none, because the system has no power".to_string(),
        _ => format!("{} along y, {} along x", one(along_y), one(along_x)),
    };
    for (label, value) in [
        ("focal length", pair(report.efl_mm, report.efl_x_mm)),
        ("back focus", pair(report.bfd_mm, report.bfd_x_mm) + " from the last surface"),
        ("image plane", format!("{:.4} mm from the last surface, as in the file", report.image_distance_mm)),
        ("f-number", report.f_number.map_or("undefined".to_string(), |f_number| format!("{f_number:.4}"))),
        ("entrance", format!("{:.4} mm wide", report.entrance_diameter_mm)),
    ] {
        if label != "back focus" || report.bfd_mm.or(report.bfd_x_mm).is_some() {
            text += &format!("{label:<15} {value}\n");
        }
    }
    text += &format!("\nfield       image x     image y   spot radius (RMS) in {}     passing\n", lines.join(", "));
    for field in &report.fields {
        let FoldedFieldReport { angle_deg, object_height_mm, image_x_mm, image_height_mm, spots, passing } = field;
        let spots = spots.iter().map(|spot| format!("{:>9.2}", 1e3 * spot.rms_mm)).collect::<String>();
        let name = angle_deg.map_or_else(
            || format!("{:.2} mm", object_height_mm.unwrap_or_default()),
            |degrees| format!("{degrees:.2}°"),
        );
        let (Some(x_mm), Some(y_mm)) = (image_x_mm, image_height_mm) else {
            text += &format!("{name:<7} no light passes\n");
            continue;
        };
        // Rounded before it is printed, so that no zero has a sign.
        let rounded = |mm: f64| (1e3 * mm).round() / 1e3 + 0.0;
        let (x_mm, y_mm) = (rounded(*x_mm), rounded(*y_mm));
        text += &format!("{name:<7} {x_mm:>8.3} mm {y_mm:>8.3} mm {spots} µm {:>7.1} %\n", 100.0 * passing);
    }
    text
}
