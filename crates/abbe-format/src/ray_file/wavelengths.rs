//! Groups of rays by their wavelengths.

use super::{RayGroup, RaySpectrum};
use abbe_scene::light::EmittedRay;

/// Rays with their own wavelengths form this many groups of equal flux, unless they have no more
/// different wavelengths.
const GROUPS: usize = 8;

/// The width in nm of the steps of a group's spectrum.
const STEP_NM: f64 = 2.0;

/// Divides rays with their wavelengths in nm into groups. A photon of a group has a wavelength of
/// its group, but not necessarily that of its ray.
pub(super) fn groups(mut rays: Vec<(f64, EmittedRay)>) -> Vec<RayGroup> {
    rays.sort_by(|a, b| a.0.total_cmp(&b.0));
    let lines: Vec<&[(f64, EmittedRay)]> = rays.chunk_by(|a, b| a.0 == b.0).collect();
    if lines.len() <= GROUPS {
        let group = |line: &&[(f64, EmittedRay)]| RayGroup {
            spectrum: RaySpectrum::Line(line[0].0),
            rays: line.iter().map(|(_, ray)| *ray).collect(),
        };
        return lines.iter().map(group).collect();
    }
    let flux: f64 = rays.iter().map(|(_, ray)| f64::from(ray.flux)).sum();
    let mut before = 0.0;
    let mut groups = vec![Vec::new(); GROUPS];
    for (nm, ray) in rays {
        let group = (before / flux * GROUPS as f64) as usize;
        groups[group.min(GROUPS - 1)].push((nm, ray));
        before += f64::from(ray.flux);
    }
    groups.retain(|group| !group.is_empty());
    let group = |rays: Vec<(f64, EmittedRay)>| RayGroup {
        spectrum: histogram(&rays),
        rays: rays.into_iter().map(|(_, ray)| ray).collect(),
    };
    groups.into_iter().map(group).collect()
}

/// Returns the spectrum of rays whose wavelengths ascend. Each ray adds its flux to the two nearest
/// steps, so that the mean wavelength stays.
fn histogram(rays: &[(f64, EmittedRay)]) -> RaySpectrum {
    let (first, last) = (rays[0].0, rays[rays.len() - 1].0);
    if first == last {
        return RaySpectrum::Line(first);
    }
    let from = (first / STEP_NM).floor() * STEP_NM;
    let steps = ((last - from) / STEP_NM).ceil() as usize + 1;
    let mut flux = vec![0.0; steps + 1];
    for (nm, ray) in rays {
        let place = (nm - from) / STEP_NM;
        let (step, part) = (place as usize, place.fract());
        flux[step] += (1.0 - part) * f64::from(ray.flux);
        flux[step + 1] += part * f64::from(ray.flux);
    }
    // The table is zero outside, so that the flux of its ends is whole.
    let nm = |step: usize| from + (step as f64 - 1.0) * STEP_NM;
    let values = [0.0].into_iter().chain(flux).chain([0.0]);
    RaySpectrum::Table(values.enumerate().map(|(step, value)| (nm(step), value)).collect())
}
