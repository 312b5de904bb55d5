//! The gathering of a camera sample.

use super::scenes::{Prepared, Total, gatherer};
use abbe::gather::{CameraNumbers, Maps, Outlines, RADIUS_KINDS, Scratch, power_heuristic};
use abbe::map::LightMaps;
use abbe::map::kernel::Disk;
use abbe::map::radius::least;
use abbe::optics::surface::{Class, Sides, Transport};
use abbe::scene::geometry::Ray;
use abbe::scene::light::{Light, Tint};
use abbe::spectrum::LANES;
use abbe::walk::{Sink, Tally};
use glam::DVec3;

/// Kernels of about 50 photons.
const RADIUS_M: f32 = 0.2;

/// Photons of surfaces that face another way, or off the tangent plane, do not count.
const NORMAL_TOLERANCE: f64 = 0.7;
const PLANE_TOLERANCE: f64 = 0.3;

/// As the renderer gathers.
pub(crate) fn general(prepared: &Prepared, maps: &Maps, count: u64) -> f64 {
    let (outlines, light_maps) = (Outlines::default(), LightMaps::default());
    let gatherer = gatherer(prepared, (maps, &outlines, &light_maps));
    let (mut scratch, mut tally, mut total) = (Scratch::default(), Tally::default(), Total(0.0));
    for pixel in pixels(prepared, count) {
        let numbers = CameraNumbers::new(1, 0, pixel);
        gatherer.sample(pixel, numbers, &[RADIUS_M; RADIUS_KINDS], (&mut scratch, &mut tally), &mut total);
    }
    total.0
}

/// Pixels all over the picture.
fn pixels(prepared: &Prepared, count: u64) -> impl Iterator<Item = u64> {
    let all = prepared.scene.camera.pixel_count() as u64;
    (0..count).map(move |number| number * 7919 % all)
}

/// Written out: a pinhole, one lamp with a surface, opaque walls that scatter or absorb, clear air, photons scattered before.
pub(crate) fn plain(prepared: &Prepared, maps: &Maps, count: u64) -> f64 {
    let (scene, mut total) = (&prepared.scene, Total(0.0));
    let (world, lamp) = (scene.world(), &scene.lights[0]);
    let sides = Sides { here: &scene.air, there: &scene.air };
    for pixel in pixels(prepared, count) {
        let mut numbers = CameraNumbers::new(1, 0, pixel);
        let ray = numbers.ray(&scene.camera, pixel);
        numbers.stream.uniform();
        let Some(hit) = scene.geometry.intersect(&ray, None, f64::INFINITY) else { continue };
        let object = &scene.objects[hit.object as usize];
        if object.light.is_some() {
            let radiance = lamp.surface_radiance(ray.direction, &hit);
            each_wavelength(lamp, numbers.wavelength, |nm, share| {
                total.biased(nm, share * lamp.shape_at(Tint::Own, nm) * radiance, 0.0);
            });
        }
        let surface = &scene.materials[object.material].surface;
        if surface.class() != Class::Diffuse {
            continue;
        }
        let frame = hit.frame(ray.direction);
        let (wo, place) = (frame.to_local(-ray.direction), hit.position);

        // A shadow ray, then a scattered ray, each with its share of the lamp.
        if let Some(incident) = lamp.towards(world, place, numbers.lamp()) {
            let wi = frame.to_local(incident.direction);
            let pdf = surface.pdf(wo, wi, sides, 550.0);
            let share = incident.pdf_solid_angle.map_or(1.0, |of_lamp| power_heuristic(of_lamp, pdf));
            let strength = incident.irradiance * wi.z.abs() * share;
            let way = Ray { origin: place, direction: incident.direction };
            if pdf > 0.0
                && strength > 0.0
                && !scene.geometry.occluded(&way, Some(hit.surface), incident.target, incident.distance)
            {
                each_wavelength(lamp, numbers.wavelength, |nm, share| {
                    let f = surface.eval(wo, wi, sides, Transport::Radiance, nm);
                    total.biased(nm, share * lamp.shape_at(incident.tint, nm) * strength * f, 0.0);
                });
            }
        }
        if let Some(scatter) = surface.sample(wo, sides, 550.0, Transport::Radiance, numbers.stream.triple()) {
            let way = Ray { origin: place, direction: frame.to_world(scatter.wi) };
            let found = scene.geometry.intersect(&way, Some(hit.surface), f64::INFINITY);
            if let Some(found) = found.filter(|found| scene.objects[found.object as usize].light.is_some()) {
                let share = power_heuristic(scatter.probability, lamp.surface_pdf(world, place, &found));
                let radiance = lamp.surface_radiance(way.direction, &found) * share;
                each_wavelength(lamp, numbers.wavelength, |nm, share| {
                    let response = surface.response(wo, &scatter, sides, Transport::Radiance, nm) / scatter.probability;
                    total.biased(nm, share * (lamp.shape_at(Tint::Own, nm) * radiance) * response, 0.0);
                });
            }
        }

        // Photons around.
        let radius = f64::from(RADIUS_M).max(least(place));
        let facing = if hit.leads_back(ray.direction, hit.normal) { hit.normal } else { -hit.normal };
        let disk = Disk::new(radius * radius);
        maps.indirect.within(place.as_vec3().to_array(), radius as f32, |found| {
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
            for (nm, power) in found.photon.load.lanes() {
                let radiance = surface.eval(wo, wi, sides, Transport::Radiance, nm) * power;
                total.biased(nm, radiance * kernels.estimate, radiance * kernels.bias());
            }
        });
    }
    total.0
}

/// Four wavelengths of the lamp, and one over their density.
fn each_wavelength(lamp: &Light, u: f64, mut f: impl FnMut(f64, f64)) {
    for k in 0..LANES {
        let (nm, pdf) = lamp.wavelengths.sample((u + k as f64) / LANES as f64);
        f(nm, 1.0 / (pdf * LANES as f64));
    }
}
