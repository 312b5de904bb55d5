//! The materials of mesh files, independent of the file format.

use crate::PictureFile;
use abbe_optics::texture::{Filter, UvTransform, Wrap};
use std::sync::Arc;

/// A material of a mesh file. Colours are linear sRGB.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshMaterial {
    /// Name of the material in the file. The string is empty if the material has no name.
    pub name: String,
    /// Colour of the diffuse reflection, or colour of the metal. Each component is from 0 to 1.
    pub base_colour: [f64; 3],
    pub base_colour_texture: Option<MeshTexture>,
    /// 0 for a dielectric, 1 for a metal.
    pub metallic: f64,
    /// Perceptual roughness as in glTF: √α of the microfacet parameter α, from 0 (smooth) to 1.
    pub roughness: f64,
    /// A linear picture: green multiplies the roughness, and blue multiplies `metallic`.
    pub metallic_roughness_texture: Option<MeshTexture>,
    /// The transmitted fraction of the light that enters the surface. 0 is opaque, and 1 is clear.
    pub transmission: f64,
    /// True if the transmitting surface has no thickness: a pane, unless it encloses a volume.
    pub is_sheet: bool,
    /// A linear picture whose red channel multiplies `transmission`.
    pub transmission_texture: Option<MeshTexture>,
    /// The light that a surface without transmission transmits diffusely.
    pub diffuse_transmission: Option<MeshDiffuseTransmission>,
    pub coat: Option<MeshCoat>,
    /// Factor of the reflectance of the dielectric at normal incidence, from 0 to 1.
    pub specular: f64,
    /// A thin film on smooth glass.
    pub film: Option<MeshFilm>,
    pub ior: f64,
    /// Abbe number of the glass, or `None` if there is no dispersion.
    pub abbe_number: Option<f64>,
    pub attenuation: Option<MeshAttenuation>,
    pub opacity: MeshOpacity,
    /// Emitted colour times the emissive strength, in glTF in cd/m². Zero emits nothing.
    pub emission: [f64; 3],
    pub emission_texture: Option<MeshTexture>,
    pub normal_texture: Option<MeshTexture>,
    /// Factor of the components of the normals along the surface.
    pub normal_strength: f64,
}

/// The covered part of the area. The base colour's alpha channel multiplies `alpha`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeshOpacity {
    /// The surface covers its whole area.
    Opaque,
    /// The surface has holes where the alpha value is below `cutoff`.
    Cut {
        alpha: f64,
        /// The smallest alpha value of the surface.
        cutoff: f64,
    },
    /// The alpha value is the part of the area that the surface covers.
    Blend { alpha: f64 },
}

impl MeshOpacity {
    /// Returns the part of the area that the surface covers, for an alpha value of the picture.
    pub fn covered(self, picture_alpha: f64) -> f64 {
        match self {
            Self::Opaque => 1.0,
            Self::Cut { alpha, cutoff } => f64::from(u8::from(alpha * picture_alpha >= cutoff)),
            Self::Blend { alpha } => (alpha * picture_alpha).clamp(0.0, 1.0),
        }
    }
}

/// A picture over the texture coordinates of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshTexture {
    pub picture: Arc<PictureFile>,
    pub wrap: [Wrap; 2],
    pub filter: Filter,
    pub transform: UvTransform,
}

/// The absorption inside a mesh: after `distance`, white light has the colour `colour`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshAttenuation {
    pub colour: [f64; 3],
    /// Distance in the unit of the mesh file.
    pub distance: f64,
}

/// Diffuse transmission of a thin sheet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshDiffuseTransmission {
    /// The transmitted fraction of the light that is scattered diffusely, from 0 to 1.
    pub factor: f64,
    pub colour: [f64; 3],
}

/// A clear coat over a diffuse surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshCoat {
    /// The part of the area that the coat covers, from 0 to 1.
    pub factor: f64,
    pub roughness: f64,
}

/// A thin film in which light interferes.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshFilm {
    /// The part of the area that the film covers, from 0 to 1.
    pub factor: f64,
    pub ior: f64,
    /// The thickness in nm where the picture is 0, and where it is 1.
    pub thickness_nm: [f64; 2],
    /// A linear picture whose green channel selects the thickness, which is else the second one.
    pub thickness_texture: Option<MeshTexture>,
}

impl MeshMaterial {
    /// Returns true if a picture over the texture coordinates changes the surface.
    pub(crate) fn has_textures(&self) -> bool {
        let film = self.film.as_ref().and_then(|film| film.thickness_texture.as_ref());
        let pictures = [&self.base_colour_texture, &self.metallic_roughness_texture, &self.transmission_texture];
        let others = [&self.emission_texture, &self.normal_texture];
        pictures.into_iter().chain(others).any(Option::is_some) || film.is_some()
    }
}

impl Default for MeshMaterial {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_colour: [0.8; 3],
            base_colour_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            transmission: 0.0,
            is_sheet: false,
            transmission_texture: None,
            diffuse_transmission: None,
            coat: None,
            specular: 1.0,
            film: None,
            ior: 1.5,
            abbe_number: None,
            attenuation: None,
            opacity: MeshOpacity::Opaque,
            emission: [0.0; 3],
            emission_texture: None,
            normal_texture: None,
            normal_strength: 1.0,
        }
    }
}
