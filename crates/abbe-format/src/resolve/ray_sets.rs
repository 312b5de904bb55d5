//! Resolves lights that replay the rays of a file.

use super::context::Resolver;
use super::lights::{LightContext, radiometric};
use crate::light::RaysFile;
use crate::ray_file::{self, FluxUnit, RayFile, RayGroup, RaySpectrum};
use crate::{JsonPath, QuantityFile};
use abbe_scene::light::{Emitter, LightSpectrum, RaySet, RaySetLight};
use abbe_spectra::error::{Error, Result};
use abbe_spectra::spectrum::{Outside, SpectralLine, Spectrum};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::sync::Arc;

impl Resolver<'_> {
    /// Resolves a ray file to a light for each of its spectra.
    pub(super) fn ray_lights(
        &self,
        path: &JsonPath,
        file: &RaysFile,
        context: &mut LightContext,
    ) -> Result<Vec<(Emitter, LightSpectrum)>> {
        let at_path = path.key("path");
        let read = self.source.file(&file.path).and_then(|path| ray_file::read(&path));
        let RayFile { unit, groups, notes } = self.at(&at_path, read)?;
        context.notes.extend(notes.iter().map(|note| format!("{}: {note}", file.path)));
        let explicit = file.spectrum.as_ref().map(|it| self.light_spectrum(path, it, context.notes)).transpose()?;
        let groups = if explicit.is_some() { joined(groups) } else { groups };
        let mut parts = Vec::new();
        for RayGroup { spectrum, rays } in groups {
            let spectrum = match &explicit {
                Some(spectrum) => Some((spectrum.clone(), 1.0)),
                None if spectrum == RaySpectrum::Unknown => {
                    let error =
                        Error::input("missing key \"spectrum\"").expected("a spectrum, which the ray file lacks");
                    return self.at(path, Err(error));
                }
                None => self.at(&at_path, spectrum_in_band(&spectrum))?,
            };
            let Some(((spectrum, in_band), rays)) = spectrum.zip(RaySet::new(rays)) else { continue };
            let power_w = match unit {
                FluxUnit::Watt => rays.flux() * in_band,
                FluxUnit::Lumen => self.at(path, spectrum.watts_from_lumens(rays.flux()))?,
            };
            parts.push((rays, spectrum, power_w));
        }
        let watts: f64 = parts.iter().map(|(_, _, power_w)| power_w).sum();
        if watts <= 0.0 {
            let error = Error::input("the rays of the file have no light").expected("light within 360–830 nm");
            return self.at(&at_path, Err(error));
        }
        let lumens = parts.iter().map(|(_, spectrum, power_w)| spectrum.lumens_from_watts(*power_w)).sum::<f64>();
        let factor = match self.at(path, file.quantity())? {
            None => 1.0,
            Some(QuantityFile::LuminousFlux(wanted)) if lumens > 0.0 => wanted / lumens,
            Some(quantity) => self.at(path, radiometric(quantity, &parts[0].1))?.value() / watts,
        };
        let (toward, to_world) = (DVec3::from(file.toward).normalize(), context.to_world.matrix3);
        let turn = to_world * DMat3::from_quat(DQuat::from_rotation_arc(DVec3::Z, toward));
        let place = DAffine3 { matrix3: turn, translation: self.point_of_light(context, file.at) };
        let light = |(rays, spectrum, power_w): (RaySet, LightSpectrum, f64)| {
            (Emitter::Rays(RaySetLight::new(Arc::new(rays), place, factor * power_w)), spectrum)
        };
        Ok(parts.into_iter().map(light).collect())
    }
}

/// Returns all rays as one group.
fn joined(groups: Vec<RayGroup>) -> Vec<RayGroup> {
    let rays = groups.into_iter().flat_map(|group| group.rays).collect();
    vec![RayGroup { spectrum: RaySpectrum::Unknown, rays }]
}

/// Returns the spectrum and the fraction of its power that lies within the band. `None` if that is
/// 0 or if the spectrum is unknown.
fn spectrum_in_band(spectrum: &RaySpectrum) -> Result<Option<(LightSpectrum, f64)>> {
    let (spectrum, power) = match spectrum {
        RaySpectrum::Unknown => return Ok(None),
        RaySpectrum::Line(nm) => (line(*nm)?, 1.0),
        RaySpectrum::Table(table) if table.len() == 1 => (line(table[0].0)?, 1.0),
        RaySpectrum::Table(table) => {
            let (nm, values): (Vec<f64>, Vec<f64>) = table.iter().copied().unzip();
            let trapezoid = |pair: &[(f64, f64)]| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1);
            (Some(Spectrum::table(&nm, &values, Outside::Zero)?), table.windows(2).map(trapezoid).sum())
        }
    };
    let in_band = spectrum.filter(|spectrum| spectrum.integral() > 0.0);
    Ok(in_band.map(|spectrum| (LightSpectrum::new(&spectrum), spectrum.integral() / power)))
}

/// Returns a line of 1 W, or `None` outside of the band.
fn line(nm: f64) -> Result<Option<Spectrum>> {
    let (from, to) = abbe_spectra::spectrum::BAND_NM;
    if !(from..=to).contains(&nm) {
        return Ok(None);
    }
    Spectrum::lines(&[SpectralLine { nm, power: 1.0, fwhm_nm: None }]).map(Some)
}
