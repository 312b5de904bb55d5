//! The kinds of files that are fuzzed, with valid examples of each.

use std::path::Path;

use abbe::api::read_scene_text;
use abbe_format::luminaire::{self, LuminaireSummary};
use abbe_format::volume_file;
use abbe_format::{self as format, FileAccess};
use abbe_format::{mesh, resolve};
use abbe_optics::glass::{AgfCatalogue, IndexFileData};
use abbe_optics::phase;
use abbe_session::output::Metadata;
use abbe_session::output::exr;
use abbe_session::render::{Integrator, Job, NoMonitor, PartSet, RenderIdentity, Request, SavedRun, StopRules};
use abbe_spectra::spectrum::{Outside, read};
use abbe_transport::sensor::SpectralBands;

/// A kind of input.
pub(crate) struct Target {
    pub(crate) name: &'static str,
    pub(crate) extension: &'static str,
    /// Its share of the cases.
    pub(crate) share: u64,
    /// Valid inputs.
    pub(crate) good: Vec<Vec<u8>>,
    /// Other files in the same folder.
    pub(crate) beside: Vec<(&'static str, Vec<u8>)>,
    /// Reads a file; returns whether it was valid.
    pub(crate) read: fn(&Path) -> bool,
}

impl Target {
    fn new(
        name: &'static str,
        extension: &'static str,
        share: u64,
        good: Vec<Vec<u8>>,
        read: fn(&Path) -> bool,
    ) -> Self {
        Self { name, extension, share, good, beside: Vec::new(), read }
    }
}

pub(crate) fn all() -> Vec<Target> {
    let mesh = |path: &Path| mesh::load(path, FileAccess::WithinFolder).is_ok();
    let spectrum = |path: &Path| read::spectrum_file(path, Outside::Zero).is_ok();
    let of_sample = |path: &Path| read::samples_of(path, Some("A2")).is_ok();
    let luminaire = |path: &Path| {
        let read = luminaire::read(path, FileAccess::WithinFolder);
        read.and_then(|photometry| LuminaireSummary::of(&photometry)).is_ok()
    };
    let lens = |path: &Path| resolve::lens_file(path, &[]).is_ok();
    let beside = vec![("cube.bin", buffer()), ("a.mtl", MTL.as_bytes().to_vec())];
    let bytes = |text: &str| text.as_bytes().to_vec();
    vec![
        Target::new("scene", "json", 30, scenes(), plans),
        Target::new("pbrt", "pbrt", 6, import_examples("pbrt", &["cornell.pbrt", "plates.pbrt", "prism.pbrt"]), plans),
        Target {
            beside: vec![("film.xml", import_examples("mitsuba", &["film.xml"]).remove(0))],
            ..Target::new("mitsuba", "xml", 6, import_examples("mitsuba", &MITSUBA_SCENES), plans)
        },
        Target::new("index", "yml", 2, vec![bytes(INDEX)], is_index),
        Target::new("index", "csv", 1, vec![bytes("nm,n,k\n400,1.5,2\n800,0.2,4\n")], is_index),
        Target::new("set", "txt", 12, SETS.iter().map(|set| bytes(set)).collect(), patches),
        Target { beside: beside.clone(), ..Target::new("obj", "obj", 8, vec![bytes(OBJ)], mesh) },
        Target::new("ply", "ply", 8, vec![bytes(PLY), binary_ply()], mesh),
        Target::new("stl", "stl", 8, vec![bytes(STL), binary_stl()], mesh),
        Target::new("serialized", "serialized", 4, vec![serialized()], mesh),
        Target::new("gem", "asc", 4, vec![bytes(GEM_ASC)], mesh),
        Target::new("gem", "gem", 4, vec![gem()], mesh),
        Target::new("gem", "gcs", 4, vec![bytes(GEM_GCS)], mesh),
        Target {
            beside: beside.clone(),
            ..Target::new("gltf", "gltf", 6, vec![bytes(&gltf("\"uri\": \"cube.bin\", "))], mesh)
        },
        Target { beside, ..Target::new("room", "gltf", 4, vec![bytes(&gltf("\"uri\": \"cube.bin\", "))], plans) },
        Target {
            beside: vec![("room.glb", glb())],
            ..Target::new("overlay", "json", 2, vec![bytes(OVERLAY)], overlays)
        },
        Target::new("glb", "glb", 6, vec![glb()], mesh),
        Target::new("spdx", "spdx", 5, vec![bytes(SPDX)], spectrum),
        Target::new("chart", "ti3", 3, vec![bytes(CHART)], of_sample),
        Target::new("table", "csv", 4, vec![bytes("nm,value\n400,0.1\n500,0.5\n600,1\n700,0.2\n")], spectrum),
        Target::new("zemax", "zmx", 5, vec![bytes(ZMX)], lens),
        Target::new("oslo", "len", 3, vec![bytes(OSLO)], lens),
        Target::new("bench", "txt", 3, vec![bytes(BENCH)], lens),
        Target::new("prescription", "json", 4, vec![bytes(PRESCRIPTION)], lens),
        Target::new("catalogue", "agf", 2, vec![bytes(AGF)], |path| {
            AgfCatalogue::parse(&std::fs::read(path).unwrap(), path).and_then(|file| file.find("OWN-7")).is_ok()
        }),
        Target::new("volume", "npy", 2, vec![npy()], |path| volume_file::read(path).is_ok()),
        Target::new("volume", "npz", 2, vec![npz()], |path| volume_file::read(path).is_ok()),
        Target::new("phase", "csv", 1, vec![bytes(PHASE)], |path| {
            phase::parse_table(&String::from_utf8_lossy(&std::fs::read(path).unwrap())).is_ok()
        }),
        Target::new("luminaire", "ies", 4, vec![bytes(IES), bytes(IES_TYPE_B)], luminaire),
        Target::new("luminaire", "ldt", 4, vec![bytes(LDT)], luminaire),
        Target::new("luminaire", "tm33", 4, vec![bytes(TM33)], luminaire),
        Target::new("checkpoint", "exr", 4, vec![checkpoint()], is_saved),
        Target::new("sky", "exr", 1, vec![picture()], is_sky),
        Target::new("spectral_sky", "exr", 6, vec![spectral_picture()], is_sky),
        Target::new("sky", "png", 1, vec![png()], is_sky),
        Target::new("sky", "hdr", 1, vec![HDR.to_vec()], is_sky),
    ]
}

/// Returns the inputs whose structure is changed, and the step with which changes are chosen.
pub(crate) fn structured() -> Vec<(Target, usize)> {
    let mesh = |path: &Path| mesh::load(path, FileAccess::WithinFolder).is_ok();
    let bytes = |text: &str| text.as_bytes().to_vec();
    let library = |path: &Path| mesh::load(&path.with_file_name("user.obj"), FileAccess::WithinFolder).is_ok();
    let beside = vec![("a.mtl", bytes(MTL)), ("user.obj", bytes(OBJ)), ("a.png", png()), ("a.ies", bytes(IES))];
    let mtl = format!(
        "{MTL}Tr 0.5\nKs 1 1 1\nKe 0 0 1\nNs 10\nPm 0.5\nPr 0.1\nTf 1 1 1\nmap_Kd -s 2 2 -o 0 0 -clamp on a.png\n"
    );
    let gltf = || vec![super::rich_gltf::text().into_bytes()];
    let targets = [
        (Target::new("obj", "obj", 1, vec![bytes(OBJ)], mesh), 1),
        (Target::new("a", "mtl", 1, vec![mtl.into_bytes()], library), 1),
        (Target::new("ply", "ply", 1, vec![bytes(PLY)], mesh), 1),
        (Target::new("stl", "stl", 1, vec![bytes(STL)], mesh), 1),
        (Target::new("rich", "gltf", 1, gltf(), mesh), 1),
        (Target::new("room", "gltf", 1, gltf(), plans), 61),
    ];
    targets.map(|(target, step)| (Target { beside: beside.clone(), ..target }, step)).into()
}

/// Small scenes. Scenes with a lens system are left out, because tracing their pupils takes 0.1 s;
/// lens prescriptions are a target of their own.
fn scenes() -> Vec<Vec<u8>> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths: Vec<_> = ["tests/good_scenes", "scenes"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(package.join(folder)).unwrap().map(|entry| entry.unwrap().path()))
        .filter(|path| path.extension().is_some_and(|end| end == "json") && !path.ends_with("scene.schema.json"))
        .collect();
    paths.sort();
    let texts = paths.iter().map(|path| std::fs::read_to_string(path).unwrap());
    texts.filter(|text| !text.contains("\"prescription\"")).map(String::into_bytes).collect()
}

/// Scenes of Mitsuba that name no other files than the film.
const MITSUBA_SCENES: [&str; 5] = ["cornell.xml", "fog.xml", "lights.xml", "metal.xml", "plastic.xml"];

/// Scenes of other programs.
fn import_examples(program: &str, names: &[&str]) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/import").join(program);
    names.iter().map(|name| std::fs::read(folder.join(name)).unwrap()).collect()
}

/// An entry of refractiveindex.info.
const INDEX: &str = "REFERENCES: a data sheet\nDATA:\n  - type: formula 2\n    wavelength_range: 0.3 2.5\n    \
    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n  \
    - type: tabulated k\n    data: |\n        0.300 2.8607E-06\n        2.5 8.1E-06\n";

/// Reads the index of a glass or of a metal.
fn is_index(path: &Path) -> bool {
    let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    IndexFileData::parse(&text, path).is_ok_and(|data| data.index().is_ok() || data.n_and_k().is_ok())
}

/// Changes the scene of another program.
const OVERLAY: &str = r#"{"materials": {"glass": {"dielectric": {"ior": "N-SF10"}}},
  "lights": {"sky": {"spectrum": "D65", "illuminance": 10}}, "objects": {"node 1": {"name": "cube"}},
  "camera": {"lens": {"pinhole": {"fov": 20}}}, "film": {"width": 9}, "render": {"passes": 2}}"#;

/// Applies a file to the scene beside it.
fn overlays(path: &Path) -> bool {
    let room = path.with_file_name("room.glb");
    let text = read_scene_text(&room, FileAccess::WithinFolder, Some(path));
    text.and_then(|scene| format::parse(&scene.text, &room, &[])).is_ok()
}

/// Reads a scene, converts it if it belongs to another program, resolves it and plans it.
fn plans(path: &Path) -> bool {
    let text = read_scene_text(path, FileAccess::WithinFolder, None);
    let read = text.and_then(|scene| format::parse(&scene.text, path, &[]));
    read.and_then(|(scene, source)| resolve::resolve(&scene, &source)).and_then(Job::new).is_ok()
}

const SCENE: &str = r#"{"camera": {"from": [0, 2, 5], "at": [0, 0.5, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 4, "height": 3, "spectral_bands": 2},
  "materials": {"grey": {"diffuse": {"reflectance": 0.5}}, "glass": {"dielectric": {"ior": "SF10"}}},
  "objects": [{"name": "floor", "shape": {"rectangle": {"width": 6, "height": 6}}, "material": "grey"},
    {"name": "ball", "shape": {"sphere": {"center": [0, 0.6, 0], "radius": 0.5}}, "material": "glass"}],
  "lights": [{"point": {"at": [1, 4, 1], "spectrum": "D65", "power": 20}}], "render": {"photons": 50}}"#;

const SETS: [&str; 6] = [
    "film.width=640",
    "objects[1].material=\"grey\"",
    "lights[0]={\"point\":{\"at\":[0,1,0],\"spectrum\":{\"lines\":[{\"nm\":589.3,\"power\":1}]},\"power\":1}}",
    "materials.glass.dielectric.ior={\"cauchy\":{\"a\":1.5,\"b\":0.004}}",
    "render.photons=1000",
    "objects[0].transform=[{\"translate\":[0,1,0]},{\"rotate\":{\"axis\":[0,1,0],\"degrees\":30}}]",
];

/// Uses the text as a patch of a valid scene.
fn patches(path: &Path) -> bool {
    let patch = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
    let read = format::parse(SCENE, Path::new("scene.json"), &[patch]);
    read.and_then(|(scene, source)| resolve::resolve(&scene, &source)).is_ok()
}

/// Uses the picture as the surroundings of a scene.
fn is_sky(path: &Path) -> bool {
    let name = path.file_name().unwrap().to_str().unwrap();
    let patch = format!("lights[0]={{\"environment\":{{\"image\":{{\"path\":\"{name}\"}},\"irradiance\":1}}}}");
    let read = format::parse(SCENE, &path.with_file_name("scene.json"), &[patch]);
    read.and_then(|(scene, source)| resolve::resolve(&scene, &source)).is_ok()
}

/// Reads the file as a picture and as a part to be merged.
fn is_saved(path: &Path) -> bool {
    let picture = exr::read(path).is_ok();
    PartSet::new(&[path.to_path_buf()]).and_then(PartSet::merge).is_ok() && picture
}

fn checkpoint() -> Vec<u8> {
    let (scene, source) = format::parse(SCENE, Path::new("scene.json"), &[]).unwrap();
    let job = Job::new(resolve::resolve(&scene, &source).unwrap()).unwrap();
    let request = Request { integrator: Integrator::Path, stop: StopRules { passes: Some(3), ..StopRules::default() } };
    let run = job.render(request, &mut NoMonitor).unwrap().run;
    let metadata = Metadata::new().with("abbe.version", env!("CARGO_PKG_VERSION")).with("abbe.seed", "0");
    let identity = RenderIdentity::of(&job, Integrator::Path, &metadata);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    SavedRun::write(&path, &job, &identity, &run, metadata).unwrap();
    assert!(is_saved(&path));
    std::fs::read(path).unwrap()
}

fn picture() -> Vec<u8> {
    exr::encode(
        &abbe_transport::sensor::Picture {
            xyz: vec![[0.2, 0.3, 0.1]; 12],
            ..abbe_transport::sensor::Picture::black(4, 3)
        },
        &Metadata::new(),
    )
    .unwrap()
}

fn spectral_picture() -> Vec<u8> {
    let bands = SpectralBands { centres_nm: SpectralBands::centres_nm(3), values: vec![0.5; 36] };
    let picture = abbe_transport::sensor::Picture::black(4, 3);
    exr::encode(&abbe_transport::sensor::Picture { bands: Some(bands), ..picture }, &Metadata::new()).unwrap()
}

pub(crate) fn png() -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_fn(4, 2, |x, y| image::Rgb([60 * x as u8, 100 * y as u8, 200]))
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

const HDR: &[u8] = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n\x80\x40\x20\x81\x80\x40\x20\x82\x80\x40\x20\x83\x80\x40\x20\x84";

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nvn 0 0 1\nusemtl glass\n\
    f 1/1/1 3/3/1 2/2/1\nf 1 2 4\nf 1 4 3\nf -3 -2 -1\n";

const MTL: &str = "newmtl glass\nKd 0.5 0.5 0.5\nNi 1.5\nd 0.2\nillum 7\n";

const GEM_ASC: &str = "GemCad 5.0\ng 96 0.0\ny 4 y\nI 1.54\nH Step\na 90 0.5 96 24 48 72 n G\na -42 0.4 96 n P 24 48 72\n\
                       a 30 0.35 12 n C 36 60 84 G Meet G\na 0 0.25 96 n T\nF End\n";

const GEM_GCS: &str = r#"<GemCutStudio version="1000"><index gear="96" base="0" symmetry="4" mirror="0"/>
<tier angle="90" depth="1" name="G" instructions="" visible="true" guide="false"><facet index_angle="0"/>
<facet nx="1" ny="0" nz="0" index_angle="270"><vertex x="1" y="0" z="0"/></facet><facet index_angle="90"/>
<facet index_angle="180"/></tier><tier angle="180" depth="0.5"><facet index_angle="0"/></tier>
<tier angle="0" depth="0.5" frosting="0.5"><facet nx="0" ny="0" nz="1"/></tier>
<render material="Quartz" refractive_index="1.54"><color r="1" g="1" b="1"/></render><info title="A"/></GemCutStudio>"#;

const PLY: &str = "ply\nformat ascii 1.0\ncomment a pyramid\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

const STL: &str =
    "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";

const SPDX: &str = r#"<?xml version="1.0"?>
<IESTM2714 version="1.0"><Header><Description>lamp</Description></Header>
<SpectralDistribution><SpectralQuantity>radiant</SpectralQuantity>
<SpectralData wavelength="400">0.034</SpectralData><SpectralData wavelength="500">0.5</SpectralData>
<SpectralData wavelength="700">0.1</SpectralData></SpectralDistribution></IESTM2714>"#;

const CHART: &str = "CTI3\nDEVICE_CLASS \"OUTPUT\"\nSPECTRAL_BANDS \"3\"\nSPECTRAL_START_NM \"400\"\nSPECTRAL_END_NM \"700\"\n\
    BEGIN_DATA_FORMAT\nSAMPLE_ID SAMPLE_LOC SPEC_400 SPEC_550 SPEC_700\nEND_DATA_FORMAT\nNUMBER_OF_SETS 2\nBEGIN_DATA\n\
    1 \"A1\" 5.0 6.1 7.2\n2 \"A2\" 80.5 85 92.5\nEND_DATA\n";

const ZMX: &str = "VERS 140124\nMODE SEQ\nNAME achromat\nUNIT MM X W X CM MR CPMM\nENPD 25\nFTYP 0 0 2 3 0 0 0\nYFLN 0 1\nWAVM 1 0.5876 1\n\
    SURF 0\n  TYPE STANDARD\n  CURV 0\n  DISZ INFINITY\nSURF 1\n  STOP\n  TYPE STANDARD\n  CURV 1.628E-02\n  DISZ 6\n  GLAS N-BK7 0 0 1.5\n  DIAM 12.7\n\
    SURF 2\n  TYPE STANDARD\n  CURV -2.24E-02\n  DISZ 2.5\n  GLAS N-SF5 0 0 1.67\n  DIAM 12.66\nSURF 3\n  TYPE EVENASPH\n  CURV -7.7E-03\n  CONI 0\n\
    \x20 PARM 1 0\n  PARM 2 1E-7\n  DISZ 95.95\n  DIAM 12.53\nSURF 4\n  TYPE STANDARD\n  CURV 0\n  DISZ 0\n  DIAM 2\n";

const OSLO: &str = "LEN NEW \"achromat\" 100 4\nEBR 12.5\nANG 1.0\nUNI 1.0\nTH 1e20\nNXT // SRF 1\nGLA N-BK7\nRD 61.47\nTH 6\nAP CHK 12.7\nAST\n\
    NXT\nGLA MOD G 1.67271 1.68750 1.66662\nPK CVM 1 -0.006\nTH 2.5\nNXT\nRD -129.94\nCC -0.5\nAD 1e-7\nPY 0\nNXT\nTH 0\nEND 4\n";

const BENCH: &str = "[descriptive data]\ntitle\tachromat\n[constants]\nAsphericalA2\n[variable distances]\nAngle of View\t2\nF-Number\t4\nd0\tInfinity\n\
    d2\t2.5\nBf\t95.9\n[lens data]\n1\tAS\t1\t\t25\n2\t61.47\t6\t1.5168\t25.4\t64.17\tN-BK7\tschott\n3\t-44.64\td2\t1.67271\t25.3\t32.2\n\
    4\t-129.94\tBf\t\t25\n[aspherical data]\n4\t-129.94\t-0.5\t0\t1e-7\n";

const AGF: &str = "CC own glasses\nNM OWN-7 2 517642 1.5168 64.17 0 1\nCD 1.03961212 6.00069867E-3 0.231792344 2.00179144E-2 1.01046945 1.03560653E+2 0 0 0 0\n\
    LD 0.3 2.5\nNM OWN-8 1 0 1.6 50 0 1\nCD 2.5 -0.01 0.01 0 0 0\nLD 0.4 0.7\n";

const PHASE: &str = "angle_deg,p_400nm_per_sr,p_700nm_per_sr\n0,0.3,0.2\n60,0.1,0.1\n120,0.05,0.06\n180,0.07,0.08\n";

const IES: &str = "IESNA:LM-63-1995\n[TEST] 1\n[MANUFAC] Abbe\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9\n2 1200 1.5 4 3 1 1 1 2 0\n\
    1.0 1.0 58\n0 30 60 90\n0 45 90\n500 400 200 0\n500 300, 100, 0\n500 200 50\n0\n";

const IES_TYPE_B: &str =
    "IES:LM-63-2019\nTILT=NONE\n1 -1 1 3 3 2 2 -0.2 -0.2 0\n1 1.1 20\n-10 0 10\n-20 0 20\n1 2 1\n2 9 2\n1 2 1\n";

const LDT: &str = "Abbe\n1\n2\n4\n90\n3\n45\nreport\nLamp\n1\nlamp.ldt\ntoday\n600\n200\n50\n600\n200\n0\n0\n0\n0\n100\n100\n\
    1\n0\n1\n1\nLED\n2000\n4000\n80\n20\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n0\n90\n180\n270\n0\n45\n90\n\
    300\n200\n10\n300\n150\n5\n300\n180\n7\n";

const TM33: &str = r#"<IESTM33><Version>1.0</Version><Header><Description>a</Description></Header><Emitter>
<Quantity>2</Quantity><InputWattage>9</InputWattage><LuminousData><LuminousIntensity><Multiplier>2</Multiplier>
<NumberHorz>2</NumberHorz><NumberVert>2</NumberVert><IntData h="0" v="0">9</IntData><IntData h="0" v="90">1</IntData>
<IntData h="90" v="0">9</IntData><IntData h="90" v="90">2</IntData></LuminousIntensity><LuminousFlux>50</LuminousFlux>
</LuminousData><SpectralData><EmitterSpectral><PwrData w="400">1</PwrData><PwrData w="700">1</PwrData></EmitterSpectral>
</SpectralData><EmissionAreas><BottomFace><BottomArea><Length>1</Length><Width>1</Width></BottomArea></BottomFace>
</EmissionAreas></Emitter></IESTM33>"#;

/// A grid of 2 × 3 × 4 values.
fn npy() -> Vec<u8> {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4), }                                                   \n";
    let length = (header.len() as u16).to_le_bytes();
    let values = (0..24).flat_map(|i| (i as f32 * 0.25).to_le_bytes());
    [&b"\x93NUMPY\x01\x00"[..], &length, header.as_bytes()].concat().into_iter().chain(values).collect()
}

fn npz() -> Vec<u8> {
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    archive.start_file("density.npy", zip::write::SimpleFileOptions::default()).unwrap();
    archive.write_all(&npy()).unwrap();
    archive.finish().unwrap().into_inner()
}

const PRESCRIPTION: &str = r#"{"surfaces": [
  {"radius_mm": 60, "thickness_mm": 6, "ior": "N-BK7", "semi_aperture_mm": 12}, {"radius_mm": -45, "thickness_mm": 2.5, "ior": "N-SF5", "semi_aperture_mm": 12},
  {"radius_mm": -130, "thickness_mm": 90, "ior": 1, "semi_aperture_mm": 12, "stop": true}]}"#;

fn corners() -> Vec<u8> {
    [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect()
}

const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn binary_ply() -> Vec<u8> {
    let mut bytes =
        PLY.split_inclusive("end_header\n").next().unwrap().replace("ascii", "binary_little_endian").into_bytes();
    bytes.extend(corners());
    for face in FACES {
        bytes.push(3);
        bytes.extend(face.iter().flat_map(|&index| i32::from(index).to_le_bytes()));
    }
    bytes
}

/// A serialized mesh of Mitsuba: one triangle in single precision.
fn serialized() -> Vec<u8> {
    let floats = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let mut data = 0x1000_u32.to_le_bytes().to_vec();
    data.extend(b"a\0");
    data.extend([3_u64, 1].map(u64::to_le_bytes).as_flattened());
    data.extend(floats.map(f32::to_le_bytes).as_flattened());
    data.extend([0_u32, 1, 2].map(u32::to_le_bytes).as_flattened());
    let mut encoder = flate2::write::ZlibEncoder::new(vec![0x1C, 4, 4, 0], flate2::Compression::none());
    std::io::Write::write_all(&mut encoder, &data).unwrap();
    let mut file = encoder.finish().unwrap();
    file.extend([0; 8]);
    file.extend(1_u32.to_le_bytes());
    file
}

/// A cube as a design of GemCad: the planes of its facets without corners, and the trailer.
fn gem() -> Vec<u8> {
    let mut bytes = Vec::new();
    for (facet, [x, y, z]) in [[2, 0, 0], [-2, 0, 0], [0, 2, 0], [0, -2, 0], [0, 0, 2], [0, 0, -2]].iter().enumerate() {
        bytes.extend([x, y, z].map(|component| f64::from(*component).to_le_bytes()).as_flattened());
        bytes.extend((facet as i32).to_le_bytes());
        bytes.extend(b"\x05A\tcut\0\0\0\0");
    }
    bytes.extend((-99_999.0_f64).to_le_bytes());
    bytes.extend([4_i32, 1, 96].map(i32::to_le_bytes).as_flattened());
    bytes.extend(1.54_f64.to_le_bytes());
    bytes.extend(0x7FFF_u32.to_le_bytes());
    bytes.extend([0; 16]);
    bytes
}

fn binary_stl() -> Vec<u8> {
    let (mut bytes, corners) = (vec![b' '; 80], corners());
    bytes.extend((FACES.len() as u32).to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        face.iter().for_each(|&index| bytes.extend(&corners[12 * usize::from(index)..][..12]));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Vertices, then indices.
fn buffer() -> Vec<u8> {
    let mut bytes = corners();
    bytes.extend(FACES.iter().flatten().flat_map(|index| index.to_le_bytes()));
    bytes
}

fn gltf(uri: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"children": [1], "rotation": [0, 0, 0, 1]}}, {{"mesh": 0, "translation": [1, 2, 3], "scale": [2, 2, 2]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}],
        "materials": [{{"name": "glass", "pbrMetallicRoughness": {{"metallicFactor": 0}},
          "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 1}}, "KHR_materials_ior": {{"ior": 1.5}}}}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}},
          {{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 24}}],
        "buffers": [{{{uri}"byteLength": 72}}]}}"#
    )
}

fn glb() -> Vec<u8> {
    let mut json = gltf("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = buffer();
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2_u32.to_le_bytes());
    bytes.extend((28 + json.len() as u32 + buffer.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &buffer)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}
