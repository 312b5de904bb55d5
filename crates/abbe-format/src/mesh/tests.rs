use super::*;
use abbe_scene::geometry::mesh::TriangleMesh;
use glam::DVec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::io::Read as _;
use std::path::PathBuf;
use tempfile::TempDir;

pub(super) fn load(path: &Path) -> Result<Vec<MeshPart>> {
    super::load(path, FileAccess::WithinFolder).map(|file| file.parts)
}

/// Returns what the reader says about ignored parts of a file.
pub(super) fn ignored(path: &Path) -> Option<String> {
    let file = super::load(path, FileAccess::WithinFolder).unwrap();
    let all: Vec<String> = file.ignored.into_iter().chain(file.warnings).collect();
    (!all.is_empty()).then(|| all.join("; "))
}

/// The corners of a unit cube with the centre (0.5, 0.5, 0.5). The faces in `QUADS` face outwards.
const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 1.0],
];
const QUADS: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

fn cube_triangles() -> Vec<[u32; 3]> {
    QUADS.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

pub(super) fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    path
}

/// Returns a PNG file of 2 × 2 pixels.
pub(super) fn small_png(codes: [[u8; 3]; 4]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 2, 2);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_image_data(codes.as_flattened()).unwrap();
    bytes
}

/// Checks that a mesh is the unit cube.
fn is_the_cube(mesh: &TriangleMesh) {
    assert_eq!(mesh.triangles().len(), 12);
    assert!(mesh.is_closed());
    assert!((mesh.signed_volume() - 1.0).abs() < 1e-12, "volume {}", mesh.signed_volume());
    assert!((mesh.area() - 6.0).abs() < 1e-12);
}

pub(super) fn obj() -> String {
    let mut text = String::from("mtllib cube.mtl\no cube\nusemtl glass\n");
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    for quad in QUADS {
        let corners: Vec<String> = quad.iter().map(|index| (index + 1).to_string()).collect();
        text += &format!("f {}\n", corners.join(" "));
    }
    text
}

fn ply_header(format: &str, coordinate: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment a cube\nelement vertex 8\nproperty {coordinate} x\nproperty {coordinate} y\n\
         property {coordinate} z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn ply_text() -> String {
    let mut text = ply_header("ascii", "float");
    for [x, y, z] in CORNERS {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c, d] in QUADS {
        text += &format!("4 {a} {b} {c} {d}\n");
    }
    text
}

fn ply_binary(big_endian: bool) -> Vec<u8> {
    let format = if big_endian { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_header(format, "double").into_bytes();
    let eight = |x: f64| if big_endian { x.to_be_bytes() } else { x.to_le_bytes() };
    let four = |i: u32| if big_endian { i.to_be_bytes() } else { i.to_le_bytes() };
    bytes.extend(CORNERS.iter().flatten().flat_map(|&x| eight(f64::from(x))));
    for quad in QUADS {
        bytes.push(4);
        bytes.extend(quad.iter().flat_map(|&index| four(index)));
    }
    bytes
}

fn stl_binary() -> Vec<u8> {
    // The header begins with the word that marks a text file.
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(12_u32.to_le_bytes());
    for triangle in cube_triangles() {
        bytes.extend([0; 12]);
        bytes.extend(triangle.iter().flat_map(|&index| CORNERS[index as usize]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl_text() -> String {
    let mut text = String::from("solid cube\n");
    for triangle in cube_triangles() {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in triangle.map(|index| CORNERS[index as usize]) {
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid\n"
}

/// Returns the positions, followed by the indices as 16-bit integers.
fn gltf_buffer() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes());
    let indices = cube_triangles().into_iter().flatten().flat_map(|index| (index as u16).to_le_bytes());
    positions.chain(indices).collect()
}

/// Returns the JSON of a glTF cube in two nested nodes: one scales it by 2 and moves it, and the
/// other mirrors it. The material is a glass that uses every extension.
fn gltf_json(buffer: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "extensionsUsed": ["KHR_materials_dispersion", "KHR_materials_ior", "KHR_materials_transmission", "KHR_materials_volume", "KHR_materials_emissive_strength"],
        "extensionsRequired": ["KHR_materials_dispersion"],
        "nodes": [{{"name": "stand", "translation": [10, 0, 0], "scale": [2, 2, 2], "children": [1]}},
                  {{"name": "prism", "mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 0}}, "indices": 1, "material": 0}}]}}],
        "materials": [{{"name": "flint", "emissiveFactor": [1, 0.5, 0],
            "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.25, 1, 1], "metallicFactor": 0, "roughnessFactor": 0.125}},
            "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 1}}, "KHR_materials_ior": {{"ior": 1.75}},
                "KHR_materials_volume": {{"thicknessFactor": 1, "attenuationDistance": 0.5, "attenuationColor": [1, 0.5, 0.25]}},
                "KHR_materials_emissive_strength": {{"emissiveStrength": 4}},
                "KHR_materials_dispersion": {{"dispersion": 0.5}}}}}}],
        "buffers": [{{{buffer}"byteLength": 168}}],
        "bufferViews": [{{"buffer": 0, "byteOffset": 0, "byteLength": 96}}, {{"buffer": 0, "byteOffset": 96, "byteLength": 72}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0,0,0], "max": [1,1,1]}},
            {{"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}}]}}"#
    )
}

fn glb() -> Vec<u8> {
    let mut json = gltf_json("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = gltf_buffer();
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

fn packed(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    flate2::read::GzEncoder::new(bytes, flate2::Compression::fast()).read_to_end(&mut packed).unwrap();
    packed
}

#[test]
fn the_cube_is_the_same_from_every_format() {
    let folder = TempDir::new().unwrap();
    write(&folder, "cube.bin", gltf_buffer());
    let files = [
        write(&folder, "cube.obj", obj()),
        write(&folder, "text.ply", ply_text()),
        write(&folder, "little.ply", ply_binary(false)),
        write(&folder, "big.PLY", ply_binary(true)),
        write(&folder, "packed.ply.gz", packed(&ply_binary(false))),
        write(&folder, "binary.stl", stl_binary()),
        write(&folder, "text.stl", stl_text()),
    ];
    for file in files {
        let parts = load(&file).unwrap();
        assert_eq!(parts.len(), 1);
        is_the_cube(&parts[0].mesh);
        assert_eq!(parts[0].mesh.positions().len(), 8, "{}", file.display());
    }
    for file in [write(&folder, "cube.gltf", gltf_json("\"uri\": \"cube.bin\", ")), write(&folder, "cube.glb", glb())] {
        let parts = load(&file).unwrap();
        assert_eq!((parts.len(), parts[0].name.as_str()), (1, "prism"));
        let mesh = &parts[0].mesh;
        assert!(mesh.is_closed() && (mesh.signed_volume() - 8.0).abs() < 1e-12);
        let low = mesh.positions().iter().copied().reduce(DVec3::min).unwrap();
        let high = mesh.positions().iter().copied().reduce(DVec3::max).unwrap();
        assert_eq!((low, high), (DVec3::new(8.0, 0.0, 0.0), DVec3::new(10.0, 2.0, 2.0)));
        // The normals point from the cube's origin to its corners. The node mirrors both.
        let normals = mesh.normals().unwrap();
        assert!(normals[7].normalize().distance(DVec3::new(-1.0, 1.0, 1.0).normalize()) < 1e-12);
    }
}

#[test]
fn a_gltf_glass_keeps_all_its_extensions() {
    let folder = TempDir::new().unwrap();
    let parts = load(&write(&folder, "cube.glb", glb())).unwrap();
    let expected = MeshMaterial {
        name: "flint".to_string(),
        base_colour: [0.5, 0.25, 1.0],
        metallic: 0.0,
        roughness: 0.125,
        transmission: 1.0,
        ior: 1.75,
        abbe_number: Some(40.0),
        attenuation: Some(MeshAttenuation { colour: [1.0, 0.5, 0.25], distance: 0.5 }),
        emission: [4.0, 2.0, 0.0],
        ..MeshMaterial::default()
    };
    assert_eq!(parts[0].material.as_ref(), Some(&expected));
}

/// If a file is cut after any byte, the error names the file. A text STL file may end after a
/// facet.
#[test]
fn truncated_files_are_errors() {
    let folder = TempDir::new().unwrap();
    let text_stl = stl_text().into_bytes();
    let stl_end = text_stl.len() - "endsolid\n".len();
    let text_ply = ply_text().into_bytes();
    let ply_end = text_ply.len() - "6\n".len();
    let (ply, stl, glb) = (ply_binary(false), stl_binary(), glb());
    let files = [
        ("cut.ply", ply.len(), ply),
        ("text.ply", ply_end, text_ply),
        ("cut.stl", stl.len(), stl),
        ("text.stl", stl_end, text_stl),
        ("cut.glb", glb.len(), glb),
    ];
    for (name, end, whole) in files {
        for length in (0..end).step_by(11).chain([end - 1]) {
            let path = write(&folder, name, &whole[..length]);
            let read = super::load(&path, FileAccess::WithinFolder);
            if read.as_ref().is_ok_and(|file| !file.remarks.is_empty()) {
                continue;
            }
            let error = read.expect_err(&format!("{name} cut to {length} bytes"));
            assert_eq!(error.location.file.as_deref(), Some(path.as_path()));
            assert_eq!(error.exit_status(), 2);
        }
    }
    let short = write(&folder, "cut.stl", &stl_binary()[..300]);
    assert!(load(&short).unwrap_err().what.contains("truncated") || load(&short).unwrap_err().what.contains("STL"));
}

#[test]
fn a_gltf_whose_buffer_is_missing_or_short_is_an_error() {
    let folder = TempDir::new().unwrap();
    let path = write(&folder, "cube.gltf", gltf_json("\"uri\": \"cube.bin\", "));
    assert!(load(&path).unwrap_err().what.contains("cannot be read"));
    write(&folder, "cube.bin", &gltf_buffer()[..100]);
    assert!(load(&path).unwrap_err().what.contains("truncated: 100 of 168 bytes"));
    // The stated length of the buffer is less than what the accessors read.
    let lies = gltf_json("\"uri\": \"cube.bin\", ").replace("\"byteLength\": 168", "\"byteLength\": 100");
    assert!(load(&write(&folder, "lies.gltf", lies)).unwrap_err().what.contains("beyond its buffer"));
    let loops = gltf_json("\"uri\": \"cube.bin\", ").replace("\"mesh\": 0, ", "\"mesh\": 0, \"children\": [0], ");
    write(&folder, "cube.bin", gltf_buffer());
    assert!(load(&write(&folder, "loop.gltf", loops)).unwrap_err().what.contains("two parents"));
    let escaped = gltf_json("\"uri\": \"%ff.bin\", ");
    assert!(load(&write(&folder, "escaped.gltf", escaped)).is_err());
}

/// A mesh file may name files outside its folder only with `FileAccess::Anywhere`.
#[test]
fn a_mesh_file_names_no_files_outside_its_folder() {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir(folder.path().join("below")).unwrap();
    write(&folder, "cube.bin", gltf_buffer());
    write(&folder, "cube.mtl", "newmtl glass\nNi 1.5\nd 0.1\n");
    let root = folder.path().join("cube.bin");
    for uri in ["../cube.bin", "%2e%2e/cube.bin", "x/../../cube.bin", root.to_str().unwrap()] {
        let path = write(&folder, "below/cube.gltf", gltf_json(&format!("\"uri\": \"{uri}\", ")));
        assert!(load(&path).is_err(), "{uri}");
    }
    let path = write(&folder, "below/cube.gltf", gltf_json("\"uri\": \"../cube.bin\", "));
    assert_eq!(super::load(&path, FileAccess::Anywhere).unwrap().parts[0].mesh.triangles().len(), 12);
    let path = write(&folder, "below/cube.obj", obj().replace("mtllib cube.mtl", "mtllib ../cube.mtl"));
    let [within, anywhere] =
        [FileAccess::WithinFolder, FileAccess::Anywhere].map(|access| super::load(&path, access).unwrap());
    let note = within.warnings.join("; ");
    assert!(note.contains("../cube.mtl") && note.contains(FileAccess::EXPECTED_WITHIN_FOLDER), "{note}");
    assert!(within.parts[0].material.is_none());
    assert!(anywhere.parts[0].material.is_some() && anywhere.warnings.is_empty());
}

#[test]
fn a_gltf_says_what_is_ignored() {
    let folder = TempDir::new().unwrap();
    write(&folder, "cube.bin", gltf_buffer());
    let json = gltf_json("\"uri\": \"cube.bin\", ").replace("[0.5, 0.25, 1, 1]", "[1, 1, 1, 1]");
    assert_eq!(ignored(&write(&folder, "white.gltf", &json)), None);
    let textured = json
        .replace("\"metallicFactor\": 0", "\"metallicFactor\": 0, \"baseColorTexture\": {\"index\": 0}")
        .replace(
            "\"name\": \"flint\"",
            "\"name\": \"flint\", \"alphaMode\": \"BLEND\", \"occlusionTexture\": {\"index\": 0}",
        )
        .replace(
            "\"KHR_materials_ior\": {",
            "\"KHR_materials_sheen\": {\"sheenColorFactor\": [1, 1, 1]}, \"KHR_materials_ior\": {",
        )
        .replace("\"buffers\"", "\"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"a.png\"}], \"buffers\"")
        .replace("\"NORMAL\": 0", "\"NORMAL\": 0, \"COLOR_0\": 0");
    let expected = "textures are ignored: occlusionTexture; material extensions are ignored: KHR_materials_sheen (cloth has no bright rim); ignored \
                    as well: vertex colours of materials with textures (their mean applies); base colours of clear glass that encloses a volume are ignored; state the \
                    colour as attenuation of the volume; the image 0, \"a.png\", cannot be used (";
    let found = ignored(&write(&folder, "textured.gltf", &textured)).unwrap();
    assert!(found.starts_with(expected), "{found}");
    write(&folder, "a.png", small_png([[0; 3]; 4]));
    let found = ignored(&write(&folder, "textured.gltf", &textured)).unwrap();
    assert!(!found.contains("cannot be used"), "{found}");
    let outside = textured.replace("\"a.png\"", "\"%2e%2e/a.png\"");
    let found = ignored(&write(&folder, "outside.gltf", &outside)).unwrap();
    assert!(found.contains("the image 0, \"../a.png\", cannot be used (the path \"../a.png\" leads out"), "{found}");
}

#[test]
fn malformed_meshes_give_errors_that_name_the_file() {
    let folder = TempDir::new().unwrap();
    let cases = [
        ("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "2 corners"),
        ("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "corner \"4\""),
        ("zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "corner \"0\""),
        ("negative.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", "corner \"-4\""),
        ("normal.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", "corner \"1//1\""),
        ("huge.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", "corner"),
        ("number.obj", "v 0 0 zero\nf 1 1 1\n", "a vertex: found \"zero\""),
        ("line.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", "no area"),
        ("points.obj", "v 0 0 0\nv 1 1 1\n", "no triangles"),
        ("empty.obj", "", "no triangles"),
        ("infinite.obj", "v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n", "a vertex has the position"),
        ("empty.ply", "", "truncated"),
        ("picture.ply", "P6 1 1 255\n", "not a valid PLY file"),
        ("index.ply", "TRIANGLE\n3 0 1 -1\n", "face 0"),
        ("high.ply", "TRIANGLE\n3 0 1 3\n", "vertex 3 of 3"),
        (
            "flat.ply",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nelement face 0\nproperty list uchar int vertex_index\nend_header\n0 0\n1 0\n0 1\n",
            "no vertices with x, y, z",
        ),
        ("word.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex a b c\n", "not a valid STL file"),
        ("empty.gltf", "", "not a valid glTF file"),
        ("json.gltf", "{\"asset\": 3}", "not a valid glTF file"),
        ("nothing.gltf", "{\"asset\": {\"version\": \"2.0\"}}", "no triangles"),
        (
            "draco.gltf",
            r#"{ASSET, "extensionsUsed": ["DRACO"], "extensionsRequired": ["DRACO"]}"#,
            "compressed by KHR_draco_mesh_compression",
        ),
        (
            "accessor.gltf",
            r#"{ASSET, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]}"#,
            "an accessor that does not exist",
        ),
        ("mesh.fbx", "", "unknown kind of mesh file \"fbx\""),
    ];
    let triangle = ply_header("ascii", "float").replace("vertex 8", "vertex 3").replace("face 6", "face 1");
    for (name, text, fault) in cases {
        let text = text.replace("TRIANGLE", &format!("{triangle}0 0 0\n1 0 0\n0 1 0"));
        let text =
            text.replace("ASSET", r#""asset": {"version": "2.0"}"#).replace("DRACO", "KHR_draco_mesh_compression");
        let path = write(&folder, name, text);
        let error = load(&path).expect_err(name);
        assert!(error.to_string().contains(fault), "{name}: {error}");
        assert_eq!(error.location.file.as_deref(), Some(path.as_path()));
    }
    for missing in ["no.obj", "no.ply", "no.stl", "no.glb"] {
        let error = load(&folder.path().join(missing)).unwrap_err();
        assert!(error.what.contains("cannot read the mesh"), "{error}");
    }
    let index = load(&folder.path().join("index.obj")).unwrap_err();
    assert_eq!(index.location.line_column, Some((4, 1)));
}

/// Reading a file with random damage gives a mesh or an error, and never a panic.
#[test]
fn damaged_files_never_panic() {
    let folder = TempDir::new().unwrap();
    write(&folder, "cube.bin", gltf_buffer());
    write(&folder, "cube.mtl", "newmtl glass\nKd 0.5 0.5 1\n");
    let files = [
        ("damaged.obj", obj().into_bytes()),
        ("text.ply", ply_text().into_bytes()),
        ("damaged.ply", ply_binary(false)),
        ("damaged.stl", stl_binary()),
        ("text.stl", stl_text().into_bytes()),
        ("damaged.gltf", gltf_json("\"uri\": \"cube.bin\", ").into_bytes()),
        ("damaged.glb", glb()),
    ];
    let mut rng = Pcg64::seed_from_u64(1);
    for (name, whole) in files {
        let mut read = 0;
        for _ in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..bytes.len());
                bytes[at] = match rng.random_range(0..4) {
                    0 => rng.random(),
                    1 => b'0' + rng.random_range(0..10),
                    2 => b'-',
                    _ => bytes[at] ^ (1 << rng.random_range(0..8)),
                };
            }
            read += u32::from(load(&write(&folder, name, &bytes)).is_ok());
        }
        assert!(read < 400, "{name}: no damage was noticed");
    }
}

/// A text file may be in capitals, indented, with a byte order mark, and with several solids. If it
/// ends early but after a facet, a remark says so.
#[test]
fn text_stl_files_are_read_as_programs_write_them() {
    let folder = TempDir::new().unwrap();
    let text = stl_text();
    let two = format!(
        "{text}solid\nfacet normal 0 0 1\nouter loop\nvertex 2 0 0\nvertex 3 0 0\nvertex 2 1 0\nendloop\nendfacet\nendsolid b\n"
    );
    let files = [
        (text.to_uppercase(), 6.0, false),
        (format!("  {}", text.replace('\n', "\r\n")), 6.0, false),
        (format!("\u{feff}{text}"), 6.0, false),
        (text.replace("solid cube", "solid"), 6.0, false),
        (text.replace("endsolid\n", ""), 6.0, true),
        (two, 6.5, false),
    ];
    for (text, area, is_unfinished) in files {
        let file = super::load(&write(&folder, "a.stl", &text), FileAccess::WithinFolder).unwrap();
        assert!((file.parts[0].mesh.area() - area).abs() < 1e-6, "{text}");
        assert_eq!(file.remarks.iter().any(|it| it.contains("without `endsolid`")), is_unfinished, "{text}");
    }
    let mut trailing = stl_binary();
    trailing.push(0);
    is_the_cube(&load(&write(&folder, "a.stl", trailing)).unwrap()[0].mesh);
}

/// Colours at the vertices are in sRGB, as integers or from 0 to 1.
#[test]
fn a_ply_has_colours_at_its_vertices() {
    let folder = TempDir::new().unwrap();
    let header = ply_header("ascii", "float").replace("vertex 8", "vertex 3").replace("face 6", "face 1");
    for (kind, colour) in [("uchar", "200 60 30"), ("float", "0.7843 0.2353 0.1176"), ("ushort", "51400 15420 7710")] {
        let properties: String = ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat();
        let header = header.replace("element face", &format!("{properties}element face"));
        let text = format!("\u{feff}{header}0 0 0 {colour}\n1 0 0 {colour}\n0 1 0 {colour}\n3 0 1 2\n");
        let parts = load(&write(&folder, "a.ply", text)).unwrap();
        let found = parts[0].colours.as_ref().unwrap()[1];
        assert!(found.iter().zip([0.578, 0.045, 0.013]).all(|(c, it)| (c - it).abs() < 1e-3), "{kind}: {found:?}");
    }
}

#[test]
fn open_and_inside_out_meshes_are_recognised() {
    let corners: Vec<DVec3> = CORNERS.iter().map(|&corner| DVec3::from_array(corner.map(f64::from))).collect();
    let new = |triangles| TriangleMesh::new(corners.clone(), None, None, triangles).unwrap();
    is_the_cube(&new(cube_triangles()));
    let mut open = cube_triangles();
    open.pop();
    assert!(!new(open).is_closed());
    let inside_out: Vec<_> = cube_triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    assert!(new(inside_out.clone()).is_closed());
    assert!((new(inside_out).signed_volume() + 1.0).abs() < 1e-12);
    let mut one_flipped = cube_triangles();
    one_flipped[3].swap(0, 1);
    assert!(!new(one_flipped).is_closed());
    // A mesh whose triangles share no vertices is closed if the positions match.
    let exploded: Vec<DVec3> = cube_triangles().iter().flatten().map(|&index| corners[index as usize]).collect();
    let own = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    is_the_cube(&TriangleMesh::new(exploded, None, None, own).unwrap());
}

#[test]
fn triangles_without_area_are_dropped_and_counted() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(2.0, 0.0, 0.0)];
    let triangles = vec![[0, 1, 2], [0, 1, 3], [1, 1, 2]];
    let mesh = TriangleMesh::new(positions, None, None, triangles).unwrap();
    assert_eq!((mesh.triangles().len(), mesh.dropped()), (1, 2));
}
