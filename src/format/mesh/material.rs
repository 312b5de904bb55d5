//! The materials of mesh files, independent of the file format.

/// A material of a mesh file. Colours are linear sRGB.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshMaterial {
    /// Name in the file, or the empty string.
    pub name: String,
    /// Colour of the diffuse reflection or of the metal, from 0 to 1.
    pub base_colour: [f64; 3],
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f64,
    /// Perceptual roughness of glTF, from 0 (smooth) to 1 (rough): the square root of the
    /// microfacet parameter α.
    pub roughness: f64,
    /// Fraction of the light entering the surface that is transmitted, from 0 (opaque) to 1
    /// (clear).
    pub transmission: f64,
    /// Index of refraction.
    pub ior: f64,
    /// Abbe number of the glass; `None` without dispersion.
    pub abbe_number: Option<f64>,
    /// Absorption inside, or `None` without absorption.
    pub attenuation: Option<MeshAttenuation>,
    /// Emitted colour multiplied by the emissive strength. In glTF files, the unit is cd/m². Zero
    /// for a surface that does not emit.
    pub emission: [f64; 3],
}

/// The absorption inside a mesh, given by the colour of white light that has travelled a distance
/// through the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshAttenuation {
    /// Colour in linear sRGB, from 0 to 1.
    pub colour: [f64; 3],
    /// Distance in the unit of the mesh file.
    pub distance: f64,
}

impl Default for MeshMaterial {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_colour: [0.8; 3],
            metallic: 0.0,
            roughness: 1.0,
            transmission: 0.0,
            ior: 1.5,
            abbe_number: None,
            attenuation: None,
            emission: [0.0; 3],
        }
    }
}
