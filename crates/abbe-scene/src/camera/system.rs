//! A camera lens of real glass, through which each ray is traced with the refractive indices at its
//! wavelength.
//!
//! Lens coordinates are in mm, as in [`abbe_optics::lens`]. The origin and the camera's position
//! are the vertex of the first surface. The z axis points towards the sensor, the x axis to the
//! right of the picture, and the y axis up. Rays start on the sensor and are aimed at the part of
//! the plane of the last vertex through which light reaches the sensor position (Kolb, Mitchell &
//! Hanrahan 1995; exit-pupil bounds after Steinert et al. 2011).

use abbe_optics::aperture::Blades;
use abbe_optics::glass::lines;
use abbe_optics::lens::{ApertureCheck, GhostPair, Lens, LensRay, LensSurface, MonochromaticLens, TraceDirection};
use abbe_spectra::error::{Error, Result};
use glam::DVec2;
use std::f64::consts::PI;

/// The number of sensor positions along a radius at which the exit-pupil bounds are computed.
const RADII: usize = 48;

/// The number of rays along each side of the square grid that finds the exit-pupil bounds.
const BOUNDS_GRID: usize = 48;

/// The number of rays along each side of the square grid that measures the exit pupil on the axis.
const AXIS_GRID: usize = 512;

/// Half the side length of both grids, divided by the semi-aperture of the last surface. It exceeds
/// 1 because oblique rays cross the plane of the last vertex outside the semi-aperture.
const GRID_EXTENT: f64 = 1.5;

/// The wavelengths (nm) for the exit-pupil bounds: several, because dispersion moves the pupil.
const BOUNDING_NM: [f64; 3] = [400.0, lines::D_NM, 760.0];

/// What happens to the light that the surfaces of a lens reflect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LensReflections {
    Absent,
    Lost,
    /// Light that two surfaces reflect reaches the sensor as ghosts; other reflected light is lost.
    Ghosts,
}

/// A lens and the sensor behind it.
#[derive(Debug, Clone, PartialEq)]
pub struct SystemLens {
    lens: Lens,
    /// In mm, between the last vertex and the sensor.
    sensor_mm: f64,
    /// In m, from the first vertex to the plane in focus at the wavelength of the d line.
    focus_m: f64,
    /// In mm, at the wavelength of the d line.
    focal_mm: f64,
    /// The radius in mm of the entrance pupil at the wavelength of the d line.
    pupil_mm: f64,
    /// The largest distance of a sensor position from the axis, in mm.
    sensor_radius_mm: f64,
    /// The bounds of the exit pupil on the plane of the last vertex, for equal intervals of sensor
    /// positions on the positive x axis. `None` if no light reaches the interval.
    pupils: Vec<Option<[DVec2; 2]>>,
    /// The integral ∫ cos⁴θ/z² dA over the exit pupil, for the middle of the sensor and the
    /// wavelength of the d line. The weights of all rays are divided by it, so that the middle of
    /// the picture of a uniform scene has exactly the scene's radiance.
    on_axis: f64,
    /// `on_axis` of the same lens without blades.
    on_axis_round: f64,
    reflections: LensReflections,
    /// The ghosts that rays sample.
    ghosts: Vec<GhostPair>,
    /// The least and the largest sag in mm of the last surface within its semi-aperture.
    last_sag_mm: [f64; 2],
}

/// A lens system at one wavelength.
#[derive(Debug, Clone)]
pub struct SystemAt<'a> {
    system: &'a SystemLens,
    glass: MonochromaticLens<'a>,
}

impl SystemLens {
    /// Creates a lens system that is focused at `focus_m` (in m) from the first vertex.
    /// `sensor_radius_mm` is the distance of the sensor's corners from the axis. Returns an error
    /// if the lens cannot focus at the distance, the sensor would be inside the lens, or no light
    /// passes through the lens.
    pub fn new(lens: Lens, focus_m: f64, sensor_radius_mm: f64) -> Result<Self> {
        let at_d = lens.at(lines::D_NM);
        let sensor_mm = at_d.image_distance_mm(1e3 * focus_m)?;
        let paraxial = at_d.paraxial()?;
        let focal_mm = paraxial.efl_mm;
        let pupil_mm = paraxial.entrance_pupil.map_or(0.0, |pupil| 0.5 * pupil.diameter_mm);
        let mut system = Self {
            lens,
            sensor_mm,
            focus_m,
            focal_mm,
            pupil_mm,
            sensor_radius_mm,
            pupils: Vec::new(),
            on_axis: 0.0,
            on_axis_round: 0.0,
            reflections: LensReflections::Absent,
            ghosts: Vec::new(),
            last_sag_mm: [0.0; 2],
        };
        if sensor_mm <= 0.0 {
            let error = Error::input("the sensor would be inside the lens");
            return Err(error.expected("a lens with its image behind the last surface"));
        }
        system.on_axis = system.measure_axis();
        if system.on_axis <= 0.0 {
            return Err(Error::input("no light passes through the lens").expected("apertures with a common opening"));
        }
        let radius = |i: usize| sensor_radius_mm * i as f64 / (RADII - 1) as f64;
        // The exit pupil of a polygonal stop depends on the direction of the sensor position, so
        // the bounds are those of the polygon's circumcircle.
        let round = Self { lens: system.lens.clone().with_blades(None), ..system.clone() };
        let bounds: Vec<_> = (0..RADII).map(|i| round.bounds(radius(i))).collect();
        system.pupils = bounds.windows(2).map(|pair| union(pair[0], pair[1])).collect();
        system.on_axis_round = if system.blades().is_some() { round.measure_axis() } else { system.on_axis };
        Ok(system)
    }

    #[must_use]
    pub fn with_reflections(mut self, reflections: LensReflections) -> Self {
        self.reflections = reflections;
        self.ghosts = if reflections == LensReflections::Ghosts { self.lens.ghost_pairs() } else { Vec::new() };
        let LensSurface { profile, semi_aperture_mm, .. } = self.last_surface();
        let sag_mm = (0..=64).map(|i| profile.sag_mm((f64::from(i) / 64.0 * semi_aperture_mm).powi(2)));
        self.last_sag_mm = sag_mm.fold([0.0; 2], |[least, most], sag: f64| [least.min(sag), most.max(sag)]);
        self
    }

    /// Removes all ghosts, so that reflected light is lost.
    pub fn remove_ghosts(&mut self) {
        if self.reflections == LensReflections::Ghosts {
            *self = self.clone().with_reflections(LensReflections::Lost);
        }
    }

    pub fn remove_coatings(&mut self) {
        if self.is_coated() {
            self.lens.remove_coatings();
            *self = self.clone().with_reflections(self.reflections);
        }
    }

    pub fn has_ghosts(&self) -> bool {
        !self.ghosts.is_empty()
    }

    pub fn is_coated(&self) -> bool {
        self.lens.is_coated()
    }

    /// The distance in m from the first vertex to the plane in focus at the d line.
    pub fn focus_m(&self) -> f64 {
        self.focus_m
    }

    /// The radius in m of the surface at which rays leave the lens.
    pub fn front_radius_m(&self) -> f64 {
        1e-3 * self.lens.surfaces().first().map_or(0.0, |surface| surface.semi_aperture_mm)
    }

    pub fn pupil_radius_m(&self) -> f64 {
        1e-3 * self.pupil_mm
    }

    pub fn blades(&self) -> Option<Blades> {
        self.lens.blades()
    }

    /// The working f-number 1/(2 sin θ) at the focus distance, for the middle of the sensor and the
    /// wavelength of the d line. θ is the half-angle of the cone in which the light through the
    /// circle around the aperture stop converges to the middle of the sensor.
    pub fn working_f_number(&self) -> f64 {
        0.5 * (PI / self.on_axis_round).sqrt()
    }

    pub fn name(&self) -> &str {
        self.lens.name()
    }

    /// The image distance in mm, by the thin-lens equation. The sensor height divided by it is
    /// twice the tangent of half the vertical field of view.
    pub fn image_mm(&self) -> f64 {
        let focus_mm = 1e3 * self.focus_m;
        if focus_mm.is_finite() { self.focal_mm * focus_mm / (focus_mm - self.focal_mm) } else { self.focal_mm }
    }

    /// The lens system at a wavelength in nm, with its refractive indices computed once.
    pub fn at(&self, nm: f64) -> SystemAt<'_> {
        SystemAt { system: self, glass: self.lens.at(nm) }
    }

    /// Returns the ray from a sensor position towards a pupil point, and its cos⁴θ/z².
    fn ray_to_pupil(&self, place: DVec2, pupil: DVec2) -> (LensRay, f64) {
        let behind = self.lens.length_mm();
        let origin = place.extend(behind + self.sensor_mm);
        let direction = (pupil.extend(behind) - origin).normalize();
        (LensRay { origin, direction }, direction.z.powi(4) / (self.sensor_mm * self.sensor_mm))
    }

    /// Half the side length in mm of both grids of rays on the plane of the last vertex.
    fn grid_extent_mm(&self) -> f64 {
        GRID_EXTENT * self.last_surface().semi_aperture_mm
    }

    fn last_surface(&self) -> &LensSurface {
        &self.lens.surfaces()[self.lens.surfaces().len() - 1]
    }

    /// Bounds, on the plane of the last vertex, the rays through the aperture of the last surface.
    fn bounds_of_last_surface(&self, place: DVec2) -> [DVec2; 2] {
        // A line from the position through a point of the surface crosses the plane at position +
        // k·(point − position), where k depends on the sag of the point.
        let half_extent = DVec2::splat(self.last_surface().semi_aperture_mm);
        let [low, high] = self.last_sag_mm.map(|sag_mm| {
            let k = self.sensor_mm / (self.sensor_mm - sag_mm);
            [place * (1.0 - k) - half_extent * k, place * (1.0 - k) + half_extent * k]
        });
        [low[0].min(high[0]), low[1].max(high[1])]
    }

    fn measure_axis(&self) -> f64 {
        let (at_d, half_extent) = (self.lens.at(lines::D_NM), self.grid_extent_mm());
        let cell = 2.0 * half_extent / AXIS_GRID as f64;
        let cos4_term = |pupil: DVec2| {
            let (ray, geometry) = self.ray_to_pupil(DVec2::ZERO, pupil);
            let passes = at_d.trace(ray, TraceDirection::ToScene, ApertureCheck::Enforced).is_ok();
            if passes { geometry * cell * cell } else { 0.0 }
        };
        grid(AXIS_GRID, half_extent).map(cos4_term).sum()
    }

    /// The bounds of the exit pupil on the plane of the last vertex, with a margin of one grid
    /// cell, for a sensor position on the positive x axis at `radius_mm` from the optical axis.
    fn bounds(&self, radius_mm: f64) -> Option<[DVec2; 2]> {
        let half_extent = self.grid_extent_mm();
        let margin = DVec2::splat(2.0 * half_extent / BOUNDS_GRID as f64);
        let colours = BOUNDING_NM.map(|nm| self.lens.at(nm));
        let passes = |pupil: &DVec2| {
            let (ray, _) = self.ray_to_pupil(DVec2::new(radius_mm, 0.0), *pupil);
            colours.iter().any(|lens| lens.trace(ray, TraceDirection::ToScene, ApertureCheck::Enforced).is_ok())
        };
        let boxes = grid(BOUNDS_GRID, half_extent).filter(passes).map(|pupil| Some([pupil - margin, pupil + margin]));
        boxes.fold(None, union)
    }
}

impl SystemAt<'_> {
    pub fn system(&self) -> &SystemLens {
        self.system
    }

    /// The ray from a position of the picture (mm to the right and upwards) into the scene, and its
    /// weight, or `None` if the lens blocks it. The random numbers `u` sample the exit pupil. The
    /// mean of weight × radiance over all `u` is the value of a pixel, and the weight contains the
    /// transmittance of all surfaces if the lens has losses.
    pub fn ray(&self, picture_mm: DVec2, u: [f64; 2]) -> Option<(LensRay, f64)> {
        let system = self.system;
        // The image on the sensor is upside down.
        let place = -picture_mm;
        let radius = place.length();
        let step = radius / system.sensor_radius_mm * system.pupils.len() as f64;
        let [least, most] = system.pupils[(step as usize).min(system.pupils.len() - 1)]?;
        let size = most - least;
        let along = if radius > 0.0 { place / radius } else { DVec2::X };
        let pupil = along.rotate(least + size * DVec2::from(u));
        let (ray, geometry) = system.ray_to_pupil(place, pupil);
        let (out, transmitted) = match system.reflections {
            LensReflections::Absent => {
                (self.glass.trace(ray, TraceDirection::ToScene, ApertureCheck::Enforced).ok()?, 1.0)
            }
            LensReflections::Lost | LensReflections::Ghosts => self.glass.trace_with_losses(ray, None).ok()?,
        };
        Some((out, size.x * size.y * geometry / system.on_axis * transmitted))
    }

    /// The ray of a ghost from a position of the picture into the scene, and its weight, with the
    /// arguments of [`ray`](Self::ray); `None` if the lens blocks the ray or has no ghosts. The
    /// number `choice` in [0, 1) selects the two surfaces that reflect. Light of a ghost may reach
    /// the sensor from every part of the last surface, so `u` samples a rectangle around it. The
    /// ghosts add the mean of weight × radiance over all `u` and `choice` to the value of a pixel.
    pub fn ghost_ray(&self, picture_mm: DVec2, u: [f64; 2], mut choice: f64) -> Option<(LensRay, f64)> {
        let system = self.system;
        let found = system.ghosts.iter().find(|pair| {
            choice -= pair.probability;
            choice < 0.0
        });
        let pair = found.or(system.ghosts.last())?;
        let [least, most] = system.bounds_of_last_surface(-picture_mm);
        let size = most - least;
        let (ray, geometry) = system.ray_to_pupil(-picture_mm, least + size * DVec2::from(u));
        let (out, fraction) = self.glass.trace_with_losses(ray, Some(pair.surfaces)).ok()?;
        Some((out, size.x * size.y * geometry / system.on_axis * fraction / pair.probability))
    }
}

/// The cell centres of a grid of `side` × `side` cells from −`extent` to +`extent`.
fn grid(side: usize, extent: f64) -> impl Iterator<Item = DVec2> {
    let place = move |i: usize| extent * (2.0 * (i as f64 + 0.5) / side as f64 - 1.0);
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
    use abbe_optics::lens::catalogue;
    use abbe_spectra::math::sobol::Sobol;

    fn mean_weight(system: &SystemLens, place: DVec2, nm: f64) -> f64 {
        let (sobol, lens) = (Sobol::new(5), system.at(nm));
        let n = 1 << 14;
        let weight = |i| lens.ray(place, [sobol.at(i, 0), sobol.at(i, 1)]).map_or(0.0, |(_, weight)| weight);
        (0..n).map(weight).sum::<f64>() / f64::from(n)
    }

    #[test]
    fn a_uniform_wall_has_its_radiance_in_the_middle_only() {
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
    fn rays_of_the_d_line_meet_in_the_plane_in_focus() {
        let system = SystemLens::new(catalogue::find("double gauss").unwrap().clone(), 3.0, 21.6).unwrap();
        let at_d = system.at(lines::D_NM);
        let at_focus = |u| at_d.ray(DVec2::new(2.0, 0.0), u).map(|(ray, _)| ray.at_z(-3000.0));
        let middle = at_focus([0.5, 0.5]).unwrap();
        assert!(middle.x > 0.0, "right in the picture is right in the scene: {middle}");
        for u in [[0.4, 0.5], [0.5, 0.62], [0.6, 0.45]] {
            // The tolerance allows for the aberrations of the lens.
            assert!((at_focus(u).unwrap() - middle).length() < 0.5, "{u:?}");
        }
    }

    #[test]
    fn a_focus_that_is_too_near_is_an_error() {
        let lens = catalogue::find("double gauss").unwrap().clone();
        assert!(SystemLens::new(lens, 0.01, 21.6).is_err());
    }
}
