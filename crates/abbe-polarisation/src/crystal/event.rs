//! What the surface of a crystal does to a ray: it leaves outside, or as one of the two waves
//! inside.

use super::surface::{CrystalSurface, SurfaceAmplitudes};
use super::wave::{CrystalMode, across};
use crate::jones::{Jones, JonesVector};
use crate::{Mueller, Stokes};
use abbe_spectra::math::complex::Complex;
use glam::DVec3;

/// A ray at the surface of a crystal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrystalRay {
    /// The direction of travel of the power, a unit vector.
    pub direction: DVec3,
    /// The wave inside the crystal, or `None` outside.
    pub mode: Option<CrystalMode>,
}

/// One way in which light goes on at a surface.
///
/// Light outside has a Stokes vector with x along [`CrystalEvents::s_axis`]. A wave inside has one
/// polarisation, so only its power S0 counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrystalEvent {
    /// The leaving light, or the camera path that goes on to the source of the light.
    pub ray: CrystalRay,
    /// The fraction of the power of natural light, or of a wave inside. For a camera path, it is
    /// the factor of the radiance divided by the squared index.
    pub power: f64,
    /// The Mueller matrix of the light, divided by `power`.
    pub matrix: Mueller,
}

/// The events of a ray: outside, as the ordinary wave, and as the extraordinary wave.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrystalEvents {
    /// The events that are possible.
    pub events: [Option<CrystalEvent>; 3],
    /// The axis s of the light outside: perpendicular to the plane of incidence.
    pub s_axis: DVec3,
}

/// The way of the light, along which a ray is traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrystalTracing {
    /// With the light.
    FromLight,
    /// Against the light.
    FromCamera,
}

impl CrystalSurface {
    /// Returns what happens to a ray that arrives at the surface: from outside with a direction of
    /// z < 0, or from inside with z > 0.
    pub fn events(&self, ray: CrystalRay, tracing: CrystalTracing) -> CrystalEvents {
        debug_assert!(ray.mode.is_some() == (ray.direction.z > 0.0), "the ray leads away from the surface");
        let k = self.wave_vector(ray);
        // The wave vector of the light.
        let k = if tracing == CrystalTracing::FromLight { k } else { -k };
        let tangential = DVec3::new(k.x, k.y, 0.0);
        let away = if tracing == CrystalTracing::FromLight { 1.0 } else { -1.0 };
        let outer_normal = self.outside * self.outside - tangential.length_squared();
        let outer = |sign: f64| {
            (outer_normal > 0.0)
                .then(|| DVec3::new(tangential.x, tangential.y, sign * outer_normal.sqrt()) / self.outside)
        };
        // Light leaves upwards outside, and downwards inside; it arrives the other way round.
        let outside_ray = outer(away).map(|travel| CrystalRay { direction: travel * away, mode: None });
        let inside_ray = |mode: CrystalMode| {
            let wave = self.wave(mode, tangential, away < 0.0)?;
            Some(CrystalRay { direction: wave.ray * away, mode: Some(mode) })
        };
        let from_outside = || outer(-1.0).map(|travel| self.from_outside(travel));
        let from_inside = || self.from_inside(tangential);
        let event = |ray: Option<CrystalRay>, found: Option<(f64, Mueller)>| {
            let (power, matrix) = found?;
            (power > 0.0).then_some(CrystalEvent { ray: ray?, power, matrix })
        };
        let each_mode = |find: &dyn Fn(CrystalMode) -> Option<(f64, Mueller)>| {
            [CrystalMode::Ordinary, CrystalMode::Extraordinary].map(|mode| event(inside_ray(mode), find(mode)))
        };
        let (outside, [ordinary, extraordinary]) = match (ray.mode, tracing) {
            (None, CrystalTracing::FromLight) => {
                let amplitudes = from_outside();
                let outside = event(outside_ray, amplitudes.map(|found| found.reflected()));
                (outside, each_mode(&|mode| amplitudes.map(|found| found.entering(mode))))
            }
            (None, CrystalTracing::FromCamera) => {
                let outside = event(outside_ray, from_outside().map(|found| found.reflected()));
                let amplitudes = from_inside();
                (outside, each_mode(&|mode| Some(amplitudes.leaving(mode))))
            }
            (Some(arriving), CrystalTracing::FromLight) => {
                let amplitudes = from_inside();
                let outside = event(outside_ray, Some(amplitudes.leaving(arriving)));
                (outside, each_mode(&|mode| Some(amplitudes.inner([arriving, mode]))))
            }
            (Some(leaving), CrystalTracing::FromCamera) => {
                let outside = event(outside_ray, from_outside().map(|found| found.entering(leaving)));
                let amplitudes = from_inside();
                (outside, each_mode(&|mode| Some(amplitudes.inner([mode, leaving]))))
            }
        };
        CrystalEvents { events: [outside, ordinary, extraordinary], s_axis: across(tangential) }
    }

    /// Returns the wave vector of a ray in units of ω/c.
    fn wave_vector(&self, CrystalRay { direction, mode }: CrystalRay) -> DVec3 {
        match mode {
            None => direction * self.outside,
            Some(CrystalMode::Ordinary) => direction * self.indices.ordinary,
            Some(CrystalMode::Extraordinary) => {
                // The ray is parallel to k⊥/n_e² + k∥/n_o², and k lies on the surface of indices.
                let along = direction.dot(self.axis) * self.axis;
                let (o, e) = (self.indices.ordinary, self.indices.extraordinary);
                let k = (direction - along) * (e * e) + along * (o * o);
                let length = ((direction - along).length_squared() * (e * e) + along.length_squared() * (o * o)).sqrt();
                k / length
            }
        }
    }
}

impl SurfaceAmplitudes {
    /// Returns the power and the matrix of reflection outside.
    fn reflected(&self) -> (f64, Mueller) {
        let [s, p] = self.outside;
        relative(Jones([[s[0], p[0]], [s[1], p[1]]]).mueller())
    }

    /// Returns the power and the matrix of the light that enters as a wave.
    fn entering(&self, mode: CrystalMode) -> (f64, Mueller) {
        let [s, p] = self.inside.map(|amplitudes| amplitudes[mode as usize]);
        let zero = Complex::new(0.0, 0.0);
        let Mueller([row, ..]) = Jones([[s, p], [zero, zero]]).mueller();
        let power: f64 = self.inside_power.iter().map(|powers| 0.5 * powers[mode as usize]).sum();
        let scale = if row[0] > 0.0 { row[0].recip() } else { 0.0 };
        (power, Mueller([row.map(|part| part * scale), [0.0; 4], [0.0; 4], [0.0; 4]]))
    }

    /// Returns the power and the matrix of a wave that leaves the crystal.
    fn leaving(&self, mode: CrystalMode) -> (f64, Mueller) {
        let Stokes(light) = JonesVector(self.outside[mode as usize]).stokes();
        let scale = if light[0] > 0.0 { light[0].recip() } else { 0.0 };
        let power = self.outside_power[mode as usize].iter().sum();
        (power, Mueller(light.map(|part| [part * scale, 0.0, 0.0, 0.0])))
    }

    /// Returns the power and the matrix of reflection inside, from the first wave to the second.
    fn inner(&self, [from, to]: [CrystalMode; 2]) -> (f64, Mueller) {
        (self.inside_power[from as usize][to as usize], Mueller::depolariser(1.0))
    }
}

/// Separates the power from a matrix.
fn relative(matrix: Mueller) -> (f64, Mueller) {
    let power = matrix.0[0][0];
    (power, if power > 0.0 { matrix * power.recip() } else { matrix })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crystal::UniaxialIndices;

    const MODES: [Option<CrystalMode>; 3] = [None, Some(CrystalMode::Ordinary), Some(CrystalMode::Extraordinary)];

    fn calcite(axis: DVec3) -> CrystalSurface {
        let indices = UniaxialIndices { ordinary: 1.6584, extraordinary: 1.4864 };
        CrystalSurface { indices, axis: axis.normalize(), outside: 1.0 }
    }

    /// Rays from outside and from inside, at angles from 5° to 80°.
    fn rays() -> impl Iterator<Item = CrystalRay> {
        let angles = [5.0, 25.0, 36.0, 50.0, 80.0_f64];
        let directions = angles.into_iter().flat_map(|angle| {
            let (sin, cos) = angle.to_radians().sin_cos();
            [0.3, 2.0, 4.5_f64].map(|turn| DVec3::new(sin * turn.cos(), sin * turn.sin(), cos))
        });
        directions.flat_map(|direction| {
            MODES.map(|mode| CrystalRay { direction: if mode.is_none() { -direction } else { direction }, mode })
        })
    }

    fn surfaces() -> [CrystalSurface; 3] {
        [DVec3::new(0.3, 0.5, 0.8), DVec3::new(0.0, 1.0, 0.0), DVec3::new(-0.7, 0.1, 0.2)].map(calcite)
    }

    #[test]
    fn the_powers_of_light_sum_to_one() {
        for surface in surfaces() {
            for ray in rays() {
                let found = surface.events(ray, CrystalTracing::FromLight);
                let sum: f64 = found.events.iter().flatten().map(|event| event.power).sum();
                assert!((sum - 1.0).abs() < 1e-9, "{ray:?}: {sum}");
            }
        }
    }

    /// A camera path goes back along the light, with the same power and polarisation.
    #[test]
    fn camera_paths_reverse_the_light() {
        let mut count = 0;
        for surface in surfaces() {
            for ray in rays() {
                for event in surface.events(ray, CrystalTracing::FromLight).events.into_iter().flatten() {
                    let back = CrystalRay { direction: -event.ray.direction, ..event.ray };
                    let found = surface.events(back, CrystalTracing::FromCamera);
                    let same = found.events[MODES.iter().position(|mode| *mode == ray.mode).unwrap()].unwrap();
                    assert!((same.ray.direction + ray.direction).length() < 1e-9, "{ray:?} {event:?} {same:?}");
                    assert!((same.power - event.power).abs() < 1e-9, "{ray:?} {event:?} {same:?}");
                    let (a, b) = (same.matrix.0.as_flattened(), event.matrix.0.as_flattened());
                    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{ray:?} {event:?} {same:?}");
                    count += 1;
                }
            }
        }
        assert!(count > 250, "{count}");
    }

    /// Light that enters and leaves a crystal keeps its reciprocity: natural light excites a wave
    /// with half the power with which that wave leaves on the reversed path.
    #[test]
    fn entering_and_leaving_are_reciprocal() {
        for surface in surfaces() {
            for ray in rays().filter(|ray| ray.mode.is_none()) {
                for event in surface.events(ray, CrystalTracing::FromLight).events.into_iter().flatten().skip(1) {
                    let back = CrystalRay { direction: -event.ray.direction, ..event.ray };
                    let leaving = surface.events(back, CrystalTracing::FromLight).events[0].unwrap();
                    assert!((leaving.ray.direction + ray.direction).length() < 1e-9);
                    assert!((leaving.power - 2.0 * event.power).abs() < 1e-9, "{leaving:?} {event:?}");
                }
            }
        }
    }

    /// Without birefringence, both waves together are refracted light of Fresnel's equations.
    #[test]
    fn an_isotropic_crystal_is_glass() {
        let indices = UniaxialIndices { ordinary: 1.5, extraordinary: 1.5 };
        let glass = CrystalSurface { indices, axis: DVec3::new(0.36, 0.48, 0.8), outside: 1.0 };
        for ray in rays().filter(|ray| ray.mode.is_none()) {
            let found = glass.events(ray, CrystalTracing::FromLight);
            let reflected = abbe_optics::fresnel::dielectric(-ray.direction.z, 1.0, 1.5);
            assert!((found.events[0].unwrap().power - reflected).abs() < 1e-12);
            let [o, e] = [1, 2].map(|i| found.events[i].unwrap());
            assert!((o.power + e.power - (1.0 - reflected)).abs() < 1e-12);
            assert!((o.ray.direction - e.ray.direction).length() < 1e-12);
        }
    }
}
