//! Little-endian numbers of a file, with their places in errors.

use abbe_spectra::error::{Error, Result};
use std::io::BufRead;

pub(super) struct Bytes<R> {
    reader: R,
    /// The number of bytes that were read.
    offset: u64,
    /// The number of bytes of the file.
    length: u64,
}

impl<R: BufRead> Bytes<R> {
    pub(super) fn new(reader: R, length: u64) -> Self {
        Self { reader, offset: 0, length }
    }

    /// Returns the first four bytes without reading them, or zeros in a shorter file.
    pub(super) fn first(&mut self) -> Result<[u8; 4]> {
        let buffer =
            self.reader.fill_buf().map_err(|error| Error::input(format!("cannot read the ray file: {error}")))?;
        Ok(buffer.first_chunk().copied().unwrap_or_default())
    }

    pub(super) fn left(&self) -> u64 {
        self.length.saturating_sub(self.offset)
    }

    fn end(&self) -> Error {
        Error::input(format!("the file ends after {} bytes", self.length))
    }

    pub(super) fn read(&mut self, bytes: &mut [u8]) -> Result<()> {
        if bytes.len() as u64 > self.left() {
            return Err(self.end());
        }
        self.reader.read_exact(bytes).map_err(|error| Error::input(format!("cannot read the ray file: {error}")))?;
        self.offset += bytes.len() as u64;
        Ok(())
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        self.read(&mut bytes)?;
        Ok(bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub(super) fn u64(&mut self) -> Result<u64> {
        Ok(u64::from_le_bytes(self.array()?))
    }

    pub(super) fn f32(&mut self) -> Result<f32> {
        Ok(f32::from_le_bytes(self.array()?))
    }

    /// Reads a whole number within a range. `what` names it in errors.
    pub(super) fn whole(&mut self, what: &str, (least, most): (i32, i32)) -> Result<i32> {
        let at = self.offset;
        let value = self.i32()?;
        let in_range = (least..=most).contains(&value);
        in_range.then_some(value).ok_or_else(|| {
            Error::input(format!("{what} at byte {at}: {value}"))
                .expected(format!("a whole number from {least} to {most}"))
        })
    }

    pub(super) fn skip(&mut self, count: u64) -> Result<()> {
        if count > self.left() {
            return Err(self.end());
        }
        let mut left = count;
        let mut buffer = [0; 512];
        while left > 0 {
            let part = left.min(buffer.len() as u64) as usize;
            self.read(&mut buffer[..part])?;
            left -= part as u64;
        }
        Ok(())
    }

    /// Reads the rest of the file.
    pub(super) fn rest(&mut self) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let read = self.reader.read_to_end(&mut bytes);
        read.map_err(|error| Error::input(format!("cannot read the ray file: {error}")))?;
        Ok(bytes)
    }

    /// Checks that records of so many numbers fill the rest of the file.
    pub(super) fn check_records(&self, count: u64, numbers: usize) -> Result<()> {
        let expected = count.saturating_mul(4 * numbers as u64);
        if expected == self.left() {
            return Ok(());
        }
        let left = self.left();
        Err(Error::input(format!("{left} bytes of rays from byte {}", self.offset))
            .expected(format!("{expected} bytes: {count} rays of {numbers} numbers")))
    }
}

/// Converts the bytes of a record to numbers.
pub(super) fn numbers(record: &[u8], numbers: &mut [f32]) {
    for (number, bytes) in numbers.iter_mut().zip(record.chunks_exact(4)) {
        *number = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    }
}
