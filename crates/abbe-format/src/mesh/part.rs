//! The parts of mesh files, and helpers of their readers.

use super::material::MeshMaterial;
use abbe_scene::geometry::mesh::TriangleMesh;
use std::collections::BTreeMap;

/// One part of a mesh file: triangles with one material.
#[derive(Debug, Clone)]
pub struct MeshPart {
    /// The triangles in the unit of the file, after all node transforms.
    pub mesh: TriangleMesh,
    pub material: Option<MeshMaterial>,
    /// The number of the material in a glTF file. Parts with the same number have equal materials.
    pub material_number: Option<usize>,
    /// Name of the part in the file. The string is empty if the part has no name.
    pub name: String,
    /// The colours of the vertices in linear sRGB. They multiply the base colour of the part's own
    /// material.
    pub colours: Option<Vec<[f32; 3]>>,
}

#[derive(Debug, Clone)]
pub struct UnplacedParts {
    /// The parts. In a glTF file, they are the primitives with triangles of the default scene, in
    /// the order of the file and without the transforms of the nodes.
    pub parts: BTreeMap<u32, MeshPart>,
    pub ignored: Vec<String>,
    /// Sentences about what the file names and the reader cannot use.
    pub warnings: Vec<String>,
    /// Sentences about the geometry.
    pub remarks: Vec<String>,
}

#[derive(Debug, Default)]
pub(super) struct PartsAndNotes {
    pub(super) parts: Vec<MeshPart>,
    pub(super) ignored: Vec<String>,
    pub(super) warnings: Vec<String>,
    pub(super) remarks: Vec<String>,
    pub(super) has_lights: bool,
}

#[cfg(feature = "meshes")]
impl PartsAndNotes {
    pub(super) fn of(parts: Vec<MeshPart>) -> Self {
        Self { parts, ..Self::default() }
    }
}

/// Returns sentences about the glass without thickness on open meshes, which is a pane.
pub fn open_panes<'p>(parts: impl IntoIterator<Item = &'p MeshPart>) -> Vec<String> {
    const MOST: usize = 5;
    let mut sentences: Vec<String> = Vec::new();
    for part in parts {
        let Some(material) = &part.material else { continue };
        if !(material.is_sheet && material.transmission > 0.0) || part.mesh.is_closed() {
            continue;
        }
        let edges = part.mesh.open_edges();
        let edges = if edges == 1 { "1 open edge".to_owned() } else { format!("{edges} open edges") };
        let sentence = format!("glass of an open mesh is a pane ({edges}): material \"{}\"", material.name);
        if !sentences.contains(&sentence) {
            sentences.push(sentence);
        }
    }
    let others = sentences.len().saturating_sub(MOST);
    sentences.truncate(MOST);
    sentences.extend((others > 0).then(|| format!("the same holds for {others} other panes")));
    sentences
}

/// Lists names once each, in order of occurrence: the first five, and the number of the others.
#[cfg(feature = "meshes")]
pub(super) fn listed<'a>(names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    const MOST: usize = 5;
    let mut unique: Vec<&str> = Vec::new();
    for name in names {
        if !unique.contains(&name) {
            unique.push(name);
        }
    }
    let others = unique.len().saturating_sub(MOST);
    unique.truncate(MOST);
    let list = unique.join(", ");
    (!list.is_empty()).then(|| if others == 0 { list } else { format!("{list} and {others} others") })
}

/// Splits a polygon into triangles that share its first corner.
#[cfg(feature = "meshes")]
pub(super) fn fan(polygon: &[u32]) -> impl Iterator<Item = [u32; 3]> {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]])
}
