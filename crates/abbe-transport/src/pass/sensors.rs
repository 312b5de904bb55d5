//! Light that reaches the sensors of meters through glass or from mirrors.
//!
//! A path from a sensor finds a light behind glass only if the light has an extent. Photons find
//! the light of every light, but no photon hits a point, so at a point sensor a kernel averages
//! over a small disk; this is the only biased estimate of a meter. Photons arrive at sensors that
//! are surfaces without a kernel. Both techniques are combined by multiple importance sampling
//! ([`CausticWeights`]).
//!
//! No photon crosses the part of a disk behind a wall. Beside walls, each kernel is therefore
//! divided by its mass on the line through the photon and the sensor, between the walls.

use super::context::PassContext;
use crate::emit::{PhotonFlight, PhotonState, SurfaceArrival};
use crate::gather::{Portals, sensor_pdf};
use crate::map::SphereTree;
use crate::map::kernel::{DiskKernel, KernelDomain, KernelValues};
use crate::plan::PathClass;
use crate::plan::partition::LightPath;
use crate::sensor::SplatSink;
use crate::walk::{CausticWeights, RayDensity, transmittance};
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::meter::{ReceivingSide, Response, Sensor, SensorShape};
use abbe_spectra::spectrum::LANES;
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, PI};

#[derive(Debug)]
pub(crate) struct SensorKernels<'a> {
    scene: &'a Scene,
    portals: &'a Portals,
    /// The radius of each sensor in this pass, in m.
    radii_m: Vec<f64>,
    /// The weights of photons and of paths at each sensor.
    weights: Vec<CausticWeights>,
    rows: usize,
    disks: PointDisks,
    /// The sensors that are surfaces: the object and the sensor, sorted.
    surfaces: Vec<(u32, u32)>,
}

#[derive(Debug)]
pub(crate) struct PointDisks {
    tree: SphereTree,
    /// The numbers of the sensors, in the order of the spheres of the tree.
    sensors: Vec<u32>,
}

impl PointDisks {
    /// Creates the index. `radius_m` returns the radius of the disk of a sensor in m.
    pub(crate) fn new(sensors: &[Sensor], radius_m: impl Fn(usize) -> f64) -> Self {
        let points = || {
            let numbered = sensors.iter().enumerate();
            numbered.filter_map(|(number, sensor)| Some((number, sensor.position()?)))
        };
        let tree = SphereTree::build(points().map(|(number, position)| (position, radius_m(number))));
        Self { tree, sensors: points().map(|(number, _)| number as u32).collect() }
    }

    /// Calls `visit` with the number of each sensor whose disk the flight may cross.
    pub(crate) fn visit(&self, flight: &PhotonFlight<'_>, mut visit: impl FnMut(usize)) {
        self.tree.visit(flight.ray, flight.length_m, |sphere| visit(self.sensors[sphere] as usize));
    }
}

struct Received {
    /// The factor from the photon's power to the mean radiance of the sensor.
    estimate: f64,
    /// The factor from the photon's power to the bias of the mean radiance.
    bias: f64,
}

impl<'a> SensorKernels<'a> {
    /// Creates the kernels of a pass. Returns `None` if there are no first radii.
    pub(super) fn of_pass(
        context: &PassContext<'a>,
        scene: &'a Scene,
        (first_m, scale): (&[f64], f64),
        photons_per_sample: f64,
    ) -> Option<Self> {
        if first_m.is_empty() {
            return None;
        }
        let sensors = scene.camera.sensors();
        let radii_m: Vec<f64> = first_m.iter().map(|radius| radius * scale).collect();
        let rows = scene.camera.pixel_count() / sensors.len();
        let paths_per_sensor = rows as f64 * context.budget.camera_samples.unwrap_or(1) as f64;
        let weights = |(sensor, radius_m): (&Sensor, &f64)| {
            let area_m2 = match sensor.shape {
                SensorShape::Point(..) => PI * radius_m.powi(2),
                SensorShape::Surface(object, _) => scene.geometry.area(object),
            };
            CausticWeights { photons_m2: photons_per_sample * area_m2 / paths_per_sensor }
        };
        let weights = sensors.iter().zip(&radii_m).map(weights).collect();
        let disks = PointDisks::new(sensors, |number| radii_m[number]);
        let surface = |(number, sensor): (usize, &Sensor)| match sensor.shape {
            SensorShape::Point(..) => None,
            SensorShape::Surface(object, _) => Some((object, number as u32)),
        };
        let mut surfaces: Vec<(u32, u32)> = sensors.iter().enumerate().filter_map(surface).collect();
        surfaces.sort_unstable();
        Some(Self { scene, portals: context.portals, radii_m, weights, rows, disks, surfaces })
    }

    pub(super) fn weights(&self) -> &[CausticWeights] {
        &self.weights
    }

    /// Adds the light that a photon brings to the point sensors along a straight line.
    pub(super) fn add_flight(&self, flight: &PhotonFlight<'_>, light: usize, splats: &mut SplatSink) {
        if flight.photon.light_path != LightPath::Caustic {
            return;
        }
        let sensors = self.scene.camera.sensors();
        self.disks.visit(flight, |number| {
            let SensorShape::Point(position, response) = sensors[number].shape else { return };
            let Some((t, d2)) = crossing(flight, position, response, self.radii_m[number]) else { return };
            let kernels = DiskKernel::new(self.radii_m[number].powi(2)).at(d2);
            let offset = flight.ray.at(t) - position;
            let Some(kernels) = self.between_walls(kernels, position, offset, self.radii_m[number]) else { return };
            let to_light = -flight.ray.direction;
            // The disk of a plane catches the flux through the plane. The other disks are
            // perpendicular to the ray, so they catch the fluence.
            let per_flux = match response {
                Response::Plane(_) => FRAC_1_PI,
                Response::Sphere | Response::Cylinder(_) | Response::Cone(..) => response.pdf(to_light),
            };
            let weight = per_flux * self.mis_weight(number, (position, response), flight.photon.ray_density, to_light);
            let received = Received { estimate: weight * kernels.estimate, bias: weight * kernels.bias() };
            self.splat(number, &received, flight.photon, (t, Some(flight)), light, splats);
        });
    }

    /// Corrects the kernels beside walls, or `None` if a wall is between photon and sensor.
    fn between_walls(
        &self,
        kernels: KernelValues,
        position: DVec3,
        offset: DVec3,
        radius_m: f64,
    ) -> Option<KernelValues> {
        let distance_m = offset.length();
        let towards = if distance_m > 0.0 { offset / distance_m } else { return Some(kernels) };
        let extent_m = |direction: DVec3| {
            let hit = self.scene.geometry.intersect(&Ray::new(position, direction), None, radius_m);
            hit.map_or(radius_m, |hit| hit.t)
        };
        let ahead_m = extent_m(towards);
        if ahead_m < distance_m {
            return None;
        }
        let extents = [ahead_m, extent_m(-towards)].map(|extent_m| extent_m / radius_m);
        Some(kernels.between_faces(KernelDomain::Disk, extents))
    }

    /// Adds the light that a photon brings to the sensors on the surface where it arrives.
    pub(super) fn add_arrival(&self, arrival: &SurfaceArrival<'_>, light: usize, splats: &mut SplatSink) {
        if arrival.photon.light_path != LightPath::Caustic {
            return;
        }
        let hit = &arrival.interaction.hit;
        let first = self.surfaces.partition_point(|(object, _)| *object < hit.object);
        let on_object = self.surfaces[first..].iter().take_while(|(object, _)| *object == hit.object);
        for number in on_object.map(|(_, number)| *number as usize) {
            let SensorShape::Surface(object, side) = self.scene.camera.sensors()[number].shape else { continue };
            let to_light = arrival.to_light();
            let front = to_light.dot(hit.normal) > 0.0;
            let (counts, sides) = match side {
                ReceivingSide::Front => (front, 1.0),
                ReceivingSide::Back => (!front, 1.0),
                ReceivingSide::Both => (true, 2.0),
            };
            if !counts {
                continue;
            }
            let facing = if front { hit.normal } else { -hit.normal };
            let response = Response::Plane(facing);
            let weight = self.mis_weight(number, (hit.position, response), arrival.photon.ray_density, to_light);
            let estimate = weight * FRAC_1_PI / (sides * self.scene.geometry.area(object));
            let received = Received { estimate, bias: 0.0 };
            self.splat(number, &received, arrival.photon, (0.0, None), light, splats);
        }
    }

    fn mis_weight(&self, number: usize, point: (DVec3, Response), density: RayDensity, to_light: DVec3) -> f64 {
        self.weights[number].of_photon(density, sensor_pdf(point, self.portals, to_light))
    }

    fn splat(
        &self,
        number: usize,
        received: &Received,
        photon: &PhotonState,
        (t, flight): (f64, Option<&PhotonFlight<'_>>),
        light: usize,
        splats: &mut SplatSink,
    ) {
        let along = flight.map(|flight| flight.transmittance(t));
        // The reading is the mean of its rows, and only the first row gets the splat.
        let rows = self.rows as f64;
        let pixel = (number * self.rows) as u32;
        let mut lanes = [(0.0, 0.0); LANES];
        for (k, &nm) in photon.wavelengths.active().iter().enumerate() {
            let passed = along.as_ref().map_or(1.0, |along| transmittance(along, nm));
            lanes[k] = (nm, photon.power[k] * passed * rows);
        }
        let lanes = &lanes[..photon.wavelengths.count];
        let of = |factor: f64| lanes.iter().map(move |&(nm, power)| (nm, power * factor));
        splats.splat((PathClass::Caustic.number(), light), pixel, of(received.estimate));
        splats.bias(pixel, of(received.bias));
    }
}

/// Returns the distance along the flight to the disk of a sensor, and the squared distance (m²)
/// from its middle, or `None` if the photon misses the disk.
pub(crate) fn crossing(
    flight: &PhotonFlight<'_>,
    position: DVec3,
    response: Response,
    radius_m: f64,
) -> Option<(f64, f64)> {
    let (ray, offset) = (flight.ray, position - flight.ray.origin);
    let t = match response {
        Response::Plane(normal) => {
            let cosine = ray.direction.dot(normal);
            if cosine >= 0.0 {
                return None;
            }
            offset.dot(normal) / cosine
        }
        Response::Sphere | Response::Cylinder(_) | Response::Cone(..) => offset.dot(ray.direction),
    };
    let d2 = ray.at(t).distance_squared(position);
    (t >= 0.0 && t <= flight.length_m && d2 < radius_m * radius_m).then_some((t, d2))
}
