//! Names of channels.

/// The channels of XYZ.
pub(super) const XYZ: [&str; 3] = ["xyz.X", "xyz.Y", "xyz.Z"];

/// The channel of the standard error.
pub(super) const NOISE: &str = "error.noise";

/// The channel of the bias.
pub(super) const BIAS: &str = "error.bias";

/// The channel that marks pixels near an edge of the illumination.
pub(super) const EDGE: &str = "error.edge";

/// The names of the channels that contain exact sums begin with this prefix.
pub(super) const SUMS_PREFIX: &str = "sums.";

/// Returns the name of a band's channel: `S0.`, the centre wavelength and `nm`. The wavelength has
/// a decimal comma, because a point would end the name of a layer.
pub(super) fn channel_name(centre_nm: f64) -> String {
    format!("S0.{}nm", centre_nm.to_string().replace('.', ","))
}

/// Returns the wavelength in nm from a channel's name, or `None` if the channel is not an emissive
/// band.
pub(super) fn wavelength_nm(channel: &str) -> Option<f64> {
    let number = channel.strip_prefix("S0.")?.strip_suffix("nm")?;
    let nm: f64 = number.replace(',', ".").parse().ok()?;
    (nm.is_finite() && nm > 0.0).then_some(nm)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_a_decimal_comma_and_round_trip() {
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
