//! Packets of the image viewer tev, as documented in its README and its file `Ipc.cpp`
//! (<https://github.com/Tom94/tev>). A packet begins with its length in bytes and a byte for the
//! operation. All numbers are little-endian, and all texts end with a zero byte.

use abbe_spectra::colour::RgbSpace;
use abbe_transport::sensor::{Development, Picture};

pub const DEFAULT_PORT: u16 = 14158;

const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE_V3: u8 = 6;

const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// The largest number of pixels in a packet, unless a single row has more.
const PIXELS_PER_PACKET: usize = 1 << 16;

/// A picture as tev shows it: linear sRGB components, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct TevImage {
    pub name: String,
    pub width: usize,
    pub height: usize,
    /// Red, green and blue of each pixel. The exposure maps white to 1.
    pub rgb: Vec<f32>,
}

impl TevImage {
    /// Converts a picture with an exposure in 1/(cd/m²) and the white balance of `development`,
    /// without tone curve and gamut mapping. A name cannot contain zero bytes, which end a text, so
    /// spaces replace them.
    pub fn new(name: &str, picture: &Picture, exposure: f64, development: &Development) -> Self {
        let development = Development { space: RgbSpace::Srgb, ..*development };
        let matrix = development.matrix().map(|row| row.map(|entry| entry * exposure));
        let rgb = |xyz: &[f64; 3]| matrix.map(|row| (row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]) as f32);
        Self {
            name: name.replace('\0', " "),
            width: picture.width,
            height: picture.height,
            rgb: picture.xyz.iter().flat_map(rgb).collect(),
        }
    }

    /// Returns the packet that creates and selects the image, or replaces one of the same name.
    pub fn creation(&self) -> Vec<u8> {
        let mut packet = Packet::new(CREATE_IMAGE, true, &self.name);
        [self.width, self.height, CHANNELS.len()].into_iter().for_each(|number| packet.number(number));
        CHANNELS.iter().for_each(|channel| packet.text(channel));
        packet.finish()
    }

    /// Returns the packets that replace all pixels. Each packet contains some rows.
    pub fn updates(&self) -> impl Iterator<Item = Vec<u8>> {
        let rows = (PIXELS_PER_PACKET / self.width).max(1);
        let floats = CHANNELS.len() * self.width * rows;
        self.rgb.chunks(floats).enumerate().map(move |(index, rgb)| {
            let mut packet = Packet::new(UPDATE_IMAGE_V3, false, &self.name);
            packet.number(CHANNELS.len());
            CHANNELS.iter().for_each(|channel| packet.text(channel));
            let height = rgb.len() / (CHANNELS.len() * self.width);
            [0, index * rows, self.width, height].into_iter().for_each(|number| packet.number(number));
            // The components of a pixel are neighbours.
            (0..CHANNELS.len()).for_each(|offset| packet.long_number(offset));
            CHANNELS.iter().for_each(|_| packet.long_number(CHANNELS.len()));
            packet.0.extend(rgb.iter().flat_map(|value| value.to_le_bytes()));
            packet.finish()
        })
    }
}

/// A packet whose first four bytes are not written yet.
#[derive(Debug)]
struct Packet(Vec<u8>);

impl Packet {
    fn new(operation: u8, selects_image: bool, name: &str) -> Self {
        let mut packet = Self(vec![0, 0, 0, 0, operation, u8::from(selects_image)]);
        packet.text(name);
        packet
    }

    fn text(&mut self, text: &str) {
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// Appends a number of 32 bits. Pictures have at most 2³¹ − 1 rows and columns.
    fn number(&mut self, number: usize) {
        self.0.extend((number as i32).to_le_bytes());
    }

    fn long_number(&mut self, number: usize) {
        self.0.extend((number as i64).to_le_bytes());
    }

    fn finish(mut self) -> Vec<u8> {
        let length = self.0.len() as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::colour::linear_srgb_to_xyz;

    /// The bytes are written out by hand from the description of the protocol.
    #[test]
    fn packets_have_the_bytes_of_the_protocol() {
        let image = TevImage { name: "a".to_string(), width: 1, height: 1, rgb: vec![1.0, 0.5, 0.0] };
        let channels = [b'R', 0, b'G', 0, b'B', 0];
        let number = |value: u8| [value, 0, 0, 0];
        let long = |value: u8| [value, 0, 0, 0, 0, 0, 0, 0];
        let header = [number(26).as_slice(), &[4, 1, b'a', 0]].concat();
        let creation = [&header, number(1).as_slice(), &number(1), &number(3), &channels].concat();
        assert_eq!(image.creation(), creation);
        let header = [number(94).as_slice(), &[6, 0, b'a', 0], &number(3), &channels].concat();
        let window = [number(0), number(0), number(1), number(1)].concat();
        let places = [long(0), long(1), long(2), long(3), long(3), long(3)].concat();
        let values = [0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f, 0, 0, 0, 0];
        let update = [&header, &window, &places, values.as_slice()].concat();
        assert_eq!(image.updates().collect::<Vec<_>>(), [update]);
    }

    #[test]
    fn updates_cover_all_rows_once() {
        let (width, height) = (1000, 150);
        let image = TevImage { name: "a".to_string(), width, height, rgb: vec![0.0; 3 * width * height] };
        let rows = |packet: Vec<u8>| {
            let number = |at: usize| i32::from_le_bytes(packet[at..at + 4].try_into().unwrap());
            (number(22), number(30))
        };
        assert_eq!(image.updates().map(rows).collect::<Vec<_>>(), [(0, 65), (65, 65), (130, 20)]);
    }

    #[test]
    fn white_becomes_one() {
        let mut picture = Picture::black(1, 1);
        picture.xyz[0] = linear_srgb_to_xyz([200.0; 3]);
        let image = TevImage::new("a\0b", &picture, 1.0 / 200.0, &Development::default());
        assert_eq!(image.name, "a b");
        assert!(image.rgb.iter().all(|component| (component - 1.0).abs() < 1e-5), "{:?}", image.rgb);
    }
}
