//! The camera: from a place on the film to a ray into the scene, and from a point of the scene to its place on the film.
//!
//! Film coordinates are in pixels, origin at the top left. Here stand the pinhole and the thin lens, which are the same to all wavelengths;
//! real glass has a file of its own.

mod depth_of_field;
mod diffraction;
mod shutter;
mod stop;
mod system;

pub use depth_of_field::DepthOfField;
pub use diffraction::Diffraction;
pub use shutter::Shutter;
pub use stop::Stop;
pub use system::{SystemAt, SystemLens};

use crate::scene::geometry::Ray;
use crate::scene::interior::Interior;
use glam::{DVec2, DVec3};

/// What lets the light in.
#[derive(Debug, Clone, PartialEq)]
pub enum Aperture {
    /// A point: everything is sharp.
    Pinhole,
    /// A thin lens, focused on the plane at a distance.
    ThinLens {
        /// Its opening.
        stop: Stop,
        /// Distance in m of the plane in focus, along the axis.
        focus_m: f64,
    },
    /// A lens of real glass.
    System(Box<SystemLens>),
}

/// Where the camera stands and what it sees.
#[derive(Debug, Clone)]
pub struct Camera {
    origin: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    aperture: Aperture,
    size: DVec2,
    /// The side of a pixel on the plane at distance 1.
    pixel: f64,
    /// The bodies of glass that it stands in.
    pub interior: Interior,
    /// Whether its opening diffracts light; of a pinhole it says nothing.
    pub diffracts: bool,
}

/// How a point of the scene is seen on the film.
#[derive(Debug, Clone, Copy)]
pub struct Sighting {
    /// The pixel's index, row by row.
    pub pixel: u32,
    /// From the point to the camera, unit.
    pub direction: DVec3,
    /// Distance to the lens.
    pub distance: f64,
    /// The pixel's mean radiance per W/sr that the point sends along `direction` (1/m²): |dA_film/dω| over the pixel's area.
    pub importance: f64,
}

impl Camera {
    /// A camera at `origin` that looks along `forward` with `up` above, all orthonormal; `tan_half_height` is the
    /// tangent of half the vertical field of view.
    pub fn new(
        origin: DVec3,
        (forward, up): (DVec3, DVec3),
        tan_half_height: f64,
        (width, height): (u32, u32),
        aperture: Aperture,
    ) -> Self {
        let size = DVec2::new(f64::from(width), f64::from(height));
        let pixel = 2.0 * tan_half_height / size.y;
        let (right, interior, diffracts) = (forward.cross(up), Interior::AIR, false);
        Self { origin, right, up, forward, aperture, size, pixel, interior, diffracts }
    }

    /// Where it stands (the lens's centre).
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Stands it at a place, looking at another, with a third vector up in the picture.
    pub fn stand(&mut self, [from, at, up]: [DVec3; 3]) {
        (self.forward, self.up) = axes(at - from, up);
        (self.origin, self.right) = (from, self.forward.cross(self.up));
    }

    /// What lets the light in.
    pub fn aperture(&self) -> &Aperture {
        &self.aperture
    }

    /// The lens of real glass that it has, if any.
    pub fn system(&self) -> Option<&SystemLens> {
        match &self.aperture {
            Aperture::Pinhole | Aperture::ThinLens { .. } => None,
            Aperture::System(system) => Some(system),
        }
    }

    /// Makes it a pinhole.
    pub fn close_aperture(&mut self) {
        self.aperture = Aperture::Pinhole;
    }

    /// The whole field of view across and down the picture, in radians.
    pub fn field_of_view(&self) -> [f64; 2] {
        [self.size.x, self.size.y].map(|pixels| 2.0 * (0.5 * pixels * self.pixel).atan())
    }

    /// The angle that a pixel in the middle subtends, in radians: a point at distance d has a footprint of d times this.
    pub fn pixel_angle(&self) -> f64 {
        self.pixel
    }

    /// How many pixels there are.
    pub fn pixel_count(&self) -> usize {
        (self.size.x * self.size.y) as usize
    }

    /// Pixels per row.
    pub fn width(&self) -> usize {
        self.size.x as usize
    }

    /// The ray through a place of the film (in pixels) and, for a thin lens, through the place of the opening that `lens` draws. Of real glass
    /// it is the ray through the middle of an ideal lens with the same field of view.
    pub fn ray(&self, film: DVec2, lens: [f64; 2]) -> Ray {
        let offset = (film - 0.5 * self.size) * self.pixel;
        let through = self.forward + self.right * offset.x - self.up * offset.y;
        match self.aperture {
            Aperture::Pinhole | Aperture::System(_) => Ray { origin: self.origin, direction: through.normalize() },
            Aperture::ThinLens { stop, focus_m } => {
                let opening = stop.place(lens);
                let shift = self.right * opening.x + self.up * opening.y;
                // The shift over the distance: the distance itself may be far beyond what can be squared.
                Ray { origin: self.origin + shift, direction: (through - shift / focus_m).normalize() }
            }
        }
    }

    /// The ray from a place of the film (in pixels) through the lens of real glass at a wavelength, and its weight; `None` where the lens lets
    /// nothing through.
    pub fn ray_through(&self, glass: &SystemAt<'_>, film: DVec2, lens: [f64; 2]) -> Option<(Ray, f64)> {
        let offset = (film - 0.5 * self.size) * (self.pixel * glass.system().image_mm());
        let (ray, weight) = glass.ray(DVec2::new(offset.x, -offset.y), lens)?;
        let to_world = |v: DVec3| self.right * v.x + self.up * v.y - self.forward * v.z;
        Some((Ray { origin: self.origin + to_world(ray.origin) * 1e-3, direction: to_world(ray.direction) }, weight))
    }

    /// Where on the film (in pixels, perhaps beside it) a point is seen through the middle of the lens; `None` behind the camera.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let offset = point - self.origin;
        let depth = offset.dot(self.forward);
        (depth > 0.0).then(|| self.on_film(DVec2::new(offset.dot(self.right), offset.dot(self.up)) / depth))
    }

    /// The place on the film (in pixels) of a place on the plane at distance 1, right and up from its middle.
    fn on_film(&self, on_plane: DVec2) -> DVec2 {
        DVec2::new(on_plane.x, -on_plane.y) / self.pixel + 0.5 * self.size
    }

    /// How the point is seen, through the place of the opening that `lens` draws; `None` if it is not on the film.
    /// Real glass is left aside, as in [`ray`](Self::ray).
    pub fn sight(&self, point: DVec3, lens: [f64; 2]) -> Option<Sighting> {
        let (shift, focus_m) = match self.aperture {
            Aperture::Pinhole | Aperture::System(_) => (DVec2::ZERO, 1.0),
            Aperture::ThinLens { stop, focus_m } => (stop.place(lens), focus_m),
        };
        let lens_point = self.origin + self.right * shift.x + self.up * shift.y;
        let offset = lens_point - point;
        let depth = -offset.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let sideways = DVec2::new(-offset.dot(self.right), -offset.dot(self.up));
        // Where the line meets the plane in focus, brought to the plane at distance 1.
        let on_plane = sideways / depth + shift / focus_m;
        let film = self.on_film(on_plane);
        if !(film.x >= 0.0 && film.y >= 0.0 && film.x < self.size.x && film.y < self.size.y) {
            return None;
        }
        let distance = offset.length();
        let cos = depth / distance;
        Some(Sighting {
            pixel: film.y as u32 * self.size.x as u32 + film.x as u32,
            direction: offset / distance,
            distance,
            importance: 1.0 / (distance * distance * cos * cos * cos * self.pixel * self.pixel),
        })
    }
}

/// The unit vectors forward and up of a camera that looks along `view`, with `up` above (not along the view).
pub fn axes(view: DVec3, up: DVec3) -> (DVec3, DVec3) {
    let forward = view.normalize();
    let right = forward.cross(up).normalize();
    (forward, right.cross(forward))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optics::aperture::Blades;

    fn cameras() -> [Camera; 3] {
        let axes = (DVec3::NEG_Z, DVec3::Y);
        let lens = |blades| Aperture::ThinLens { stop: Stop { radius_m: 0.3, blades }, focus_m: 2.5 };
        let five = Blades { count: 5, rotation: 0.3 };
        [Aperture::Pinhole, lens(None), lens(Some(five))]
            .map(|aperture| Camera::new(DVec3::new(1.0, 2.0, 3.0), axes, 0.4, (40, 30), aperture))
    }

    #[test]
    fn a_point_on_a_pixels_ray_is_seen_in_that_pixel() {
        for camera in cameras() {
            for (i, film) in [[0.5, 0.5], [12.25, 20.75], [39.5, 29.5]].into_iter().enumerate() {
                let lens = [0.2 + 0.3 * i as f64, 0.7];
                let ray = camera.ray(DVec2::from(film), lens);
                let sighting = camera.sight(ray.origin + ray.direction * 4.2, lens).unwrap();
                assert_eq!(sighting.pixel, film[1] as u32 * 40 + film[0] as u32);
                assert!((sighting.distance - 4.2).abs() < 1e-12);
                let seen = camera.project(camera.origin() + (ray.origin - camera.origin()) + ray.direction * 4.2);
                assert!(camera.aperture() != &Aperture::Pinhole || (seen.unwrap() - DVec2::from(film)).length() < 1e-9);
                assert!((sighting.direction + ray.direction).length() < 1e-12);
            }
            assert!(camera.sight(DVec3::new(1.0, 2.0, 4.0), [0.5; 2]).is_none(), "behind the camera");
        }
    }

    #[test]
    fn the_first_row_is_the_top_and_the_first_column_the_left() {
        let [camera, ..] = cameras();
        let direction = camera.ray(DVec2::ZERO, [0.5; 2]).direction;
        assert!(direction.x < 0.0 && direction.y > 0.0);
    }

    #[test]
    fn importance_is_the_film_area_per_solid_angle() {
        // A small square on the plane at distance 1 subtends cos³ times its area.
        for camera in cameras() {
            for film in [DVec2::new(3.0, 4.0), DVec2::new(20.0, 15.0)] {
                let lens = [0.5, 0.5];
                let ray = camera.ray(film, lens);
                let cos = ray.direction.dot(DVec3::NEG_Z);
                let sighting = camera.sight(ray.origin + ray.direction * 2.0, lens).unwrap();
                let pixel_solid_angle = camera.pixel_angle().powi(2) * cos.powi(3);
                assert!((sighting.importance * 4.0 * pixel_solid_angle - 1.0).abs() < 1e-9);
            }
        }
    }
}
