//! Tests of OBJ files and their materials.

use super::MeshPart;
use super::tests::{ignored, load, obj, small_png, write};
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
    let keys = "Kd 0.5 0.5 1\nNi 1.5168\nTr 0.75\nillum 2\nKs 1 1 1\nNs 2046\nKe 1 2 3\n";
    write(&folder, "cube.mtl", format!("newmtl glass\n{keys}"));
    let part = &load(&path).unwrap()[0];
    let material = part.material.as_ref().unwrap();
    assert_eq!((material.base_colour, material.ior, material.transmission), ([0.5, 0.5, 1.0], 1.5168, 1.0));
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
    assert_eq!(of("Kd 0 0 0\nKs 1 1 1\nTr 1\n"), (0.0, [0.0; 3]), "glass");
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
