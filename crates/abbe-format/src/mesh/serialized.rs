//! The mesh files of Mitsuba (`.serialized`), versions 3 and 4.
//!
//! A file holds any number of meshes. Each mesh is a header followed by a zlib stream. A table at
//! the end of the file states where the meshes start. The format is described in the documentation
//! of Mitsuba 3, plugin `serialized`.

use super::{packed::unpacked, part::MeshPart};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use flate2::read::ZlibDecoder;
use glam::DVec3;

/// The first number of a file and of each mesh.
const MAGIC: u16 = 0x041C;

/// The bits of a mesh that state its contents.
mod flags {
    pub(super) const NORMALS: u32 = 0x0001;
    pub(super) const UVS: u32 = 0x0002;
    pub(super) const COLOURS: u32 = 0x0008;
    pub(super) const FACE_NORMALS: u32 = 0x0010;
    pub(super) const DOUBLE: u32 = 0x2000;
}

/// Reads a file. Each mesh is a part.
pub(super) fn load(bytes: &[u8]) -> Result<Vec<MeshPart>> {
    let starts = starts(bytes)?;
    starts.into_iter().map(|start| part(bytes, start)).collect()
}

/// Returns the positions of the meshes in the file.
fn starts(bytes: &[u8]) -> Result<Vec<usize>> {
    let version = header(bytes, 0)?;
    let truncated = || Error::input("the serialized mesh file is truncated");
    let (count_at, entry) = (bytes.len().checked_sub(4).ok_or_else(truncated)?, if version < 4 { 4 } else { 8 });
    let count = number(bytes, count_at, 4).ok_or_else(truncated)?;
    let table = count.checked_mul(entry).and_then(|length| count_at.checked_sub(length)).ok_or_else(truncated)?;
    if count == 0 {
        return Err(Error::input("the serialized mesh file has no meshes"));
    }
    (0..count).map(|i| number(bytes, table + i * entry, entry).ok_or_else(truncated)).collect()
}

fn header(bytes: &[u8], at: usize) -> Result<usize> {
    let word = |at: usize| number(bytes, at, 2);
    match (word(at), at.checked_add(2).and_then(word)) {
        (Some(magic), Some(version)) if magic == usize::from(MAGIC) && (3..=4).contains(&version) => Ok(version),
        (Some(magic), Some(version)) if magic == usize::from(MAGIC) => {
            Err(Error::input(format!("the serialized mesh file has the version {version}")).expected("version 3 or 4"))
        }
        _ => Err(Error::input("not a valid serialized mesh file")),
    }
}

/// Reads a number of `size` bytes. Returns `None` if it reaches beyond the end.
fn number(bytes: &[u8], at: usize, size: usize) -> Option<usize> {
    let digits = bytes.get(at..at.checked_add(size)?)?;
    let value = digits.iter().rev().fold(0_u64, |value, &digit| value << 8 | u64::from(digit));
    usize::try_from(value).ok()
}

/// Reads the mesh that starts at a position.
fn part(bytes: &[u8], start: usize) -> Result<MeshPart> {
    let version = header(bytes, start)?;
    // The decoder stops at the end of the stream. Anything may follow it.
    let data = unpacked(ZlibDecoder::new(&bytes[start + 4..]), "zlib stream of a serialized mesh")?;
    let mut data = MeshData { rest: &data };
    let declared = data.number(4)? as u32;
    let name = if version >= 4 { data.text()? } else { String::new() };
    let [vertices, faces] = [data.number(8)?, data.number(8)?];
    let size = if declared & flags::DOUBLE == 0 { 4 } else { 8 };
    let positions = data.vectors(vertices, size)?;
    let normals = if declared & flags::NORMALS == 0 { None } else { Some(data.vectors(vertices, size)?) };
    let uvs = if declared & flags::UVS == 0 { None } else { Some(data.floats::<2>(vertices, size)?) };
    if declared & flags::COLOURS != 0 {
        data.floats::<3>(vertices, size)?;
    }
    let index_size = if u32::try_from(vertices).is_ok() { 4 } else { 8 };
    let mut triangles = Vec::new();
    for corner in data.take(faces, 3 * index_size)?.chunks_exact(3 * index_size) {
        let index = |i: usize| number(corner, i * index_size, index_size).and_then(|index| u32::try_from(index).ok());
        let index = |i: usize| index(i).ok_or_else(|| Error::input("the mesh has more than 2³² vertices"));
        triangles.push([index(0)?, index(1)?, index(2)?]);
    }
    let normals = normals.filter(|_| declared & flags::FACE_NORMALS == 0);
    let mesh = TriangleMesh::new(positions, normals, uvs, triangles)?;
    Ok(MeshPart { mesh, material: None, material_number: None, name, colours: None })
}

/// The rest of an unpacked mesh.
struct MeshData<'d> {
    rest: &'d [u8],
}

impl<'d> MeshData<'d> {
    /// Takes `count` items of `size` bytes.
    fn take(&mut self, count: usize, size: usize) -> Result<&'d [u8]> {
        let taken = count.checked_mul(size).and_then(|length| self.rest.split_at_checked(length));
        let (taken, rest) = taken.ok_or_else(|| Error::input("a mesh of the serialized file is truncated"))?;
        self.rest = rest;
        Ok(taken)
    }

    fn number(&mut self, size: usize) -> Result<usize> {
        let digits = self.take(1, size)?;
        number(digits, 0, size).ok_or_else(|| Error::input("a mesh of the serialized file is too large"))
    }

    /// Takes a text that ends with a zero byte.
    fn text(&mut self) -> Result<String> {
        let length = self.rest.iter().position(|&byte| byte == 0);
        let length = length.ok_or_else(|| Error::input("a name in the serialized file has no end"))?;
        let text = String::from_utf8_lossy(&self.rest[..length]).into_owned();
        self.rest = &self.rest[length + 1..];
        Ok(text)
    }

    /// Takes `count` arrays of `N` floats. A float has `size` bytes.
    fn floats<const N: usize>(&mut self, count: usize, size: usize) -> Result<Vec<[f64; N]>> {
        let float = |bytes: &[u8]| match bytes.first_chunk() {
            Some(double) => f64::from_le_bytes(*double),
            None => bytes.first_chunk().map_or(f64::NAN, |single| f64::from(f32::from_le_bytes(*single))),
        };
        let bytes = self.take(count, N * size)?;
        let item = |item: &[u8]| std::array::from_fn(|i| float(&item[i * size..(i + 1) * size]));
        Ok(bytes.chunks_exact(N * size).map(item).collect())
    }

    fn vectors(&mut self, count: usize, size: usize) -> Result<Vec<DVec3>> {
        Ok(self.floats::<3>(count, size)?.into_iter().map(DVec3::from_array).collect())
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    /// Returns a file with two meshes, each one triangle: one in single precision, and one in
    /// double precision with texture coordinates and colours.
    fn two_meshes(version: u16) -> Vec<u8> {
        let mut file = Vec::new();
        let mut starts = Vec::new();
        for (declared, size) in [(0x1000 | flags::NORMALS, 4), (flags::DOUBLE | flags::UVS | flags::COLOURS, 8)] {
            starts.push(file.len() as u64);
            let mut data = declared.to_le_bytes().to_vec();
            if version >= 4 {
                data.extend(b"part\0");
            }
            data.extend(3_u64.to_le_bytes());
            data.extend(1_u64.to_le_bytes());
            let mut floats = vec![0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
            floats.extend(if size == 4 { [0.0, 0.0, 1.0].repeat(3) } else { vec![0.25; 6 + 9] });
            for x in floats {
                if size == 4 { data.extend((x as f32).to_le_bytes()) } else { data.extend(f64::to_le_bytes(x)) }
            }
            [0_u32, 1, 2].iter().for_each(|index| data.extend(index.to_le_bytes()));
            file.extend(MAGIC.to_le_bytes());
            file.extend(version.to_le_bytes());
            let mut encoder = flate2::write::ZlibEncoder::new(&mut file, flate2::Compression::fast());
            encoder.write_all(&data).unwrap();
            encoder.finish().unwrap();
        }
        for start in starts {
            if version >= 4 { file.extend(start.to_le_bytes()) } else { file.extend((start as u32).to_le_bytes()) }
        }
        file.extend(2_u32.to_le_bytes());
        file
    }

    #[test]
    fn both_versions_hold_several_meshes() {
        for version in [3, 4] {
            let parts = load(&two_meshes(version)).unwrap();
            assert_eq!(parts.len(), 2);
            assert_eq!(parts[0].name, if version == 4 { "part" } else { "" });
            assert!(parts[0].mesh.normals().is_some() && parts[0].mesh.uvs().is_none());
            assert!(parts[1].mesh.normals().is_none() && parts[1].mesh.uvs().unwrap()[2] == [0.25, 0.25]);
            assert!(parts.iter().all(|part| (part.mesh.area() - 0.5).abs() < 1e-15));
        }
    }

    /// Each cut and each change of a byte gives an error or a mesh, and never a panic.
    #[test]
    fn damaged_files_are_errors() {
        let whole = two_meshes(4);
        for length in 0..whole.len() {
            assert!(load(&whole[..length]).is_err(), "{length} bytes");
        }
        for at in 0..whole.len() {
            for bit in [1, 16, 128] {
                let mut damaged = whole.clone();
                damaged[at] ^= bit;
                let _ = load(&damaged);
            }
        }
        assert!(load(&[0x1C, 4, 9, 0, 0, 0, 0, 0]).unwrap_err().to_string().contains("version 9"));
    }
}
