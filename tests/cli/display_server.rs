//! `abbe render --display-server`: a small server in the place of tev checks what it receives.

use crate::abbe_command::folder::with_ball;
use crate::abbe_command::{Said, abbe, command};
use abbe_session::output::exr;
use std::io::Read;
use std::net::TcpListener;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

/// The exposure of all pictures is 1/64 per cd/m².
const SCENE: &str = r#"{
  "camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 300, "height": 240, "exposure": {"ev": -6}},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
  "objects": [{"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}],
  "render": {"passes": 4, "photons": 100}
}"#;

/// A listener, and its address as an argument.
fn listen() -> (TcpListener, String) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap().to_string();
    (listener, address)
}

fn render(folder: &Path, address: &str, more: &[&str]) -> Said {
    abbe(folder, &[&["render", "ball.json", "--quiet", "--display-server", address], more].concat())
}

/// Reads the fields of a packet one after another.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn byte(&mut self) -> u8 {
        let byte = self.0[0];
        self.0 = &self.0[1..];
        byte
    }

    fn text(&mut self) -> String {
        let end = self.0.iter().position(|byte| *byte == 0).unwrap();
        let text = String::from_utf8(self.0[..end].to_vec()).unwrap();
        self.0 = &self.0[end + 1..];
        text
    }

    fn number(&mut self) -> usize {
        let number = i32::from_le_bytes(self.0[..4].try_into().unwrap());
        self.0 = &self.0[4..];
        usize::try_from(number).unwrap()
    }

    fn long_number(&mut self) -> i64 {
        let number = i64::from_le_bytes(self.0[..8].try_into().unwrap());
        self.0 = &self.0[8..];
        number
    }
}

/// Splits a stream into packets without their lengths.
fn packets(mut bytes: &[u8]) -> Vec<&[u8]> {
    let mut packets = Vec::new();
    while !bytes.is_empty() {
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        packets.push(&bytes[4..length]);
        bytes = &bytes[length..];
    }
    packets
}

/// The last picture in tev is the saved one, times the exposure.
#[test]
fn tev_receives_the_growing_picture() {
    let folder = with_ball(SCENE);
    let (listener, address) = listen();
    let receive = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        listener.accept().unwrap().0.read_to_end(&mut bytes).unwrap();
        bytes
    });
    let said = render(folder.path(), &address, &[]);
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    let bytes = receive.join().unwrap();
    let (mut shown, mut pictures) = (vec![f32::NAN; 300 * 240 * 3], 0);
    for (index, packet) in packets(&bytes).into_iter().enumerate() {
        let mut fields = Fields(packet);
        let (operation, selects) = (fields.byte(), fields.byte());
        assert_eq!(fields.text(), "ball.exr");
        if index == 0 {
            assert_eq!((operation, selects), (4, 1));
            assert_eq!([fields.number(), fields.number(), fields.number()], [300, 240, 3]);
            assert_eq!([fields.text(), fields.text(), fields.text()], ["R", "G", "B"]);
            assert!(fields.0.is_empty());
            continue;
        }
        assert_eq!((operation, selects, fields.number()), (6, 0, 3));
        assert_eq!([fields.text(), fields.text(), fields.text()], ["R", "G", "B"]);
        let [x, y, width, height] = [(); 4].map(|()| fields.number());
        assert_eq!((x, width), (0, 300));
        assert_eq!([(); 6].map(|()| fields.long_number()), [0, 1, 2, 3, 3, 3]);
        let values: Vec<f32> = fields.0.chunks(4).map(|value| f32::from_le_bytes(value.try_into().unwrap())).collect();
        shown[y * 900..(y + height) * 900].copy_from_slice(&values);
        pictures += usize::from(y == 0);
    }
    assert!(pictures >= 2, "the coarse picture and the last one: {pictures}");
    let saved = exr::read(&folder.path().join("ball.exr")).unwrap().picture;
    for (rgb, xyz) in shown.chunks(3).zip(&saved.xyz) {
        let y = 0.212_639 * rgb[0] + 0.715_169 * rgb[1] + 0.072_192 * rgb[2];
        assert!((f64::from(y) - xyz[1] / 64.0).abs() <= 1e-4 * xyz[1] / 64.0 + 1e-7, "{rgb:?} {xyz:?}");
    }
}

#[test]
fn an_absent_tev_is_an_error_at_the_start() {
    let folder = with_ball(SCENE);
    let (listener, address) = listen();
    drop(listener);
    render(folder.path(), &address, &[]).is_error(1, &["no tev at", &address]);
    render(folder.path(), "127.0.0.1:x", &[]).is_error(2, &["--display-server", "HOST:PORT"]);
    assert!(!folder.path().join("ball.exr").exists(), "nothing was rendered");
}

/// The render goes on, and its picture does not change.
#[test]
fn a_tev_that_goes_away_costs_one_note() {
    let folder = with_ball(SCENE);
    let (listener, address) = listen();
    // The server closes the connection at the end of the closure.
    let server = std::thread::spawn(move || listener.accept().unwrap().0.read_exact(&mut [0; 1000]).unwrap());
    let more = ["--time", "2s", "--reproducible", "-o", "a.exr"];
    let said = render(folder.path(), &address, &more);
    server.join().unwrap();
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.err.contains("does not answer") && said.err.trim_end().lines().count() == 1, "{}", said.err);
    let saved = exr::read(&folder.path().join("a.exr")).unwrap();
    let passes = saved.metadata.get("abbe.passes").unwrap();
    assert!(passes.parse::<u64>().unwrap() > 1, "{passes}");
    let again = ["render", "ball.json", "--quiet", "--passes", passes, "-o", "b.exr"];
    assert_eq!(abbe(folder.path(), &again).status, 0);
    assert_eq!(exr::read(&folder.path().join("b.exr")).unwrap().picture, saved.picture);
}

/// A server that reads nothing.
#[test]
fn a_slow_tev_does_not_slow_the_render() {
    let folder = with_ball(SCENE);
    let (listener, address) = listen();
    let arguments = ["render", "ball.json", "--quiet", "--time", "4s", "--display-server", &address];
    let start = Instant::now();
    let child = command(folder.path()).args(arguments).args(["--size", "900x720"]).stderr(Stdio::piped()).spawn();
    let stream = listener.accept().unwrap();
    let said: Said = child.unwrap().wait_with_output().unwrap().into();
    drop(stream);
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(said.err.contains("too slow"), "{}", said.err);
    // The time of the render, of its last pass, and of the wait at the end.
    assert!(start.elapsed() < Duration::from_secs(25), "{:?}", start.elapsed());
}
