//! Reads grids from NumPy's `.npy` arrays, and from `.npz` archives with one array.
//!
//! The array has three axes and is indexed [z, y, x]. In NumPy's default order, x varies fastest,
//! as in the `values` of a scene. NumPy's module `numpy.lib.format` defines versions 1 to 3 of the
//! format.
//!
//! This module parses the header itself instead of using a crate. The crate `npyz` multiplies the
//! sizes of the axes without an overflow check, and does not compare the product with the length of
//! the data. The crate `ndarray-npy` needs the number type at compile time, and depends on the
//! large crate `ndarray`.

use abbe_scene::medium::field::FieldGrid;
use abbe_spectra::error::{Error, Result};
use std::io::{Cursor, Read};
use std::path::Path;

/// Reads a grid from a `.npy` or `.npz` file.
///
/// # Errors
/// Returns an error if the file cannot be read or has another format, or if its header is malformed
/// or does not match the length of the data. Also returns an error if the array does not have three
/// axes, or if a value is negative or not finite. The error contains the name of the file. OpenVDB
/// and NanoVDB files are not supported, because there is no maintained reader for them.
pub fn read(path: &Path) -> Result<FieldGrid> {
    let kind = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    let bytes = || std::fs::read(path).map_err(|error| Error::input(format!("cannot read the volume: {error}")));
    let grid = match kind.as_str() {
        "npy" => bytes().and_then(|bytes| npy(&bytes)),
        "npz" => bytes().and_then(|bytes| npy(&only_array(bytes)?)),
        "vdb" | "nvdb" => {
            let what = "an OpenVDB or NanoVDB file, for which there is no maintained reader";
            Err(Error::input(what).expected("a .npy or .npz file with the values on a dense grid"))
        }
        _ => Err(Error::input(format!("a volume file of the kind \".{kind}\"")).expected("a .npy or .npz file")),
    };
    grid.map_err(|error| error.in_file(path))
}

/// Unpacks the only array of an archive.
fn only_array(bytes: Vec<u8>) -> Result<Vec<u8>> {
    /// An array of at most this size in bytes is unpacked even from a very small archive.
    const ALWAYS_ALLOWED: u64 = 1 << 28;
    /// The highest compression ratio of deflate.
    const MOST_PER_BYTE: u64 = 1032;
    let whole_mib = bytes.len() as u64 >> 20 << 20;
    let broken = |error: zip::result::ZipError| Error::input(format!("a broken archive: {error}"));
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(broken)?;
    let names: std::result::Result<Vec<String>, _> = archive.file_names().map(|name| Ok(name?.into_owned())).collect();
    let names = names.map_err(broken)?;
    let [name] = names.as_slice() else {
        let what = format!("an archive of {} arrays ({})", names.len(), names.join(", "));
        return Err(Error::input(what).expected("an archive of one array"));
    };
    let file = archive.by_name(name).map_err(broken)?;
    // The size that the archive states may be wrong, so at most one byte more is unpacked.
    let announced = file.size();
    if announced > ALWAYS_ALLOWED.max(whole_mib.saturating_mul(MOST_PER_BYTE)) {
        let what = format!("an array of {announced} bytes in a small archive");
        return Err(Error::input(what).expected("at most 256 MiB in an archive below 1 MiB"));
    }
    let mut array = Vec::new();
    let unpacked = file.take(announced.saturating_add(1)).read_to_end(&mut array);
    unpacked.map_err(|error| Error::input(format!("a broken archive: {error}")))?;
    Ok(array)
}

/// The storage format of the numbers of an array.
#[derive(Debug, Clone, Copy, PartialEq)]
struct NpyFormat {
    big_endian: bool,
    number: NpyNumber,
}

/// The number types that are supported: floats and unsigned integers, with their size in bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum NpyNumber {
    F4,
    F8,
    U1,
    U2,
}

impl NpyNumber {
    fn bytes(self) -> usize {
        match self {
            Self::F8 => 8,
            Self::F4 => 4,
            Self::U2 => 2,
            Self::U1 => 1,
        }
    }
}

impl NpyFormat {
    /// Parses NumPy's description of a number type, such as `<f4`.
    fn new(description: &str) -> Result<Self> {
        let unknown = || {
            let what = format!("an array of numbers \"{description}\"");
            Error::input(what).expected("numbers of the kind f4, f8, u1 or u2, such as \"<f4\"")
        };
        let big_endian = description.starts_with('>');
        let number = match description.trim_start_matches(['<', '>', '|', '=']) {
            "f4" => NpyNumber::F4,
            "f8" => NpyNumber::F8,
            "u1" => NpyNumber::U1,
            "u2" => NpyNumber::U2,
            _ => return Err(unknown()),
        };
        Ok(Self { big_endian, number })
    }

    /// Decodes a number from its bytes. The length of `bytes` must be the size of the number type.
    fn value(self, bytes: &[u8]) -> f64 {
        let last = bytes.len() - 1;
        let byte = |i: usize| bytes[if self.big_endian { last - i } else { i }];
        match self.number {
            NpyNumber::F4 => f64::from(f32::from_le_bytes(std::array::from_fn(byte))),
            NpyNumber::F8 => f64::from_le_bytes(std::array::from_fn(byte)),
            NpyNumber::U2 => f64::from(u16::from_le_bytes(std::array::from_fn(byte))),
            NpyNumber::U1 => f64::from(byte(0)),
        }
    }
}

/// Reads a grid from the bytes of a `.npy` file.
fn npy(bytes: &[u8]) -> Result<FieldGrid> {
    let (header, data) = split(bytes).ok_or_else(|| {
        Error::input("the file does not begin like a .npy array").expected("NumPy's .npy format, version 1, 2 or 3")
    })?;
    let format = NpyFormat::new(quoted(header, "descr").ok_or_else(|| bad_header("descr"))?)?;
    let fortran_order = match entry(header, "fortran_order").ok_or_else(|| bad_header("fortran_order"))? {
        order if order.starts_with("True") => true,
        order if order.starts_with("False") => false,
        _ => return Err(bad_header("fortran_order")),
    };
    let shape = shape(header).ok_or_else(|| bad_header("shape"))?;
    let &[z, y, x] = shape.as_slice() else {
        let what = format!("an array of {} axes", shape.len());
        return Err(Error::input(what).expected("an array of three axes, [z, y, x]"));
    };
    let size = format.number.bytes();
    let cells = x.checked_mul(y).and_then(|cells| cells.checked_mul(z));
    if cells.and_then(|cells| cells.checked_mul(size)) != Some(data.len()) {
        let what = format!("{} bytes of data in an array of {z} × {y} × {x} numbers of {size} bytes", data.len());
        return Err(Error::input(what).expected("as many numbers as the header announces"));
    }
    let place = |i: usize| {
        if fortran_order { i / (x * y) + z * (i / x % y) + z * y * (i % x) } else { i }
    };
    let value = |i: usize| format.value(&data[size * place(i)..size * (place(i) + 1)]);
    FieldGrid::new([x, y, z], (0..data.len() / size).map(value))
}

fn bad_header(key: &str) -> Error {
    Error::input(format!("a .npy header without a valid `{key}`")).expected("descr, fortran_order and shape")
}

/// Splits a `.npy` file into two parts: the text of the header, and the data.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(b"\x93NUMPY")?;
    let (version, rest) = rest.split_at_checked(2)?;
    let (length, rest) = match version[0] {
        1 => {
            let (length, rest) = rest.split_first_chunk()?;
            (usize::from(u16::from_le_bytes(*length)), rest)
        }
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk()?;
            (usize::try_from(u32::from_le_bytes(*length)).ok()?, rest)
        }
        _ => return None,
    };
    let (header, data) = rest.split_at_checked(length)?;
    Some((std::str::from_utf8(header).ok()?, data))
}

/// Returns the text after a key of the header. The header is a Python dictionary.
fn entry<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

fn quoted<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    Some(entry(header, key)?.strip_prefix('\'')?.split_once('\'')?.0)
}

fn shape(header: &str) -> Option<Vec<usize>> {
    let (inside, _) = entry(header, "shape")?.strip_prefix('(')?.split_once(')')?;
    inside.split(',').map(str::trim).filter(|size| !size.is_empty()).map(|size| size.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    /// Returns a `.npy` file of version 1.
    fn array(description: &str, fortran_order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{{'descr': '{description}', 'fortran_order': {fortran_order}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    /// Returns a grid of 2 × 1 × 3 cells with the value 10·z + x at [z, 0, x].
    fn expected() -> FieldGrid {
        FieldGrid::new([3, 1, 2], [0.0, 1.0, 2.0, 10.0, 11.0, 12.0].into_iter()).unwrap()
    }

    #[test]
    fn every_order_and_kind_of_number_is_read() {
        let c = [0_u8, 1, 2, 10, 11, 12];
        let fortran = [0_u8, 10, 1, 11, 2, 12];
        assert_eq!(npy(&array("|u1", "False", "(2, 1, 3)", &c)).unwrap(), expected());
        assert_eq!(npy(&array("|u1", "True", "(2, 1, 3)", &fortran)).unwrap(), expected());
        let wide = |to: &dyn Fn(u8) -> Vec<u8>| -> Vec<u8> { c.iter().flat_map(|&value| to(value)).collect() };
        for (description, data) in [
            ("<f4", wide(&|v| f32::from(v).to_le_bytes().to_vec())),
            (">f4", wide(&|v| f32::from(v).to_be_bytes().to_vec())),
            ("<f8", wide(&|v| f64::from(v).to_le_bytes().to_vec())),
            (">f8", wide(&|v| f64::from(v).to_be_bytes().to_vec())),
            (">u2", wide(&|v| u16::from(v).to_be_bytes().to_vec())),
        ] {
            assert_eq!(npy(&array(description, "False", "(2, 1, 3)", &data)).unwrap(), expected(), "{description}");
        }
    }

    #[test]
    fn an_archive_of_one_array_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, arrays: &[&str]| {
            let path = folder.path().join(name);
            let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
            for name in arrays {
                archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
                archive.write_all(&array("|u1", "False", "(2, 1, 3)", &[0, 1, 2, 10, 11, 12])).unwrap();
            }
            archive.finish().unwrap();
            read(&path)
        };
        assert_eq!(write("one.npz", &["density.npy"]).unwrap(), expected());
        let error = write("two.npz", &["a.npy", "b.npy"]).unwrap_err().to_string();
        assert!(error.contains("an archive of 2 arrays"), "{error}");
        std::fs::write(folder.path().join("torn.npz"), b"PK\x03\x04").unwrap();
        let error = read(&folder.path().join("torn.npz")).unwrap_err().to_string();
        assert!(error.contains("a broken archive"), "{error}");
    }

    #[test]
    fn malformed_volume_files_are_refused() {
        for (bytes, words) in [
            (b"hello".to_vec(), "the file does not begin like a .npy array"),
            (b"\x93NUMPY\x01\x00\xff\xff{}".to_vec(), "the file does not begin like a .npy array"),
            (b"\x93NUMPY\x09\x00\x02\x00{}".to_vec(), "the file does not begin like a .npy array"),
            (array("<c16", "False", "(1, 1, 1)", &[0; 16]), "an array of numbers \"<c16\""),
            (array("|O", "False", "(1, 1, 1)", &[0; 16]), "an array of numbers \"|O\""),
            (array("|u1", "Maybe", "(1, 1, 1)", &[0]), "without a valid `fortran_order`"),
            (array("|u1", "False", "(1, -1, 1)", &[0]), "without a valid `shape`"),
            (array("|u1", "False", "(4, 4)", &[0; 16]), "an array of 2 axes"),
            (array("|u1", "False", "(4,)", &[0; 4]), "an array of 1 axes"),
            (array("|u1", "False", "(2, 2, 2)", &[0; 7]), "7 bytes of data in an array of 2 × 2 × 2"),
            (array("|u1", "False", "(2, 2, 2)", &[0; 9]), "9 bytes of data"),
            (array("<f8", "False", "(4294967296, 4294967296, 4294967296)", &[0; 8]), "8 bytes of data"),
            (array("|u1", "False", "(0, 2, 2)", &[]), "0 values for 2 × 2 × 0 cells"),
            (array("<f4", "False", "(1, 1, 1)", &f32::NAN.to_le_bytes()), "the value NaN in cell (0, 0, 0)"),
            (array("<f4", "False", "(1, 1, 1)", &(-1.0_f32).to_le_bytes()), "the value -1 in cell (0, 0, 0)"),
            (array("<f8", "False", "(1, 1, 1)", &1e300_f64.to_le_bytes()), "in cell (0, 0, 0)"),
        ] {
            let error = npy(&bytes).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
        for (name, words) in [("a.vdb", "no maintained reader"), ("a.raw", "\".raw\""), ("a.npy", "cannot read")] {
            let error = read(Path::new("/nowhere").join(name).as_path()).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
