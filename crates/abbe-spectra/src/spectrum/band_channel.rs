//! Names of the channels of spectral OpenEXR files, by the layout of Alban Fichet, Romain
//! Pacanowski and Alexander Wilkie, "An OpenEXR Layout for Spectral Images", Journal of Computer
//! Graphics Techniques 10(3), 2021.

/// Returns the name of the channel for light in a band: `S0.`, the centre wavelength and `nm`. It
/// has a decimal comma, because a point would end the name of a layer.
pub fn emissive_channel(centre_nm: f64) -> String {
    format!("S0.{}nm", centre_nm.to_string().replace('.', ","))
}

/// Returns the wavelength in nm of a channel for light, or `None` for another channel.
pub fn emissive_wavelength_nm(channel: &str) -> Option<f64> {
    wavelength_nm(channel.strip_prefix("S0.")?)
}

/// Returns the wavelength in nm of a channel for reflectances (`T.550nm`), or `None`.
pub fn reflective_wavelength_nm(channel: &str) -> Option<f64> {
    wavelength_nm(channel.strip_prefix("T.")?)
}

fn wavelength_nm(wavelength: &str) -> Option<f64> {
    let nm: f64 = wavelength.strip_suffix("nm")?.replace(',', ".").parse().ok()?;
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_a_decimal_comma_and_round_trip() {
        assert_eq!(emissive_channel(380.0), "S0.380nm");
        assert_eq!(emissive_channel(367.34375), "S0.367,34375nm");
        for nm in [360.0 + 47.0 / 3.0, 829.5, 500.0] {
            assert_eq!(emissive_wavelength_nm(&emissive_channel(nm)), Some(nm));
        }
        assert_eq!(emissive_wavelength_nm("S0.550,000000nm"), Some(550.0));
        assert_eq!(reflective_wavelength_nm("T.550,5nm"), Some(550.5));
        for other in ["R", "S1.550nm", "S0.550", "S0.nm", "T.550nm", "S0.-5nm"] {
            assert_eq!(emissive_wavelength_nm(other), None, "{other}");
        }
    }
}
