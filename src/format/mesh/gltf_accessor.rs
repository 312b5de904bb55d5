//! Reads the accessors of glTF files, which are typed views of buffers.

use ::gltf::Accessor;
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::Data;
use glam::DVec3;

use crate::error::{Error, Result};

/// Reads the accessors of a glTF file.
pub(in crate::format) struct GltfAccessors<'b> {
    buffers: &'b [Data],
}

impl<'b> GltfAccessors<'b> {
    pub(in crate::format) fn new(buffers: &'b [Data]) -> Self {
        Self { buffers }
    }

    /// Returns the items of an accessor after checking that all items are inside the buffer. Each
    /// item has `size` bytes.
    fn items(&self, accessor: &Accessor<'_>, size: usize) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>> {
        if accessor.sparse().is_some() {
            return Err(Error::input("sparse glTF accessors are not supported"));
        }
        let short = || Error::input(format!("accessor {} reaches beyond its buffer", accessor.index()));
        let view = accessor.view().ok_or_else(short)?;
        let (stride, count) = (view.stride().unwrap_or(size), accessor.count());
        if stride < size || count == 0 {
            return Err(Error::input(format!("accessor {} has no items or too small a stride", accessor.index())));
        }
        let data = self.buffers.get(view.buffer().index()).ok_or_else(short)?;
        let view_end = view.offset().checked_add(view.length()).ok_or_else(short)?;
        let in_view = data.get(view.offset()..view_end).ok_or_else(short)?;
        let length = (count - 1).checked_mul(stride).and_then(|length| length.checked_add(size)).ok_or_else(short)?;
        let end = accessor.offset().checked_add(length).ok_or_else(short)?;
        let items = in_view.get(accessor.offset()..end).ok_or_else(short)?;
        Ok(items.chunks(stride).map(move |item| &item[..size]))
    }

    /// Returns vectors of three numbers. The numbers may be integers (KHR_mesh_quantization).
    pub(in crate::format) fn vectors(&self, accessor: &Accessor<'_>) -> Result<impl Iterator<Item = DVec3> + use<'b>> {
        if accessor.dimensions() != Dimensions::Vec3 {
            return Err(Error::input(format!("accessor {} does not hold vectors of three numbers", accessor.index())));
        }
        Ok(self.numbers::<3>(accessor)?.map(DVec3::from_array))
    }

    /// Returns texture coordinates.
    pub(super) fn pairs(&self, accessor: &Accessor<'_>) -> Result<Vec<[f64; 2]>> {
        if accessor.dimensions() != Dimensions::Vec2 {
            return Err(Error::input(format!("accessor {} does not hold texture coordinates", accessor.index())));
        }
        Ok(self.numbers::<2>(accessor)?.collect())
    }

    /// Returns arrays of `N` numbers. If the accessor says so, integers are divided by the largest
    /// integer of their type.
    fn numbers<const N: usize>(&self, accessor: &Accessor<'_>) -> Result<impl Iterator<Item = [f64; N]> + use<'b, N>> {
        let (kind, normalized) = (accessor.data_type(), accessor.normalized());
        if kind == DataType::U32 {
            return Err(Error::input(format!("accessor {} holds integers of 32 bits", accessor.index())));
        }
        let size = kind.size();
        let number = move |item: &[u8], i: usize| {
            let (value, largest) = match kind {
                DataType::U8 => (f64::from(item[i]), 255.0),
                DataType::I8 => (f64::from(item[i] as i8), 127.0),
                DataType::U16 => (f64::from(u16::from_le_bytes([item[2 * i], item[2 * i + 1]])), 65535.0),
                DataType::I16 => (f64::from(i16::from_le_bytes([item[2 * i], item[2 * i + 1]])), 32767.0),
                DataType::F32 | DataType::U32 => return float(item, 4 * i),
            };
            if normalized { (value / largest).max(-1.0) } else { value }
        };
        Ok(self.items(accessor, N * size)?.map(move |item| std::array::from_fn(|i| number(item, i))))
    }

    /// Returns indices of vertices.
    pub(super) fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>> {
        let wrong = || Error::input(format!("accessor {} does not hold indices", accessor.index()));
        if accessor.dimensions() != Dimensions::Scalar {
            return Err(wrong());
        }
        Ok(match accessor.data_type() {
            DataType::U8 => self.items(accessor, 1)?.map(|item| u32::from(item[0])).collect(),
            DataType::U16 => {
                self.items(accessor, 2)?.map(|item| u32::from(u16::from_le_bytes([item[0], item[1]]))).collect()
            }
            DataType::U32 => {
                self.items(accessor, 4)?.map(|item| u32::from_le_bytes([item[0], item[1], item[2], item[3]])).collect()
            }
            DataType::I8 | DataType::I16 | DataType::F32 => return Err(wrong()),
        })
    }

    /// Returns the numbers of an accessor of scalars, vectors of three numbers, or quaternions.
    /// Each item is filled up with zeros.
    pub(in crate::format) fn floats(&self, accessor: &Accessor<'_>) -> Result<Vec<[f64; 4]>> {
        match accessor.dimensions() {
            Dimensions::Scalar => Ok(self.numbers(accessor)?.map(|[x]| [x, 0.0, 0.0, 0.0]).collect()),
            Dimensions::Vec3 => Ok(self.numbers(accessor)?.map(|[x, y, z]| [x, y, z, 0.0]).collect()),
            Dimensions::Vec4 => Ok(self.numbers(accessor)?.collect()),
            Dimensions::Vec2 | Dimensions::Mat2 | Dimensions::Mat3 | Dimensions::Mat4 => Err(Error::input(format!(
                "accessor {} does not hold numbers, vectors or quaternions",
                accessor.index()
            ))),
        }
    }
}

fn float(item: &[u8], at: usize) -> f64 {
    f64::from(f32::from_le_bytes([item[at], item[at + 1], item[at + 2], item[at + 3]]))
}
