//! Reads the accessors of glTF files, which are typed views of buffers.

use ::gltf::Accessor;
use ::gltf::accessor::sparse::IndexType;
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::buffer::View;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;

/// Reads the accessors of a glTF file.
pub struct GltfAccessors<'b> {
    buffers: &'b [Vec<u8>],
}

impl<'b> GltfAccessors<'b> {
    pub fn new(buffers: &'b [Vec<u8>]) -> Self {
        Self { buffers }
    }

    /// Returns the items of an accessor after checking that all items are inside the buffer. Each
    /// item has `size` bytes. Items without data are 0.
    fn items(&self, accessor: &Accessor, size: usize) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>> {
        /// The largest number of items without data.
        const MOST_ZEROS: usize = 1 << 24;
        /// An item without data. No item is larger.
        const ZERO: &[u8] = &[0; 64];
        let short = || Error::input(format!("accessor {} reaches beyond its buffer", accessor.index()));
        let count = accessor.count();
        let stored = match accessor.view() {
            Some(view) => self.view_items(&view, accessor.offset(), count, size).ok_or_else(short)?.collect(),
            None if count <= MOST_ZEROS => vec![&ZERO[..size]; count],
            None => return Err(short()),
        };
        let mut items: Vec<&'b [u8]> = stored;
        if let Some(sparse) = accessor.sparse() {
            let (indices, values) = (sparse.indices(), sparse.values());
            let width = match indices.index_type() {
                IndexType::U8 => 1,
                IndexType::U16 => 2,
                IndexType::U32 => 4,
            };
            let found = self.view_items(&indices.view(), indices.offset(), sparse.count(), width);
            let indices = found.ok_or_else(short)?;
            let values = self.view_items(&values.view(), values.offset(), sparse.count(), size).ok_or_else(short)?;
            for (index, value) in indices.zip(values) {
                let index = index.iter().rev().fold(0, |index, &byte| index << 8 | usize::from(byte));
                *items.get_mut(index).ok_or_else(short)? = value;
            }
        }
        Ok(items.into_iter())
    }

    /// Returns `count` items of `size` bytes, from an offset in a view, or `None` beyond its end.
    fn view_items(
        &self,
        view: &View,
        offset: usize,
        count: usize,
        size: usize,
    ) -> Option<impl Iterator<Item = &'b [u8]> + use<'b>> {
        let stride = view.stride().unwrap_or(size);
        if stride < size || count == 0 {
            return None;
        }
        let data = self.buffers.get(view.buffer().index())?;
        let in_view = data.get(view.offset()..view.offset().checked_add(view.length())?)?;
        let length = (count - 1).checked_mul(stride)?.checked_add(size)?;
        let items = in_view.get(offset..offset.checked_add(length)?)?;
        Some(items.chunks(stride).map(move |item| &item[..size]))
    }

    /// Returns vectors of three numbers. The numbers may be integers (KHR_mesh_quantization).
    pub fn vectors(&self, accessor: &Accessor) -> Result<impl Iterator<Item = DVec3> + use<'b>> {
        if accessor.dimensions() != Dimensions::Vec3 {
            return Err(Error::input(format!("accessor {} does not hold vectors of three numbers", accessor.index())));
        }
        Ok(self.numbers::<3>(accessor)?.map(DVec3::from_array))
    }

    /// Returns matrices of four rows and four columns, column by column.
    pub(super) fn matrices(&self, accessor: &Accessor) -> Result<Vec<[f64; 16]>> {
        if accessor.dimensions() != Dimensions::Mat4 || accessor.data_type() != DataType::F32 {
            return Err(Error::input(format!("accessor {} does not hold matrices", accessor.index())));
        }
        Ok(self.numbers::<16>(accessor)?.collect())
    }

    pub(super) fn pairs(&self, accessor: &Accessor) -> Result<Vec<[f64; 2]>> {
        if accessor.dimensions() != Dimensions::Vec2 {
            return Err(Error::input(format!("accessor {} does not hold texture coordinates", accessor.index())));
        }
        Ok(self.numbers::<2>(accessor)?.collect())
    }

    /// Returns arrays of `N` numbers. Normalised integers are divided by the largest of their type.
    fn numbers<const N: usize>(&self, accessor: &Accessor) -> Result<impl Iterator<Item = [f64; N]> + use<'b, N>> {
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

    pub(super) fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>> {
        let wrong = || Error::input(format!("accessor {} does not hold indices", accessor.index()));
        if accessor.dimensions() != Dimensions::Scalar {
            return Err(wrong());
        }
        Ok(match accessor.data_type() {
            DataType::U8 => self.items(accessor, 1)?.map(|item| u32::from(item[0])).collect(),
            DataType::U16 => self.items(accessor, 2)?.map(|it| u32::from(u16::from_le_bytes([it[0], it[1]]))).collect(),
            DataType::U32 => {
                self.items(accessor, 4)?.map(|item| u32::from_le_bytes([item[0], item[1], item[2], item[3]])).collect()
            }
            DataType::I8 | DataType::I16 | DataType::F32 => return Err(wrong()),
        })
    }

    /// Returns the numbers of scalars, vectors or quaternions, filled up with zeros.
    pub fn floats(&self, accessor: &Accessor) -> Result<Vec<[f64; 4]>> {
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
