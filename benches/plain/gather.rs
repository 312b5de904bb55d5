//! Gathering of camera samples, by the renderer and by hand.

use super::scenes::{Prepared, Total, camera_pass};
use abbe_optics::bsdf::{BsdfClass, InterfaceIors, TransportMode};
use abbe_scene::geometry::Ray;
use abbe_scene::light::{EmittedSpd, Light};
use abbe_spectra::math::random::{Purpose, Seed};
use abbe_spectra::spectrum::{LANES, REFERENCE_NM};
use abbe_transport::gather::{
    NORMAL_TOLERANCE, PLANE_TOLERANCE, PathBuffers, PixelSampler, SurfaceExtents, power_heuristic,
};
use abbe_transport::map::kernel::DiskKernel;
use abbe_transport::map::radius::least;
use abbe_transport::map::{LightMaps, PixelRadii, SetMaps};
use abbe_transport::plan::{LightOrigin, PathClass, Tally};
use abbe_transport::walk::Sink;
use glam::DVec3;

/// The kernel radius; kernels contain about 50 photons.
const RADIUS_M: f32 = 0.2;

/// The origin of all contributions. The sum of all light does not depend on it.
const ORIGIN: LightOrigin = LightOrigin { class: PathClass::Direct, light: 0 };

/// Gathers as the renderer does.
pub(crate) fn general(prepared: &Prepared, maps: &SetMaps, count: u64) -> f64 {
    let (surface_extents, light_maps) = (SurfaceExtents::default(), LightMaps::default());
    let camera_pass = camera_pass(prepared, (maps, &surface_extents, &light_maps));
    let (mut buffers, mut tally, mut total) = (PathBuffers::default(), Tally::default(), Total(0.0));
    for pixel in pixels(prepared, count) {
        let sampler = PixelSampler::new(Seed::new(1).streams(Purpose::Camera), 0, pixel);
        camera_pass.sample(pixel, sampler, &PixelRadii::splat(RADIUS_M), &mut buffers, &mut tally, &mut total);
    }
    total.0
}

/// Returns pixels from all parts of the image.
fn pixels(prepared: &Prepared, count: u64) -> impl Iterator<Item = u64> {
    let all = prepared.scene.camera.pixel_count() as u64;
    (0..count).map(move |number| number * 7919 % all)
}

/// Gathers by hand: a pinhole camera, one area light, opaque walls that scatter or absorb, clear
/// air, and indirect photons.
pub(crate) fn plain(prepared: &Prepared, maps: &SetMaps, count: u64) -> f64 {
    let (scene, mut total) = (&prepared.scene, Total(0.0));
    let (world, light) = (scene.extent(), &scene.lights[0]);
    let sides = InterfaceIors { here: &scene.air, there: &scene.air };
    for pixel in pixels(prepared, count) {
        let mut sampler = PixelSampler::new(Seed::new(1).streams(Purpose::Camera), 0, pixel);
        let ray = sampler.ray(&scene.camera, pixel);
        sampler.stream.uniform();
        let Some(hit) = scene.geometry.intersect(&ray, None, f64::INFINITY) else { continue };
        let object = &scene.objects[hit.object as usize];
        if object.light.is_some() {
            let radiance = light.le_surface(scene.extent(), ray.direction, &hit).0;
            each_wavelength(light, sampler.wavelength, |nm, share| {
                total.biased(ORIGIN, nm, share * light.spd_at(EmittedSpd::Own, nm) * radiance, 0.0);
            });
        }
        let surface = scene.materials[object.material].surface.at(0.0);
        if surface.class() != BsdfClass::Diffuse {
            continue;
        }
        let frame = hit.frame();
        let (wo, place) = (frame.to_local(-ray.direction), hit.position);

        // Direct light by a shadow ray and by a scattered ray, with multiple importance sampling.
        if let Some(incident) = light.sample_li(world, place, sampler.light()) {
            let wi = frame.to_local(incident.direction);
            let pdf = surface.pdf(wo, wi, sides, REFERENCE_NM);
            let share = incident.pdf_solid_angle.map_or(1.0, |pdf_light| power_heuristic(pdf_light, pdf));
            let strength = incident.irradiance * wi.z.abs() * share;
            let way = Ray { origin: place, direction: incident.direction };
            if pdf > 0.0
                && strength > 0.0
                && !scene.geometry.occluded(&way, Some(hit.surface), incident.target, incident.distance)
            {
                each_wavelength(light, sampler.wavelength, |nm, share| {
                    let f = surface.eval(wo, wi, sides, TransportMode::Radiance, nm);
                    total.biased(ORIGIN, nm, share * light.spd_at(incident.spd, nm) * strength * f, 0.0);
                });
            }
        }
        if let Some(scatter) = surface.sample(wo, sides, REFERENCE_NM, sampler.stream.triple()) {
            let way = Ray { origin: place, direction: frame.to_world(scatter.wi) };
            let found = scene.geometry.intersect(&way, Some(hit.surface), f64::INFINITY);
            if let Some(found) = found.filter(|found| scene.objects[found.object as usize].light.is_some()) {
                let share = power_heuristic(scatter.probability, light.pdf_li_surface(world, place, &found));
                let radiance = light.le_surface(scene.extent(), way.direction, &found).0 * share;
                each_wavelength(light, sampler.wavelength, |nm, share| {
                    let response =
                        surface.eval_sample(wo, &scatter, sides, TransportMode::Radiance, nm) / scatter.probability;
                    total.biased(ORIGIN, nm, share * (light.spd_at(EmittedSpd::Own, nm) * radiance) * response, 0.0);
                });
            }
        }

        // Nearby photons.
        let radius = f64::from(RADIUS_M).max(least(place));
        let facing = if hit.leads_back(ray.direction, hit.normal) { hit.normal } else { -hit.normal };
        let disk = DiskKernel::new(radius * radius);
        maps.indirect.surface.within(place.as_vec3().to_array(), radius as f32, |found| {
            let normal = found.photon.normal();
            let alignment = normal.dot(facing);
            let offset = DVec3::from(found.position.map(f64::from)) - place;
            if alignment < NORMAL_TOLERANCE || offset.dot(hit.normal).abs() > PLANE_TOLERANCE * radius {
                return;
            }
            let to_light = found.photon.to_light();
            let own_cosine = to_light.dot(normal);
            let wi = frame.to_local((to_light + (own_cosine - to_light.dot(facing)) * facing).normalize());
            let kernels = disk.at(f64::from(found.distance2));
            for (nm, power) in found.photon.power.lanes(&prepared.spectra) {
                let radiance = surface.eval(wo, wi, sides, TransportMode::Radiance, nm) * power;
                total.biased(ORIGIN, nm, radiance * kernels.estimate, radiance * kernels.bias());
            }
        });
    }
    total.0
}

/// Calls `f` with four wavelengths of the light and the inverse of their density.
fn each_wavelength(light: &Light, u: f64, mut f: impl FnMut(f64, f64)) {
    for k in 0..LANES {
        let (nm, pdf) = light.wavelengths.sample((u + k as f64) / LANES as f64);
        f(nm, 1.0 / (pdf * LANES as f64));
    }
}
