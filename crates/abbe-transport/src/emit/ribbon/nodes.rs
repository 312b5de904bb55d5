//! The nodes of a ribbon, and its pixels.

use super::chain::{Chain, Fan, Landing, Role};
use super::film_line::for_each_pixel;
use super::spectrum::EmittedPower;
use crate::emit::connect::PhotonConnector;
use crate::emit::launch::Launch;
use abbe_scene::light::Light;
use abbe_spectra::math::random::Stream;
use abbe_spectra::spectrum::BAND_NM;
use glam::DVec2;

/// Nodes between three others lie on the parabola through these if their positions differ from it by
/// at most this many pixels, and their radiance by at most this fraction. The nodes then become those
/// of two parabolas, so the error of what is painted is about an eighth of that.
const LARGEST_DEVIATION_PIXELS: f64 = 0.1;
const LARGEST_DEVIATION_RADIANCE: f64 = 0.04;

/// A part of the spectrum is halved at most this often, about in the middle.
const LARGEST_HALVINGS: u32 = 4;

/// The largest distance, in pixels, of a parabola from the lines that are painted instead.
const FLATNESS_PIXELS: f64 = 0.02;

/// The largest number of lines of a parabola.
const LARGEST_LINES: f64 = 16.0;

/// The range of the place of a node between two others.
const MIDDLE: (f64, f64) = (0.4, 0.6);

/// The largest width (nm) of the parts of a pixel's spectrum that have one wavelength.
const LARGEST_CELL_NM: f64 = 4.0;

/// Cells of equal width that divide the band, without cells across the edges of spectral bands.
#[derive(Debug, Clone, Copy)]
struct Cells {
    width_nm: f64,
    aligned: bool,
}

impl Cells {
    fn new(bands: usize) -> Self {
        let band_nm = (BAND_NM.1 - BAND_NM.0) / bands.max(1) as f64;
        Self { width_nm: band_nm / (band_nm / LARGEST_CELL_NM).ceil(), aligned: bands > 0 }
    }

    /// Returns the lower end of the cell whose upper end is `nm`, or which contains it.
    fn next_below(self, nm: f64) -> f64 {
        if !self.aligned {
            return nm - self.width_nm;
        }
        let cell = ((nm - BAND_NM.0) / self.width_nm).ceil() - 1.0;
        (BAND_NM.0 + cell * self.width_nm).min(nm.next_down())
    }
}

/// A wavelength of a ribbon. Nodes are ordered by 1/λ², of which refractive indices are nearly
/// linear functions.
#[derive(Debug, Clone, Copy)]
struct Node {
    /// 1/λ², in 1/nm².
    s: f64,
    landing: Option<Landing>,
}

/// The numbers of events of ribbons.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RibbonTally {
    pub ribbons: u64,
    pub nodes: u64,
    /// The pixels of all lines.
    pub pixels: u64,
}

/// Paints ribbons.
#[derive(Debug)]
pub struct RibbonPainter<'a> {
    chain: Chain<'a>,
    size: DVec2,
    /// True if the film has spectral bands, which also see the ends of the spectrum.
    has_bands: bool,
    cells: Cells,
    tally: RibbonTally,
    /// The parts of the spectrum, as pairs of 1/λ², that are sampled at a random wavelength.
    sampled: Vec<(f64, f64)>,
}

/// One ribbon: its light and what it paints into.
struct Ribbon<'r, 'a, P> {
    painter: &'r mut RibbonPainter<'a>,
    fan: Fan<'a>,
    light: &'r Light,
    power: &'r EmittedPower,
    stream: Stream,
    paint: P,
}

impl<'a> RibbonPainter<'a> {
    /// Takes the number of spectral bands of the film, which may be 0.
    pub fn new(connector: PhotonConnector<'a>, bands: usize) -> Self {
        let size = connector.scene.camera.film_size();
        let (chain, tally) = (Chain::new(connector), RibbonTally::default());
        Self { chain, size, has_bands: bands > 0, cells: Cells::new(bands), tally, sampled: Vec::new() }
    }

    /// Paints the ribbon of an emission. Calls `paint` with the number of a pixel, a wavelength (nm)
    /// and a radiance (W/m²/sr).
    pub fn paint(&mut self, launch: &Launch, power: &EmittedPower, paint: impl FnMut(u32, f64, f64)) {
        let light = &self.chain.scene().lights[launch.light];
        let Some(fan) = self.chain.start(launch) else { return };
        self.tally.ribbons += 1;
        let support = power.support_nm(launch.spd);
        let (from_nm, to_nm) = if self.has_bands { support } else { power.visible_nm() };
        // The invisible ends of the spectrum are hardly worth a node.
        self.sampled.clear();
        self.sampled.extend([(0.0, to_nm.powi(-2)), (from_nm.powi(-2), f64::INFINITY)]);
        let stream = launch.streams.path(1);
        let mut ribbon = Ribbon { painter: self, fan, light, power, stream, paint };
        let [from, to] = [to_nm, from_nm].map(|nm| nm.powi(-2));
        let place = ribbon.place();
        let middle = ribbon.node(from + (to - from) * place, Role::Reference);
        let [a, b] = [from, to].map(|s| ribbon.node(s, Role::Follower));
        ribbon.refine([a, middle, b], 0);
        ribbon.sample();
    }

    pub fn tally(&self) -> RibbonTally {
        self.tally
    }
}

impl<P: FnMut(u32, f64, f64)> Ribbon<'_, '_, P> {
    fn node(&mut self, s: f64, role: Role) -> Node {
        self.painter.tally.nodes += 1;
        Node { s, landing: self.painter.chain.land(&self.fan, nm_at(s), role) }
    }

    fn place(&mut self) -> f64 {
        MIDDLE.0 + (MIDDLE.1 - MIDDLE.0) * self.stream.uniform()
    }

    fn node_between(&mut self, a: Node, b: Node) -> Node {
        let place = self.place();
        self.node(a.s + (b.s - a.s) * place, Role::Follower)
    }

    /// Paints the part of the spectrum between the first and the last of three nodes where it lies
    /// on parabolas, and collects the other parts.
    fn refine(&mut self, [a, middle, b]: [Node; 3], halvings: u32) {
        let edges = [b, a].map(|node| self.power.edge(nm_at(node.s)));
        if self.power.between(self.light, self.fan.launch.spd, edges).power <= 0.0 {
            return;
        }
        if [a, middle, b].iter().all(|node| node.landing.is_none()) {
            self.painter.sampled.push((a.s, b.s));
            return;
        }
        let halves = [[a, middle], [middle, b]].map(|[from, to]| [from, self.node_between(from, to), to]);
        if let Some(whole) = Parabola::through([a, middle, b])
            && let [Some(first), Some(second)] = halves.map(Parabola::through)
            && whole.contains(&halves[0][1])
            && whole.contains(&halves[1][1])
        {
            self.paint_parabola(&first);
            self.paint_parabola(&second);
            return;
        }
        let camera = &self.painter.chain.scene().camera;
        let is_visible = |node: &Node| node.landing.is_some_and(|landing| camera.pixel_at(landing.film).is_some());
        if halvings == LARGEST_HALVINGS || !halves.iter().flatten().any(is_visible) {
            self.painter.sampled.push((a.s, b.s));
            return;
        }
        for half in halves {
            self.refine(half, halvings + 1);
        }
    }

    fn paint_parabola(&mut self, parabola: &Parabola) {
        let lines = (parabola.sagitta() / FLATNESS_PIXELS).sqrt().ceil().clamp(1.0, LARGEST_LINES);
        let mut from = parabola.at(0.0);
        for line in 1..=lines as u32 {
            let to = parabola.at(f64::from(line) / lines);
            self.paint_line(from, to);
            from = to;
        }
    }

    /// Paints the line between two points of a parabola.
    fn paint_line(&mut self, a: Point, b: Point) {
        let Self { painter, fan, light, power, paint, .. } = self;
        let (spd, cells, pixels) = (fan.launch.spd, painter.cells, &mut painter.tally.pixels);
        let per_s = (b.radiance - a.radiance) / (b.s - a.s);
        let mut upper = power.edge(nm_at(a.s));
        for_each_pixel(a.film, b.film, painter.size, |pixel, from, to| {
            *pixels += 1;
            let start = nm_at(a.s + (b.s - a.s) * from);
            // The pixels follow each other, unless the line enters the film.
            if (upper.nm - start).abs() > f64::EPSILON * start {
                upper = power.edge(start);
            }
            let end = nm_at(a.s + (b.s - a.s) * to);
            while upper.nm > end {
                let lower = power.edge(cells.next_below(upper.nm).max(end));
                let piece = power.between(light, spd, [lower, upper]);
                if piece.power > 0.0 {
                    let radiance = a.radiance + per_s * (piece.nm.powi(-2) - a.s);
                    paint(pixel, piece.nm, radiance.max(0.0) * piece.power);
                }
                upper = lower;
            }
        });
    }

    /// Samples one wavelength, and paints its point if it is in one of the collected parts.
    fn sample(&mut self) {
        let (nm, pdf) = self.light.photon_wavelengths().sample(self.stream.uniform());
        let s = nm.powi(-2);
        if !self.painter.sampled.iter().any(|&(from, to)| s >= from && s < to) {
            return;
        }
        let Some(landing) = self.node(s, Role::Follower).landing else { return };
        let Some(pixel) = self.painter.chain.scene().camera.pixel_at(landing.film) else { return };
        let radiance = landing.radiance * self.light.spd_at(self.fan.launch.spd, nm) / pdf;
        (self.paint)(pixel, nm, radiance);
    }
}

fn nm_at(s: f64) -> f64 {
    s.sqrt().recip()
}

/// A point of a ribbon.
#[derive(Debug, Clone, Copy)]
struct Point {
    s: f64,
    film: DVec2,
    radiance: f64,
}

impl Point {
    fn combined(points: [&Self; 3], weights: [f64; 3]) -> Self {
        let mut sum = Self { s: 0.0, film: DVec2::ZERO, radiance: 0.0 };
        for (point, weight) in points.into_iter().zip(weights) {
            sum.s += weight * point.s;
            sum.film += weight * point.film;
            sum.radiance += weight * point.radiance;
        }
        sum
    }
}

/// A part of a ribbon behind one sequence of surfaces: quadratic functions of s = 1/λ² through three
/// nodes.
struct Parabola {
    nodes: [Point; 3],
    sequence: u64,
}

impl Parabola {
    /// Returns `None` if the nodes do not land behind the same sequence of surfaces.
    fn through(nodes: [Node; 3]) -> Option<Self> {
        let [a, middle, b] = nodes.map(|node| node.landing);
        let (a, middle, b) = (a?, middle?, b?);
        let sequence = middle.sequence;
        let is_one = a.sequence == sequence && b.sequence == sequence;
        let point = |node: Node, landing: Landing| Point { s: node.s, film: landing.film, radiance: landing.radiance };
        let nodes = [point(nodes[0], a), point(nodes[1], middle), point(nodes[2], b)];
        is_one.then_some(Self { nodes, sequence })
    }

    /// Returns the point at a place from 0, at the first node, to 1, at the last (Lagrange's
    /// interpolation).
    fn at(&self, place: f64) -> Point {
        let [a, middle, b] = &self.nodes;
        let m = (middle.s - a.s) / (b.s - a.s);
        let of_middle = place * (1.0 - place) / (m * (1.0 - m));
        let weights = [(1.0 - place) * (m - place) / m, of_middle, place * (place - m) / (1.0 - m)];
        Point { s: a.s + (b.s - a.s) * place, ..Point::combined([a, middle, b], weights) }
    }

    /// Returns the distance in pixels of the curve from its chord, about in the middle.
    fn sagitta(&self) -> f64 {
        let [a, middle, b] = &self.nodes;
        let m = (middle.s - a.s) / (b.s - a.s);
        (a.film + (b.film - a.film) * m).distance(middle.film) * 0.25 / (m * (1.0 - m))
    }

    /// Returns true if a node lies on the parabola, within the limits.
    fn contains(&self, node: &Node) -> bool {
        let Some(landing) = node.landing else { return false };
        let [a, _, b] = &self.nodes;
        let expected = self.at((node.s - a.s) / (b.s - a.s));
        landing.sequence == self.sequence
            && landing.film.distance(expected.film) <= LARGEST_DEVIATION_PIXELS
            && (landing.radiance - expected.radiance).abs() <= LARGEST_DEVIATION_RADIANCE * landing.radiance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::WavelengthCode;
    use crate::plan::MediumPlan;
    use crate::walk::{RayDensity, RayState};
    use abbe_format::{self as format, resolve::resolve};
    use abbe_scene::geometry::Ray;
    use abbe_scene::light::EmittedSpd;
    use abbe_scene::medium_stack::MediumStack;
    use abbe_spectra::math::random::{Purpose, Seed};
    use glam::DVec3;

    const PRISM: &str = r#"{
  "camera": {"from": [0.3, -0.1, 0.4], "at": [0.7, -0.35, 0], "lens": {"pinhole": {"fov": 40}}},
  "film": {"width": 64, "height": 64},
  "materials": {"flint": {"dielectric": {"ior": "N-SF11"}}, "white": {"diffuse": {"reflectance": 0.8}}},
  "objects": [
    {"shape": {"prism": {"side": 0.3, "length": 0.3, "apex": 60}}, "material": "flint"},
    {"shape": {"rectangle": {"width": 1, "height": 1}}, "material": "white",
     "transform": [{"rotate": {"axis": [0, 0, 1], "degrees": 61}}, {"translate": [0.7, -0.39, 0]}]}
  ],
  "lights": [{"beam": {"from": [-0.83, -0.447, 0], "to": [-0.075, 0.043, 0], "radius": 0.01, "power": 1, "spectrum": "E"}}]
}"#;

    /// Two ribbons of one emission, with different random numbers, have different nodes. Their
    /// light differs only by the probability of refraction, which the middle node decides.
    #[test]
    fn ribbons_of_one_emission_have_other_nodes_and_the_same_light() {
        let (written, source) = format::parse(PRISM, "prism.json".as_ref(), &[]).unwrap();
        let scene = resolve(&written, &source).unwrap();
        let connector =
            PhotonConnector { scene: &scene, media_plan: MediumPlan::Clear, polarised: false, photons_per_sample: 1.0 };
        let power = EmittedPower::of(&scene.lights[0], scene.film.observer).unwrap();
        let from = DVec3::new(-0.83, -0.447, 0.0) - scene.centre;
        let ray = Ray::new(from, DVec3::new(0.755, 0.49, 0.0).normalize());
        let light_of = |number: u64| {
            let launch = Launch {
                light: 0,
                spd: EmittedSpd::Own,
                flux_w: 1.0,
                ray_state: RayState { ray, from: None, medium_stack: MediumStack::AIR },
                ray_density: RayDensity::NONE,
                wavelength_code: WavelengthCode::default(),
                streams: Seed::new(number).streams(Purpose::FreePhoton).pass(0),
                hero_nm: 550.0,
            };
            let mut light = Vec::new();
            // The ends of the spectrum are sampled.
            let mut paint = |nm: f64, radiance: f64| {
                if nm > 420.0 && nm < 660.0 {
                    light.push(radiance);
                }
            };
            RibbonPainter::new(connector, 0).paint(&launch, &power, |_, nm, radiance| paint(nm, radiance));
            light
        };
        // Most ribbons pass both faces of the prism.
        let painted: Vec<Vec<f64>> = (0..12).map(light_of).filter(|light| light.len() > 10).collect();
        let sums: Vec<f64> = painted.iter().map(|light| light.iter().sum()).collect();
        assert!(sums.len() > 6, "{sums:?}");
        for (light, sum) in painted.iter().zip(&sums).skip(1) {
            assert!((sum / sums[0] - 1.0).abs() < 0.05, "{sums:?}");
            assert_ne!(light, &painted[0]);
        }
    }
}
