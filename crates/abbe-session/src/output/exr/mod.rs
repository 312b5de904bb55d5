//! The measured picture as an OpenEXR file. The file contains absolute XYZ, linear RGB for viewers,
//! error bars, the spectrum and metadata.
//!
//! | channel | content |
//! | --- | --- |
//! | `R` `G` `B` | linear Rec. 709 primaries, D65 white, not clipped; 1 is 1 cd/m² of white |
//! | `xyz.X` `xyz.Y` `xyz.Z` | tristimulus values, Y in cd/m² |
//! | `error.noise` `error.bias` | standard error and estimated bias of Y in cd/m²; −1 if unknown |
//! | `error.edge` | 1 if kernels blur an edge of the illumination, so that the bias is probably larger than estimated; else 0; −1 if unknown |
//! | `sums.<plane>.<word>` | in checkpoints and parts: the exact sums over passes, as 32-bit words |
//! | `albedo.R` … | the layers that the film recorded on request |
//! | `S0.<λ>nm` | spectral radiance in W/m²/sr/nm, λ in nm with a decimal comma |
//!
//! The spectral channels follow the layout of Alban Fichet, Romain Pacanowski and Alexander Wilkie,
//! "An OpenEXR Layout for Spectral Images", Journal of Computer Graphics Techniques 10(3), 2021.

mod channel_names;
mod cryptomatte;
mod open;
mod read;
mod samples;
mod sums;
mod write;

pub use read::{ExrFile, read};
pub use sums::{add_sums, hash_sums, holds_sums_of, read_metadata};
pub use write::{encode, write, write_uncompressed, write_with_sums};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::Metadata;
    use abbe_transport::sensor::{Picture, SpectralBands};

    /// Returns a picture. Its values differ from pixel to pixel, and are exact in single precision.
    pub(super) fn sample() -> Picture {
        let (width, height) = (5, 3);
        let mut picture = Picture::black(width, height);
        for i in 0..width * height {
            let value = i as f64;
            picture.xyz[i] = [value, 0.5 * value + 1.0, -0.25 * value];
            picture.noise[i] = (i != 4).then_some(i as f32 * 0.125);
            picture.bias[i] = (i != 4).then_some(i as f32 * 0.25);
            picture.edge[i] = (i != 4).then_some(i % 2 == 1);
        }
        let centres_nm = vec![360.5, 595.25, 830.0];
        let values = (0..3 * width * height).map(|i| i as f32 * 0.5).collect();
        picture.bands = Some(SpectralBands { centres_nm, values });
        picture
    }

    #[test]
    fn equal_pictures_are_equal_files() {
        let metadata = (0..20).fold(Metadata::new(), |metadata, i| metadata.with(&format!("abbe.{i}"), "text"));
        let bytes = || encode(&sample(), &metadata).unwrap();
        let first = bytes();
        assert!((0..5).all(|_| bytes() == first));
    }

    #[test]
    fn a_picture_and_its_metadata_survive_a_round_trip() {
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

    /// Writing and reading a picture preserves its pixels. Errors are unknown without error layers.
    #[test]
    fn pixels_survive_a_round_trip() {
        let mut picture = sample();
        picture.bands = None;
        picture.noise.fill(None);
        picture.bias.fill(None);
        picture.edge.fill(None);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        write(&path, &picture, &Metadata::new()).unwrap();
        assert_eq!(read(&path).unwrap().picture, picture);
    }
}
