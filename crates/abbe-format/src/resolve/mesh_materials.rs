//! Translates materials of mesh files to materials of the scene.

use super::materials::alpha;
use crate::EncodingFile;
use crate::mesh::{MeshCoat, MeshDiffuseTransmission, MeshFilm, MeshMaterial, MeshOpacity, MeshTexture};
use abbe_optics::bsdf::Bsdf;
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::texture::{ImagePattern, NormalMap, ScalarTexture, SpectralTexture, SurfaceScalar, SurfaceSpectrum};
use abbe_optics::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use abbe_scene::{Body, Material};
use abbe_spectra::error::Result;
use abbe_spectra::math::elementary::ln;
use abbe_spectra::spectrum::{BAND_NM, Outside, Spectrum};
use glam::Vec3;

/// A surface has no coat if its roughness is at least this value.
const MATT: f64 = 0.95;

/// The index of refraction of a clear coat in glTF.
const COAT_IOR: f64 = 1.5;

/// A component of a mixture is left out if its weight is nowhere above this value.
const LEAST_FRACTION: f64 = 0.005;

/// Resolves a material of a mesh file. `metres` is the length of the mesh's unit in m. `textured`
/// states whether the mesh has texture coordinates, and `closed` whether it encloses a volume.
///
/// The material mixes a metal and a dielectric, weighted by `metallic`, as in the
/// metallic-roughness model of glTF 2.0. The dielectric mixes glass and a coated diffuse surface,
/// weighted by `transmission`. Glass without a thickness is a pane where the mesh is open.
pub(super) fn material(file: &MeshMaterial, metres: f64, textured: bool, closed: bool) -> Result<Material> {
    let base = base_colour(file, textured)?;
    let texture = file.metallic_roughness_texture.as_ref().filter(|_| textured);
    let roughness = channel(texture, 1, file.roughness, 0.0)?;
    let metallic = channel(texture, 2, file.metallic, 0.0)?;
    let constant = || RefractiveIndex::constant(file.ior);
    let index = file.abbe_number.map_or_else(constant, |vd| RefractiveIndex::abbe(file.ior, vd))?;
    let metal = || rough(&roughness, &|alpha| Bsdf::metal(base.clone(), alpha));
    let opaque = || opaque(file, &base, &index, &roughness);
    let mut body = None;
    let mut dielectric = || {
        let texture = file.transmission_texture.as_ref().filter(|_| textured);
        let transmission = channel(texture, 0, file.transmission, 0.0)?;
        let (least, most) = transmission.range();
        if most < LEAST_FRACTION {
            return opaque();
        }
        let glass = if file.is_sheet && !closed {
            let bare = pane(file, &index)?;
            match (&file.film, bare.clone()) {
                (Some(film), Bsdf::ThinDielectric(pane)) => {
                    let coated = Bsdf::ThinDielectric(pane.with_coating(film_stack(film, textured)?));
                    mixed(coated, film.factor, bare)?
                }
                _ => bare,
            }
        } else {
            let absorption = file.attenuation.as_ref().map(|it| absorption(it.colour, it.distance * metres));
            let absorption = absorption.transpose()?;
            body = Some(Body { index: Some(index.clone()), absorption, medium: None, priority: 0 });
            let bare = rough(&roughness, &Bsdf::dielectric)?;
            match &file.film {
                Some(film) => {
                    let films = film_stack(film, textured)?;
                    let coated = rough(&roughness, &|alpha| Bsdf::coated_dielectric(films.clone(), &index, alpha))?;
                    mixed(coated, film.factor, bare)?
                }
                None => bare,
            }
        };
        if least > 1.0 - LEAST_FRACTION {
            return Ok(glass);
        }
        let rest = channel(texture, 0, -file.transmission, 1.0)?;
        Bsdf::textured_mix(vec![(transmission, glass), (rest, opaque()?)])
    };
    let surface = match metallic.range() {
        (_, most) if most < LEAST_FRACTION => dielectric()?,
        (least, _) if least > 1.0 - LEAST_FRACTION => metal()?,
        _ => {
            let rest = channel(texture, 2, -file.metallic, 1.0)?;
            Bsdf::textured_mix(vec![(metallic, metal()?), (rest, dielectric()?)])?
        }
    };
    let surface = if body.is_none() { with_holes(surface, file, textured)? } else { surface };
    let name = if file.name.is_empty() { "mesh material".to_string() } else { file.name.clone() };
    let normals = file.normal_texture.as_ref().filter(|_| textured);
    let normal_map = normals.map(|texture| normal_map(texture, file.normal_strength)).transpose()?;
    Ok(Material { name, surface, normal_map, body })
}

/// Returns a pane of glass. The base colour is the transmittance of one passage along the normal.
fn pane(file: &MeshMaterial, index: &RefractiveIndex) -> Result<Bsdf> {
    let colour = file.base_colour.map(|c| c.clamp(0.0, 1.0));
    let depth = if colour == [1.0; 3] { None } else { Some(absorption(colour, 1.0)?) };
    Bsdf::thin_dielectric(index.clone(), depth)
}

fn film_stack(film: &MeshFilm, textured: bool) -> Result<FilmStack> {
    let [thin, thick] = film.thickness_nm;
    let texture = film.thickness_texture.as_ref().filter(|_| textured);
    let thickness_nm = map_channel(texture, 1, |x| thin + (thick - thin) * f64::from(x))?;
    let index = OpticalIndex::Transparent(RefractiveIndex::constant(film.ior)?);
    FilmStack::new(vec![FilmLayer { index, thickness_nm }])
}

/// Returns a surface with a roughness. `of_alpha` creates the surface of a microfacet parameter α.
fn rough(roughness: &SurfaceScalar, of_alpha: &dyn Fn(f64) -> Result<Bsdf>) -> Result<Bsdf> {
    match roughness {
        SurfaceScalar::Uniform(roughness) => of_alpha(alpha(*roughness)),
        SurfaceScalar::Textured(texture) => Bsdf::textured_roughness(texture.clone(), |it| of_alpha(alpha(it))),
    }
}

/// Returns the surface of a dielectric that transmits no light, or diffusely. The diffuse base has
/// a clear coat unless it is matt. A further coat replaces this coat on a part of the area.
fn opaque(file: &MeshMaterial, base: &SurfaceSpectrum, n: &RefractiveIndex, roughness: &SurfaceScalar) -> Result<Bsdf> {
    let index = if file.specular < 1.0 { RefractiveIndex::constant(reduced_ior(file))? } else { n.clone() };
    let is_matt = matches!(roughness, SurfaceScalar::Uniform(roughness) if *roughness >= MATT);
    let mut surface = if is_matt || file.specular < LEAST_FRACTION {
        Bsdf::diffuse(base.clone())?
    } else {
        rough(roughness, &|alpha| Bsdf::glossy(base.clone(), index.clone(), alpha))?
    };
    if let Some(MeshDiffuseTransmission { factor, colour }) = file.diffuse_transmission {
        let sheet = Bsdf::translucent(Spectrum::constant(0.0), Spectrum::rgb_reflectance(colour)?)?;
        surface = mixed(sheet, factor, surface)?;
    }
    if let Some(MeshCoat { factor, roughness }) = file.coat {
        let coat = RefractiveIndex::constant(COAT_IOR)?;
        surface = mixed(Bsdf::glossy(base.clone(), coat, alpha(roughness))?, factor, surface)?;
    }
    Ok(surface)
}

/// Returns the index whose reflectance at normal incidence is `specular` times the file's.
fn reduced_ior(file: &MeshMaterial) -> f64 {
    let reflectance = ((file.ior - 1.0) / (file.ior + 1.0)).powi(2) * file.specular.clamp(0.0, 1.0);
    let root = reflectance.sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Mixes the part `fraction` of one surface with the rest of another one.
fn mixed(one: Bsdf, fraction: f64, other: Bsdf) -> Result<Bsdf> {
    if fraction > 1.0 - LEAST_FRACTION {
        return Ok(one);
    }
    if fraction < LEAST_FRACTION {
        return Ok(other);
    }
    let [fraction, rest] = [fraction, 1.0 - fraction].map(SurfaceScalar::Uniform);
    Bsdf::textured_mix(vec![(fraction, one), (rest, other)])
}

/// Returns the surface, mixed with nothing where it has holes. Light passes straight through a
/// hole, which is a pane with the index of refraction 1.
fn with_holes(surface: Bsdf, file: &MeshMaterial, textured: bool) -> Result<Bsdf> {
    if file.opacity == MeshOpacity::Opaque {
        return Ok(surface);
    }
    let texture = file.base_colour_texture.as_ref().filter(|_| textured);
    let covered = |x: f32| file.opacity.covered(f64::from(x));
    let fractions = [map_channel(texture, 3, covered)?, map_channel(texture, 3, |x| 1.0 - covered(x))?];
    if fractions[0].range().0 > 1.0 - LEAST_FRACTION {
        return Ok(surface);
    }
    let [covered, open] = fractions;
    let hole = Bsdf::thin_dielectric(RefractiveIndex::constant(1.0)?, None)?;
    let is_hole = covered.range().1 < LEAST_FRACTION;
    if is_hole { Ok(hole) } else { Bsdf::textured_mix(vec![(covered, surface), (open, hole)]) }
}

/// Returns the base colour: the product of a colour and a picture.
fn base_colour(file: &MeshMaterial, textured: bool) -> Result<SurfaceSpectrum> {
    let colour = file.base_colour.map(|c| c.clamp(0.0, 1.0));
    let Some(texture) = file.base_colour_texture.as_ref().filter(|_| textured) else {
        return Spectrum::rgb_reflectance(colour).map(SurfaceSpectrum::Uniform);
    };
    let mut pixels = texture.picture.linear_rgb(None);
    for pixel in &mut pixels {
        pixel.iter_mut().zip(colour).for_each(|(c, factor)| *c = (*c * factor as f32).clamp(0.0, 1.0));
    }
    Ok(SpectralTexture::from_colours(pattern(texture)?, pixels).into())
}

/// Returns `offset` + `factor` × a channel (1 without a picture), limited to the range from 0 to 1.
fn channel(texture: Option<&MeshTexture>, number: usize, factor: f64, offset: f64) -> Result<SurfaceScalar> {
    map_channel(texture, number, |x| (offset + factor * f64::from(x)).clamp(0.0, 1.0))
}

/// Returns `value` of a channel of a picture. Without a picture, the channel is 1.
fn map_channel(texture: Option<&MeshTexture>, number: usize, value: impl Fn(f32) -> f64) -> Result<SurfaceScalar> {
    let Some(texture) = texture else { return Ok(SurfaceScalar::Uniform(value(1.0))) };
    let mut values = texture.picture.linear_channel(number, EncodingFile::Linear);
    values.iter_mut().for_each(|x| *x = value(*x) as f32);
    Ok(SurfaceScalar::Textured(ScalarTexture::from_values(pattern(texture)?, values)))
}

fn normal_map(texture: &MeshTexture, strength: f64) -> Result<NormalMap> {
    let scale = Vec3::new(strength as f32, strength as f32, 1.0);
    Ok(NormalMap::from_picture(pattern(texture)?, &texture.picture.components(Some(EncodingFile::Linear)), scale))
}

/// Returns the light of a surface: its colour as linear RGB, and the slide, if it has a picture.
pub(super) fn emission(file: &MeshMaterial, textured: bool) -> Result<([f64; 3], Option<SurfaceSpectrum>)> {
    let Some(texture) = file.emission_texture.as_ref().filter(|_| textured) else { return Ok((file.emission, None)) };
    let most = file.emission.into_iter().fold(0.0, f64::max);
    let mut pixels = texture.picture.linear_rgb(None);
    for pixel in &mut pixels {
        let scaled = pixel.iter_mut().zip(file.emission);
        scaled.for_each(|(c, factor)| *c = (*c * (factor / most) as f32).clamp(0.0, 1.0));
    }
    Ok(([most; 3], Some(SpectralTexture::from_colours(pattern(texture)?, pixels).into())))
}

fn pattern(texture: &MeshTexture) -> Result<ImagePattern> {
    ImagePattern::new(texture.picture.size, texture.wrap, texture.filter, texture.transform)
}

/// Returns an absorption coefficient in 1/m. In a material with this coefficient, white light gets
/// the colour `colour` after the distance `distance_m`.
fn absorption(colour: [f64; 3], distance_m: f64) -> Result<Spectrum> {
    let transmittance = Spectrum::rgb_reflectance(colour.map(|c| c.clamp(0.0, 1.0)))?;
    mapped(&transmittance, |t| -ln(t.max(1e-6)) / distance_m)
}

/// Samples a spectrum every nanometre and applies a function to each sample.
fn mapped(spectrum: &Spectrum, f: impl Fn(f64) -> f64) -> Result<Spectrum> {
    let nm: Vec<f64> = (BAND_NM.0 as u32..=BAND_NM.1 as u32).map(f64::from).collect();
    let values: Vec<f64> = nm.iter().map(|&nm| f(spectrum.at(nm)).max(0.0)).collect();
    Ok(Spectrum::table(&nm, &values, Outside::Hold)?.with_origin_of(spectrum))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the components of the surface of a material, and whether it encloses a body.
    fn components(file: &MeshMaterial) -> (Vec<Bsdf>, bool) {
        let material = material(file, 1.0, false, true).unwrap();
        (material.surface.components().cloned().collect(), material.body.is_some())
    }

    fn glass(transmission: f64) -> MeshMaterial {
        MeshMaterial { transmission, roughness: 0.0, ..MeshMaterial::default() }
    }

    #[test]
    fn a_part_of_transmission_is_a_mix() {
        let (parts, has_body) = components(&glass(1.0));
        assert!(matches!(parts.as_slice(), [Bsdf::Dielectric(_)]) && has_body);
        let (parts, has_body) = components(&glass(0.3));
        assert!(matches!(parts.as_slice(), [Bsdf::Dielectric(_), Bsdf::Glossy(_)]) && has_body, "{parts:?}");
        let (parts, has_body) = components(&glass(0.0));
        assert!(matches!(parts.as_slice(), [Bsdf::Glossy(_)]) && !has_body);
    }

    /// Glass without a thickness is a pane on an open mesh, and its base colour a transmittance.
    #[test]
    fn sheets_of_glass_are_panes() {
        let sheet = MeshMaterial { is_sheet: true, base_colour: [1.0, 0.5, 0.25], ..glass(1.0) };
        let open = material(&sheet, 1.0, false, false).unwrap();
        assert!(open.body.is_none());
        let Bsdf::ThinDielectric(pane) = &open.surface else { panic!("{open:?}") };
        let air = RefractiveIndex::constant(1.0).unwrap();
        let [red, blue] = [620.0, 450.0].map(|nm| pane.transmittance(1.0, &air, nm));
        assert!(red > 0.75 && (0.15..0.35).contains(&blue), "{red} {blue}");
        assert!(material(&sheet, 1.0, false, true).unwrap().body.is_some());
        assert!(material(&glass(1.0), 1.0, false, false).unwrap().body.is_some());
    }

    #[test]
    fn coats_and_sheets_are_mixed_with_the_base() {
        let coat = Some(MeshCoat { factor: 0.5, roughness: 0.1 });
        let (parts, _) = components(&MeshMaterial { coat, ..MeshMaterial::default() });
        assert!(matches!(parts.as_slice(), [Bsdf::Glossy(_), Bsdf::Diffuse(_)]), "{parts:?}");
        let diffuse_transmission = Some(MeshDiffuseTransmission { factor: 0.4, colour: [0.2, 0.8, 0.1] });
        let (parts, has_body) = components(&MeshMaterial { diffuse_transmission, ..MeshMaterial::default() });
        assert!(matches!(parts.as_slice(), [Bsdf::Translucent(_), Bsdf::Diffuse(_)]) && !has_body, "{parts:?}");
    }

    /// The reflectance at normal incidence is 4 % × the factor.
    #[test]
    fn the_specular_factor_scales_the_reflectance() {
        let ior = reduced_ior(&MeshMaterial { specular: 0.25, ..MeshMaterial::default() });
        assert!((((ior - 1.0) / (ior + 1.0)).powi(2) - 0.01).abs() < 1e-15);
        let (parts, _) = components(&MeshMaterial { specular: 0.0, ..glass(0.0) });
        assert!(matches!(parts.as_slice(), [Bsdf::Diffuse(_)]), "{parts:?}");
    }
}
