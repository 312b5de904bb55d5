//! A camera lens of real glass: rays from the sensor go through every surface as their wavelength is refracted there.
//!
//! Lens coordinates are those of [`crate::optics::lens`]: the first surface's vertex is the origin and stands where the camera stands, z points
//! towards the sensor, x to the picture's right and y up, in mm. Rays start on the sensor towards the last vertex's plane, over
//! the part of it through which light gets to that place of the sensor (Kolb, Mitchell & Hanrahan 1995; exit-pupil bounds after Steinert et al. 2011).

use crate::error::{Error, Result};
use crate::optics::aperture::Blades;
use crate::optics::glass::lines;
use crate::optics::lens::{Lens, Limits, Monochromatic, Ray, Travel};
use glam::DVec2;
use std::f64::consts::PI;

/// Places along the sensor's radius at which the exit pupil's bounds are known.
const RADII: usize = 48;

/// Rays a side of the grid that finds the bounds.
const BOUNDS_GRID: usize = 48;

/// Rays a side of the grid that measures the pupil on the axis.
const AXIS_GRID: usize = 512;

/// How far the grids reach, in semi-apertures of the last surface: oblique rays meet its vertex's plane beside its edge.
const REACH: f64 = 1.5;

/// The wavelengths in nm whose rays bound the pupil: dispersion moves it a little.
const BOUNDING_NM: [f64; 3] = [400.0, lines::D_NM, 760.0];

/// A lens, and the sensor behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct SystemLens {
    lens: Lens,
    /// Distance of the sensor from the last vertex, in mm.
    sensor_mm: f64,
    /// Distance in m of the plane in focus at the d line from the first vertex.
    focus_m: f64,
    /// Focal length in mm and the entrance pupil's radius in mm, both at the d line.
    focal_mm: f64,
    pupil_mm: f64,
    /// The farthest place of the sensor from the axis, in mm.
    sensor_radius_mm: f64,
    /// Bounds of the light on the last vertex's plane for places at equal steps of the sensor's radius (which lie on +x); `None` in the dark.
    pupils: Vec<Option<[DVec2; 2]>>,
    /// ∫ cos⁴θ/z² dA over the exit pupil for the sensor's middle at the d line: what makes a pixel there read the radiance it sees.
    on_axis: f64,
    /// The same of the lens without blades.
    on_axis_round: f64,
}

/// A lens and its sensor at one wavelength.
#[derive(Debug, Clone)]
pub struct SystemAt<'a> {
    system: &'a SystemLens,
    glass: Monochromatic<'a>,
}

impl SystemLens {
    /// A lens focused at a distance (m, from the first vertex), over a sensor whose corners are `sensor_radius_mm` from the axis.
    ///
    /// # Errors
    /// A focus that the lens cannot reach, and a lens that lets no light through.
    pub fn new(lens: Lens, focus_m: f64, sensor_radius_mm: f64) -> Result<Self> {
        let at_d = lens.at(lines::D_NM);
        let sensor_mm = at_d.image_distance_mm(1e3 * focus_m)?;
        let paraxial = at_d.paraxial()?;
        let focal_mm = paraxial.efl_mm;
        let pupil_mm = paraxial.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
        let pupils = Vec::new();
        let (on_axis, on_axis_round) = (0.0, 0.0);
        let mut system =
            Self { lens, sensor_mm, focus_m, focal_mm, pupil_mm, sensor_radius_mm, pupils, on_axis, on_axis_round };
        if sensor_mm <= 0.0 {
            let error = Error::input("the sensor would stand inside the lens");
            return Err(error.expected("a lens whose image lies behind its last surface"));
        }
        system.on_axis = system.measure_axis();
        if system.on_axis <= 0.0 {
            return Err(Error::input("no light gets through the lens").expected("apertures that leave a way"));
        }
        let radius = |i: usize| sensor_radius_mm * i as f64 / (RADII - 1) as f64;
        // Blades are not the same all around: the bounds are those of the circle around them.
        let round = Self { lens: system.lens.clone().with_blades(None), ..system.clone() };
        let bounds: Vec<_> = (0..RADII).map(|i| round.bounds(radius(i))).collect();
        system.pupils = bounds.windows(2).map(|pair| union(pair[0], pair[1])).collect();
        system.on_axis_round = if system.blades().is_some() { round.measure_axis() } else { system.on_axis };
        Ok(system)
    }

    /// The plane in focus at the d line, in m from the first vertex.
    pub fn focus_m(&self) -> f64 {
        self.focus_m
    }

    /// The entrance pupil's radius in m.
    pub fn pupil_radius_m(&self) -> f64 {
        1e-3 * self.pupil_mm
    }

    /// The blades of its stop, if it has any.
    pub fn blades(&self) -> Option<Blades> {
        self.lens.blades()
    }

    /// The f-number on the sensor's middle at this focus, by the light that gets there at the d line: 1/(2 sin θ) of the cone that the circle
    /// around the stop lets through.
    pub fn working_f_number(&self) -> f64 {
        0.5 * (PI / self.on_axis_round).sqrt()
    }

    /// What the lens is called.
    pub fn name(&self) -> &str {
        self.lens.name()
    }

    /// The distance in mm from the rear principal plane to the sensor: a picture's height over it is twice the tangent of half the field of view.
    pub fn image_mm(&self) -> f64 {
        let focus_mm = 1e3 * self.focus_m;
        if focus_mm.is_finite() { self.focal_mm * focus_mm / (focus_mm - self.focal_mm) } else { self.focal_mm }
    }

    /// The lens as a wavelength (nm) sees it: its indices are looked up once, for any number of rays.
    pub fn at(&self, nm: f64) -> SystemAt<'_> {
        SystemAt { system: self, glass: self.lens.at(nm) }
    }

    /// The ray from a place of the sensor towards a place of the last vertex's plane, and cos⁴θ/z².
    fn towards(&self, place: DVec2, pupil: DVec2) -> (Ray, f64) {
        let behind = self.lens.length_mm();
        let origin = place.extend(behind + self.sensor_mm);
        let direction = (pupil.extend(behind) - origin).normalize();
        (Ray { origin, direction }, direction.z.powi(4) / (self.sensor_mm * self.sensor_mm))
    }

    /// Half the side of the square on the last vertex's plane that rays are tried in.
    fn reach_mm(&self) -> f64 {
        REACH * self.lens.surfaces()[self.lens.surfaces().len() - 1].semi_aperture_mm
    }

    fn measure_axis(&self) -> f64 {
        let (at_d, reach) = (self.lens.at(lines::D_NM), self.reach_mm());
        let cell = 2.0 * reach / AXIS_GRID as f64;
        let share = |pupil: DVec2| {
            let (ray, geometry) = self.towards(DVec2::ZERO, pupil);
            let passes = at_d.trace(ray, Travel::ToScene, Limits::Apertures).is_ok();
            if passes { geometry * cell * cell } else { 0.0 }
        };
        grid(AXIS_GRID, reach).map(share).sum()
    }

    /// The bounds of the light on the last vertex's plane for a place on +x, a cell of the grid wider on every side.
    fn bounds(&self, radius_mm: f64) -> Option<[DVec2; 2]> {
        let reach = self.reach_mm();
        let margin = DVec2::splat(2.0 * reach / BOUNDS_GRID as f64);
        let colours = BOUNDING_NM.map(|nm| self.lens.at(nm));
        let passes = |pupil: &DVec2| {
            let (ray, _) = self.towards(DVec2::new(radius_mm, 0.0), *pupil);
            colours.iter().any(|lens| lens.trace(ray, Travel::ToScene, Limits::Apertures).is_ok())
        };
        let boxes = grid(BOUNDS_GRID, reach).filter(passes).map(|pupil| Some([pupil - margin, pupil + margin]));
        boxes.fold(None, union)
    }
}

impl SystemAt<'_> {
    /// The lens at all wavelengths.
    pub fn system(&self) -> &SystemLens {
        self.system
    }

    /// The ray into the scene from a place of the picture (mm on the sensor, to the right and up as the picture is seen) through the place of
    /// the exit pupil that `u` draws; and its weight, such that the mean over `u` of weight × radiance is what the pixel reads. `None`
    /// where the lens lets nothing through.
    pub fn ray(&self, picture_mm: DVec2, u: [f64; 2]) -> Option<(Ray, f64)> {
        let system = self.system;
        // The image stands on its head.
        let place = -picture_mm;
        let radius = place.length();
        let step = radius / system.sensor_radius_mm * system.pupils.len() as f64;
        let [least, most] = system.pupils[(step as usize).min(system.pupils.len() - 1)]?;
        let size = most - least;
        let along = if radius > 0.0 { place / radius } else { DVec2::X };
        let pupil = along.rotate(least + size * DVec2::from(u));
        let (ray, geometry) = system.towards(place, pupil);
        let out = self.glass.trace(ray, Travel::ToScene, Limits::Apertures).ok()?;
        Some((out, size.x * size.y * geometry / system.on_axis))
    }
}

/// The middles of the cells of a square grid of `side` cells a side that reaches from −reach to +reach.
fn grid(side: usize, reach: f64) -> impl Iterator<Item = DVec2> {
    let place = move |i: usize| reach * (2.0 * (i as f64 + 0.5) / side as f64 - 1.0);
    (0..side).flat_map(move |j| (0..side).map(move |i| DVec2::new(place(i), place(j))))
}

fn union(a: Option<[DVec2; 2]>, b: Option<[DVec2; 2]>) -> Option<[DVec2; 2]> {
    match (a, b) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        (some, None) | (None, some) => some,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::Sobol;
    use crate::optics::lens::catalogue;

    fn mean_weight(system: &SystemLens, place: DVec2, nm: f64) -> f64 {
        let (sobol, lens) = (Sobol::new(5), system.at(nm));
        let n = 1 << 14;
        let weight = |i| lens.ray(place, [sobol.at(i, 0), sobol.at(i, 1)]).map_or(0.0, |(_, weight)| weight);
        (0..n).map(weight).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn the_middle_of_a_uniform_wall_reads_its_radiance_and_the_corners_less() {
        for name in ["double gauss", "tessar", "cooke triplet"] {
            let system = SystemLens::new(catalogue::find(name).unwrap().clone(), 3.0, 21.6).unwrap();
            let middle = mean_weight(&system, DVec2::ZERO, lines::D_NM);
            assert!((middle - 1.0).abs() < 2e-3, "{name}: {middle}");
            let off = mean_weight(&system, DVec2::new(9.0, 12.0), lines::D_NM);
            assert!(off < middle && off > 0.05, "{name}: {off}");
            let blades = Some(Blades { count: 5, rotation: 0.3 });
            let lens = catalogue::find(name).unwrap().clone().with_blades(blades);
            let bladed = SystemLens::new(lens, 3.0, 21.6).unwrap();
            let middle = mean_weight(&bladed, DVec2::ZERO, lines::D_NM);
            assert!((middle - 1.0).abs() < 2e-3, "{name} with blades: {middle}");
            let ratio = bladed.working_f_number() / system.working_f_number();
            assert!((ratio - 1.0).abs() < 2e-3, "{name}: {ratio}");
        }
    }

    #[test]
    fn rays_of_the_d_line_from_one_place_of_the_sensor_meet_in_the_plane_in_focus() {
        let system = SystemLens::new(catalogue::find("double gauss").unwrap().clone(), 3.0, 21.6).unwrap();
        let at_d = system.at(lines::D_NM);
        let at_focus = |u| at_d.ray(DVec2::new(2.0, 0.0), u).map(|(ray, _)| ray.at_z(-3000.0));
        let middle = at_focus([0.5, 0.5]).unwrap();
        assert!(middle.x > 0.0, "right in the picture is right in the scene: {middle}");
        for u in [[0.4, 0.5], [0.5, 0.62], [0.6, 0.45]] {
            // The lens is not free of aberrations; a pinhole's rays would be mm apart.
            assert!((at_focus(u).unwrap() - middle).length() < 0.5, "{u:?}");
        }
    }

    #[test]
    fn a_focus_too_near_is_refused() {
        let lens = catalogue::find("double gauss").unwrap().clone();
        assert!(SystemLens::new(lens, 0.01, 21.6).is_err());
    }
}
