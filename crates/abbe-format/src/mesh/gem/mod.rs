//! Gem designs: GemCad's cutting instructions (`.asc`) and designs (`.gem`), and designs of Gem Cut
//! Studio (`.gcs`).
//!
//! A design lists the planes of its facets. The gem is the convex body that lies behind all of
//! them. In the files, +z is the direction of the table, and the tooth 0 of the index gear points
//! to +y (in files of Gem Cut Studio to −y). The mesh has the table at +y and the tooth 0 at −z.

mod polyhedron;
#[cfg(test)]
mod tests;

use super::part::{MeshPart, PartsAndNotes, listed};
use super::polygon::PolygonSplitter;
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use abbe_spectra::math::elementary;
use glam::DVec3;
use indicatrix_formats::asc::{AscTier, parse_asc_bytes};
use indicatrix_formats::gcs::{GcsFacet, GcsTier, normal_from_index_angle, parse_gcs_bytes};
use indicatrix_formats::gem::parse_gem;
use polyhedron::{Fault, Plane, Polyhedron};
use std::io::Read as _;
use std::path::Path;

/// The largest size in bytes of a design (4 MiB). Designs of 500 facets have 150 KiB.
const MAX_BYTES: u64 = 4 << 20;

/// The largest number of facets of a design.
const MAX_FACETS: usize = 4096;

/// The length of the edges that vanish, as a part of the median distance of the facets. Files round
/// distances, so facets that meet in one point of the design miss it by a little. The length is
/// above the distance at which a mesh counts two vertices as one.
const SHORTEST_EDGE: f64 = 1e-5;

/// The largest distance of a vertex that the file states from the gem, as a part of the median
/// distance of the facets. Files of Gem Cut Studio round to 3 · 10⁻⁵.
const STATED_TOLERANCE: f64 = 1e-3;

/// One facet of a design, in the axes of the mesh and the unit of the file.
struct Facet {
    plane: Plane,
    /// What messages call the facet.
    name: String,
    /// The corners that the file states, which may be missing.
    stated: Vec<DVec3>,
}

/// The facets of a file, and sentences about what is not read.
type FacetsAndRemarks = (Vec<Facet>, Vec<String>);

/// Reads a design, whose extension is "asc", "gem" or "gcs".
pub(super) fn load(path: &Path, extension: &str) -> Result<PartsAndNotes> {
    let bytes = read(path)?;
    let (facets, mut remarks) = match extension {
        "asc" => of_asc(&bytes)?,
        "gem" => of_gem(&bytes)?,
        _ => of_gcs(&bytes)?,
    };
    let (mesh, untouched) = body(&facets)?;
    remarks.extend(untouched);
    let part = MeshPart { mesh, material: None, material_number: None, name: String::new(), colours: None };
    Ok(PartsAndNotes { parts: vec![part], remarks, ..PartsAndNotes::default() })
}

fn read(path: &Path) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    read.map_err(|error| Error::input(format!("cannot read the mesh: {error}")))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(Error::input("the gem design is above 4 MiB").expected("a smaller file"));
    }
    Ok(bytes)
}

/// Makes the body of the facets. Its width is 1, and y = 0 is half its height. Also returns a
/// sentence about the facets that do not touch the body.
fn body(facets: &[Facet]) -> Result<(TriangleMesh, Option<String>)> {
    if facets.len() > MAX_FACETS {
        let found = format!("the gem design has {} facets", facets.len());
        return Err(Error::input(found).expected(format!("at most {MAX_FACETS}")));
    }
    let mut distances: Vec<f64> = facets.iter().map(|facet| facet.plane.distance.abs()).collect();
    distances.sort_by(f64::total_cmp);
    let median = distances.get(distances.len() / 2).copied().unwrap_or_default();
    let is_usable = |distance: &f64| (1e-6..=1e6).contains(distance);
    if !is_usable(&median) || distances.last().is_some_and(|last| *last > 1e3 * median) {
        return Err(Error::input("the distances of the facets differ too much, or are 0")
            .expected("distances from 0.000001 to 1000000, at most 1000 times their median"));
    }
    check_stated(facets, STATED_TOLERANCE * median)?;
    let planes: Vec<Plane> = facets.iter().map(|facet| facet.plane).collect();
    let solid = polyhedron::intersection(&planes, SHORTEST_EDGE * median).map_err(|fault| explain(&fault, facets))?;
    let untouched = solid.untouched(&planes, SHORTEST_EDGE * median);
    let count = untouched.len();
    let note = listed(untouched.into_iter().map(|number| facets[number].name.as_str())).map(|names| {
        let facets = if count == 1 { "1 facet does" } else { &format!("{count} facets do") };
        format!("{facets} not touch the gem: {names}")
    });
    Ok((meshed(&solid)?, note))
}

fn meshed(solid: &Polyhedron) -> Result<TriangleMesh> {
    let low = solid.vertices.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = solid.vertices.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let width = (high.x - low.x).min(high.z - low.z);
    let centre = DVec3::new(0.0, (low.y + high.y) / 2.0, 0.0);
    let positions: Vec<DVec3> = solid.vertices.iter().map(|&vertex| (vertex - centre) / width).collect();
    let mut splitter = PolygonSplitter::new(&positions);
    solid.faces.iter().for_each(|face| splitter.add(&face.corners));
    let triangles = splitter.triangles;
    let mesh = TriangleMesh::new(positions, None, None, triangles)?;
    if !mesh.is_closed() || mesh.signed_volume() <= 0.0 {
        return Err(Error::input("the facets of the gem design enclose no body that is thick enough"));
    }
    Ok(mesh)
}

/// Compares the corners that a file states with the planes of its facets. In a concave design, some
/// corners lie in front of other facets.
fn check_stated(facets: &[Facet], tolerance: f64) -> Result<()> {
    for (number, facet) in facets.iter().enumerate() {
        for &corner in &facet.stated {
            let height = facet.plane.height(corner).abs();
            if height.is_nan() || height > tolerance {
                let found = format!("the corners of {} do not lie in the plane of this facet", facet.name);
                return Err(Error::input(found).expected("flat facets"));
            }
            let before = |other: &(usize, &Facet)| other.0 != number && other.1.plane.height(corner) > tolerance;
            if let Some((_, other)) = facets.iter().enumerate().find(before) {
                let found =
                    format!("the design is concave: a corner of {} lies in front of {}", facet.name, other.name);
                return Err(Error::input(found).expected("a convex gem, which lies behind all of its facets"));
            }
        }
    }
    Ok(())
}

fn explain(fault: &Fault, facets: &[Facet]) -> Error {
    let name = |number: &usize| facets[*number].name.as_str();
    match fault {
        Fault::Empty(number) => Error::input(format!("nothing of the gem remains behind {}", name(number)))
            .expected("facets that enclose a body"),
        Fault::Tangled(number) => {
            Error::input(format!("the gem is too thin at {}", name(number))).expected("facets that enclose a body")
        }
        Fault::Open(side) => {
            let side = if side.y > 0.5 {
                "above, where the table is"
            } else if side.y < -0.5 {
                "below, where the culet is"
            } else {
                "at the girdle"
            };
            Error::input(format!("the facets do not close the gem {side}")).expected("facets that enclose a body")
        }
    }
}

/// Says which tier of a design a message is about. `number` is from 0.
fn tier_name(number: usize, name: &str) -> String {
    let name: String = name.chars().filter(|character| !character.is_control()).take(20).collect();
    if name.is_empty() { format!("tier {}", number + 1) } else { format!("tier {} ({name})", number + 1) }
}

/// Makes an error from a message that may begin with a line or a tier counted from 0.
fn malformed(kind: &str, message: &str) -> Error {
    let line = message.strip_prefix("line ").and_then(|rest| rest.split_once(": "));
    if let Some((line, fault)) = line.and_then(|(line, fault)| Some((line.parse::<usize>().ok()?, fault))) {
        return Error::input(format!("not a valid {kind}: {fault}")).at(line, 1);
    }
    let tier = message.strip_prefix("tier #").map(|rest| rest.split_at(rest.find([' ', ':']).unwrap_or(rest.len())));
    let message = match tier.and_then(|(tier, fault)| Some((tier.parse::<usize>().ok()?, fault))) {
        Some((tier, fault)) => format!("tier {}{fault}", tier + 1),
        None => message.to_owned(),
    };
    Error::input(format!("not a valid {kind}: {message}"))
}

/// Keeps the first sentences of a reader about what it leaves out.
fn first_of(mut warnings: Vec<String>) -> Vec<String> {
    const MOST: usize = 5;
    let others = warnings.len().saturating_sub(MOST);
    warnings.truncate(MOST);
    warnings.extend((others > 0).then(|| format!("{others} other lines of the design are not read")));
    warnings
}

fn of_asc(bytes: &[u8]) -> Result<FacetsAndRemarks> {
    let design = parse_asc_bytes(bytes).map_err(|error| malformed("GemCad design", &error.to_string()))?;
    let mut facets = Vec::new();
    for (number, tier) in design.tiers.iter().enumerate() {
        let name = tier_name(number, &tier.name);
        let fault = |what: &str| Error::input(format!("{name} of the GemCad design {what}"));
        let AscTier { angle_deg, mast, indices, .. } = tier;
        if angle_deg.abs() > 90.0 {
            return Err(fault(&format!("has the angle {angle_deg}°")).expected("an angle from −90° to 90°"));
        }
        if *mast < 0.0 {
            return Err(fault("is inclined and has a distance below 0").expected("a distance above 0"));
        }
        if indices.is_empty() && *angle_deg != 0.0 {
            return Err(fault("has no index").expected("the teeth of the index gear at which its facets are cut"));
        }
        // The tooth of a table has no meaning.
        let teeth: &[f64] = if *angle_deg == 0.0 { &[0.0] } else { indices };
        for tooth in teeth {
            let turn = (tooth - design.gear_reference_angle) / f64::from(design.gear_teeth);
            let plane = Plane { normal: inclined(*angle_deg, turn), distance: *mast };
            facets.push(Facet { plane, name: format!("{name}, index {tooth}"), stated: Vec::new() });
        }
    }
    Ok((facets, first_of(design.warnings)))
}

/// Returns the normal of a facet with an angle to the girdle's plane. Negative angles are those of
/// the pavilion. `turn` is the part of a turn from the tooth 0, clockwise seen from the table.
fn inclined(angle_deg: f64, turn: f64) -> DVec3 {
    let side = if angle_deg.is_sign_negative() { -1.0 } else { 1.0 };
    let (sin, cos) = match angle_deg.abs() {
        90.0 => (1.0, 0.0),
        angle => elementary::sin_cos(angle.to_radians()),
    };
    let (across, along) = elementary::sin_cos((turn % 1.0) * std::f64::consts::TAU);
    DVec3::new(sin * across, side * cos, -sin * along)
}

fn of_gem(bytes: &[u8]) -> Result<FacetsAndRemarks> {
    let design = parse_gem(bytes).map_err(|error| malformed("GemCad design", &error.to_string()))?;
    let turned = |[x, y, z]: [f64; 3]| DVec3::new(x, z, -y);
    let mut facets = Vec::new();
    for (number, facet) in design.facets.iter().enumerate() {
        // The plane contains the points whose product with this vector is 1.
        let vector = turned(facet.plane);
        let label = facet.name.as_deref().map(|name| tier_name(number, name).replacen("tier", "facet", 1));
        let name = label.unwrap_or_else(|| format!("facet {}", number + 1));
        let length = vector.length();
        if !(1e-9..=1e9).contains(&length) {
            return Err(Error::input(format!("{name} of the GemCad design is not a plane near the gem")));
        }
        let stated = facet.vertices_on_plane(design.vertex_scale).into_iter().map(turned).collect();
        let plane = Plane { normal: vector / length, distance: 1.0 / length };
        facets.push(Facet { plane, name, stated });
    }
    Ok((facets, Vec::new()))
}

fn of_gcs(bytes: &[u8]) -> Result<FacetsAndRemarks> {
    let design = parse_gcs_bytes(bytes).map_err(|error| malformed("design of Gem Cut Studio", &error.to_string()))?;
    let turned = |[x, y, z]: [f64; 3]| DVec3::new(-x, z, y);
    let (mut facets, mut hidden, mut frosted) = (Vec::new(), Vec::new(), Vec::new());
    for (number, tier) in design.tiers.iter().enumerate() {
        let name = tier_name(number, &tier.name);
        if !tier.visible {
            hidden.push(name);
            continue;
        }
        if tier.is_frosted() || tier.facets.iter().any(GcsFacet::is_frosted) {
            frosted.push(name.clone());
        }
        for (position, facet) in tier.facets.iter().enumerate() {
            let name = format!("{name}, facet {}", position + 1);
            let normal = turned(normal_of(tier, facet));
            let length = normal.length();
            if !(0.5..=2.0).contains(&length) {
                return Err(Error::input(format!("{name} of the design has a normal of length {length}")).expected("1"));
            }
            let plane = Plane { normal: normal / length, distance: tier.depth };
            let stated = facet.vertices.iter().map(|corner| turned([corner.x, corner.y, corner.z])).collect();
            facets.push(Facet { plane, name, stated });
        }
    }
    let mut remarks = first_of(design.warnings);
    let sentence = |names: &[String], what: &str| {
        listed(names.iter().map(String::as_str)).map(|names| format!("{what} of the design: {names}"))
    };
    remarks.extend(sentence(&hidden, "not cut, because they are hidden, are these tiers"));
    remarks.extend(sentence(&frosted, "smooth, although they are frosted, are these tiers"));
    Ok((facets, remarks))
}

/// Returns the normal of a facet. The crate derives the normal of a file that states none with the
/// functions of the C library, whose bits differ between machines, so it is derived again.
fn normal_of(tier: &GcsTier, facet: &GcsFacet) -> [f64; 3] {
    if facet.normal != normal_from_index_angle(tier.angle_deg, facet.index_angle_deg) {
        return facet.normal;
    }
    let (sin, cos) = elementary::sin_cos(tier.angle_deg.to_radians());
    let turn = if tier.angle_deg < 90.0 { facet.index_angle_deg - 90.0 } else { 270.0 - facet.index_angle_deg };
    let (across, along) = elementary::sin_cos((turn % 360.0).to_radians());
    [sin * along, sin * across, cos]
}
