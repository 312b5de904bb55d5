use super::*;
use crate::FileAccess;
use crate::mesh::tests::write;
use crate::mesh::{MeshFile, load};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::fmt::Write as _;
use tempfile::TempDir;

/// The lines of a design before its facets.
const HEADER: &str = "GemCad 5.0\ng 96 0.0\ny 8 y\nI 2.417\nH A test\n";

/// A cube with edges of length 1.
const CUBE: &str = "a 0 0.5 96 n T\na -0 0.5 96 n U\na 90 0.5 96 24 48 72 n G\n";

fn file(name: &str, bytes: impl AsRef<[u8]>) -> Result<MeshFile> {
    let folder = TempDir::new().unwrap();
    load(&write(&folder, name, bytes), FileAccess::WithinFolder)
}

fn asc(facets: &str) -> Result<MeshFile> {
    file("a.asc", format!("{HEADER}{facets}"))
}

fn fault(name: &str, bytes: impl AsRef<[u8]>) -> String {
    let error = file(name, bytes).expect_err("the design is at fault");
    assert!(error.location.file.is_some(), "{error}");
    error.to_string()
}

/// Returns the vertices, edges and facets of a mesh. Triangles in one plane are one facet.
fn counts(mesh: &TriangleMesh) -> [usize; 3] {
    assert!(mesh.is_closed() && mesh.signed_volume() > 0.0 && mesh.dropped() == 0);
    let normals: Vec<DVec3> = facet_normals(mesh).collect();
    let mut facets: Vec<DVec3> = Vec::new();
    let mut facet_of = Vec::new();
    for &normal in &normals {
        let known = facets.iter().position(|known| known.distance(normal) < 1e-5);
        facet_of.push(known.unwrap_or(facets.len()));
        if known.is_none() {
            facets.push(normal);
        }
    }
    let mut sides: BTreeMap<[u32; 2], BTreeSet<usize>> = BTreeMap::new();
    for (&[a, b, c], &facet) in mesh.triangles().iter().zip(&facet_of) {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            sides.entry([from.min(to), from.max(to)]).or_default().insert(facet);
        }
    }
    let edges = sides.values().filter(|facets| facets.len() == 2).count();
    [mesh.positions().len(), edges, facets.len()]
}

fn facet_normals(mesh: &TriangleMesh) -> impl Iterator<Item = DVec3> {
    mesh.triangles().iter().map(|&triangle| {
        let [a, b, c] = mesh.corners(triangle);
        (b - a).cross(c - a).normalize()
    })
}

/// Returns the angles in degrees between the facets and the plane of the girdle, each once.
fn angles(mesh: &TriangleMesh) -> Vec<f64> {
    let mut angles: Vec<f64> = Vec::new();
    for normal in facet_normals(mesh) {
        let is_vertical = normal.y.abs() < 1e-6;
        let angle = if is_vertical { 90.0 } else { normal.y.abs().min(1.0).acos().to_degrees() * normal.y.signum() };
        if !angles.iter().any(|known| (known - angle).abs() < 1e-3) {
            angles.push(angle);
        }
    }
    angles
}

/// The brilliant of the gallery: a table of 53 %, stars of 50 % and lower girdle facets of 77 %.
struct Brilliant {
    half_girdle: f64,
    table: [f64; 2],
    star: [f64; 2],
    lower: [f64; 2],
    culet: f64,
}

impl Brilliant {
    const CROWN: f64 = 34.5;
    const PAVILION: f64 = 40.75;
    const RADIUS: f64 = 0.5;

    /// Computes the points where facets meet: their distances from the axis and their heights.
    fn new() -> Self {
        let (crown, pavilion) = (Self::CROWN.to_radians().tan(), Self::PAVILION.to_radians().tan());
        let (radius, half_girdle, c) = (Self::RADIUS, 0.01, (PI / 8.0).cos());
        let table = 0.53 * radius;
        let star = f64::midpoint(table * c, radius);
        let lower = 0.23 * radius;
        Self {
            half_girdle,
            table: [table, half_girdle + (radius - table) * crown],
            star: [star, half_girdle + (radius - star * c) * crown],
            lower: [lower, -half_girdle - (radius - lower * c) * pavilion],
            culet: -half_girdle - radius * pavilion,
        }
    }

    fn text(&self) -> String {
        let [apothem, near] = [Self::RADIUS, 1.0].map(|length| length * (PI / 16.0).cos());
        let girdle = self.half_girdle;
        let edge = self.table[0] * (PI / 8.0).cos();
        let star = ((self.table[1] - self.star[1]) / (self.star[0] - edge)).atan().to_degrees();
        let upper = ((self.star[1] - girdle) / (apothem - self.star[0] * near)).atan().to_degrees();
        let lower = ((-girdle - self.lower[1]) / (apothem - self.lower[0] * near)).atan().to_degrees();
        let teeth = |first: usize, step: usize| {
            let teeth: Vec<String> = (first..=96).step_by(step).map(|tooth| tooth.to_string()).collect();
            teeth.join(" ")
        };
        let mut text = String::from("GemCad 5.0\ng 96 0.0\ny 8 y\nI 2.417\nH Round brilliant, 57 facets and girdle\n");
        let mut tier = |angle: f64, [radius, height]: [f64; 2], teeth: &str, name: &str| {
            let (sin, cos) = angle.abs().to_radians().sin_cos();
            let distance = radius * sin + height * cos * angle.signum();
            writeln!(text, "a {angle:.6} {distance:.8} {teeth} n {name}").unwrap();
        };
        tier(-Self::PAVILION, [Self::RADIUS, -girdle], &teeth(12, 12), "P1");
        tier(-lower, [apothem, -girdle], &teeth(3, 6), "P2");
        tier(-90.0, [apothem, 0.0], &teeth(3, 6), "G");
        tier(upper, [apothem, girdle], &teeth(3, 6), "C1");
        tier(Self::CROWN, [Self::RADIUS, girdle], &teeth(12, 12), "C2");
        tier(star, [edge, self.table[1]], &teeth(6, 12), "C3");
        tier(0.0, self.table, "96", "T");
        text
    }
}

/// The brilliant has 57 facets and 16 of the girdle, and all points where facets meet are at the
/// places that follow from its angles.
#[test]
fn a_round_brilliant_meets_at_the_closed_form_points() {
    let brilliant = Brilliant::new();
    let read = file("a.asc", brilliant.text()).unwrap();
    assert!(read.remarks.is_empty(), "{:?}", read.remarks);
    let mesh = &read.parts[0].mesh;
    assert_eq!(counts(mesh), [57, 128, 73]);
    let middle = f64::midpoint(brilliant.table[1], brilliant.culet);
    let girdle = brilliant.half_girdle;
    let expected = [
        (brilliant.table, 8, 0.0),
        (brilliant.star, 8, 0.5),
        ([0.5, girdle], 16, 0.0),
        ([0.5, -girdle], 16, 0.0),
        (brilliant.lower, 8, 0.5),
        ([0.0, brilliant.culet], 1, 0.0),
    ];
    for ([radius, height], count, first) in expected {
        for number in 0..count {
            let (sin, cos) = ((f64::from(number) + first) / f64::from(count) * 2.0 * PI).sin_cos();
            let point = DVec3::new(radius * sin, height - middle, -radius * cos);
            let distance = mesh.positions().iter().map(|it| it.distance(point)).fold(1.0, f64::min);
            assert!(distance < 1e-6, "{point}: {distance}");
        }
    }
    let found = angles(mesh);
    assert_eq!(found.len(), 7, "{found:?}");
    for angle in [Brilliant::CROWN, -Brilliant::PAVILION, 0.0] {
        assert!(found.iter().any(|it| (it - angle).abs() < 1e-4), "{angle}: {found:?}");
    }
}

/// The gallery's design is the one of this test.
#[test]
fn the_brilliant_of_the_gallery_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/gallery/meshes/brilliant.asc");
    let text = Brilliant::new().text();
    if std::env::var_os("ABBE_BLESS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap().replace("\r\n", "\n"), text);
}

/// Volumes and widths of bodies with closed forms: a box, and a bipyramid over a polygon.
#[test]
fn simple_gems_have_the_closed_form_volume() {
    let read = asc("a 0 1 96 n T\na -0 0.5 96\na 90 1 96 48\na -90 3 24 72\n").unwrap();
    let mesh = &read.parts[0].mesh;
    assert_eq!(counts(mesh), [8, 12, 6]);
    // The unit is the smaller extent, which is along z: 1 × 3 × 0.75.
    assert!((mesh.signed_volume() - 2.25).abs() < 1e-12, "{}", mesh.signed_volume());
    let heights: Vec<f64> = mesh.positions().iter().map(|vertex| vertex.y.abs()).collect();
    assert!(heights.iter().all(|height| (height - 0.375).abs() < 1e-12), "{heights:?}");
    let teeth: Vec<String> = (0..12).map(|tooth| (8 * tooth + 4).to_string()).collect();
    let teeth = teeth.join(" ");
    let (sin, cos) = 40_f64.to_radians().sin_cos();
    let read = asc(&format!("a 40 {} {teeth}\na -40 {} {teeth}\n", 0.5 * sin, 0.5 * sin)).unwrap();
    let mesh = &read.parts[0].mesh;
    assert_eq!(counts(mesh), [14, 36, 24]);
    // Corners of the girdle lie on the axes, so its circumscribed circle has the diameter 1.
    let (radius, half_height) = (0.5, 0.5 * (PI / 12.0).cos() * sin / cos);
    let area = 6.0 * radius * radius * (PI / 6.0).sin();
    let volume = area * 2.0 * half_height / 3.0;
    assert!((mesh.signed_volume() - volume).abs() < 1e-12, "{} {volume}", mesh.signed_volume());
}

/// The tooth 0 points to −z, and teeth count clockwise seen from the table.
#[test]
fn teeth_count_clockwise_from_minus_z() {
    let slanted = |design: &str| {
        let mesh = &file("a.asc", design).unwrap().parts[0].mesh;
        facet_normals(mesh).find(|normal| (0.5..0.9).contains(&normal.y)).unwrap()
    };
    let text = format!("{HEADER}{CUBE}a 45 0.6 24\n");
    let half = 0.5_f64.sqrt();
    assert!(slanted(&text).distance(DVec3::new(half, half, 0.0)) < 1e-9);
    assert!(slanted(&text.replace("0.6 24", "0.6 96")).distance(DVec3::new(0.0, half, -half)) < 1e-9);
    // A negative gear counts in the other direction, from the offset on.
    let mirrored = text.replace("g 96 0.0", "g -96 48.0").replace("0.6 24", "0.6 72");
    assert!(slanted(&mirrored).distance(DVec3::new(-half, half, 0.0)) < 1e-9);
}

/// Designs of the three formats with the same facets are the same gem.
#[test]
fn the_formats_agree() {
    let text = format!("{HEADER}{CUBE}a 45 0.6 24 12\na -30 0.55 10\n");
    let mesh = file("a.asc", &text).unwrap().parts.remove(0).mesh;
    for (name, bytes) in [("a.gem", gem(&text)), ("A.GCS", gcs(&text).into_bytes())] {
        let read = file(name, bytes).unwrap();
        assert!(read.remarks.is_empty(), "{:?}", read.remarks);
        let other = &read.parts[0].mesh;
        assert_eq!(counts(other), counts(&mesh), "{name}");
        for vertex in mesh.positions() {
            let distance = other.positions().iter().map(|it| it.distance(*vertex)).fold(1.0, f64::min);
            assert!(distance < 1e-9, "{name}: {distance}");
        }
    }
}

/// Returns the facets of a design in the axes of GemCad's files.
fn planes(text: &str) -> Vec<([f64; 3], f64)> {
    let facets = of_asc(text.as_bytes()).unwrap().0;
    facets.iter().map(|it| ([it.plane.normal.x, -it.plane.normal.z, it.plane.normal.y], it.plane.distance)).collect()
}

/// Writes a design of GemCad without corners.
fn gem(text: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (number, (normal, distance)) in planes(text).into_iter().enumerate() {
        bytes.extend(normal.map(|component| component / distance).map(f64::to_le_bytes).as_flattened());
        bytes.extend((number as i32).to_le_bytes());
        bytes.extend(b"\x05A\tcut");
        bytes.extend(0_i32.to_le_bytes());
    }
    bytes.extend((-99_999.0_f64).to_le_bytes());
    bytes.extend([8_i32, 1, 96].map(i32::to_le_bytes).as_flattened());
    bytes.extend(2.417_f64.to_le_bytes());
    bytes.extend(0x7FFF_u32.to_le_bytes());
    bytes.extend(0_f64.to_le_bytes());
    bytes.extend([0; 8]);
    bytes
}

/// Writes a design of Gem Cut Studio, one tier for each facet.
fn gcs(text: &str) -> String {
    let mut xml = String::from("<GemCutStudio version=\"1000\">\n<index gear=\"96\"/>\n");
    for (number, ([x, y, z], distance)) in planes(text).into_iter().enumerate() {
        let angle = z.clamp(-1.0, 1.0).acos().to_degrees();
        let facet = format!("<facet nx=\"{}\" ny=\"{}\" nz=\"{z}\" index_angle=\"0\"/>", -x, -y);
        writeln!(xml, "<tier angle=\"{angle}\" depth=\"{distance}\" name=\"P{number}\">{facet}</tier>").unwrap();
    }
    xml + "</GemCutStudio>\n"
}

#[test]
fn facets_that_do_not_touch_the_gem_are_noted() {
    let far = "a 45 0.8 24 n C1 48\na 90 0.5 96\n";
    let read = asc(&format!("{CUBE}{far}")).unwrap();
    assert_eq!(counts(&read.parts[0].mesh), [8, 12, 6]);
    assert_eq!(read.remarks, ["2 facets do not touch the gem: tier 4 (C1), index 24, tier 4 (C1), index 48"]);
    let hidden = gcs(&format!("{HEADER}{CUBE}a 45 0.6 24\n")).replace("name=\"P6\"", "name=\"P6\" visible=\"false\"");
    let frosted = hidden.replace("name=\"P0\"", "name=\"P0\" frosting=\"0.5\"");
    let read = file("a.gcs", frosted).unwrap();
    assert_eq!(counts(&read.parts[0].mesh), [8, 12, 6]);
    let remarks = read.remarks.join("; ");
    assert!(remarks.contains("hidden, are these tiers of the design: tier 7 (P6)"), "{remarks}");
    assert!(remarks.contains("frosted, are these tiers of the design: tier 1 (P0)"), "{remarks}");
}

#[test]
fn designs_that_are_no_convex_body_are_refused() {
    let text = |facets: &str| format!("{HEADER}{facets}");
    let sides = "a 90 0.5 96 24 48 72\n";
    for (facets, words) in [
        (format!("{sides}a -40 0.3 96 24 48 72\n"), "do not close the gem above"),
        (format!("{sides}a 0 0.3\n"), "do not close the gem below"),
        ("a 0 0.3\na -0 0.3\na 90 0.5 96 48\n".into(), "do not close the gem at the girdle"),
        (format!("{CUBE}a 45 -0.2 24\n"), "tier 4 of the GemCad design is inclined and has a distance below 0"),
        (format!("{CUBE}a 95 0.2 24 n X\n"), "tier 4 (X) of the GemCad design has the angle 95°"),
        (format!("{CUBE}a 45 0.2 n X\n"), "tier 4 (X) of the GemCad design has no index"),
        (format!("{CUBE}a 45 0.2 nan\n"), "index \"nan\" must be finite"),
        (format!("{CUBE}a 45 1e9 24\n"), "the distances of the facets differ too much"),
        (format!("{CUBE}a 0 0\na -0 0\na 90 0 1 2 3 4 5 6 7\n"), "the distances of the facets differ too much"),
        (format!("{sides}a 0 1e-7\na -0 1e-7\n"), "enclose no body that is thick enough"),
        ("a forty 1 96\n".into(), "angle \"forty\" is not numeric"),
        (String::new(), "no valid 'a' (facet tier) records"),
        (format!("a 45 1 {}", "1 ".repeat(5000)), "the gem design has 5000 facets"),
    ] {
        let found = fault("a.asc", text(&facets));
        assert!(found.contains(words), "{found}");
    }
    let empty = gcs(&text(CUBE)).replacen("depth=\"0.5\"", "depth=\"-0.6\"", 1);
    let found = fault("a.gcs", empty);
    assert!(found.contains("nothing of the gem remains behind tier 2 (P1), facet 1"), "{found}");
    assert!(fault("a.asc", text("a 0\n")).contains("a.asc:6:1: "), "{}", fault("a.asc", text("a 0\n")));
    assert!(fault("a.asc", vec![b' '; 5 << 20]).contains("above 4 MiB"));
    for name in ["a.asc", "a.gem", "a.gcs"] {
        assert!(fault(name, "").contains("not a valid"), "{name}");
        assert!(load(Path::new(name), FileAccess::WithinFolder).unwrap_err().what.contains("cannot read the mesh"));
    }
}

/// A file that states the corners of its facets is compared with the planes of the facets.
#[test]
fn stated_corners_show_concave_designs() {
    let plain = gcs(&format!("{HEADER}{CUBE}"));
    let with_corner = |x: f64, z: f64| {
        let corner = format!("index_angle=\"0\"><vertex x=\"{x}\" y=\"0\" z=\"{z}\"/></facet>");
        plain.replacen("index_angle=\"0\"/>", &corner, 1)
    };
    assert!(file("a.gcs", with_corner(0.5, 0.5)).is_ok());
    let found = fault("a.gcs", with_corner(0.2, 0.6));
    assert!(found.contains("the corners of tier 1 (P0), facet 1 do not lie in the plane"), "{found}");
    let found = fault("a.gcs", with_corner(0.7, 0.5));
    assert!(found.contains("the design is concave: a corner of tier 1 (P0), facet 1 lies in front of"), "{found}");
    let found = fault("a.gcs", plain.replacen("depth=\"0.5\"", "depth=\"much\"", 2));
    assert!(found.contains("tier 1 attribute \"depth\""), "{found}");
}

/// Reading a design with random damage gives a closed mesh or an error, and never a panic.
#[test]
fn damaged_designs_never_panic() {
    let folder = TempDir::new().unwrap();
    let text = Brilliant::new().text();
    let files = [("a.asc", text.clone().into_bytes()), ("a.gem", gem(&text)), ("a.gcs", gcs(&text).into_bytes())];
    let mut rng = Pcg64::seed_from_u64(1);
    for (name, whole) in files {
        let mut read = 0;
        for _ in 0..300 {
            let mut bytes = whole.clone();
            for _ in 0..rng.random_range(1..6) {
                let at = rng.random_range(0..bytes.len());
                match rng.random_range(0..6) {
                    0 => bytes[at] = rng.random(),
                    1 => bytes[at] = b'0' + rng.random_range(0..10),
                    2 => bytes[at] = b'-',
                    3 => bytes[at] ^= 1 << rng.random_range(0..8),
                    4 => drop(bytes.drain(at..(at + 20).min(bytes.len()))),
                    _ => bytes.truncate(at.max(1)),
                }
                if bytes.is_empty() {
                    bytes.push(0);
                }
            }
            if let Ok(file) = load(&write(&folder, name, &bytes), FileAccess::WithinFolder) {
                assert!(file.parts[0].mesh.is_closed());
                read += 1;
            }
        }
        assert!(read < 300, "{name}: no damage was noticed");
    }
}

/// Random cuts of a body satisfy Euler's formula, and all vertices lie behind all facets.
#[test]
fn random_gems_satisfy_eulers_formula() {
    let mut rng = Pcg64::seed_from_u64(2);
    for _ in 0..200 {
        let mut planes: Vec<Plane> = (0..rng.random_range(0..60))
            .map(|_| {
                let mut component = || rng.random_range(-1.0..1.0);
                let normal = DVec3::new(component(), component(), component()).normalize_or(DVec3::X);
                Plane { normal, distance: rng.random_range(0.5..0.7) }
            })
            .collect();
        planes.extend(DVec3::AXES.iter().flat_map(|&axis| [axis, -axis]).map(|normal| Plane { normal, distance: 0.6 }));
        let solid = polyhedron::intersection(&planes, 1e-5).unwrap();
        let corners: usize = solid.faces.iter().map(|face| face.corners.len()).sum();
        assert_eq!(solid.vertices.len() + solid.faces.len(), corners / 2 + 2);
        for plane in &planes {
            assert!(solid.vertices.iter().all(|&vertex| plane.height(vertex) < 1e-5));
        }
    }
}
