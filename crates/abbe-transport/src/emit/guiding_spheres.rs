//! Scattering towards distant guiding spheres.
//!
//! In a large world, most photons arrive far from the spheres of [`EmissionStrata`], and a surface
//! scatters few of them there, so that rare, heavy photons carry the light. Therefore a small
//! fraction of the photons is scattered towards a sphere on purpose. The directions of the BSDF and
//! to the spheres form a mixture, by whose density a photon is weighted (one-sample multiple
//! importance sampling: Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation",
//! section 9.2.4).
//!
//! [`EmissionStrata`]: super::EmissionStrata

use super::photon_path::PhotonPath;
use crate::walk::ledger::Ledger;
use crate::walk::{BodyMode, ScatteredRay, SurfaceInteraction};
use abbe_optics::bsdf::{BsdfClass, ScatterEvent, TransportMode};
use abbe_spectra::math::random::Stream;
use abbe_spectra::math::sphere::BoundingSphere;
use abbe_spectra::spectrum::LANES;
use glam::DVec3;

/// The fraction of the photons that a surface scatters towards spheres.
const GUIDED_FRACTION: f64 = 0.1;

/// A sphere is distant if its distance is at least this multiple of its radius.
const LEAST_DISTANCE: f64 = 2.0;

/// Scatters a photon at a surface, a fraction of the photons towards a distant sphere. Returns
/// `None` if the surface absorbs the photon.
#[inline(never)]
pub(super) fn scatter_with_guiding<M: BodyMode>(
    spheres: &[BoundingSphere],
    path: &mut PhotonPath,
    interaction: &SurfaceInteraction<'_>,
    stream: &mut Stream,
    ledger: &mut Ledger,
) -> Option<ScatteredRay> {
    let distant = DistantSpheres::new(spheres, interaction);
    if distant.count == 0 {
        return M::scatter(interaction, &path.photon.wavelengths, TransportMode::Importance, stream);
    }
    let before = path.total_w();
    let scattered = if stream.uniform() < GUIDED_FRACTION {
        distant.scatter(path, interaction, stream)
    } else {
        distant.scatter_by_bsdf::<M>(path, interaction, stream)
    };
    ledger.sampling += path.total_w() - before;
    scattered
}

struct DistantSpheres<'a> {
    spheres: &'a [BoundingSphere],
    position: DVec3,
    count: usize,
}

impl<'a> DistantSpheres<'a> {
    /// Finds the distant spheres of a point on an opaque surface without shading normals.
    fn new(spheres: &'a [BoundingSphere], interaction: &SurfaceInteraction<'_>) -> Self {
        let position = interaction.hit.position;
        let model = interaction.bsdf.model;
        let scatters = model.class() != BsdfClass::Specular && !model.is_transmissive();
        let is_flat = interaction.hit.shading_normal == interaction.hit.normal;
        let mut found = Self { spheres, position, count: 0 };
        if scatters && is_flat {
            found.count = found.all().count();
        }
        found
    }

    fn all(&self) -> impl Iterator<Item = &BoundingSphere> {
        self.spheres.iter().filter(|sphere| sphere.centre.distance(self.position) >= LEAST_DISTANCE * sphere.radius_m)
    }

    /// Returns the density of the sampled directions, per steradian.
    fn pdf(&self, direction: DVec3) -> f64 {
        self.all().map(|sphere| sphere.pdf_direction(self.position, direction)).sum::<f64>() / self.count as f64
    }

    /// Returns the density of the mixture, per steradian. `pdf_bsdf` is the density of the BSDF.
    fn mixture_pdf(&self, pdf_bsdf: f64, direction: DVec3) -> f64 {
        (1.0 - GUIDED_FRACTION) * pdf_bsdf + GUIDED_FRACTION * self.pdf(direction)
    }

    /// Scatters the photon towards a sphere, or returns `None` if the surface scatters no light
    /// there. The photon's power becomes the power after the event, and the weights are 1, because
    /// roulette must not end a photon for its small weight.
    fn scatter(
        &self,
        path: &mut PhotonPath,
        interaction: &SurfaceInteraction<'_>,
        stream: &mut Stream,
    ) -> Option<ScatteredRay> {
        let number = ((stream.uniform() * self.count as f64) as usize).min(self.count - 1);
        let sphere = self.all().nth(number)?;
        let (direction, _) = sphere.sample_direction(self.position, stream.pair());
        let (bsdf, wo, sides) = (interaction.bsdf, interaction.wo, interaction.sides);
        let wi = interaction.frame.to_local(direction);
        let reflects = interaction.is_consistent(direction, ScatterEvent::Reflection);
        let pdf = self.mixture_pdf(bsdf.pdf(wo, wi, sides, path.photon.wavelengths.hero()), direction);
        for k in 0..path.photon.wavelengths.count {
            let f = || bsdf.eval(wo, wi, sides, TransportMode::Importance, path.photon.wavelengths.nm[k]);
            path.photon.power[k] *= if reflects { f() * wi.z.abs() / pdf } else { 0.0 };
        }
        (path.total_w() > 0.0).then_some(ScatteredRay {
            direction,
            weight: [1.0; LANES],
            absorbed: [0.0; LANES],
            kept: None,
            delta: false,
            pdf,
            event: ScatterEvent::Reflection,
            wave: None,
        })
    }

    /// Scatters the photon by the BSDF. Its power becomes that which the mixture requires.
    fn scatter_by_bsdf<M: BodyMode>(
        &self,
        path: &mut PhotonPath,
        interaction: &SurfaceInteraction<'_>,
        stream: &mut Stream,
    ) -> Option<ScatteredRay> {
        path.divide_power(1.0 - GUIDED_FRACTION);
        let scattered = M::scatter(interaction, &path.photon.wavelengths, TransportMode::Importance, stream)?;
        if scattered.delta {
            return Some(scattered);
        }
        let pdf = self.mixture_pdf(scattered.pdf, scattered.direction);
        let weight = (1.0 - GUIDED_FRACTION) * scattered.pdf / pdf;
        path.multiply_power(weight);
        // The absorbed power does not depend on the direction.
        Some(ScatteredRay { absorbed: scattered.absorbed.map(|absorbed| absorbed / weight), pdf, ..scattered })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::launch::RibbonPart;
    use crate::emit::photon_path::{PhotonDepth, PhotonState};
    use crate::map::WavelengthCode;
    use crate::plan::partition::LightPath;
    use crate::walk::{PhotonPolarisation, RayDensity, RayState, SurfaceLookup, WithoutBodies};
    use abbe_format as format;
    use abbe_format::resolve::resolve;
    use abbe_scene::geometry::Ray;
    use abbe_scene::medium_stack::MediumStack;
    use abbe_spectra::math::random::{Purpose, Seed};
    use abbe_spectra::spectrum::Wavelengths;

    /// A sphere of radius r at the distance d from a Lambertian surface, at the angle θ from the
    /// normal, receives the fraction (r/d)² cos θ of the scattered light and the rest goes
    /// elsewhere, with a balanced ledger. The light arrives at the front or at the back.
    #[test]
    fn guiding_keeps_the_scattered_light() {
        const ALBEDO: f64 = 0.8;
        let text = r#"{
  "camera": {"from": [0, 5, 0], "at": [0, 0, 0], "up": [0, 0, 1], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "materials": {"white": {"diffuse": {"reflectance": 0.8}}},
  "objects": [{"shape": {"rectangle": {"width": 2, "height": 2}}, "material": "white"}],
  "lights": [{"point": {"at": [3, 3, 3], "spectrum": "E", "power": 1}}]
}"#;
        let (written, source) = format::parse(text, "white.json".as_ref(), &[]).unwrap();
        let scene = resolve(&written, &source).unwrap();
        let photon = PhotonState {
            light_path: LightPath::Direct,
            depth: PhotonDepth::Unlimited,
            wavelengths: Wavelengths::new([450.0, 500.0, 550.0, 600.0]),
            power: [0.25; LANES],
            wavelength_code: WavelengthCode::default(),
            lane: None,
            ribbon: RibbonPart::Missed,
            excitation: false,
            polarisation: PhotonPolarisation::NATURAL,
            ray_density: RayDensity::NONE,
        };
        for side in [1.0, -1.0] {
            let ray = Ray::new(DVec3::new(0.1, side, 0.2), -side * DVec3::Y);
            let start = RayState { ray, from: None, medium_stack: MediumStack::AIR };
            let interaction = WithoutBodies::next_interaction(&scene, start, SurfaceLookup::of_line(0.0)).unwrap();
            let sphere = |x: f64, y: f64, distance: f64| BoundingSphere {
                centre: interaction.hit.position + distance * DVec3::new(x, side * y, 0.0),
                radius_m: 1.0,
            };
            let spheres = [sphere(0.75_f64.sqrt(), 0.5, 10.0), sphere(-0.6, 0.8, 2.5)];
            let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
            let (mut on_spheres, mut elsewhere, count) = ([0.0; 2], 0.0, 100_000);
            for _ in 0..count {
                let mut path = PhotonPath { ray_state: start, photon, polarised: false, watts: [1.0; LANES] };
                let mut ledger = Ledger::new(scene.materials.len());
                let scattered =
                    scatter_with_guiding::<WithoutBodies>(&spheres, &mut path, &interaction, &mut stream, &mut ledger);
                assert!((path.total_w() - ledger.sampling - 1.0).abs() < 1e-12);
                let Some(scattered) = scattered else { continue };
                let power = path.total_w() * scattered.weight[0] / f64::from(count);
                let hit = spheres
                    .iter()
                    .position(|sphere| sphere.contains_part_of(interaction.hit.position, scattered.direction));
                *hit.map_or(&mut elsewhere, |hit| &mut on_spheres[hit]) += power;
            }
            let known = [0.01 * 0.5, 0.16 * 0.8].map(|fraction| fraction * ALBEDO);
            for (found, known) in on_spheres.iter().zip(known) {
                assert!((found / known - 1.0).abs() < 0.03, "{found} for {known}");
            }
            let rest = ALBEDO - known[0] - known[1];
            assert!((elsewhere / rest - 1.0).abs() < 0.005, "{elsewhere} for {rest}");
        }
    }
}
