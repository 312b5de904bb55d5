//! The light that the surfaces of a lens reflect: losses along the image path, and ghosts.
//!
//! A ghost is light that is reflected at two surfaces. Ghosts of four or more reflections, weaker
//! by the square of a reflectance, are not traced. The reflectances are those of unpolarised light.

use super::prescription::Lens;
use super::profile::TraceDirection;
use super::trace::{ApertureCheck, LensRay, MonochromaticLens, RayLoss};
use crate::fresnel;
use crate::glass::lines;

/// In nm, for the mean reflectances of surfaces that choose ghosts.
const PROBES_NM: [f64; 5] = [420.0, 480.0, lines::D_NM, 650.0, 740.0];

/// The fraction of ghosts that are chosen with equal probabilities; the others are chosen in
/// proportion to the product of both reflectances.
const EQUAL_FRACTION: f64 = 0.1;

/// A pair of surfaces that reflect, and the probability with which it is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GhostPair {
    /// The indices of the surface nearer to the scene, and of that nearer to the sensor.
    pub surfaces: [usize; 2],
    /// The probability of this pair.
    pub probability: f64,
}

impl Lens {
    /// Returns all pairs of surfaces that reflect light, with probabilities that sum to 1 and grow
    /// with the reflectances at normal incidence.
    pub fn ghost_pairs(&self) -> Vec<GhostPair> {
        let at = PROBES_NM.map(|nm| self.at(nm));
        let count = self.surfaces().len();
        let reflectance = |i| at.iter().map(move |lens| lens.surface_powers(i, 1.0, TraceDirection::ToSensor)[0]);
        let reflectance: Vec<f64> = (0..count).map(|i| reflectance(i).sum::<f64>() / at.len() as f64).collect();
        let pairs = (0..count).flat_map(|j| (j + 1..count).map(move |k| [j, k]));
        let weight = |&[j, k]: &[usize; 2]| reflectance[j] * reflectance[k];
        let pairs: Vec<[usize; 2]> = pairs.filter(|pair| weight(pair) > 0.0).collect();
        let sum: f64 = pairs.iter().map(weight).sum();
        let equal = EQUAL_FRACTION / pairs.len() as f64;
        let probability = |pair| equal + (1.0 - EQUAL_FRACTION) * weight(pair) / sum;
        pairs.iter().map(|pair| GhostPair { surfaces: *pair, probability: probability(pair) }).collect()
    }
}

impl MonochromaticLens<'_> {
    /// Returns the reflectance and the transmittance of surface `i` for unpolarised light that
    /// travels in the direction `travel`, at a cosine of incidence.
    pub fn surface_powers(&self, i: usize, cos: f64, travel: TraceDirection) -> [f64; 2] {
        let (front, behind) = (self.index_before(i), self.index_before(i + 1));
        let Some(films) = &self.lens().surfaces()[i].coating else {
            let (n_i, n_t) = travel.order(front, behind);
            let reflected = fresnel::dielectric(cos, n_i, n_t);
            return [reflected, 1.0 - reflected];
        };
        let nm = self.wavelength_nm();
        let response = match travel {
            TraceDirection::ToSensor => films.response(cos, front, behind.into(), nm, 0.0),
            TraceDirection::ToScene => films.response_reversed(cos, behind, front.into(), nm, 0.0),
        };
        [response.reflectance(), response.transmittance()]
    }

    /// Returns the transmittance of all surfaces for light along the axis.
    pub fn axial_transmittance(&self) -> f64 {
        let surfaces = 0..self.lens().surfaces().len();
        surfaces.map(|i| self.surface_powers(i, 1.0, TraceDirection::ToSensor)[1]).product()
    }

    /// Traces a ray from the sensor to the scene, with enforced apertures, and for a `ghost` with a
    /// reflection at the surface nearer to the scene and then at the other one.
    ///
    /// Returns the ray as [`Self::trace`] does, and the product of all transmittances and
    /// reflectances, or the reason and the index of the surface if the ray is lost.
    pub fn trace_with_losses(&self, mut ray: LensRay, ghost: Option<[usize; 2]>) -> Result<(LensRay, f64), RayLoss> {
        let (mut i, mut travel) = (self.lens().surfaces().len() - 1, TraceDirection::ToScene);
        let mut reflections = ghost.into_iter().flatten();
        let mut turn = reflections.next();
        let mut weight = 1.0;
        loop {
            let (point, normal) = self.meet(&ray, i, travel, ApertureCheck::Enforced)?;
            // A reflected ray may be so steep that it reaches the next surface only backwards.
            if ghost.is_some() && (point - ray.origin).dot(ray.direction) < -1e-9 {
                return Err(RayLoss::Missed(i));
            }
            let cos = ray.direction.dot(normal);
            let [reflected, transmitted] = self.surface_powers(i, cos, travel);
            if turn == Some(i) {
                weight *= reflected;
                ray = LensRay { origin: point, direction: ray.direction - 2.0 * cos * normal };
                (travel, turn) = (travel.reversed(), reflections.next());
            } else {
                weight *= transmitted;
                let (n_i, n_t) = travel.order(self.index_before(i), self.index_before(i + 1));
                let refracted = fresnel::refract(-ray.direction, normal, n_i, n_t);
                ray = LensRay { origin: point, direction: refracted.ok_or(RayLoss::Reflected(i))? };
            }
            match travel {
                TraceDirection::ToSensor => i += 1,
                TraceDirection::ToScene if i == 0 => return Ok((ray, weight)),
                TraceDirection::ToScene => i -= 1,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glass::RefractiveIndex;
    use crate::lens::{ApertureSpec, LensSurface, Prescription, SurfaceProfile, catalogue};
    use crate::texture::SurfaceScalar;
    use crate::thin_film::{FilmLayer, FilmStack, OpticalIndex};
    use glam::DVec3;

    fn lens(surfaces: &[(f64, f64, f64)], films: Option<&[(f64, f64)]>) -> Lens {
        let index = |n| RefractiveIndex::constant(n).unwrap();
        let layer = |&(n, nm): &(f64, f64)| FilmLayer {
            index: OpticalIndex::Transparent(index(n)),
            thickness_nm: SurfaceScalar::Uniform(nm),
        };
        let stack = films.map(|films| FilmStack::new(films.iter().map(layer).collect()).unwrap());
        let surface = |(i, &(radius_mm, thickness_mm, n)): (usize, &(f64, f64, f64))| LensSurface {
            profile: SurfaceProfile::sphere(radius_mm),
            thickness_mm,
            index: index(n),
            semi_aperture_mm: 5.0,
            obscuration_mm: 0.0,
            // The glass lies behind even surfaces, and in front of odd ones.
            coating: if i % 2 == 0 { stack.clone() } else { stack.clone().map(FilmStack::reversed) },
        };
        Lens::new(Prescription {
            name: "test".to_string(),
            source: None,
            surfaces: surfaces.iter().enumerate().map(surface).collect(),
            stop: Some(0),
            opening: ApertureSpec::Stop,
            half_field_deg: None,
            notes: Vec::new(),
        })
        .unwrap()
    }

    /// Returns the reflectance of a layer on glass at normal incidence (Born & Wolf, §1.6.4).
    fn layer_reflectance((n1, thickness_nm): (f64, f64), n2: f64, nm: f64) -> f64 {
        let (r12, r23) = ((1.0 - n1) / (1.0 + n1), (n1 - n2) / (n1 + n2));
        let cos = (2.0 * std::f64::consts::TAU * n1 * thickness_nm / nm).cos();
        (r12 * r12 + r23 * r23 + 2.0 * r12 * r23 * cos) / (1.0 + r12 * r12 * r23 * r23 + 2.0 * r12 * r23 * cos)
    }

    /// On the axis of a plate, the image has the weight T², and the ghost has the weight R²·T².
    #[test]
    fn the_ghost_of_a_plate_is_a_closed_form() {
        let n = 1.7;
        let films = [(1.38, 99.6)];
        let ray = LensRay { origin: DVec3::new(0.3, 0.2, 50.0), direction: DVec3::NEG_Z };
        for nm in [450.0, 550.0, 650.0] {
            let bare = ((n - 1.0) / (n + 1.0)) * ((n - 1.0) / (n + 1.0));
            for (films, r) in [(None, bare), (Some(&films[..]), layer_reflectance(films[0], n, nm))] {
                let plate = lens(&[(0.0, 4.0, n), (0.0, 0.0, 1.0)], films);
                let at = plate.at(nm);
                let (direct, ghost) = (at.trace_with_losses(ray, None), at.trace_with_losses(ray, Some([0, 1])));
                let t2 = (1.0 - r) * (1.0 - r);
                assert!((direct.unwrap().1 / t2 - 1.0).abs() < 1e-12);
                assert!((at.axial_transmittance() / t2 - 1.0).abs() < 1e-12);
                let (out, weight) = ghost.unwrap();
                assert!((weight / (r * r * t2) - 1.0).abs() < 1e-10, "{nm} nm: {weight}");
                assert_eq!(out.direction, DVec3::NEG_Z);
            }
        }
    }

    /// In a thick lens, a ghost ray near the axis is refracted, reflected at the front and at the
    /// back, and refracted, as in the paraxial system.
    #[test]
    fn ghost_rays_near_the_axis_are_paraxial() {
        let (n, c1, c2, thickness) = (1.6, 1.0 / 60.0, -1.0 / 45.0, 7.0);
        let thick = lens(&[(1.0 / c1, thickness, n), (1.0 / c2, 0.0, 1.0)], None);
        // The height and the slope dy/ds along the path of the ray, which starts towards −z. The
        // power of each step follows from Gauss's equations on unfolded surfaces.
        let (mut y, mut u) = (1e-4, 2e-5);
        let start = LensRay { origin: DVec3::new(0.0, y, thickness), direction: DVec3::new(0.0, u, -1.0).normalize() };
        // Refraction at the back: light travels towards −z, so the curvature changes its sign.
        u = (u - (n - 1.0) * y * -c2) / n;
        y += thickness * u;
        // Reflection inside the front surface, which is concave to the glass.
        u -= 2.0 * c1 * y;
        y += thickness * u;
        // Reflection inside the back surface.
        u -= 2.0 * -c2 * y;
        y += thickness * u;
        // Refraction at the front.
        u = n * u - (1.0 - n) * y * -c1;
        let (out, _) = thick.at(500.0).trace_with_losses(start, Some([0, 1])).unwrap();
        assert!((out.origin.y - y).abs() < 1e-8, "{} {y}", out.origin.y);
        assert!((-out.direction.y / out.direction.z - u).abs() < 1e-8, "{} {u}", out.direction);
    }

    #[test]
    fn the_image_path_with_losses_is_the_path_without_losses() {
        for lens in catalogue::all() {
            let at = lens.at(520.0);
            let origin = DVec3::new(2.0, 1.0, lens.length_mm() + 40.0);
            let ray = LensRay { origin, direction: DVec3::new(-0.03, 0.0, -1.0).normalize() };
            let plain = at.trace(ray, TraceDirection::ToScene, ApertureCheck::Enforced);
            let lossy = at.trace_with_losses(ray, None);
            assert_eq!(plain, lossy.map(|(ray, _)| ray));
            let pairs = lens.ghost_pairs();
            let sum: f64 = pairs.iter().map(|pair| pair.probability).sum();
            assert!((sum - 1.0).abs() < 1e-12 && pairs.iter().all(|pair| pair.surfaces[0] < pair.surfaces[1]));
        }
    }
}
