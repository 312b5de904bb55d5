//! PNG files of display images, with their colour space.
//!
//! | space | bits | chunks |
//! | --- | --- | --- |
//! | sRGB | 8 | `cICP`, `sRGB`, `gAMA`, `cHRM` |
//! | Display P3 | 8 | `cICP`, `iCCP`, `gAMA`, `cHRM` |
//! | Rec. 2020 | 16 | `iCCP`, `gAMA`, `cHRM` |
//! | Rec. 2100 (PQ) | 16 | `cICP`, `cHRM` |
//! | ACEScg | 16 | `iCCP`, `gAMA`, `cHRM` (linear) |
//!
//! Each row of the table lists the chunks in order of priority. A reader uses the first chunk that
//! it supports (PNG, third edition, 4.3). The chunk `cICP` contains code points. For Rec. 2020, no
//! code points are written. Browsers assume a display gamma of 2.4 for the code points of Rec.
//! 2020, so a picture with these code points would be too dark. With PQ, they are unambiguous. The
//! ICC profile of Rec. 2020 contains the curve that the standard itself defines. No code points
//! exist for the primaries of ACEScg.

use std::borrow::Cow;
use std::io::Cursor;
use std::path::{Path, PathBuf};

use ::png::chunk::ChunkType;
use ::png::{
    BitDepth, ColorType, Compression, Filter, Info, ScaledFloat, SourceChromaticities, SrgbRenderingIntent,
    Transformations,
};

use super::{file, icc};
use abbe_spectra::colour::{AdaptationTransform, RgbSpace, Transfer, adapt, transfer::REC2100_PQ};
use abbe_spectra::error::{Error, Result};
use abbe_transport::sensor::{Codes, DisplayImage, Picture};

/// Returns the bytes of a PNG file.
///
/// # Errors
/// Returns a machine error if the image cannot be encoded.
pub fn encode(screen: &DisplayImage) -> Result<Vec<u8>> {
    let failed = |error: ::png::EncodingError| Error::machine(format!("cannot be written as PNG: {error}"));
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::with_info(&mut bytes, header(screen)?).map_err(failed)?;
    encoder.set_compression(Compression::Balanced);
    encoder.set_filter(Filter::Adaptive);
    if screen.space == RgbSpace::Srgb && screen.transfer == Transfer::OfSpace {
        encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
    }
    let mut writer = encoder.write_header().map_err(failed)?;
    if let Some(points) = code_points(screen.space, screen.transfer) {
        writer.write_chunk(CODE_POINTS, &points).map_err(failed)?;
    }
    match &screen.codes {
        Codes::Eight(codes) => writer.write_image_data(codes.as_flattened()),
        Codes::Sixteen(codes) => {
            let big_endian: Vec<u8> = codes.as_flattened().iter().flat_map(|code| code.to_be_bytes()).collect();
            writer.write_image_data(&big_endian)
        }
    }
    .map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

/// Writes a PNG file atomically.
///
/// # Errors
/// Returns a machine error if the folder is missing or not writable, or the disk is full.
pub fn write(path: &Path, screen: &DisplayImage) -> Result<()> {
    let bytes = encode(screen).map_err(|error| error.in_file(path))?;
    file::write_whole(path, &bytes)
}

/// Writes PNG files of the same size and the same colour space atomically as the frames of an
/// animated PNG, which repeats for ever. `fps` is the number of frames per second.
///
/// # Errors
/// Returns an error if a frame cannot be read or differs from the first one, and a machine error if
/// the file cannot be written.
pub fn write_animation(path: &Path, frames: &[PathBuf], fps: f64) -> Result<()> {
    let Some((first, others)) = frames.split_first() else { return Ok(()) };
    let failed = |error: ::png::EncodingError| {
        Error::machine(format!("cannot be written as an animated PNG: {error}")).in_file(path)
    };
    let (info, pixels) = decoded(first)?;
    let (size, depth, code_points) = (info.size(), info.bit_depth, info.coding_independent_code_points);
    let mut bytes = Vec::new();
    let mut encoder = ::png::Encoder::with_info(&mut bytes, info).map_err(failed)?;
    encoder.set_compression(Compression::Balanced);
    encoder.set_filter(Filter::Adaptive);
    encoder.set_animated(frames.len() as u32, 0).map_err(failed)?;
    let (numerator, denominator) = frame_delay(fps);
    encoder.set_frame_delay(numerator, denominator).map_err(failed)?;
    let mut writer = encoder.write_header().map_err(failed)?;
    if let Some(points) = code_points {
        let is_full = u8::from(points.is_video_full_range_image);
        let points = [points.color_primaries, points.transfer_function, points.matrix_coefficients, is_full];
        writer.write_chunk(CODE_POINTS, &points).map_err(failed)?;
    }
    writer.write_image_data(&pixels).map_err(failed)?;
    for frame in others {
        let (info, pixels) = decoded(frame)?;
        if (info.size(), info.bit_depth) != (size, depth) {
            return Err(Error::input("differs in size or depth from the first frame").in_file(frame));
        }
        writer.write_image_data(&pixels).map_err(failed)?;
    }
    writer.finish().map_err(failed)?;
    file::write_whole(path, &bytes)
}

/// Returns the time of a frame in s as a fraction.
fn frame_delay(fps: f64) -> (u16, u16) {
    if fps.fract() == 0.0 && fps <= f64::from(u16::MAX) {
        return (1, fps as u16);
    }
    ((1000.0 / fps).round().clamp(1.0, f64::from(u16::MAX)) as u16, 1000)
}

/// Reads the header and the pixels of a PNG file.
fn decoded(path: &Path) -> Result<(Info<'static>, Vec<u8>)> {
    let wrong = |what: String| Error::input(format!("cannot be read: {what}")).in_file(path);
    let bytes = std::fs::read(path).map_err(|error| wrong(error.to_string()))?;
    let mut reader = ::png::Decoder::new(Cursor::new(bytes)).read_info().map_err(|error| wrong(error.to_string()))?;
    let size = reader.output_buffer_size().ok_or_else(|| wrong("the picture is too large".to_string()))?;
    let mut pixels = vec![0; size];
    reader.next_frame(&mut pixels).map_err(|error| wrong(error.to_string()))?;
    Ok((reader.info().clone(), pixels))
}

fn header(screen: &DisplayImage) -> Result<Info<'static>> {
    let size = |pixels: usize| u32::try_from(pixels).map_err(|_| Error::machine("the picture is too large for PNG"));
    let mut info = Info::with_size(size(screen.width)?, size(screen.height)?);
    info.color_type = ColorType::Rgb;
    info.bit_depth = match screen.codes {
        Codes::Eight(_) => BitDepth::Eight,
        Codes::Sixteen(_) => BitDepth::Sixteen,
    };
    info.source_gamma = match screen.transfer {
        Transfer::OfSpace => Some(ScaledFloat::from_scaled(gamma(screen.space))),
        Transfer::Pq => None,
    };
    info.source_chromaticities = Some(chromaticities(screen.space));
    info.icc_profile = match (screen.space, screen.transfer) {
        (RgbSpace::Srgb, Transfer::OfSpace) => None,
        (RgbSpace::DisplayP3 | RgbSpace::Rec2020 | RgbSpace::AcesCg, Transfer::OfSpace) => {
            Some(Cow::Borrowed(icc::profile(screen.space)))
        }
        // An ICC profile of version 2 or 4 cannot describe absolute luminances.
        (RgbSpace::Srgb | RgbSpace::DisplayP3 | RgbSpace::Rec2020 | RgbSpace::AcesCg, Transfer::Pq) => None,
    };
    Ok(info)
}

/// The type of the chunk with the code points (PNG, third edition, 11.3.2.6).
const CODE_POINTS: ChunkType = ChunkType(*b"cICP");

/// Returns the four code points of ITU-T H.273. They identify the primaries, the transfer function,
/// the matrix (0 means RGB) and the range (1 means full range).
fn code_points(space: RgbSpace, transfer: Transfer) -> Option<[u8; 4]> {
    match (space, transfer) {
        (RgbSpace::Srgb, Transfer::OfSpace) => Some([1, 13, 0, 1]),
        (RgbSpace::DisplayP3, Transfer::OfSpace) => Some([12, 13, 0, 1]),
        (RgbSpace::Rec2020 | RgbSpace::AcesCg, Transfer::OfSpace) => None,
        (RgbSpace::Srgb, Transfer::Pq) => Some([1, 16, 0, 1]),
        (RgbSpace::DisplayP3, Transfer::Pq) => Some([12, 16, 0, 1]),
        (RgbSpace::Rec2020, Transfer::Pq) => Some([9, 16, 0, 1]),
        (RgbSpace::AcesCg, Transfer::Pq) => None,
    }
}

/// Returns the exponent of the power function that is closest to the encoding of the space. The
/// unit of the result is 1/100,000.
fn gamma(space: RgbSpace) -> u32 {
    match space {
        RgbSpace::Srgb | RgbSpace::DisplayP3 => 45_455,
        // This power function approximates the whole curve of ITU-R BT.2020. The curve itself is
        // linear near 0. For larger values, it contains a power with the exponent 0.45.
        RgbSpace::Rec2020 => 51_000,
        RgbSpace::AcesCg => 100_000,
    }
}

fn chromaticities(space: RgbSpace) -> SourceChromaticities {
    let scaled = |xy: [f64; 2]| {
        let [x, y] = xy.map(|value| ScaledFloat::from_scaled((value * 1e5).round() as u32));
        (x, y)
    };
    let [red, green, blue] = space.primaries_xy().map(scaled);
    SourceChromaticities { white: scaled(space.white_xy()), red, green, blue }
}

/// Reads a PNG file as a picture. The codes are decoded to XYZ, and white has the luminance 1. The
/// errors are unknown, and opacity is ignored.
///
/// # Errors
/// Returns an input error if the file is missing or not a PNG, or if its colour space is not one of
/// the spaces that [`write()`] writes. A file that states no colour space is in sRGB.
pub fn read(path: &Path) -> Result<Picture> {
    let wrong = |what: String| Error::input(what).in_file(path);
    let bytes = std::fs::read(path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let broken = |error: String| wrong(format!("is not a valid PNG file: {error}"));
    let (info, pixels) = rgb16(&bytes).map_err(|error| broken(error.to_string()))?;
    let (space, transfer) = explicit_space(&info)?.ok_or_else(|| {
        let names = RgbSpace::ALL.map(RgbSpace::name).join(", ");
        wrong("has a colour space that abbe does not know".to_string()).expected(format!("{names}, {REC2100_PQ}"))
    })?;
    let mut picture = Picture::black(info.width as usize, info.height as usize);
    let adapt = |xyz| adapt(xyz, space.white(), RgbSpace::Srgb.white(), AdaptationTransform::Bradford);
    for (xyz, pixel) in picture.xyz.iter_mut().zip(&pixels) {
        *xyz = adapt(space.to_xyz(pixel.map(|code| transfer.decode(f64::from(code) / 65_535.0, space))));
    }
    Ok(picture)
}

/// Returns the colour space that a PNG file states. Returns `None` if the space is unknown.
fn explicit_space(info: &Info<'_>) -> Result<Option<(RgbSpace, Transfer)>> {
    if let Some(points) = &info.coding_independent_code_points {
        let explicit = [points.color_primaries, points.transfer_function, points.matrix_coefficients, 1];
        let encodings = RgbSpace::ALL.map(|space| (space, Transfer::OfSpace)).into_iter();
        let encodings = encodings.chain([(RgbSpace::Rec2020, Transfer::Pq)]);
        return Ok(encodings.into_iter().find(|(space, transfer)| code_points(*space, *transfer) == Some(explicit)));
    }
    let Some(profile) = &info.icc_profile else { return Ok(Some((RgbSpace::Srgb, Transfer::OfSpace))) };
    for space in RgbSpace::ALL {
        if icc::profile(space) == profile.as_ref() {
            return Ok(Some((space, Transfer::OfSpace)));
        }
    }
    Ok(None)
}

/// Reads a mask. A pixel is selected if any of its colour components is not zero. Opacity is
/// ignored.
///
/// # Errors
/// Returns an input error if the file is missing or not a PNG, or its size is not `width` ×
/// `height`.
pub fn read_mask(path: &Path, width: usize, height: usize) -> Result<Vec<bool>> {
    let wrong = |what: String| Error::input(what).in_file(path);
    let bytes = std::fs::read(path).map_err(|error| wrong(format!("cannot be read: {error}")))?;
    let (Info { width: w, height: h, .. }, pixels) =
        rgb16(&bytes).map_err(|error| wrong(format!("is not a valid PNG file: {error}")))?;
    if (w as usize, h as usize) != (width, height) {
        let what = format!("the mask has {w} × {h} pixels");
        return Err(wrong(what).expected(format!("the pictures' size, {width} × {height}")));
    }
    Ok(pixels.iter().map(|pixel| *pixel != [0; 3]).collect())
}

/// Returns the header and the pixels of a PNG file, with codes of 16 bits and without opacity.
fn rgb16(bytes: &[u8]) -> std::result::Result<(Info<'static>, Vec<[u16; 3]>), ::png::DecodingError> {
    let mut decoder = ::png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info()?;
    // The deflate method compresses to 1/1032 at best, so a header that states more is damaged.
    let possible = |size: &usize| *size <= bytes.len().saturating_mul(1032);
    let size = reader.output_buffer_size().filter(possible).ok_or(::png::DecodingError::LimitsExceeded)?;
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer)?;
    buffer.truncate(frame.buffer_size());
    let codes: Vec<u16> = if frame.bit_depth == BitDepth::Sixteen {
        buffer.as_chunks().0.iter().map(|code| u16::from_be_bytes(*code)).collect()
    } else {
        buffer.iter().map(|code| u16::from(*code) * 257).collect()
    };
    let pixels = codes.chunks_exact(frame.color_type.samples()).map(|pixel| match *pixel {
        [r, g, b, ..] => [r, g, b],
        [v, ..] => [v; 3],
        [] => [0; 3],
    });
    Ok((reader.info().clone(), pixels.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns an image of one pixel in this space. Its codes have 16 bits.
    fn wide(space: RgbSpace) -> DisplayImage {
        let codes = Codes::Sixteen(vec![[1, 0x1234, 0xfffe]]);
        DisplayImage { width: 1, height: 1, space, transfer: Transfer::OfSpace, codes }
    }

    fn decoded(screen: &DisplayImage) -> (u32, u32, Vec<[u16; 3]>) {
        let (info, pixels) = rgb16(&encode(screen).unwrap()).unwrap();
        (info.width, info.height, pixels)
    }

    #[test]
    fn a_png_contains_the_pixels() {
        let screen = DisplayImage::of_srgb(2, 1, vec![[1, 2, 3], [250, 128, 0]]);
        let codes = [[1, 2, 3], [250, 128, 0]].map(|pixel: [u16; 3]| pixel.map(|code| 257 * code));
        assert_eq!(decoded(&screen), (2, 1, codes.to_vec()));
        let pixel = [1, 0x1234, 0xfffe];
        assert_eq!(decoded(&wide(RgbSpace::Rec2020)), (1, 1, vec![pixel]));
    }

    #[test]
    fn the_file_states_the_colour_space() {
        for space in RgbSpace::ALL {
            let bytes = encode(&wide(space)).unwrap();
            let reader = ::png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
            let info = reader.info();
            let points = info.coding_independent_code_points.map(|points| {
                let range = u8::from(points.is_video_full_range_image);
                [points.color_primaries, points.transfer_function, points.matrix_coefficients, range]
            });
            let (known, gamma) = match space {
                RgbSpace::Srgb => (Some([1, 13, 0, 1]), 0.45455),
                RgbSpace::DisplayP3 => (Some([12, 13, 0, 1]), 0.45455),
                RgbSpace::Rec2020 => (None, 0.51),
                RgbSpace::AcesCg => (None, 1.0),
            };
            assert_eq!(points, known, "{space:?}");
            assert_eq!(info.gama_chunk.map(ScaledFloat::into_value), Some(gamma), "{space:?}");
            let explicit = info.chrm_chunk.unwrap();
            let whites = [explicit.white.0, explicit.white.1].map(ScaledFloat::into_value);
            let greens = [explicit.green.0, explicit.green.1].map(ScaledFloat::into_value);
            for (found, known) in [(whites, space.white_xy()), (greens, space.primaries_xy()[1])] {
                let near = (0..2).all(|i| (f64::from(found[i]) - known[i]).abs() < 1e-5);
                assert!(near, "{space:?}: {found:?} {known:?}");
            }
            assert_eq!(info.srgb.is_some(), space == RgbSpace::Srgb);
            assert_eq!(info.icc_profile.is_some(), space != RgbSpace::Srgb);
            assert!(info.icc_profile.as_deref().is_none_or(|found| found == icc::profile(space)));
        }
    }

    #[test]
    fn a_png_is_read_back_as_a_picture_in_every_space() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for space in RgbSpace::ALL {
            let codes = Codes::Sixteen(vec![[65_535; 3]]);
            let white = DisplayImage { width: 1, height: 1, space, transfer: Transfer::OfSpace, codes };
            write(&path, &white).unwrap();
            let xyz = read(&path).unwrap().xyz[0];
            let known = RgbSpace::Srgb.white();
            assert!(xyz.iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-9), "{space:?}: {xyz:?}");
        }
        write(&path, &DisplayImage::of_srgb(1, 1, vec![[188, 188, 188]])).unwrap();
        assert!((read(&path).unwrap().xyz[0][1] - 0.503).abs() < 1e-3);
        std::fs::write(&path, "no picture").unwrap();
        assert_eq!(read(&path).unwrap_err().exit_status(), 2);
    }

    /// A PQ file states the primaries of Rec. 2020 and the PQ curve, and its luminances are
    /// relative to white at 203 cd/m².
    #[test]
    fn a_hdr_png_states_pq_and_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("hdr.png");
        let space = RgbSpace::Rec2020;
        let code = |component: f64| (65_535.0 * Transfer::Pq.encode(component, space)).round() as u16;
        let codes = Codes::Sixteen([0.0, 0.18, 1.0, 4.0].map(|y| [code(y); 3]).to_vec());
        let screen = DisplayImage { width: 4, height: 1, space, transfer: Transfer::Pq, codes };
        let reader = ::png::Decoder::new(Cursor::new(encode(&screen).unwrap())).read_info().unwrap();
        let points = reader.info().coding_independent_code_points.unwrap();
        assert_eq!((points.color_primaries, points.transfer_function), (9, 16));
        assert!(points.is_video_full_range_image && reader.info().icc_profile.is_none());
        write(&path, &screen).unwrap();
        for (xyz, y) in read(&path).unwrap().xyz.iter().zip([0.0, 0.18, 1.0, 4.0]) {
            assert!((xyz[1] - y).abs() < 1e-3 * y.max(1e-3), "{xyz:?} {y}");
        }
    }

    #[test]
    fn a_mask_selects_nonzero_pixels_and_must_fit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mask.png");
        write(&path, &DisplayImage::of_srgb(3, 1, vec![[0; 3], [0, 0, 1], [255; 3]])).unwrap();
        assert_eq!(read_mask(&path, 3, 1).unwrap(), [false, true, true]);
        let error = read_mask(&path, 4, 1).unwrap_err();
        assert!(error.to_string().contains("expected the pictures' size, 4 × 1"), "{error}");
        std::fs::write(&path, "no picture").unwrap();
        assert_eq!(read_mask(&path, 3, 1).unwrap_err().exit_status(), 2);
    }
}
