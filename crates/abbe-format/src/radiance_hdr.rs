//! Reads Radiance pictures (`.hdr`), whose pixels are three mantissas with a common exponent (Ward,
//! *Real Pixels*, Graphics Gems II, 1991).

use super::picture_primaries::FilePrimaries;
use abbe_optics::texture::ImageSize;
use abbe_spectra::error::{Error, Result};

/// The first bytes of a Radiance picture, in the two versions that programs write.
const SIGNATURES: [&[u8]; 2] = [b"#?RADIANCE", b"#?RGBE"];

/// Rows of these widths may be compressed with runs for each component.
const COMPRESSED_WIDTHS: std::ops::Range<usize> = 8..0x8000;

pub(super) fn is_radiance_hdr(bytes: &[u8]) -> bool {
    SIGNATURES.iter().any(|signature| bytes.starts_with(signature))
}

/// A picture whose components are those of the original scene.
#[derive(Debug)]
pub(super) struct RadiancePicture {
    pub(super) size: ImageSize,
    /// The components red, green and blue, row by row from the top.
    pub(super) colours: Vec<[f32; 3]>,
    /// The primaries, or `None` for those of sRGB.
    pub(super) primaries: Option<FilePrimaries>,
}

/// Decodes a picture. The pixels are divided by the product of all lines `EXPOSURE=` and
/// `COLORCORR=`, by which programs have multiplied them.
pub(super) fn decode(bytes: &[u8]) -> Result<RadiancePicture> {
    let mut reader = Reader { rest: bytes };
    let (mut format, mut scale, mut primaries) = (String::new(), [1.0; 3], None);
    loop {
        let line = reader.line()?;
        if line.is_empty() {
            break;
        }
        match line.split_once('=') {
            Some(("FORMAT", value)) => format = value.trim().to_string(),
            Some(("EXPOSURE", value)) => {
                let [exposure] = numbers(value).filter(are_factors).ok_or_else(|| bad_line(line))?;
                scale = scale.map(|factor| factor * exposure);
            }
            Some(("COLORCORR", value)) => {
                let correction: [f64; 3] = numbers(value).filter(are_factors).ok_or_else(|| bad_line(line))?;
                scale = std::array::from_fn(|i| scale[i] * correction[i]);
            }
            Some(("PRIMARIES", value)) => {
                let [rx, ry, gx, gy, bx, by, wx, wy] = numbers(value).ok_or_else(|| bad_line(line))?;
                primaries = FilePrimaries::new([[rx, ry], [gx, gy], [bx, by], [wx, wy]])?;
            }
            _ => {}
        }
    }
    if !format.is_empty() && format != "32-bit_rle_rgbe" {
        return Err(damaged(&format!("the format {format} is not 32-bit_rle_rgbe")));
    }
    let size = resolution(reader.line()?)?;
    // A compressed row needs at least four bytes, and a run covers at most 127 pixels.
    if size.width.saturating_mul(size.height) / 127 > reader.rest.len() {
        return Err(damaged("it is shorter than its header states"));
    }
    let mut pixels = Vec::with_capacity(size.width * size.height);
    let mut row = vec![[0; 4]; size.width];
    for _ in 0..size.height {
        reader.row(&mut row)?;
        pixels.extend(row.iter().map(|pixel| rgb(*pixel)));
    }
    if scale != [1.0; 3] {
        for pixel in &mut pixels {
            *pixel = std::array::from_fn(|i| (f64::from(pixel[i]) / scale[i]) as f32);
        }
    }
    Ok(RadiancePicture { size, colours: pixels, primaries })
}

/// Returns the numbers of a header line, or `None` if there are fewer or more.
fn numbers<const N: usize>(value: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = value.split_whitespace().map(|word| word.parse().ok()).collect();
    numbers?.try_into().ok()
}

fn are_factors<const N: usize>(factors: &[f64; N]) -> bool {
    factors.iter().all(|factor| factor.is_finite() && *factor > 0.0)
}

fn bad_line(line: &str) -> Error {
    damaged(&format!("its header has the line {line:?}"))
}

fn damaged(what: &str) -> Error {
    Error::input(format!("the image cannot be read: {what}"))
}

/// Reads the line `-Y height +X width`, the only orientation that programs write.
fn resolution(line: &str) -> Result<ImageSize> {
    let size = match line.split_ascii_whitespace().collect::<Vec<_>>()[..] {
        ["-Y", height, "+X", width] => width.parse().ok().zip(height.parse().ok()),
        _ => None,
    };
    let size = size.map(|(width, height)| ImageSize { width, height });
    size.filter(|size| size.width > 0 && size.height > 0)
        .ok_or_else(|| damaged(&format!("the resolution {line:?} is not of the form \"-Y 1024 +X 2048\"")))
}

/// Returns the components of a pixel. The exponent has an offset of 128, and the mantissas are in
/// units of 1/256. The exponent 0 means black.
fn rgb([r, g, b, exponent]: [u8; 4]) -> [f32; 3] {
    let scale = if exponent == 0 { 0.0 } else { 2.0_f64.powi(i32::from(exponent) - 136) };
    [r, g, b].map(|mantissa| (f64::from(mantissa) * scale) as f32)
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take<const N: usize>(&mut self) -> Result<[u8; N]> {
        let (taken, rest) = self.rest.split_first_chunk().ok_or_else(|| damaged("it ends early"))?;
        self.rest = rest;
        Ok(*taken)
    }

    /// Returns the next line of the header without its end.
    fn line(&mut self) -> Result<&'a str> {
        let end = self.rest.iter().position(|byte| *byte == b'\n').ok_or_else(|| damaged("its header has no end"))?;
        let (line, rest) = self.rest.split_at(end);
        self.rest = &rest[1..];
        std::str::from_utf8(line).map(str::trim_end).map_err(|_| damaged("its header is not text"))
    }

    /// Reads a row: compressed for each component, or pixel by pixel with the runs of old files.
    fn row(&mut self, row: &mut [[u8; 4]]) -> Result<()> {
        let width = row.len();
        if let [2, 2, high, low, ..] = *self.rest
            && COMPRESSED_WIDTHS.contains(&width)
            && high < 128
        {
            if usize::from(u16::from_be_bytes([high, low])) != width {
                return Err(damaged("a row has another width than the picture"));
            }
            self.take::<4>()?;
            return (0..4).try_for_each(|component| self.component(row, component));
        }
        let (mut at, mut shift) = (0, 0);
        while at < width {
            let pixel = self.take::<4>()?;
            if pixel[..3] != [1, 1, 1] {
                row[at] = pixel;
                (at, shift) = (at + 1, 0);
                continue;
            }
            // A pixel (1, 1, 1, n) repeats the last pixel. The counts of successive ones are the
            // digits of a number to the base 256.
            let count = usize::from(pixel[3]).checked_shl(shift).unwrap_or(usize::MAX);
            let end = at.checked_add(count).filter(|end| at > 0 && *end <= width);
            let end = end.ok_or_else(|| damaged("a run leaves its row"))?;
            let repeated = row[at - 1];
            row[at..end].fill(repeated);
            (at, shift) = (end, shift + 8);
        }
        Ok(())
    }

    /// Reads one component of a compressed row. A byte above 128 starts a run of equal values, and
    /// other bytes count the values that follow.
    fn component(&mut self, row: &mut [[u8; 4]], component: usize) -> Result<()> {
        let mut at = 0;
        while at < row.len() {
            let [count] = self.take()?;
            let (length, is_run) = if count > 128 { (count - 128, true) } else { (count, false) };
            let end = at + usize::from(length);
            if length == 0 || end > row.len() {
                return Err(damaged("a run leaves its row"));
            }
            let mut value = 0;
            for (i, pixel) in row[at..end].iter_mut().enumerate() {
                if i == 0 || !is_run {
                    [value] = self.take()?;
                }
                pixel[component] = value;
            }
            at = end;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, body: &[u8]) -> Vec<u8> {
        [header.as_bytes(), body].concat()
    }

    const HEADER: &str = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n";

    #[test]
    fn pixels_have_the_value_of_mantissa_and_exponent() {
        let body = [128, 64, 0, 129, 255, 1, 2, 0, 1, 0, 0, 255, 200, 0, 0, 90];
        let RadiancePicture { size, colours: pixels, .. } =
            decode(&file(&format!("{HEADER}-Y 2 +X 2\n"), &body)).unwrap();
        assert_eq!((size.width, size.height), (2, 2));
        let expected =
            [[1.0, 0.5, 0.0], [0.0; 3], [119.0_f32.exp2(), 0.0, 0.0], [200.0 * (-46.0_f32).exp2(), 0.0, 0.0]];
        assert_eq!(pixels, expected);
    }

    #[test]
    fn both_kinds_of_runs_are_expanded() {
        let mut body = vec![2, 2, 0, 9];
        body.extend([137, 128]); // nine times 128
        body.extend([4, 1, 2, 3, 4, 133, 7]); // four values and a run of five
        body.extend([137, 0, 137, 129]);
        let pixels = decode(&file(&format!("{HEADER}-Y 1 +X 9\n"), &body)).unwrap().colours;
        let green = [1, 2, 3, 4, 7, 7, 7, 7, 7].map(|code| f32::from(code as u8) / 128.0);
        assert_eq!(pixels, green.map(|g| [1.0, g, 0.0]));
        let old = [128, 0, 0, 129, 1, 1, 1, 3, 0, 128, 0, 129];
        let pixels = decode(&file("#?RGBE\n\n-Y 1 +X 5\n", &old)).unwrap().colours;
        assert_eq!(pixels, [[1.0, 0.0, 0.0]; 4].into_iter().chain([[0.0, 1.0, 0.0]]).collect::<Vec<_>>());
    }

    /// Several exposures multiply, and `PRIMARIES` states what the components mean.
    #[test]
    fn the_header_scales_the_pixels() {
        let decoded = |lines: &str| {
            decode(&file(&format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{lines}\n-Y 1 +X 1\n"), &[128, 128, 128, 129]))
        };
        let picture = decoded("EXPOSURE=2\nexr2hdr x\nEXPOSURE= 4.0\nCOLORCORR= 1 0.5 0.25\n").unwrap();
        assert_eq!((picture.colours, picture.primaries), (vec![[0.125, 0.25, 0.5]], None));
        let srgb = "PRIMARIES= 0.6400 0.3300 0.3000 0.6000 0.1500 0.0600 0.3127 0.3290\n";
        assert!(decoded(srgb).unwrap().primaries.is_none());
        assert!(decoded(&srgb.replace("0.6400 0.3300", "0.6800 0.3200")).unwrap().primaries.is_some());
        for bad in ["EXPOSURE=0\n", "EXPOSURE=x\n", "COLORCORR=1\n", "PRIMARIES=0.3 0.3\n"] {
            assert!(decoded(bad).unwrap_err().to_string().contains(bad.trim()), "{bad}");
        }
    }

    #[test]
    fn damaged_files_are_errors() {
        let sized =
            |size: &str, body: &[u8]| decode(&file(&format!("{HEADER}{size}\n"), body)).unwrap_err().to_string();
        for (size, body, what) in [
            ("-Y 1 +X 2", &[1, 2, 3, 4][..], "ends early"),
            ("-Y 1 +X 2", &[1, 1, 1, 1, 0, 0, 0, 0], "a run leaves its row"),
            ("-Y 1 +X 9", &[2, 2, 0, 9, 0], "a run leaves its row"),
            ("-Y 1 +X 9", &[2, 2, 0, 9, 138, 1], "a run leaves its row"),
            ("-Y 1 +X 9", &[2, 2, 0, 8, 137, 1], "another width"),
            ("-Y 99999999 +X 99999999", &[0; 4], "shorter than its header states"),
            ("+X 2 -Y 1", &[0; 8], "the resolution \"+X 2 -Y 1\" is not"),
        ] {
            assert!(sized(size, body).contains(what), "{size}: {}", sized(size, body));
        }
        assert!(decode(b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n").unwrap_err().to_string().contains("xyze"));
        assert!(decode(b"#?RADIANCE\n").is_err());
    }
}
