//! Builds a scene in Rust, without JSON, and renders it: a glass ball over a grey floor.
//!
//! ```text
//! cargo run --release --example build_scene
//! ```
//!
//! The structs mirror the keys of the scene file, and the scene passes the same checks as a file.

use std::collections::BTreeMap;

use abbe::{RenderOptions, Scene};
use abbe_format::light::PointFile;
use abbe_format::{
    CameraFile, DielectricFile, ExposureFile, FilmFile, GamutFile, IndexFile, LensFile, LightFile, MaterialFile,
    ObjectFile, ObserverFile, OutputSpaceFile, ReflectanceFile, RenderFile, ScalarFile, SceneFile, ShapeFile,
    SpectrumFile, ToneFile, TransformFile, UnitFile, WhiteBalanceFile,
};

fn main() -> abbe::Result<()> {
    let reflectance = ReflectanceFile::Spectrum(SpectrumFile::Number(0.5));
    let glass = DielectricFile {
        ior: IndexFile::Name("N-BK7".to_string()),
        roughness: ScalarFile::Number(0.0),
        absorption: None,
        coating: None,
        medium: None,
        priority: 0,
    };
    let scene = SceneFile {
        schema: None,
        title: Some("A glass ball".to_string()),
        include: Vec::new(),
        variables: BTreeMap::new(),
        unit: UnitFile::Metre,
        camera: Some(CameraFile {
            from: [0.0, 2.0, 5.0],
            at: [0.0, 0.6, 0.0],
            up: [0.0, 1.0, 0.0],
            lens: LensFile::Pinhole { fov: 40.0 },
            filter: None,
            shutter: None,
            motion: Vec::new(),
        }),
        film: Some(FilmFile {
            width: 64,
            height: 48,
            observer: ObserverFile::Cie1931,
            spectral_bands: 0,
            layers: Vec::new(),
            stokes: false,
            denoise: None,
            gamut: GamutFile::Compress,
            tone: ToneFile::RollOff,
            white_balance: WhiteBalanceFile::None,
            output_space: OutputSpaceFile::Srgb,
            exposure: ExposureFile::Auto,
            bloom: None,
        }),
        spectra: BTreeMap::new(),
        media: BTreeMap::new(),
        materials: BTreeMap::from([
            ("grey".to_string(), MaterialFile::Diffuse { reflectance }),
            ("glass".to_string(), MaterialFile::Dielectric(glass)),
        ]),
        shapes: BTreeMap::new(),
        objects: vec![
            object("floor", ShapeFile::Rectangle { width: 10.0, height: 10.0 }, "grey"),
            object("ball", ShapeFile::Sphere { center: [0.0, 0.8, 0.0], radius: 0.7 }, "glass"),
        ],
        meters: Vec::new(),
        requirements: Vec::new(),
        lights: vec![LightFile::Point(PointFile {
            at: [2.0, 4.0, 1.0],
            spectrum: SpectrumFile::Name("D65".to_string()),
            power: Some(50.0),
            luminous_flux: None,
            intensity: None,
            luminous_intensity: None,
            group: None,
            transform: TransformFile::default(),
            motion: Vec::new(),
        })],
        atmosphere: None,
        render: RenderFile::default(),
    };

    let scene = Scene::try_from(&scene)?;
    let image = scene.render(&RenderOptions::default().passes(4).photons(50_000))?;
    let output = std::env::temp_dir().join("abbe-build-scene.png");
    image.write_png(&output)?;
    println!("wrote {}", output.display());
    Ok(())
}

fn object(name: &str, shape: ShapeFile, material: &str) -> ObjectFile {
    ObjectFile {
        name: Some(name.to_string()),
        shape,
        material: Some(material.to_string()),
        transform: TransformFile::default(),
        motion: Vec::new(),
        emission: None,
    }
}
