//! The first surfaces on camera rays, for the layers of a picture.

use crate::gather::PixelSampler;
use crate::sensor::first_surface::{ALBEDO_NM, FirstSurface, Sight};
use crate::walk::{SurfaceInteraction, SurfaceLookup, next_interaction};
use abbe_scene::Scene;
use abbe_spectra::spectrum::REFERENCE_NM;
use glam::DVec3;

/// Finds the first surface on the camera ray of a sample: the ray of the camera path with the same
/// random numbers or, for a lens system, that at the reference wavelength.
pub(super) fn first_surface(scene: &Scene, pixel: u64, mut sampler: PixelSampler) -> Option<FirstSurface> {
    let (ray_state, _) = sampler.ray_at(scene, pixel, REFERENCE_NM)?;
    let lookup = SurfaceLookup::of_camera(&scene.camera, 0.0, sampler.stream.uniform());
    let interaction = next_interaction(scene, ray_state, lookup)?;
    Some(FirstSurface {
        albedo: albedo(&interaction, sampler.stream.triple()),
        normal: facing_normal(&interaction).to_array(),
        depth_m: interaction.distance_m,
        sight: sight(scene, &interaction),
        uv: scene.geometry.uv(&interaction.hit),
        object: interaction.hit.object as usize,
        material: interaction.material,
    })
}

/// Returns the unit normal on the visible side.
fn facing_normal(interaction: &SurfaceInteraction<'_>) -> DVec3 {
    let normal = interaction.frame.normal();
    if interaction.leads_back(normal) { normal } else { -normal }
}

/// The largest number of reflections and refractions up to the end of a sight. A brilliant reflects
/// most of its light two to six times.
const LONGEST_SIGHT: usize = 12;

/// Follows the camera ray from its first surface through clear glass and mirrors, always in the
/// more likely of both directions.
fn sight(scene: &Scene, first: &SurfaceInteraction<'_>) -> Sight {
    const LIKELY: f64 = 0.5;
    let lookup = SurfaceLookup::of_line(LIKELY);
    let (mut at, mut depth_m) = (*first, first.distance_m);
    for nth in 0..LONGEST_SIGHT {
        let sample = at.bsdf.sample(at.wo, at.sides, REFERENCE_NM, [LIKELY; 3]).filter(|sample| sample.delta);
        let Some(sample) = sample else {
            let normal = facing_normal(&at);
            let seen = if nth > 0 { at.incoming - normal } else { normal };
            return Sight { normal: seen.to_array(), depth_m };
        };
        let direction = at.frame.to_world(sample.wi);
        let ray_state = at.spawn_ray(direction, at.medium_stack_after(sample.event));
        let Some(next) = next_interaction(scene, ray_state, lookup) else {
            return Sight { normal: direction.to_array(), depth_m };
        };
        (at, depth_m) = (next, depth_m + next.distance_m);
    }
    Sight { normal: at.incoming.to_array(), depth_m }
}

/// Returns the fraction of light that a surface reflects or transmits, at the wavelengths of the
/// albedo. At rough metals, only its mean over `u` is the albedo.
fn albedo(interaction: &SurfaceInteraction<'_>, u: [f64; 3]) -> [f64; ALBEDO_NM.len()] {
    let SurfaceInteraction { bsdf, wo, sides, .. } = *interaction;
    match bsdf.sample(wo, sides, REFERENCE_NM, u) {
        Some(sample) => ALBEDO_NM.map(|nm| 1.0 - bsdf.absorbed_fraction(wo, &sample, sides, nm)),
        None => [0.0; ALBEDO_NM.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::RayState;
    use abbe_format::{self as format, resolve::resolve};
    use abbe_scene::geometry::Ray;
    use abbe_scene::medium_stack::MediumStack;

    /// A mirror that looks up at 45°, a block of glass and a ceiling above it, and a wall in front.
    const SCENE: &str = r#"{
  "camera": {"from": [0, 0, 9], "at": [0, 0, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 8, "height": 8},
  "materials": {"silver": {"mirror": {"reflectance": 0.9}}, "glass": {"dielectric": {"ior": 1.5}}, "grey": {"diffuse": {"reflectance": 0.5}}},
  "objects": [
    {"shape": {"rectangle": {"width": 2, "height": 1}}, "material": "silver",
     "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 45}}]},
    {"shape": {"box": {"size": [2, 1, 2]}}, "material": "glass", "transform": [{"translate": [0, 2.5, 0]}]},
    {"shape": {"rectangle": {"width": 2, "height": 2}}, "material": "grey", "transform": [{"translate": [0, 4, 0]}]},
    {"shape": {"rectangle": {"width": 2, "height": 0.4}}, "material": "grey",
     "transform": [{"rotate": {"axis": [1, 0, 0], "degrees": 90}}, {"translate": [0, -0.6, 0.5]}]}
  ],
  "lights": [{"point": {"at": [3, 3, 3], "spectrum": "E", "power": 1}}]
}"#;

    /// Returns what a ray shows that starts at (0.1, y, 3) and runs along −z.
    fn seen(y: f64) -> Sight {
        let (written, source) = format::parse(SCENE, "sight.json".as_ref(), &[]).unwrap();
        let scene = resolve(&written, &source).unwrap();
        let ray = Ray::new(DVec3::new(0.1, y, 3.0) - scene.centre, -DVec3::Z);
        let ray_state = RayState { ray, from: None, medium_stack: MediumStack::AIR };
        sight(&scene, &next_interaction(&scene, ray_state, SurfaceLookup::of_line(0.0)).unwrap())
    }

    #[track_caller]
    fn assert_sight(y: f64, normal: [f64; 3], depth_m: f64) {
        let found = seen(y);
        assert!((DVec3::from(found.normal) - DVec3::from(normal)).length() < 1e-9, "{found:?}");
        assert!((found.depth_m - depth_m).abs() < 1e-6, "{found:?}");
    }

    /// The mirror deflects the ray upwards, through the block of glass, to the ceiling.
    #[test]
    fn a_sight_follows_mirrors_and_glass_to_what_they_show() {
        assert_sight(0.2, [0.0, 2.0, 0.0], 3.2 + 3.8);
    }

    /// Through the front face of the block and out of its back face, the ray sees nothing.
    #[test]
    fn a_sight_that_leaves_the_scene_has_the_direction_of_its_ray() {
        assert_sight(2.5, [0.0, 0.0, -1.0], 4.0);
    }

    #[test]
    fn a_sight_of_a_wall_has_its_normal_and_distance() {
        assert_sight(-0.6, [0.0, 0.0, 1.0], 2.5);
    }
}
