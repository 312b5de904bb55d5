//! What a mesh file says about how its surface looks, in neutral terms.

/// A material as mesh files describe it. Colours are linear sRGB.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshMaterial {
    /// Its name in the file, or empty.
    pub name: String,
    /// Colour of diffuse reflection, or of the metal, in [0, 1].
    pub base_colour: [f64; 3],
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f64,
    /// 0 smooth to 1 rough (glTF's perceptual roughness, the square root of the microfacet α).
    pub roughness: f64,
    /// How much of what is not reflected passes through, 0 opaque to 1 clear.
    pub transmission: f64,
    /// Index of refraction.
    pub ior: f64,
    /// Abbe number of the glass; `None` without dispersion.
    pub abbe_number: Option<f64>,
    /// Absorption inside; `None` if there is none.
    pub attenuation: Option<MeshAttenuation>,
    /// Emitted colour times its strength (in nits per glTF); zero where it does not emit.
    pub emission: [f64; 3],
}

/// White light that has gone `distance` through the inside has this `colour`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshAttenuation {
    /// Linear sRGB, in [0, 1].
    pub colour: [f64; 3],
    /// In the mesh's units.
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
