//! The camera: maps film positions to rays into the scene, and points of the scene to film
//! positions.
//!
//! Film coordinates are in pixels with the origin at the top left. The pinhole and the thin lens,
//! which do not depend on wavelength, are here, and lens systems of real glass in `system`.

mod aperture;
mod depth_of_field;
mod diffraction;
mod shutter;
mod system;

pub use aperture::ApertureStop;
pub use depth_of_field::DepthOfField;
pub use diffraction::ApertureDiffraction;
pub use shutter::Shutter;
pub use system::{LensReflections, SystemAt, SystemLens};

use crate::geometry::Ray;
use crate::medium_stack::MediumStack;
use crate::meter::Sensor;
use crate::motion::LookAt;
use abbe_optics::bsdf::PolarisingFilter;
use abbe_spectra::math::elementary::atan;
use glam::{DVec2, DVec3};
use std::sync::Arc;

#[derive(Debug, Clone, PartialEq)]
pub enum Aperture {
    /// A point: the whole scene is in focus.
    Pinhole,
    /// An orthographic projection: parallel rays that start on the plane of the camera.
    Orthographic,
    /// A thin lens that is focused on a plane.
    ThinLens {
        stop: ApertureStop,
        /// The distance along the optical axis, in m.
        focus_m: f64,
    },
    /// A lens system of real glass.
    System(Box<SystemLens>),
}

/// A camera: its pose, field of view, aperture and resolution. That of a measurement has no lens
/// and no field of view: each of its pixels belongs to a sensor of a meter, at which paths start.
#[derive(Debug, Clone)]
pub struct Camera {
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    aperture: Aperture,
    size: DVec2,
    /// The side length of a pixel at distance 1, or in m for an orthographic camera.
    pixel: f64,
    /// The sensors of meters. Empty for a camera with a picture.
    sensors: Arc<[Sensor]>,
    /// The bodies around the middle of the lens.
    pub medium_stack: MediumStack,
    /// True if the bodies may differ from point to point of the lens or of an orthographic picture.
    pub crosses_bodies: bool,
    /// The polarising filter before the lens. Its axis u is the right side of the picture, and its
    /// first layer faces the scene.
    pub filter: Option<Arc<PolarisingFilter>>,
    /// True if the scene enables diffraction at the aperture. A pinhole ignores it.
    pub diffracts: bool,
}

/// The connection from a point of the scene to the film, through the lens.
#[derive(Debug, Clone, Copy)]
pub struct CameraConnection {
    /// The position on the film in pixels, from the upper left corner.
    pub film: DVec2,
    /// The unit vector from the point to the lens.
    pub direction: DVec3,
    /// In m, from the point to the lens.
    pub distance: f64,
    /// Converts the point's intensity along `direction` to the pixel's mean radiance, in 1/m². It
    /// is 1/(d² Ω), where d is `distance` and Ω is the solid angle that the pixel subtends at the
    /// lens, or 1/(area of a pixel) for an orthographic camera.
    pub importance: f64,
}

impl Camera {
    /// Creates a camera at `origin` (m, relative to the scene's centre) with a film of `width` ×
    /// `height` pixels.
    ///
    /// `forward` and `up` are orthogonal unit vectors; see [`look_at_axes`]. `tan_half_height` is
    /// the tangent of half the vertical field of view, or half the height of the picture in m for
    /// an orthographic camera.
    pub fn new(
        origin: DVec3,
        (forward, up): (DVec3, DVec3),
        tan_half_height: f64,
        (width, height): (u32, u32),
        aperture: Aperture,
    ) -> Self {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let pixel = 2.0 * tan_half_height / size.y;
        let (right, medium_stack, diffracts) = (forward.cross(up), MediumStack::AIR, false);
        let sensors = Arc::default();
        let (crosses_bodies, filter) = (false, None);
        Self {
            origin,
            right,
            up,
            forward,
            aperture,
            size,
            pixel,
            sensors,
            medium_stack,
            crosses_bodies,
            filter,
            diffracts,
        }
    }

    /// Creates the camera of a measurement, a film of one column with `rows` rows per sensor.
    pub fn of_sensors(sensors: Arc<[Sensor]>, rows: u32) -> Self {
        /// The angle (rad) of the cone that a path from a sensor represents, which sets the
        /// footprint of textures and the largest kernels.
        const PATH_ANGLE: f64 = 0.02;
        let height = sensors.len() as u32 * rows;
        let axes = (DVec3::NEG_Z, DVec3::Y);
        let half = 0.5 * PATH_ANGLE * f64::from(height);
        Self { sensors, ..Self::new(DVec3::ZERO, axes, half, (1, height), Aperture::Pinhole) }
    }

    pub fn sensors(&self) -> &Arc<[Sensor]> {
        &self.sensors
    }

    /// Replaces the sensors by the same number of others.
    pub fn set_sensors(&mut self, sensors: Arc<[Sensor]>) {
        self.sensors = sensors;
    }

    /// The sensor of a pixel and its number, or `None` if the camera has a picture.
    #[inline]
    pub fn sensor(&self, pixel: u64) -> Option<(usize, &Sensor)> {
        if self.sensors.is_empty() {
            return None;
        }
        let number = pixel as usize / (self.pixel_count() / self.sensors.len());
        self.sensors.get(number).map(|sensor| (number, sensor))
    }

    /// The centre of the lens, relative to the scene's centre, in m.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The direction of the view, a unit vector.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The direction to the right side of the picture, a unit vector.
    pub fn right(&self) -> DVec3 {
        self.right
    }

    /// Moves the camera to a pose in m, relative to the scene's centre.
    pub fn look_at(&mut self, LookAt { from, at, up }: LookAt) {
        (self.forward, self.up) = look_at_axes(at - from, up);
        (self.origin, self.right) = (from, self.forward.cross(self.up));
    }

    pub fn aperture(&self) -> &Aperture {
        &self.aperture
    }

    pub fn system(&self) -> Option<&SystemLens> {
        let Aperture::System(system) = &self.aperture else { return None };
        Some(system)
    }

    pub fn system_mut(&mut self) -> Option<&mut SystemLens> {
        let Aperture::System(system) = &mut self.aperture else { return None };
        Some(system)
    }

    /// Returns this camera with a coarser film about the same centre. Each pixel covers `factor` ×
    /// `factor` pixels of this camera, and the coarse film is not smaller.
    #[must_use]
    pub fn coarser(&self, factor: u32) -> Self {
        let factor = f64::from(factor);
        Self { size: (self.size / factor).ceil(), pixel: self.pixel * factor, ..self.clone() }
    }

    pub fn close_aperture(&mut self) {
        if self.aperture != Aperture::Orthographic {
            self.aperture = Aperture::Pinhole;
        }
    }

    /// The horizontal and the vertical field of view in radians. 0 for an orthographic camera.
    pub fn field_of_view(&self) -> [f64; 2] {
        [self.size.x, self.size.y].map(|pixels| 2.0 * atan(0.5 * pixels * self.pixel_angle()))
    }

    pub fn orthographic_size_m(&self) -> Option<[f64; 2]> {
        (self.aperture == Aperture::Orthographic).then(|| (self.size * self.pixel).to_array())
    }

    /// The angle in rad of a pixel in the middle of the picture. 0 for an orthographic camera.
    pub fn pixel_angle(&self) -> f64 {
        self.pixel_angle_at(f64::INFINITY)
    }

    /// The angle in rad of a pixel in the middle, fixed except for an orthographic camera.
    pub fn pixel_angle_at(&self, distance_m: f64) -> f64 {
        match self.aperture {
            Aperture::Orthographic => self.pixel / distance_m,
            Aperture::Pinhole | Aperture::ThinLens { .. } | Aperture::System(_) => self.pixel,
        }
    }

    /// The length in m that a pixel in the middle of the picture covers at a distance.
    #[inline]
    pub fn pixel_width_m(&self, distance_m: f64) -> f64 {
        match self.aperture {
            Aperture::Orthographic => self.pixel,
            Aperture::Pinhole | Aperture::ThinLens { .. } | Aperture::System(_) => distance_m * self.pixel,
        }
    }

    /// A box around the points at which the camera's rays start.
    pub fn viewpoint_bounds(&self) -> (DVec3, DVec3) {
        let around = |radius_m: f64| (self.origin - radius_m, self.origin + radius_m);
        match self.aperture {
            Aperture::Orthographic => {
                let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(DVec2::from);
                let corners = corners.map(|corner| self.ray(corner * self.size, [0.5; 2]).origin);
                corners
                    .iter()
                    .fold((self.origin, self.origin), |(low, high), &corner| (low.min(corner), high.max(corner)))
            }
            Aperture::Pinhole => around(0.0),
            Aperture::ThinLens { stop, .. } => around(stop.radius_m),
            Aperture::System(ref system) => around(system.front_radius_m()),
        }
    }

    /// The point from which the camera sees a point, in the middle of the lens.
    pub fn viewpoint_of(&self, point: DVec3) -> DVec3 {
        match self.aperture {
            Aperture::Orthographic => point - (point - self.origin).dot(self.forward) * self.forward,
            Aperture::Pinhole | Aperture::ThinLens { .. } | Aperture::System(_) => self.origin,
        }
    }

    pub fn pixel_count(&self) -> usize {
        (self.size.x * self.size.y) as usize
    }

    /// Returns the width and the height of the film in pixels.
    pub fn film_size(&self) -> DVec2 {
        self.size
    }

    pub fn width(&self) -> usize {
        self.size.x as usize
    }

    /// The ray through a film position (in pixels). `lens` samples the opening of a thin lens. For
    /// a lens system, the ray passes through the centre of an ideal lens with the same field of
    /// view; see [`ray_through`](Self::ray_through).
    pub fn ray(&self, film: DVec2, lens: [f64; 2]) -> Ray {
        let offset = (film - 0.5 * self.size) * self.pixel;
        let through = self.forward + self.right * offset.x - self.up * offset.y;
        match self.aperture {
            Aperture::Pinhole | Aperture::System(_) => Ray { origin: self.origin, direction: through.normalize() },
            Aperture::Orthographic => {
                let origin = self.origin + self.right * offset.x - self.up * offset.y;
                Ray { origin, direction: self.forward }
            }
            Aperture::ThinLens { stop, focus_m } => {
                let opening = stop.sample(lens);
                let shift = self.right * opening.x + self.up * opening.y;
                // The squared length of `through` × `focus_m` could overflow.
                Ray { origin: self.origin + shift, direction: (through - shift / focus_m).normalize() }
            }
        }
    }

    /// Traces a ray of one wavelength from a film position (in pixels) through the lens system.
    /// Returns the ray that leaves the lens and its weight, or `None` if the lens blocks it. `lens`
    /// samples the exit pupil. `ghost` selects a ghost; `None` stands for the image.
    pub fn ray_through(
        &self,
        glass: &SystemAt<'_>,
        film: DVec2,
        lens: [f64; 2],
        ghost: Option<f64>,
    ) -> Option<(Ray, f64)> {
        let offset = (film - 0.5 * self.size) * (self.pixel * glass.system().image_mm());
        let place = DVec2::new(offset.x, -offset.y);
        let (ray, weight) = match ghost {
            None => glass.ray(place, lens)?,
            Some(choice) => glass.ghost_ray(place, lens, choice)?,
        };
        let to_world = |v: DVec3| self.right * v.x + self.up * v.y - self.forward * v.z;
        Some((Ray { origin: self.origin + to_world(ray.origin) * 1e-3, direction: to_world(ray.direction) }, weight))
    }

    /// Projects a point through the centre of the lens to a position in pixels, which may be
    /// outside the film. Returns `None` for a point behind the camera.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let offset = point - self.origin;
        let depth = offset.dot(self.forward);
        let scale = if self.aperture == Aperture::Orthographic { 1.0 } else { depth };
        (depth > 0.0).then(|| self.on_film(DVec2::new(offset.dot(self.right), offset.dot(self.up)) / scale))
    }

    /// The film position (in pixels) of a point on the plane at distance 1, given by its distances
    /// from the optical axis to the right and upwards.
    fn on_film(&self, on_plane: DVec2) -> DVec2 {
        DVec2::new(on_plane.x, -on_plane.y) / self.pixel + 0.5 * self.size
    }

    /// Connects a point of the scene to the film. Returns `None` if the image of the point is
    /// outside the film, or if the camera has no picture. `lens` samples the opening of a thin
    /// lens. A lens system is treated as an ideal lens, as in [`ray`](Self::ray).
    pub fn connect(&self, point: DVec3, lens: [f64; 2]) -> Option<CameraConnection> {
        self.connect_to_plane(point, lens).filter(|connection| self.pixel_at(connection.film).is_some())
    }

    /// Does the same as [`Self::connect`], but also for images beside the film.
    pub fn connect_to_plane(&self, point: DVec3, lens: [f64; 2]) -> Option<CameraConnection> {
        if !self.sensors.is_empty() {
            return None;
        }
        let (shift, focus_m) = match self.aperture {
            Aperture::Orthographic => return self.connect_orthographic(point),
            Aperture::Pinhole | Aperture::System(_) => (DVec2::ZERO, 1.0),
            Aperture::ThinLens { stop, focus_m } => (stop.sample(lens), focus_m),
        };
        let lens_point = self.origin + self.right * shift.x + self.up * shift.y;
        let offset = lens_point - point;
        let depth = -offset.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let sideways = DVec2::new(-offset.dot(self.right), -offset.dot(self.up));
        // Where the line from the lens to the point meets the plane in focus, at distance 1.
        let on_plane = sideways / depth + shift / focus_m;
        let distance = offset.length();
        let cos = depth / distance;
        Some(CameraConnection {
            film: self.on_film(on_plane),
            direction: offset / distance,
            distance,
            importance: 1.0 / (distance * distance * cos * cos * cos * self.pixel * self.pixel),
        })
    }

    fn connect_orthographic(&self, point: DVec3) -> Option<CameraConnection> {
        let film = self.project(point)?;
        let distance = (point - self.origin).dot(self.forward);
        let importance = (self.pixel * self.pixel).recip();
        Some(CameraConnection { film, direction: -self.forward, distance, importance })
    }

    /// The number of the pixel at a film position, row by row, or `None` outside the film.
    pub fn pixel_at(&self, film: DVec2) -> Option<u32> {
        let is_inside = film.x >= 0.0 && film.y >= 0.0 && film.x < self.size.x && film.y < self.size.y;
        is_inside.then(|| film.y as u32 * self.size.x as u32 + film.x as u32)
    }
}

/// The unit vectors `forward` and `up` of a camera that looks along `view`. `up` need not be
/// orthogonal to `view`, but must not be parallel to it.
pub fn look_at_axes(view: DVec3, up: DVec3) -> (DVec3, DVec3) {
    let forward = view.normalize();
    let right = forward.cross(up).normalize();
    (forward, right.cross(forward))
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_optics::aperture::Blades;

    fn cameras() -> [Camera; 3] {
        let axes = (DVec3::NEG_Z, DVec3::Y);
        let lens = |blades| Aperture::ThinLens { stop: ApertureStop { radius_m: 0.3, blades }, focus_m: 2.5 };
        let five = Blades { count: 5, rotation: 0.3 };
        [Aperture::Pinhole, lens(None), lens(Some(five))]
            .map(|aperture| Camera::new(DVec3::new(1.0, 2.0, 3.0), axes, 0.4, (40, 30), aperture))
    }

    #[test]
    fn a_point_on_the_ray_of_a_pixel_connects_to_that_pixel() {
        for camera in cameras() {
            for (i, film) in [[0.5, 0.5], [12.25, 20.75], [39.5, 29.5]].into_iter().enumerate() {
                let lens = [0.2 + 0.3 * i as f64, 0.7];
                let ray = camera.ray(DVec2::from(film), lens);
                let connection = camera.connect(ray.origin + ray.direction * 4.2, lens).unwrap();
                assert_eq!(camera.pixel_at(connection.film), Some(film[1] as u32 * 40 + film[0] as u32));
                assert!((connection.distance - 4.2).abs() < 1e-12);
                let seen = camera.project(camera.origin() + (ray.origin - camera.origin()) + ray.direction * 4.2);
                assert!(camera.aperture() != &Aperture::Pinhole || (seen.unwrap() - DVec2::from(film)).length() < 1e-9);
                assert!((connection.direction + ray.direction).length() < 1e-12);
            }
            assert!(camera.connect(DVec3::new(1.0, 2.0, 4.0), [0.5; 2]).is_none(), "behind the camera");
        }
    }

    /// A coarse film covers the same view, even if its size is not a multiple of the factor.
    #[test]
    fn a_coarse_film_shows_the_same_view() {
        for camera in cameras() {
            let coarse = camera.coarser(4);
            assert_eq!((coarse.width(), coarse.pixel_count()), (10, 10 * 8));
            for offset in [DVec2::ZERO, DVec2::new(12.0, -8.0)] {
                let fine = camera.ray(DVec2::new(20.0, 15.0) + offset, [0.3, 0.6]);
                let same = coarse.ray(DVec2::new(5.0, 4.0) + offset / 4.0, [0.3, 0.6]);
                assert!(fine.origin == same.origin && (fine.direction - same.direction).length() < 1e-15);
            }
        }
    }

    #[test]
    fn the_first_row_is_the_top_and_the_first_column_the_left() {
        let [camera, ..] = cameras();
        let direction = camera.ray(DVec2::ZERO, [0.5; 2]).direction;
        assert!(direction.x < 0.0 && direction.y > 0.0);
    }

    /// A pixel covers the same length at all distances. The picture is 0.8 m high.
    #[test]
    fn an_orthographic_camera_sees_along_parallel_rays() {
        let axes = (DVec3::NEG_Z, DVec3::Y);
        let camera = Camera::new(DVec3::new(1.0, 2.0, 3.0), axes, 0.4, (40, 20), Aperture::Orthographic);
        let film = DVec2::new(35.25, 4.75);
        let ray = camera.ray(film, [0.5; 2]);
        assert_eq!(ray.direction, DVec3::NEG_Z);
        assert!((ray.origin - DVec3::new(1.61, 2.21, 3.0)).length() < 1e-12, "{}", ray.origin);
        for distance in [0.5, 70.0] {
            let point = ray.origin + distance * ray.direction;
            assert!((camera.project(point).unwrap() - film).length() < 1e-9);
            assert!((camera.viewpoint_of(point) - ray.origin).length() < 1e-9);
            let connection = camera.connect(point, [0.5; 2]).unwrap();
            assert_eq!((camera.pixel_at(connection.film), connection.direction), (Some(4 * 40 + 35), DVec3::Z));
            assert!((connection.distance - distance).abs() < 1e-9);
            assert!((connection.importance * 0.04 * 0.04 - 1.0).abs() < 1e-12);
            assert!((camera.pixel_width_m(distance) - 0.04).abs() < 1e-15);
        }
        assert_eq!((camera.pixel_angle(), camera.orthographic_size_m()), (0.0, Some([1.6, 0.8])));
        assert!(camera.connect(ray.origin + DVec3::Z, [0.5; 2]).is_none(), "behind the camera");
        assert!(camera.connect(ray.origin + DVec3::new(0.3, 0.0, -1.0), [0.5; 2]).is_none(), "beside the film");
    }

    #[test]
    fn importance_is_the_film_area_per_solid_angle() {
        // The solid angle of a small square on the plane at distance 1 is cos³ θ times its area.
        for camera in cameras() {
            for film in [DVec2::new(3.0, 4.0), DVec2::new(20.0, 15.0)] {
                let lens = [0.5, 0.5];
                let ray = camera.ray(film, lens);
                let cos = ray.direction.dot(DVec3::NEG_Z);
                let connection = camera.connect(ray.origin + ray.direction * 2.0, lens).unwrap();
                let pixel_solid_angle = camera.pixel_angle().powi(2) * cos.powi(3);
                assert!((connection.importance * 4.0 * pixel_solid_angle - 1.0).abs() < 1e-9);
            }
        }
    }
}
