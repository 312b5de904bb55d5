//! Tests of OBJ files and their materials.

use super::tests::{ignored, load, obj, small_png, write};
use super::{MeshMaterial, MeshOpacity, MeshPart};
use abbe_optics::texture::{UvTransform, Wrap};
use glam::DVec3;
use tempfile::TempDir;

#[test]
fn an_obj_has_its_materials_or_a_note_that_they_are_missing() {
    let folder = TempDir::new().unwrap();
    let path = write(&folder, "cube.obj", obj());
    let without = load(&path).unwrap();
    assert!(without[0].material.is_none());
    let note = ignored(&path).unwrap();
    assert!(note.starts_with("the material library \"cube.mtl\" cannot be used"), "{note}");
    assert!(note.ends_with("; unknown materials became matt grey: glass"), "{note}");
    let keys = "Kd 0.5 0.5 1\nNi 1.5168\nTr 0.75\nillum 7\nKs 1 1 1\nNs 2046\nKe 1 2 3\n";
    write(&folder, "cube.mtl", format!("newmtl glass\n{keys}"));
    let part = &load(&path).unwrap()[0];
    let material = part.material.as_ref().unwrap();
    assert_eq!((material.base_colour, material.ior, material.transmission), ([1.0; 3], 1.5168, 1.0));
    assert_eq!((material.emission, part.name.as_str(), ignored(&path)), ([1.0, 2.0, 3.0], "cube", None));
    // The roughness is the square root of α, and α = √(2/2048) = 1/32.
    assert!((material.roughness - 32.0_f64.sqrt().recip()).abs() < 1e-15);
}

/// A line may continue on the next line. Errors have the number of the first line.
#[test]
fn a_line_of_an_obj_may_continue_on_the_next_line() {
    let folder = TempDir::new().unwrap();
    let text = "v 0 0 0\r\nv 1 \\\r\n 0 0\r\nv 0 0 -1\r\nf 1 \\\r\n 2 \\\r\n 3\r\n";
    for text in [text.to_string(), text.replace('\r', "")] {
        let part = &load(&write(&folder, "triangle.obj", &text)).unwrap()[0];
        assert_eq!(part.mesh.triangles(), [[0, 1, 2]]);
        let wrong = text.replace(" 3", " 4");
        let error = load(&write(&folder, "wrong.obj", wrong + "v 0 1 0\n")).unwrap_err();
        assert_eq!(error.location.line_column, Some((5, 1)), "{error}");
    }
}

/// A material with a black diffuse colour and a specular colour is a metal.
#[test]
fn a_mirror_of_an_mtl_file_is_a_metal() {
    let folder = TempDir::new().unwrap();
    let path = write(&folder, "cube.obj", obj());
    let of = |keys: &str| {
        write(&folder, "cube.mtl", format!("newmtl glass\n{keys}"));
        let material = load(&path).unwrap()[0].material.clone().unwrap();
        (material.metallic, material.base_colour)
    };
    assert_eq!(of("Kd 0 0 0\nKs 0.9 0.8 0.7\nNs 1000\nillum 3\n"), (1.0, [0.9, 0.8, 0.7]));
    assert_eq!(of("Kd 0.1 0 0\nKs 0.9 0.8 0.7\nNs 1000\nillum 2\n"), (0.0, [0.1, 0.0, 0.0]));
    assert_eq!(of("Kd 0 0 0\nKs 1 1 1\nTr 1\n"), (0.0, [1.0; 3]), "glass");
}

/// The options of `map_Kd` scale and move the texture coordinates, in which v increases upwards.
#[test]
fn options_of_an_mtl_texture_map_its_coordinates() {
    let folder = TempDir::new().unwrap();
    let path = write(&folder, "cube.obj", obj());
    write(&folder, "my picture.png", include_bytes!("../../../../tests/textures/tiles.png"));
    let of = |value: &str| {
        write(&folder, "cube.mtl", format!("newmtl glass\nKd 1 1 1\nmap_Kd {value}\n"));
        (load(&path).unwrap()[0].material.clone().unwrap().base_colour_texture, ignored(&path))
    };
    let (texture, note) = of("-s 2 3 1 -o 0.5 0.25 0 -clamp on my picture.png");
    let texture = texture.unwrap_or_else(|| panic!("{note:?}"));
    assert_eq!(texture.transform, UvTransform::new([2.0, 3.0], 0.0, [0.5, -2.25]));
    assert_eq!(texture.wrap, [Wrap::Clamp; 2]);
    let (texture, _) = of("-s 4 my picture.png");
    assert_eq!(texture.unwrap().transform, UvTransform::new([4.0, 1.0], 0.0, [0.0; 2]));
    let (texture, note) = of("-bm 0.5 my picture.png");
    assert!(texture.is_none() && note.unwrap().contains("the option -bm of"));
}

/// Vertices of OBJ files keep their normals and their texture coordinates in double precision. The
/// coordinate v is reversed, because it increases upwards in OBJ files.
#[test]
fn an_obj_keeps_normals_and_texture_coordinates() {
    let folder = TempDir::new().unwrap();
    let text = "v 0 0 0\nv 1 0 0\nv 0 0 -1\nvn 0 1 0\nvt 0 0\nvt 1 0\nvt 0 0.3333333333333333\nf 1/1/1 2/2/1 -1/-1/-1";
    let mesh = &load(&write(&folder, "triangle.obj", text)).unwrap()[0].mesh;
    assert_eq!(mesh.normals(), Some([DVec3::Y; 3].as_slice()));
    // Double precision is kept.
    assert_eq!(mesh.uvs(), Some([[0.0, 1.0], [1.0, 1.0], [0.0, 0.666_666_666_666_666_7]].as_slice()));
}

#[test]
fn an_obj_says_which_textures_and_keys_are_ignored() {
    let folder = TempDir::new().unwrap();
    let path = write(&folder, "cube.obj", obj().replace("f 1", "usemtl wood\nf 1"));
    let textures = "map_Kd a.png\nmap_Bump b.png\nmap_Pr c.png\nnorm d.png\n";
    let keys = format!("Kd 1 1 1\n{textures}Tf 0.5 1 1\nPc 0.5\nnewmtl other\nmap_Kd e\n");
    write(&folder, "cube.mtl", format!("newmtl glass\n{keys}"));
    write(&folder, "a.png", small_png([[0; 3]; 4]));
    let expected = "textures are ignored: map_Bump, map_Pr, norm; material keys are ignored: Pc, Tf; unknown materials \
                    became matt grey: wood; the texture map_Kd of \"other\" cannot be used (";
    let found = ignored(&path).unwrap();
    assert!(found.starts_with(expected), "{found}");
    let parts = load(&write(&folder, "glass.obj", obj())).unwrap();
    let textured = |part: &MeshPart| part.material.as_ref().is_some_and(|own| own.base_colour_texture.is_some());
    assert!(parts.iter().any(textured));
    write(&folder, "cube.mtl", "newmtl glass\nTf 1 1 1\nPc 0\nnewmtl wood\n");
    assert_eq!(ignored(&path), None);
}

/// Returns the material "a" of a library, and what the reader ignores.
fn material(keys: &str) -> (MeshMaterial, Option<String>) {
    let folder = TempDir::new().unwrap();
    write(&folder, "m.mtl", format!("newmtl a\n{keys}"));
    let path = write(&folder, "m.obj", format!("mtllib m.mtl\nusemtl a\n{SQUARE}"));
    (load(&path).unwrap()[0].material.clone().unwrap(), ignored(&path))
}

const SQUARE: &str = "v -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n";

/// A colour with one component is grey. A value that is no colour is ignored, and the others count.
#[test]
fn colours_of_an_mtl_file_have_one_or_three_components() {
    assert_eq!(
        material("Kd 0.5"),
        (MeshMaterial { name: "a".into(), base_colour: [0.5; 3], ..MeshMaterial::default() }, None)
    );
    let (found, note) = material("Kd .5 .1 .1 # red\nKe spectral lamp.rfl 2\nNs\nd -halo 0.5\nKs 1 1");
    assert_eq!((found.base_colour, found.emission), ([0.5, 0.1, 0.1], [0.0; 3]));
    let expected = "are ignored: d -halo 0.5, Ke spectral lamp.rfl 2, Ks 1 1, Ns ";
    assert!(note.as_ref().is_some_and(|note| note.contains(expected)), "{note:?}");
}

/// `d` is the covered part of the area. Only a material that refracts is glass.
#[test]
fn the_dissolve_of_an_mtl_file_is_an_opacity() {
    let of = |keys: &str| {
        let (material, note) = material(&format!("Kd .5 .1 .1\n{keys}"));
        (material.opacity, material.transmission, note.unwrap_or_default())
    };
    for (keys, alpha) in [("d .25", 0.25), ("Tr .25", 0.75), ("d 0.3\nTr 0.3\nillum 2", 0.3), ("d 0.75\nillum 6", 0.75)]
    {
        let (opacity, transmission, note) = of(keys);
        assert_eq!((opacity, transmission), (MeshOpacity::Blend { alpha }, 0.0), "{keys}");
        assert!(note.contains("material \"a\" (for glass, state `illum 6`)"), "{note}");
    }
    for keys in ["illum 1\nTr 1.0\nKs 0 0 0", "Tr 1", "illum 2\nTr 1\nNi 1.45"] {
        let (opacity, transmission, note) = of(keys);
        assert_eq!((opacity, transmission), (MeshOpacity::Opaque, 0.0), "{keys}");
        assert!(note.contains("`Tr 1`") && note.contains("material \"a\""), "{note}");
    }
    for keys in ["illum 7", "illum 4\nd 0.1", "illum 6\nTr 1", "Ni 1.5\nd 0.1", "Ni 1.5\nTr 1"] {
        let pane = "glass of an open mesh is a pane (4 open edges): material \"a\"".to_owned();
        assert_eq!(of(keys), (MeshOpacity::Opaque, 1.0, pane), "{keys}");
    }
    assert_eq!(of("d 1\nillum 7\nNi 1.5"), (MeshOpacity::Opaque, 0.0, String::new()));
}

/// A library counts for the whole file. Byte order marks, blanks and tabs change nothing.
#[test]
fn libraries_count_for_the_whole_file() {
    let folder = TempDir::new().unwrap();
    write(&folder, "m.mtl", "\u{feff}newmtl a b\n\tKd .5 .1 .1\n");
    write(&folder, "n.mtl", "newmtl c\nKd .1 .5 .1\n");
    let red = |text: &str| {
        let path = write(&folder, "m.obj", text);
        let parts = load(&path).unwrap();
        assert_eq!(ignored(&path), None, "{text}");
        parts[0].material.as_ref().map(|material| material.base_colour) == Some([0.5, 0.1, 0.1])
    };
    assert!(red(&format!("usemtl a b\nmtllib m.mtl\n{SQUARE}")));
    assert!(red(&format!("{SQUARE}mtllib .\\m.mtl\n").replace("f 1", "usemtl\ta b\nf 1")));
    assert!(red(&format!("\u{feff}mtllib n.mtl m.mtl\nusemtl a b\n{SQUARE}")));
    let path = write(&folder, "two.obj", format!("mtllib m.mtl no.mtl\n{SQUARE}"));
    assert!(ignored(&path).unwrap().starts_with("the material library \"no.mtl\" cannot be used ("));
}

/// Concave faces are filled, and not more than that.
#[test]
fn concave_faces_of_an_obj_have_their_area() {
    let folder = TempDir::new().unwrap();
    let c = "v -1 0 1\nv 1 0 1\nv 1 0 0.5\nv 0 0 0.5\nv 0 0 -0.5\nv 1 0 -0.5\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4 5 6 7 8\n";
    let arrow = "v -1 0 1\nv 0 0 0\nv 1 0 1\nv 0 0 -1\nf 1 2 3 4\n";
    for (text, area) in [(c, 3.0), (arrow, 1.0)] {
        let parts = load(&write(&folder, "a.obj", text)).unwrap();
        assert!((parts[0].mesh.area() - area).abs() < 1e-12, "{}", parts[0].mesh.area());
    }
}

/// Colours at the vertices are in sRGB, from 0 to 1 or to 255.
#[test]
fn an_obj_has_colours_at_its_vertices() {
    let folder = TempDir::new().unwrap();
    for colour in [".784 .235 .118", "200 60 30", ".784 .235 .118 1"] {
        let text = SQUARE.replace("\nv", &format!(" {colour}\nv")).replace("\nf", &format!(" {colour}\nf"));
        let parts = load(&write(&folder, "a.obj", text)).unwrap();
        let colours = parts[0].colours.as_ref().unwrap();
        assert_eq!(colours.len(), 4);
        for colour in colours {
            let expected = [0.578, 0.045, 0.013];
            assert!(colour.iter().zip(expected).all(|(c, expected)| (c - expected).abs() < 1e-3), "{colour:?}");
        }
    }
    assert!(load(&write(&folder, "a.obj", SQUARE)).unwrap()[0].colours.is_none());
}
