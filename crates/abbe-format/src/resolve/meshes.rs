//! Reads the meshes of objects. A mesh that several objects name is read once, and they share it.

use super::context::Resolver;
use crate::mesh::{MeshFile, MeshMaterial, MeshPart, UnplacedParts};
use crate::{JsonPath, MeshShapeFile, ShapeFile, mesh};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use std::borrow::Cow;
use std::cell::{Cell, OnceCell};
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// The largest number of shared shapes that refer to each other.
const MAX_DEPTH: usize = 16;

pub(super) struct LoadedMesh {
    pub(super) parts: Vec<LoadedPart>,
    /// A sentence about the properties of materials that the reader ignores.
    pub(super) ignored: Option<String>,
    /// Sentences about what the file names and the reader cannot use.
    pub(super) warnings: Vec<String>,
    /// Sentences about the geometry.
    pub(super) remarks: Vec<String>,
    /// True if the file also contains lights.
    pub(super) has_lights: bool,
}

/// One part of a mesh: triangles with one material.
#[derive(Clone)]
pub(super) struct LoadedPart {
    pub(super) mesh: Arc<TriangleMesh>,
    /// The mesh with the copies of its triangles, which let a light shine to both sides.
    doubled: Option<Arc<TriangleMesh>>,
    pub(super) copies: usize,
    pub(super) material: Option<MeshMaterial>,
    /// The number of this material in the scene once it is used. Parts with it share the cell.
    pub(super) material_number: Rc<Cell<Option<usize>>>,
    /// Name of the part in the file. It may be empty.
    pub(super) name: String,
    /// The colours of the vertices, which the part's own material shows.
    colours: Option<Arc<Vec<[f32; 3]>>>,
    /// The part with these colours, once an object needs it.
    painted: Rc<OnceCell<PaintedPart>>,
}

type PaintedPart = (Arc<TriangleMesh>, MeshMaterial);

/// The meshes that were read before, each with its form in the scene file.
#[derive(Default)]
pub(super) struct MeshCache<'a> {
    list: Vec<(&'a ShapeFile, Rc<LoadedMesh>)>,
    /// The files whose parts are named one by one, by their path in the scene file.
    files: BTreeMap<&'a str, LoadedFile>,
}

struct LoadedFile {
    parts: BTreeMap<u32, LoadedPart>,
    ignored: Option<String>,
    warnings: Vec<String>,
    remarks: Vec<String>,
}

impl LoadedMesh {
    fn of(part: LoadedPart) -> Self {
        let (warnings, remarks) = (Vec::new(), Vec::new());
        Self { parts: vec![part], ignored: None, warnings, remarks, has_lights: false }
    }
}

impl<'a> Resolver<'a> {
    /// Hands the shape to which a shape refers, usually itself, and its place to `then`.
    pub(super) fn shared_shape<T>(
        &self,
        at: &JsonPath,
        shape: &'a ShapeFile,
        then: impl FnOnce(&JsonPath, &'a ShapeFile) -> Result<T>,
    ) -> Result<T> {
        let ShapeFile::Shared(name) = shape else { return then(at, shape) };
        let root = JsonPath::Root;
        let shapes = root.key("shapes");
        let (mut name, mut depth) = (name, 0);
        loop {
            let Some(found) = self.scene.shapes.get(name) else {
                let known = self.scene.shapes.keys().map(String::as_str);
                let error = Error::unknown_name("shape", name, known).expected("a name of the scene's `shapes`");
                return self.at(&at.key("shared"), Err(error));
            };
            let ShapeFile::Shared(next) = found else { return then(&shapes.key(name), found) };
            if depth >= MAX_DEPTH {
                return self.at(&at.key("shared"), Err(Error::input("this shape contains itself")));
            }
            (name, depth) = (next, depth + 1);
        }
    }

    /// Returns a mesh. Returns `None` for other shapes.
    pub(super) fn mesh(
        &self,
        at: &JsonPath,
        shape: &'a ShapeFile,
        cache: &mut MeshCache<'a>,
    ) -> Result<Option<Rc<LoadedMesh>>> {
        // Large meshes in the scene file are compared by their address only.
        let same = |known: &ShapeFile| match (known, shape) {
            // The parts of a large file differ in their number only.
            (ShapeFile::Mesh(known), ShapeFile::Mesh(mesh)) => known.part == mesh.part && known == mesh,
            _ => std::ptr::eq(known, shape),
        };
        if let Some((_, known)) = cache.list.iter().find(|(known, _)| same(known)) {
            return Ok(Some(Rc::clone(known)));
        }
        let loaded = if let ShapeFile::Mesh(file) = shape {
            self.mesh_file(&at.key("mesh"), file, cache)?
        } else if let ShapeFile::Triangles(triangles) = shape {
            let mesh = self.at(&at.key("triangles"), triangles.mesh())?;
            let part = MeshPart { mesh, material: None, material_number: None, name: String::new(), colours: None };
            LoadedMesh::of(LoadedPart::new(part))
        } else {
            return Ok(None);
        };
        let loaded = Rc::new(loaded);
        cache.list.push((shape, Rc::clone(&loaded)));
        Ok(Some(loaded))
    }

    fn mesh_file(&self, at: &JsonPath, file: &'a MeshShapeFile, cache: &mut MeshCache<'a>) -> Result<LoadedMesh> {
        let MeshShapeFile { path, part, reverse, flat, smooth, flip_v } = file;
        let changed = |part: LoadedPart| {
            if !(*flat || *smooth || *reverse || *flip_v) {
                return part;
            }
            let changed = |mesh: Arc<TriangleMesh>| {
                let mut mesh = Arc::unwrap_or_clone(mesh);
                mesh = if *flat { mesh.without_normals() } else { mesh };
                mesh = if *smooth { mesh.with_normals() } else { mesh };
                mesh = if *reverse { mesh.reversed() } else { mesh };
                mesh = if *flip_v { mesh.with_flipped_v() } else { mesh };
                Arc::new(mesh)
            };
            let (mesh, doubled) = (changed(part.mesh), part.doubled.map(changed));
            // The picture of the colours follows the triangles.
            let own = Rc::default();
            let material_number = if part.colours.is_some() { own } else { part.material_number };
            LoadedPart { mesh, doubled, material_number, painted: Rc::default(), ..part }
        };
        let Some(number) = part else {
            let read = self.source.file(path).and_then(|path| mesh::load(&path, self.source.file_access()));
            let MeshFile { parts, ignored, warnings, remarks, has_lights } = self.at(&at.key("path"), read)?;
            let loaded = |part: MeshPart| changed(LoadedPart::new(part));
            let parts = parts.into_iter().map(loaded).collect();
            return Ok(LoadedMesh { parts, ignored, warnings, remarks, has_lights });
        };
        if !cache.files.contains_key(path.as_str()) {
            let read = self.source.file(path).and_then(|path| mesh::load_unplaced(&path, self.source.file_access()));
            cache.files.insert(path, LoadedFile::new(self.at(&at.key("path"), read)?));
        }
        let LoadedFile { parts, ignored, warnings, remarks } = &cache.files[path.as_str()];
        let missing = || {
            let last = parts.keys().last().map_or("no part".into(), |last| format!("a part from 0 to {last}"));
            Error::input(format!("the mesh has no part {number}")).expected(last)
        };
        let part = self.at(&at.key("part"), parts.get(number).cloned().ok_or_else(missing))?;
        let (ignored, warnings, remarks) = (ignored.clone(), warnings.clone(), remarks.clone());
        Ok(LoadedMesh { ignored, warnings, remarks, ..LoadedMesh::of(changed(part)) })
    }
}

impl LoadedFile {
    fn new(file: UnplacedParts) -> Self {
        let UnplacedParts { parts, ignored, warnings, remarks } = file;
        // A material with textures differs from the same material on a mesh without texture
        // coordinates, and glass differs from the same glass on an open mesh.
        let mut numbers: BTreeMap<_, Rc<Cell<Option<usize>>>> = BTreeMap::new();
        let loaded = |(number, part): (u32, MeshPart)| {
            let known = part.material_number;
            let loaded = LoadedPart::new(part);
            let (textured, closed) = (loaded.mesh.uvs().is_some(), loaded.mesh.is_closed());
            let material_number = known.map(|known| Rc::clone(numbers.entry((known, textured, closed)).or_default()));
            (number, LoadedPart { material_number: material_number.unwrap_or_default(), ..loaded })
        };
        let parts = parts.into_iter().map(loaded).collect();
        Self { parts, warnings, remarks, ignored: (!ignored.is_empty()).then(|| ignored.join("; ")) }
    }
}

impl LoadedPart {
    fn new(part: MeshPart) -> Self {
        let MeshPart { mesh, material, material_number: _, name, colours } = part;
        let (mesh, doubled, copies) = match mesh.without_copies() {
            Some((single, copies)) => (single, Some(Arc::new(mesh)), copies),
            None => (mesh, None, 0),
        };
        let (mesh, colours, material_number) = (Arc::new(mesh), colours.map(Arc::new), Rc::default());
        Self { mesh, doubled, copies, material, material_number, name, colours, painted: Rc::default() }
    }

    /// Returns the part whose own material has the colours of the vertices.
    pub(super) fn painted(&self) -> Result<Cow<'_, Self>> {
        let Some(colours) = &self.colours else { return Ok(Cow::Borrowed(self)) };
        let painted = match self.painted.get() {
            Some(known) => known,
            None => {
                let painted = mesh::painted(&self.mesh, self.material.as_ref(), colours)?;
                self.painted.get_or_init(|| painted)
            }
        };
        let (mesh, material) = painted.clone();
        Ok(Cow::Owned(Self { mesh, doubled: None, material: Some(material), colours: None, ..self.clone() }))
    }

    /// Returns the part's own material if it emits light.
    pub(super) fn emitter(&self) -> Option<&MeshMaterial> {
        self.material.as_ref().filter(|own| own.emission.iter().any(|&component| component > 0.0))
    }

    /// Returns the mesh for an object: its own if luminous, as no points are sampled on shared
    /// ones.
    pub(super) fn mesh_for(&self, is_luminous: bool) -> Arc<TriangleMesh> {
        let luminous = || TriangleMesh::clone(self.doubled.as_ref().unwrap_or(&self.mesh));
        if is_luminous { Arc::new(luminous()) } else { Arc::clone(&self.mesh) }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::{parse, resolve::resolve};

    /// Returns the fault of a scene with these shapes and this object.
    fn fault(shapes: &str, object: &str) -> String {
        let text = format!(
            r#"{{
                "camera": {{"from": [0, 0, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 35}}}}}},
                "film": {{"width": 4, "height": 4}}, "materials": {{"white": {{"diffuse": {{"reflectance": 0.8}}}}}},
                "shapes": {shapes}, "objects": [{object}],
                "lights": [{{"environment": {{"spectrum": 1, "irradiance": 1}}}}]
            }}"#
        );
        let (file, source) = parse(&text, Path::new("scene.json"), &[]).unwrap();
        resolve(&file, &source).map_or_else(|error| error.to_string(), |_| String::new())
    }

    #[test]
    fn shared_shapes_need_a_known_name_and_a_material() {
        let tree = r#"{"tree": {"sphere": {"radius": 1}}}"#;
        assert_eq!(fault(tree, r#"{"shape": {"shared": "tree"}, "material": "white"}"#), "");
        for (shapes, object, expected) in [
            (tree, r#"{"shape": {"shared": "tre"}, "material": "white"}"#, "unknown shape \"tre\""),
            (tree, r#"{"shape": {"shared": "tree"}}"#, "the shape has no material"),
            (
                r#"{"a": {"shared": "b"}, "b": {"shared": "a"}}"#,
                r#"{"shape": {"shared": "a"}, "material": "white"}"#,
                "contains itself",
            ),
        ] {
            let found = fault(shapes, object);
            assert!(found.contains(expected) && found.contains("objects[0]"), "{found}");
        }
    }
}
