//! Volumetric light maps: the precomputed transmittance between a light and the points of a medium,
//! with a map for each pair of a light and a medium.
//!
//! A map is a grid around a medium. Radiance is not interpolated, because it falls off with the
//! square of the distance and depends on the light's spectrum. Instead, each node stores the mean
//! density of each medium along the straight line from the light, which represents homogeneous fog
//! without error. For each lookup, the caller computes the distance to the light and the irradiance
//! without interpolation. The column density D is the mean density times the distance, and the
//! transmittance exp(−σ_t(λ)·D). Each node also stores whether it sees the light: if none of the
//! eight nodes around a position does, the position is very likely in shadow, and most of its
//! shadow rays can be omitted.
//!
//! Every second node belongs to a coarse lattice of half the resolution. For a smooth function, the
//! error of trilinear interpolation is of second order in the cell size, so the error of the coarse
//! lattice is four times that of the fine one, which a third of their difference estimates
//! (Richardson extrapolation).

use crate::walk::{MediumSegment, NumberedMedium, RayState, for_each_segment};
use abbe_scene::Scene;
use abbe_scene::geometry::Ray;
use abbe_scene::light::{LightConnection, VirtualLight};
use abbe_scene::medium::Medium;
use abbe_spectra::math::random::{Purpose, REPLICATES, Seed};
use abbe_spectra::math::sobol::Sobol;
use abbe_spectra::spectrum::{LANES, Lanes, Spectrum, Wavelengths};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// The maps of a pass. A light has maps only if one position or direction can represent it.
#[derive(Debug, Default)]
pub struct LightMaps<'a> {
    maps: Vec<LightMap<'a>>,
    /// The number of cells along the longest side of each medium's box.
    cells: u32,
}

#[derive(Debug)]
pub struct LightMap<'a> {
    pub light: usize,
    pub medium: usize,
    /// The position or direction that represents the light in this pass.
    pub virtual_light: VirtualLight,
    /// Transforms scene coordinates to cells of the fine lattice.
    to_cells: DAffine3,
    /// The number of cells along each axis. It is an even number.
    cells: [usize; 3],
    attenuators: Vec<Attenuator<'a>>,
    /// The mean density along the line from the light to each node, or the column density (m) if
    /// the light is at infinity. The values of all attenuators at one node are adjacent, and x
    /// varies fastest.
    means: Vec<f32>,
    /// One value per node: true if the light is visible from the node.
    visible: Vec<bool>,
}

#[derive(Debug, Clone, Copy)]
enum Attenuator<'a> {
    Medium(NumberedMedium<'a>),
    /// The absorption coefficient of a clear body, in 1/m.
    Clear(&'a Spectrum),
}

/// Trilinear interpolation: the eight nodes around a position, with their weights.
#[derive(Debug, Clone, Copy)]
struct TrilinearWeights {
    nodes: [usize; 8],
    weights: [f64; 8],
}

#[derive(Debug, Clone, Copy)]
pub struct LightMapLookup([TrilinearWeights; 2]);

/// The number of a light in the scene, and the position or direction that represents the light.
#[derive(Debug, Clone, Copy)]
struct PickedLight {
    number: usize,
    virtual_light: VirtualLight,
}

/// The number of a medium, and the transform from the unit cube to the box of the medium.
#[derive(Debug, Clone, Copy)]
struct MediumBox {
    medium: usize,
    from_unit: DAffine3,
}

impl<'a> LightMaps<'a> {
    /// Updates the maps for a pass, by the seed of the render. The longest side of each medium's
    /// box is divided into `cells` cells, rounded up to an even number. Each pass represents an
    /// extended light by another position. Maps are kept if `cells` is unchanged and all lights
    /// with maps are points or sources of parallel light.
    pub fn update(&mut self, scene: &'a Scene, cells: u32, seed: Seed, pass: u64) {
        if self.cells == cells && !self.maps.iter().any(|map| !scene.lights[map.light].is_delta()) {
            return;
        }
        let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
        let numbers = |light: usize| {
            let key = seed.streams(Purpose::LightMap).pass(replicate).part(light as u64);
            let point = Sobol::of(key).point(index as u32);
            [point[0], point[1], point[2]]
        };
        let lights = scene.lights.iter().enumerate();
        let virtual_lights = lights.filter_map(|(number, light)| {
            Some(PickedLight { number, virtual_light: light.virtual_light(scene.extent(), numbers(number))? })
        });
        // A light map contains no wavelengths that could excite a dye.
        let is_served =
            |medium: &Medium| medium.scatters() && medium.fluorophore.is_none() && medium.is_smooth_in_cells(cells);
        let media = (0..scene.media.len()).filter(|&number| is_served(&scene.media[number]));
        let boxes: Vec<MediumBox> =
            media.filter_map(|medium| Some(MediumBox { medium, from_unit: scene.box_of_medium(medium)? })).collect();
        let of_light = |light: PickedLight| boxes.iter().map(move |&place| LightMap::build(scene, light, place, cells));
        *self = Self { maps: virtual_lights.flat_map(of_light).collect(), cells };
    }

    pub fn over(&self, medium: usize) -> impl Iterator<Item = &LightMap<'a>> {
        self.maps.iter().filter(move |map| map.medium == medium)
    }

    pub fn of(&self, light: usize, medium: usize) -> Option<&LightMap<'a>> {
        self.maps.iter().find(|map| map.light == light && map.medium == medium)
    }
}

impl<'a> LightMap<'a> {
    fn build(
        scene: &'a Scene,
        light: PickedLight,
        MediumBox { medium, from_unit }: MediumBox,
        resolution: u32,
    ) -> Self {
        let axes = from_unit.matrix3;
        let sides = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
        let longest = sides.into_iter().fold(0.0, f64::max);
        let cells = sides.map(|side| 2 * ((0.5 * f64::from(resolution) * side / longest).ceil() as usize).max(1));
        let counts = DVec3::from_array(cells.map(|count| count as f64));
        let from_cells = from_unit * DAffine3::from_scale(counts.recip());
        let attenuators = attenuators(scene);
        let node_count = cells.iter().map(|count| count + 1).product();
        let mut map = Self {
            light: light.number,
            medium,
            virtual_light: light.virtual_light,
            to_cells: from_cells.inverse(),
            cells,
            means: vec![0.0; node_count * attenuators.len()],
            attenuators,
            visible: vec![false; node_count],
        };
        let [x, y] = [cells[0] + 1, cells[1] + 1];
        let position = |node: usize| {
            let along = [node % x, node / x % y, node / (x * y)];
            from_cells.transform_point3(DVec3::from_array(along.map(|along| along as f64)))
        };
        let (attenuators, means) = (&map.attenuators, &mut map.means);
        let nodes = means.par_chunks_mut(attenuators.len()).zip(&mut map.visible).enumerate();
        nodes.for_each(|(node, (means, visible))| {
            *visible = trace_to_node(scene, &light, position(node), attenuators, means);
        });
        map.remove_absent_attenuators();
        map
    }

    /// Keeps only the attenuators that lie between the light and at least one node.
    fn remove_absent_attenuators(&mut self) {
        let count = self.attenuators.len();
        let present: Vec<bool> =
            (0..count).map(|i| self.means.iter().skip(i).step_by(count).any(|&mean| mean > 0.0)).collect();
        let kept = |index: &usize| present[index % count];
        self.means = (0..self.means.len()).filter(kept).map(|index| self.means[index]).collect();
        self.attenuators = (0..count).filter(kept).map(|index| self.attenuators[index]).collect();
    }

    /// Looks up a position. Positions outside the grid are clamped to the grid.
    pub fn lookup(&self, position: DVec3) -> LightMapLookup {
        let in_cells = self.to_cells.transform_point3(position);
        LightMapLookup([1, 2].map(|step| self.trilinear_weights(in_cells, step)))
    }

    /// Returns the interpolation at a position in fine cells, from every `step`-th node.
    fn trilinear_weights(&self, in_cells: DVec3, step: usize) -> TrilinearWeights {
        let (mut nodes, mut weights) = ([0; 8], [1.0; 8]);
        let mut stride = 1;
        for axis in 0..3 {
            let last = self.cells[axis] / step;
            let position = (in_cells[axis] / step as f64).clamp(0.0, last as f64);
            let cell = (position as usize).min(last - 1);
            let fraction = position - cell as f64;
            for corner in 0..8 {
                let upper = corner >> axis & 1;
                nodes[corner] += (cell + upper) * step * stride;
                weights[corner] *= if upper == 1 { fraction } else { 1.0 - fraction };
            }
            stride *= self.cells[axis] + 1;
        }
        TrilinearWeights { nodes, weights }
    }

    /// Returns true if any node around the position sees the light.
    pub fn may_be_lit(&self, lookup: &LightMapLookup) -> bool {
        lookup.0[0].nodes.iter().any(|&node| self.visible[node])
    }

    /// Returns the extinction coefficients (1/m) of each attenuator, for [`Self::optical_depths`].
    pub fn coefficients(&self, wavelengths: &Wavelengths) -> impl Iterator<Item = Lanes> {
        self.attenuators.iter().map(|attenuator| wavelengths.each(|nm| attenuator.coefficient(nm)))
    }

    /// Returns the optical depths between the light and the position, from the fine and from the
    /// coarse lattice. `distance` (m) is infinite for a light at infinity.
    pub fn optical_depths(&self, lookup: &LightMapLookup, distance: f64, coefficients: &[Lanes]) -> [Lanes; 2] {
        lookup.0.map(|weights| {
            let mut depths = [0.0; LANES];
            for (attenuator, coefficients) in coefficients.iter().enumerate() {
                let column = self.column_m(&weights, attenuator, distance);
                (0..LANES).for_each(|k| depths[k] += coefficients[k] * column);
            }
            depths
        })
    }

    /// Returns the column density (m) of an attenuator.
    fn column_m(&self, interpolation: &TrilinearWeights, attenuator: usize, distance: f64) -> f64 {
        let TrilinearWeights { nodes, weights } = interpolation;
        let count = self.attenuators.len();
        let mean: f64 = (0..8).map(|i| weights[i] * f64::from(self.means[nodes[i] * count + attenuator])).sum();
        if distance.is_finite() { mean * distance } else { mean }
    }
}

impl Attenuator<'_> {
    /// Returns the extinction or absorption coefficient in 1/m.
    fn coefficient(&self, nm: f64) -> f64 {
        match self {
            Attenuator::Medium(filling) => filling.medium.extinction.at(nm),
            Attenuator::Clear(absorption) => absorption.at(nm),
        }
    }

    /// Returns the column density (m) along a segment, 0 if the attenuator does not fill it.
    fn column_m(&self, segment: &MediumSegment<'_>) -> f64 {
        match self {
            Attenuator::Medium(filling) if segment.medium.is_some_and(|other| other.number == filling.number) => {
                filling.medium.column_m(&segment.ray, segment.length_m)
            }
            Attenuator::Clear(absorption)
                if segment.absorption.is_some_and(|other| std::ptr::eq(other, *absorption)) =>
            {
                segment.length_m
            }
            Attenuator::Medium(_) | Attenuator::Clear(_) => 0.0,
        }
    }

    /// Returns the relative density at a position inside the attenuator.
    fn density_at(&self, position: DVec3) -> f64 {
        match self {
            Attenuator::Medium(filling) => filling.medium.density_at(position),
            Attenuator::Clear(_) => 1.0,
        }
    }
}

fn attenuators(scene: &Scene) -> Vec<Attenuator<'_>> {
    let bodies = || scene.materials.iter().filter_map(|material| material.body.as_ref());
    let fills = |number: &usize| bodies().any(|body| body.medium == Some(*number));
    let numbered = |number| NumberedMedium { number, medium: &scene.media[number] };
    let media = (0..scene.media.len()).filter(fills).map(|number| Attenuator::Medium(numbered(number)));
    media.chain(bodies().filter_map(|body| body.absorption.as_ref().map(Attenuator::Clear))).collect()
}

/// Computes the mean density of each attenuator between the light and a node, or the column density
/// for a light at infinity. Returns whether the node sees the light.
///
/// The function follows the line from the light, where the medium stack is known. Surfaces do not
/// interrupt it, so the stored densities vary smoothly even behind surfaces.
fn trace_to_node(
    scene: &Scene,
    light: &PickedLight,
    node: DVec3,
    attenuators: &[Attenuator<'_>],
    means: &mut [f32],
) -> bool {
    let LightConnection { direction, distance, target } = light.virtual_light.connection_from(node);
    if distance <= 0.0 {
        means.iter_mut().zip(attenuators).for_each(|(mean, attenuator)| *mean = attenuator.density_at(node) as f32);
        return false;
    }
    let outside = 2.0 * (scene.radius_m.max(scene.boundaries.radius_m()) + node.length());
    let (ray, length) = light.virtual_light.ray_to(node, outside);
    let medium_stack = scene.medium_stack_of_emission(&scene.lights[light.number], ray, target);
    let ray_state = RayState { ray, from: target, medium_stack };
    let per_length = if distance.is_finite() { 1.0 / distance } else { 1.0 };
    let _end = for_each_segment(scene, ray_state, length, &mut |segment| {
        for (mean, attenuator) in means.iter_mut().zip(attenuators) {
            *mean += (attenuator.column_m(segment) * per_length) as f32;
        }
        ControlFlow::Continue(())
    });
    !scene.geometry.occluded(&Ray::new(node, direction), None, target, distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_format::{self as format, resolve::resolve};
    use abbe_spectra::math::sobol::Sobol;

    /// Returns a ball of smoke that fades outwards, and a light beside it, half behind a wall.
    fn scene(light: &str) -> Scene {
        let text = format!(
            r#"{{
  "camera": {{"from": [0, 0, 5], "at": [0, 0, 0], "lens": {{"pinhole": {{"fov": 40}}}}}},
  "film": {{"width": 8, "height": 8}},
  "media": {{"smoke": {{"grid": {{"bounds": [[-1, -1, -1], [1, 1, 1]], "absorption": 0, "scattering": 3, "phase": "isotropic",
    "density": {{"sphere": {{"value": 1, "center": [0.1, 0, 0], "radius": 0.9, "falloff": 1}}}}}}}}}},
  "materials": {{"smoke": {{"boundary": {{"medium": "smoke"}}}}, "black": "absorber"}},
  "objects": [{{"shape": {{"box": {{"size": [2, 2, 2]}}}}, "material": "smoke"}},
    {{"shape": {{"rectangle": {{"width": 1, "height": 4}}}}, "material": "black",
      "transform": [{{"rotate": {{"axis": [0, 0, 1], "degrees": 90}}}}, {{"translate": [1.5, -0.5, 0]}}]}}],
  "lights": [{light}]
}}"#
        );
        let (written, source) = format::parse(&text, "smoke.json".as_ref(), &[]).unwrap();
        resolve(&written, &source).unwrap()
    }

    const POINT: &str = r#"{"point": {"at": [2.5, 0.3, 0.2], "spectrum": "E", "power": 1}}"#;
    const SUN: &str = r#"{"directional": {"toward": [-1, 0.1, 0.2], "spectrum": "E", "irradiance": 1}}"#;

    fn places() -> impl Iterator<Item = DVec3> {
        let sobol = Sobol::new(5);
        (0..4096).map(move |i| 2.0 * DVec3::new(sobol.at(i, 0), sobol.at(i, 1), sobol.at(i, 2)) - 1.0)
    }

    /// Returns the mean absolute error of the transmittance, and its estimate by the map.
    fn transmittance_errors(scene: &Scene, cells: u32) -> [f64; 2] {
        let mut maps = LightMaps::default();
        maps.update(scene, cells, Seed::new(0), 0);
        let (map, medium) = (maps.of(0, 0).unwrap(), &scene.media[0]);
        let sigma: Vec<Lanes> = map.coefficients(&Wavelengths::single(550.0)).collect();
        let (mut error, mut estimated, mut count) = (0.0, 0.0, 0.0);
        for place in places() {
            let way = map.virtual_light.connection_from(place);
            let truth = (-3.0 * medium.column_m(&Ray::new(place, way.direction), way.distance.min(10.0))).exp();
            let [fine, coarse] =
                map.optical_depths(&map.lookup(place), way.distance, &sigma).map(|depths| (-depths[0]).exp());
            error += (fine - truth).abs();
            estimated += ((coarse - fine) / 3.0).abs();
            count += 1.0;
        }
        [error / count, estimated / count]
    }

    /// The error is of second order in the cell size, and the two lattices estimate it.
    #[test]
    fn map_error_is_second_order_and_estimated() {
        for (name, light) in [("point", POINT), ("sun", SUN)] {
            let scene = scene(light);
            let errors = [8, 16, 32].map(|cells| transmittance_errors(&scene, cells));
            for (pair, cells) in errors.windows(2).zip([16, 32]) {
                let order = (pair[0][0] / pair[1][0]).log2();
                println!(
                    "{name}, {cells} cells: error {:.2e}, estimated {:.2e}, order {order:.2}",
                    pair[1][0], pair[1][1]
                );
                assert!((1.7..2.3).contains(&order), "order {order}");
                assert!((0.5..2.0).contains(&(pair[1][1] / pair[1][0])), "estimated {:e}", pair[1][1]);
            }
        }
    }

    #[test]
    fn positions_between_dark_nodes_are_nearly_all_dark() {
        let scene = scene(POINT);
        let mut maps = LightMaps::default();
        maps.update(&scene, 32, Seed::new(0), 0);
        let map = maps.of(0, 0).unwrap();
        let (mut dark, mut lit_in_the_dark, mut dark_in_the_light) = (0, 0, 0);
        for place in places() {
            let LightConnection { direction, distance, .. } = map.virtual_light.connection_from(place);
            let hidden = scene.geometry.occluded(&Ray::new(place, direction), None, None, distance);
            if map.may_be_lit(&map.lookup(place)) {
                dark_in_the_light += u32::from(hidden);
            } else {
                dark += 1;
                lit_in_the_dark += u32::from(!hidden);
            }
        }
        println!("{dark} dark, {lit_in_the_dark} of them lit; {dark_in_the_light} dark beside lit nodes");
        assert!(dark > 400 && lit_in_the_dark < 8 && dark_in_the_light < 200);
    }

    /// Maps of lights without extent are kept until the resolution changes. All others are rebuilt.
    #[test]
    fn maps_of_point_lights_last_until_cells_change() {
        let still = scene(POINT);
        let mut maps = LightMaps::default();
        maps.update(&still, 8, Seed::new(0), 0);
        let first = maps.maps[0].means.as_ptr();
        maps.update(&still, 8, Seed::new(0), 1);
        assert_eq!(maps.maps[0].means.as_ptr(), first);
        maps.update(&still, 10, Seed::new(0), 2);
        assert_eq!(maps.maps[0].cells, [10; 3]);
        let wide = scene(
            r#"{"directional": {"toward": [-1, 0, 0], "angular_diameter": 5, "spectrum": "E", "irradiance": 1}}"#,
        );
        let direction = |maps: &LightMaps<'_>| maps.maps[0].virtual_light.connection_from(DVec3::ZERO).direction;
        let mut maps = LightMaps::default();
        maps.update(&wide, 8, Seed::new(0), 0);
        let before = direction(&maps);
        maps.update(&wide, 8, Seed::new(0), 1);
        assert_ne!(direction(&maps), before);
    }
}
