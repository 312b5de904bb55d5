//! Names of spectral channels.

/// The channel of a band by its centre: `S0.`, the wavelength with a decimal comma (a point would end a layer's name),
/// `nm`.
pub(super) fn channel_name(centre_nm: f64) -> String {
    format!("S0.{}nm", centre_nm.to_string().replace('.', ","))
}

/// The wavelength in nm that a channel's name states; `None` for channels that are no emissive band.
pub(super) fn wavelength_nm(channel: &str) -> Option<f64> {
    let number = channel.strip_prefix("S0.")?.strip_suffix("nm")?;
    let nm: f64 = number.replace(',', ".").parse().ok()?;
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_carry_a_decimal_comma_and_come_back() {
        assert_eq!(channel_name(380.0), "S0.380nm");
        assert_eq!(channel_name(367.34375), "S0.367,34375nm");
        for nm in [360.0 + 47.0 / 3.0, 829.5, 500.0] {
            assert_eq!(wavelength_nm(&channel_name(nm)), Some(nm));
        }
        assert_eq!(wavelength_nm("S0.550,000000nm"), Some(550.0));
        for other in ["R", "S1.550nm", "S0.550", "S0.nm", "T.550nm", "S0.-5nm"] {
            assert_eq!(wavelength_nm(other), None, "{other}");
        }
    }
}
