//! The measured picture as OpenEXR: absolute XYZ, linear RGB for every viewer, error bars, the spectrum, and its history.
//!
//! | channel | holds |
//! | --- | --- |
//! | `R` `G` `B` | linear Rec. 709 primaries, D65 white, unclipped; 1 is 1 cd/m² of white |
//! | `xyz.X` `xyz.Y` `xyz.Z` | tristimulus values, Y in cd/m² |
//! | `error.noise` `error.bias` | standard error and estimated bias of Y in cd/m²; −1 where unknown |
//! | `error.edge` | 1 beside an edge of light that kernels blur, where the bias is likely larger than told; else 0; −1 where unknown |
//! | `sums.<plane>.<word>` | in checkpoints and parts: the exact sums over passes, as 32-bit words |
//! | `S0.<λ>nm` | spectral radiance in W/m²/sr/nm, λ in nm with a decimal comma |
//!
//! The spectral channels follow A. Fichet, R. Pacanowski and A. Wilkie, "An OpenEXR Layout for Spectral Images",
//! Journal of Computer Graphics Techniques 10(3), 2021.

mod read;
mod spectral;
mod sums;
mod write;

pub use read::{ExrFile, read};
pub use sums::{add_sums, holds_sums_of, read_metadata};
pub use write::{encode, write, write_with_sums};

/// The channels of XYZ.
const XYZ: [&str; 3] = ["xyz.X", "xyz.Y", "xyz.Z"];

/// The channel of the standard error.
const NOISE: &str = "error.noise";

/// The channel of the bias.
const BIAS: &str = "error.bias";

/// The channel that marks edges of light.
const EDGE: &str = "error.edge";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Metadata;
    use crate::sensor::{Bands, Picture};

    /// A picture whose every value is its own and survives single precision.
    pub(super) fn sample() -> Picture {
        let (width, height) = (5, 3);
        let mut picture = Picture::black(width, height);
        for i in 0..width * height {
            let value = i as f64;
            picture.xyz[i] = [value, 0.5 * value + 1.0, -0.25 * value];
            picture.noise[i] = if i == 4 { -1.0 } else { i as f32 * 0.125 };
            picture.bias[i] = if i == 4 { -1.0 } else { i as f32 * 0.25 };
            picture.edge[i] = if i == 4 { -1.0 } else { (i % 2) as f32 };
        }
        let centres_nm = vec![360.5, 595.25, 830.0];
        let values = (0..3 * width * height).map(|i| i as f32 * 0.5).collect();
        picture.bands = Some(Bands { centres_nm, values });
        picture
    }

    #[test]
    fn a_picture_comes_back_with_everything_it_holds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let metadata = Metadata::new().with("abbe.seed", "7").with_json("abbe.scene", "λ");
        write(&path, &sample(), &metadata).unwrap();
        let file = read(&path).unwrap();
        assert_eq!(file.picture, sample());
        assert_eq!(file.metadata.get("abbe.seed"), Some("7"));
        assert_eq!(file.metadata.get("abbe.scene"), Some("\"\\u03bb\""));
        assert_eq!(file.metadata.get("spectralLayoutVersion"), Some("1.0"));
    }

    #[test]
    fn the_same_picture_gives_the_same_pixels_and_no_error_layers_stay_unknown() {
        let mut picture = sample();
        picture.bands = None;
        picture.noise.fill(-1.0);
        picture.bias.fill(-1.0);
        picture.edge.fill(-1.0);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write(&path, &picture, &Metadata::new()).unwrap();
        assert_eq!(read(&path).unwrap().picture, picture);
    }
}
