//! Volumetric light maps: a grid around a medium, one map a light, that knows at each node what the light went through to get there.
//!
//! What is kept is the smoothest thing that says it all: not radiance, which falls off with the square of the distance and has the lamp's
//! colour, but the mean density along the straight way from the lamp, for each medium on it; fog that is the same everywhere is then kept
//! without error. The way itself and the irradiance at its end are worked out anew wherever the map is asked, and the transmittance
//! exp(−σ_t(λ)·D) follows at any wavelength. Beside it each node knows whether the lamp shines there. Where none of the eight nodes around a place
//! sees it the place is very likely dark, and to look from there is mostly in vain.
//!
//! Every other node makes a lattice of half the resolution. Between nodes the error of what is smooth is of second order in the cell's size, so
//! that a third of the difference between the two lattices estimates that of the finer one.

use crate::math::random::{Purpose, REPLICATES, hash64};
use crate::math::sobol::Sobol;
use crate::scene::Scene;
use crate::scene::geometry::Ray;
use crate::scene::light::{Pick, WayTo};
use crate::scene::medium::Medium;
use crate::spectrum::{LANES, Lanes, Spectrum, Wavelengths};
use crate::walk::{Start, Stretch, stretches};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// The maps of a pass: of each light that one place stands for, in each medium that scatters.
#[derive(Debug, Default)]
pub struct LightMaps<'a> {
    maps: Vec<LightMap<'a>>,
    /// Cells along the longest side of each medium's box.
    cells: u32,
}

/// One light's map over one medium.
#[derive(Debug)]
pub struct LightMap<'a> {
    /// The light's number.
    pub light: usize,
    /// The medium's number.
    pub medium: usize,
    /// The light's place in this pass.
    pub pick: Pick,
    /// From the scene to cells of the lattice.
    to_cells: DAffine3,
    /// Cells along each axis; even.
    cells: [usize; 3],
    /// What may be on the way.
    matters: Vec<Matter<'a>>,
    /// For each node, x fastest, and each matter the mean density along the way (of light from infinity the column density in m).
    means: Vec<f32>,
    /// For each node whether the light shines there.
    lit: Vec<bool>,
}

/// What weakens light on its way.
#[derive(Debug, Clone, Copy)]
enum Matter<'a> {
    /// A medium, by its number.
    Medium(usize, &'a Medium),
    /// A clear body's absorption.
    Clear(&'a Spectrum),
}

/// A place between the nodes of a lattice: the eight around it, with their weights.
#[derive(Debug, Clone, Copy)]
struct Between {
    nodes: [usize; 8],
    weights: [f64; 8],
}

/// A place looked up in both lattices, the fine one first.
#[derive(Debug, Clone, Copy)]
pub struct Look([Between; 2]);

impl<'a> LightMaps<'a> {
    /// Makes the maps of a pass with so many cells (rounded up to even numbers) along the longest side of each medium's box; those of another
    /// pass of the same scene stay as they are where nothing in them changes. Of a light with extent each pass sees another place.
    pub fn renew(&mut self, scene: &'a Scene, cells: u32, (seed, pass): (u64, u64)) {
        if self.cells == cells && !self.maps.iter().any(|map| scene.lights[map.light].can_be_hit()) {
            return;
        }
        let (replicate, index) = (pass % REPLICATES as u64, pass / REPLICATES as u64);
        let numbers = |light: usize| {
            let key = hash64([seed, Purpose::LightMap as u64, replicate, light as u64]);
            let point = Sobol::new(key).point(index as u32);
            [point[0], point[1], point[2]]
        };
        let lights = scene.lights.iter().enumerate();
        let picks = lights.filter_map(|(number, light)| Some((number, light.pick(scene.world(), numbers(number))?)));
        let is_served = |medium: &Medium| medium.scatters() && medium.is_smooth_in_cells(cells);
        let media = (0..scene.media.len()).filter(|&number| is_served(&scene.media[number]));
        let placed: Vec<_> = media.filter_map(|number| Some((number, scene.box_of_medium(number)?))).collect();
        let of_light =
            |pick: (usize, Pick)| placed.iter().map(move |&place| LightMap::build(scene, pick, place, cells));
        *self = Self { maps: picks.flat_map(of_light).collect(), cells };
    }

    /// The maps of lights over a medium.
    pub fn over(&self, medium: usize) -> impl Iterator<Item = &LightMap<'a>> {
        self.maps.iter().filter(move |map| map.medium == medium)
    }

    /// The map of a light over a medium.
    pub fn of(&self, light: usize, medium: usize) -> Option<&LightMap<'a>> {
        self.maps.iter().find(|map| map.light == light && map.medium == medium)
    }
}

impl<'a> LightMap<'a> {
    fn build(
        scene: &'a Scene,
        (light, pick): (usize, Pick),
        (medium, from_unit): (usize, DAffine3),
        resolution: u32,
    ) -> Self {
        let axes = from_unit.matrix3;
        let sides = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
        let longest = sides.into_iter().fold(0.0, f64::max);
        let cells = sides.map(|side| 2 * ((0.5 * f64::from(resolution) * side / longest).ceil() as usize).max(1));
        let counts = DVec3::from_array(cells.map(|count| count as f64));
        let from_cells = from_unit * DAffine3::from_scale(counts.recip());
        let matters = matters(scene);
        let node_count = cells.iter().map(|count| count + 1).product();
        let mut map = Self {
            light,
            medium,
            pick,
            to_cells: from_cells.inverse(),
            cells,
            means: vec![0.0; node_count * matters.len()],
            matters,
            lit: vec![false; node_count],
        };
        let [x, y] = [cells[0] + 1, cells[1] + 1];
        let place = |node: usize| {
            let along = [node % x, node / x % y, node / (x * y)];
            from_cells.transform_point3(DVec3::from_array(along.map(|along| along as f64)))
        };
        let (matters, means) = (&map.matters, &mut map.means);
        let nodes = means.par_chunks_mut(matters.len()).zip(&mut map.lit).enumerate();
        nodes.for_each(|(node, (means, lit))| *lit = light_up(scene, (light, &pick), place(node), (matters, means)));
        map.forget_absent();
        map
    }

    /// Drops what is on no node's way.
    fn forget_absent(&mut self) {
        let count = self.matters.len();
        let present: Vec<bool> =
            (0..count).map(|matter| self.means.iter().skip(matter).step_by(count).any(|&mean| mean > 0.0)).collect();
        let kept = |index: &usize| present[index % count];
        self.means = (0..self.means.len()).filter(kept).map(|index| self.means[index]).collect();
        self.matters = (0..count).filter(kept).map(|index| self.matters[index]).collect();
    }

    /// Looks a place up; places outside the grid count as the nearest inside.
    pub fn look(&self, place: DVec3) -> Look {
        let along = self.to_cells.transform_point3(place);
        Look([1, 2].map(|step| self.between(along, step)))
    }

    /// Between which of every `step`th node a place lies.
    fn between(&self, along: DVec3, step: usize) -> Between {
        let (mut nodes, mut weights) = ([0; 8], [1.0; 8]);
        let mut stride = 1;
        for axis in 0..3 {
            let last = self.cells[axis] / step;
            let place = (along[axis] / step as f64).clamp(0.0, last as f64);
            let cell = (place as usize).min(last - 1);
            let share = place - cell as f64;
            for corner in 0..8 {
                let upper = corner >> axis & 1;
                nodes[corner] += (cell + upper) * step * stride;
                weights[corner] *= if upper == 1 { share } else { 1.0 - share };
            }
            stride *= self.cells[axis] + 1;
        }
        Between { nodes, weights }
    }

    /// Whether any of the nodes around a place sees the light.
    pub fn may_see(&self, look: &Look) -> bool {
        look.0[0].nodes.iter().any(|&node| self.lit[node])
    }

    /// What weakens light of these wavelengths: coefficients in 1/m for each matter, to be handed to [`Self::depths`].
    pub fn coefficients(&self, wavelengths: &Wavelengths) -> impl Iterator<Item = Lanes> {
        self.matters.iter().map(|matter| wavelengths.each(|nm| matter.coefficient(nm)))
    }

    /// The optical depths, by both lattices, of the way from the light to the place, which is `distance` long.
    pub fn depths(&self, look: &Look, distance: f64, coefficients: &[Lanes]) -> [Lanes; 2] {
        look.0.map(|between| {
            let mut depths = [0.0; LANES];
            for (matter, coefficients) in coefficients.iter().enumerate() {
                let column = self.column(&between, matter, distance);
                (0..LANES).for_each(|k| depths[k] += coefficients[k] * column);
            }
            depths
        })
    }

    /// The column density in m.
    fn column(&self, Between { nodes, weights }: &Between, matter: usize, distance: f64) -> f64 {
        let count = self.matters.len();
        let mean: f64 = (0..8).map(|i| weights[i] * f64::from(self.means[nodes[i] * count + matter])).sum();
        if distance.is_finite() { mean * distance } else { mean }
    }
}

impl Matter<'_> {
    fn coefficient(&self, nm: f64) -> f64 {
        match self {
            Matter::Medium(_, medium) => medium.extinction.at(nm),
            Matter::Clear(absorption) => absorption.at(nm),
        }
    }

    /// The column density of a stretch of it in m; 0 of a stretch of something else.
    fn column_m(&self, stretch: &Stretch<'_>) -> f64 {
        match self {
            Matter::Medium(number, medium) if stretch.medium.is_some_and(|(other, _)| other == *number) => {
                medium.column_m(&stretch.ray, stretch.length_m)
            }
            Matter::Clear(absorption) if stretch.absorption.is_some_and(|other| std::ptr::eq(other, *absorption)) => {
                stretch.length_m
            }
            Matter::Medium(..) | Matter::Clear(_) => 0.0,
        }
    }

    /// The density at a place, if the matter is there.
    fn density_at(&self, place: DVec3) -> f64 {
        match self {
            Matter::Medium(_, medium) => medium.density_at(place),
            Matter::Clear(_) => 1.0,
        }
    }
}

/// All that weakens light anywhere in a scene.
fn matters(scene: &Scene) -> Vec<Matter<'_>> {
    let bodies = || scene.materials.iter().filter_map(|material| material.body.as_ref());
    let fills = |number: &usize| bodies().any(|body| body.medium == Some(*number));
    let media = (0..scene.media.len()).filter(fills).map(|number| Matter::Medium(number, &scene.media[number]));
    media.chain(bodies().filter_map(|body| body.absorption.as_ref().map(Matter::Clear))).collect()
}

/// Finds the mean density of each matter along the light's way to a node, and whether the light shines on the node. What is on the way is
/// followed from the light, for around it the bodies are known; surfaces do not end it, so that what is kept goes on smoothly behind them.
fn light_up(
    scene: &Scene,
    (light, pick): (usize, &Pick),
    node: DVec3,
    (matters, means): (&[Matter<'_>], &mut [f32]),
) -> bool {
    let WayTo { direction, distance, target } = pick.way_from(node);
    if distance <= 0.0 {
        means.iter_mut().zip(matters).for_each(|(mean, matter)| *mean = matter.density_at(node) as f32);
        return false;
    }
    let outside = 2.0 * (scene.radius_m.max(scene.boundaries.radius_m()) + node.length());
    let (ray, length) = pick.ray_to(node, outside);
    let start = Start { ray, from: target, interior: scene.lights[light].interior };
    let per_length = if distance.is_finite() { 1.0 / distance } else { 1.0 };
    let _end = stretches(scene, start, length, &mut |stretch| {
        for (mean, matter) in means.iter_mut().zip(matters) {
            *mean += (matter.column_m(stretch) * per_length) as f32;
        }
        ControlFlow::Continue(())
    });
    !scene.geometry.occluded(&Ray::new(node, direction), None, target, distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::sobol::Sobol;
    use crate::scene::{file, resolve::resolve};

    /// A ball of smoke that fades towards its surface, beside it a lamp, and between them half a wall.
    fn scene(lamp: &str) -> Scene {
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
  "lights": [{lamp}]
}}"#
        );
        let (written, source) = file::parse(&text, "smoke.json".as_ref(), &[]).unwrap();
        resolve(&written, &source).unwrap()
    }

    const POINT: &str = r#"{"point": {"at": [2.5, 0.3, 0.2], "spectrum": "E", "power": 1}}"#;
    const SUN: &str = r#"{"directional": {"toward": [-1, 0.1, 0.2], "spectrum": "E", "irradiance": 1}}"#;

    fn places() -> impl Iterator<Item = DVec3> {
        let sobol = Sobol::new(5);
        (0..4096).map(move |i| 2.0 * DVec3::new(sobol.at(i, 0), sobol.at(i, 1), sobol.at(i, 2)) - 1.0)
    }

    /// Mean |error| of the transmittance from the lamp by a map of so many cells, and the mean of what the map takes it for.
    fn transmittance_errors(scene: &Scene, cells: u32) -> [f64; 2] {
        let mut maps = LightMaps::default();
        maps.renew(scene, cells, (0, 0));
        let (map, medium) = (maps.of(0, 0).unwrap(), &scene.media[0]);
        let sigma: Vec<Lanes> = map.coefficients(&Wavelengths::single(550.0)).collect();
        let (mut off, mut told, mut count) = (0.0, 0.0, 0.0);
        for place in places() {
            let way = map.pick.way_from(place);
            let truth = (-3.0 * medium.column_m(&Ray::new(place, way.direction), way.distance.min(10.0))).exp();
            let [fine, coarse] = map.depths(&map.look(place), way.distance, &sigma).map(|depths| (-depths[0]).exp());
            off += (fine - truth).abs();
            told += ((coarse - fine) / 3.0).abs();
            count += 1.0;
        }
        [off / count, told / count]
    }

    #[test]
    fn what_a_map_lacks_falls_with_the_square_of_its_cells_and_is_told_by_halving_them() {
        for (name, lamp) in [("point", POINT), ("sun", SUN)] {
            let scene = scene(lamp);
            let errors = [8, 16, 32].map(|cells| transmittance_errors(&scene, cells));
            for (pair, cells) in errors.windows(2).zip([16, 32]) {
                let order = (pair[0][0] / pair[1][0]).log2();
                println!("{name}, {cells} cells: off by {:.2e}, told {:.2e}, order {order:.2}", pair[1][0], pair[1][1]);
                assert!((1.7..2.3).contains(&order), "order {order}");
                assert!((0.5..2.0).contains(&(pair[1][1] / pair[1][0])), "told {:e}", pair[1][1]);
            }
        }
    }

    #[test]
    fn where_no_node_sees_the_lamp_nearly_all_places_are_dark() {
        let scene = scene(POINT);
        let mut maps = LightMaps::default();
        maps.renew(&scene, 32, (0, 0));
        let map = maps.of(0, 0).unwrap();
        let (mut dark, mut lit_in_the_dark, mut dark_in_the_light) = (0, 0, 0);
        for place in places() {
            let WayTo { direction, distance, .. } = map.pick.way_from(place);
            let hidden = scene.geometry.occluded(&Ray::new(place, direction), None, None, distance);
            if map.may_see(&map.look(place)) {
                dark_in_the_light += u32::from(hidden);
            } else {
                dark += 1;
                lit_in_the_dark += u32::from(!hidden);
            }
        }
        println!("{dark} dark, {lit_in_the_dark} of them lit; {dark_in_the_light} dark beside lit nodes");
        assert!(dark > 400 && lit_in_the_dark < 8 && dark_in_the_light < 200);
    }

    #[test]
    fn maps_of_lamps_without_extent_last_until_their_cells_change() {
        let still = scene(POINT);
        let mut maps = LightMaps::default();
        maps.renew(&still, 8, (0, 0));
        let first = maps.maps[0].means.as_ptr();
        maps.renew(&still, 8, (0, 1));
        assert_eq!(maps.maps[0].means.as_ptr(), first);
        maps.renew(&still, 10, (0, 2));
        assert_eq!(maps.maps[0].cells, [10; 3]);
        let wide = scene(
            r#"{"directional": {"toward": [-1, 0, 0], "angular_diameter": 5, "spectrum": "E", "irradiance": 1}}"#,
        );
        let direction = |maps: &LightMaps<'_>| maps.maps[0].pick.way_from(DVec3::ZERO).direction;
        let mut maps = LightMaps::default();
        maps.renew(&wide, 8, (0, 0));
        let before = direction(&maps);
        maps.renew(&wide, 8, (0, 1));
        assert_ne!(direction(&maps), before);
    }
}
