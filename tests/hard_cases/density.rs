//! Density estimation: no photon, one photon, many at one point or on a line; unbounded densities;
//! photons that must not count.

use glam::DVec3;
use serde_json::{Value, json};
use std::num::NonZero;

use abbe_session::render::Integrator;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::sum::ExactSum;
use abbe_transport::map::kernel::DiskKernel;
use abbe_transport::map::{Photon, PhotonMap, PhotonPower, WavelengthCode, radius};

use super::common::{all_y, diffuse, render};
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "No photon, one photon, 10,000 at one point, 10,000 on a line",
        naive: "a radius of 0 divides by zero; a mutable kd-tree cannot split coincident points",
        here: "the tree is immutable, and the first radius is at least a pixel",
        measured: "relative error against the sum over all photons",
        bound: Bound::AtMost(1e-5),
        pace: Pace::Fast,
        measure: few_and_many,
    },
    Case {
        name: "The first radius if the k-th photon is at distance 0 or missing",
        naive: "a radius of 0 and an infinite density",
        here: "the radius is clamped between a pixel's footprint and the largest kernel",
        measured: "radii outside these limits, of 4",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let found = [Some(0.0), None, Some(1e-30), Some(f64::INFINITY)].map(|kth| radius::first(kth, 1e-3, 3e-3));
            found.iter().filter(|&&radius| !(1e-3..=3e-3).contains(&radius)).count() as f64
        },
    },
    Case {
        name: "The fold of a caustic, whose density is unbounded: growth of the estimate",
        naive: "clamping bright pixels removes energy",
        here: "no clamp: the estimate follows the closed form as the kernel shrinks",
        measured: "relative difference between the ratio of estimates with radii 4 : 1 and 2 (the density is 1/(2√x))",
        bound: Bound::AtMost(0.02),
        pace: Pace::Fast,
        measure: || (fold().at(0.02) / fold().at(0.08) / 2.0 - 1.0).abs(),
    },
    Case {
        name: "The fold and a cusp of a caustic: the sum of all estimates",
        naive: "as above",
        here: "every kernel integrates to 1",
        measured: "relative error of the power summed over the plane",
        bound: Bound::AtMost(2e-4),
        pace: Pace::Fast,
        measure: || f64::max(fold().power_error(), cusp().power_error()),
    },
    Case {
        name: "Photons on one side of a wall 1e-6 thick, seen from the other",
        naive: "a ball around the point contains photons of both sides, so light leaks through",
        here: "photons on a surface with another normal do not count",
        measured: "largest Y of the dark side relative to the lit side",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || largest_y(&wall(-3.0)) / largest_y(&wall(3.0)),
    },
    Case {
        name: "Photons on a floor beside an unlit wall",
        naive: "photons of the floor light the foot of the wall",
        here: "photons off the tangent plane, or with another normal, do not count",
        measured: "largest Y of the wall relative to the floor",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || largest_y(&corner(true)) / largest_y(&corner(false)),
    },
    Case {
        name: "A kernel smaller than the spacing of single precision, 10⁵ m from the centre",
        naive: "photons lie on a lattice of 8 mm: the estimate is 0 between its points and huge at them, in every pass",
        here: "no kernel is smaller than 16 times the spacing",
        measured: "relative standard deviation of 200 estimates of a uniform density",
        bound: Bound::AtMost(0.05),
        pace: Pace::Fast,
        measure: far_from_the_middle,
    },
    Case {
        name: "The sum of the powers of 10⁸ photons",
        naive: "in single precision the sum stops growing at 0.17 of its value",
        here: "the sum uses 128-bit fixed point",
        measured: "relative error",
        bound: Bound::AtMost(1e-10),
        pace: Pace::Fast,
        measure: || {
            let mut sum = ExactSum::default();
            let power = std::hint::black_box(1e-8);
            (0..100_000_000_u32).for_each(|_| sum += power);
            (sum.value() - 1.0).abs()
        },
    },
];

fn photon(power: f32) -> Photon {
    let power = PhotonPower::new(WavelengthCode::default(), [f64::from(power), 0.0, 0.0, 0.0], None, 0.0);
    Photon::new(power, DVec3::Y, DVec3::Y)
}

/// Photons on the plane y = 0.
struct Plane {
    places: Vec<[f64; 2]>,
    index: PhotonMap,
    middle: [f64; 2],
}

impl Plane {
    fn new(places: Vec<[f64; 2]>, middle: [f64; 2]) -> Self {
        let photons: Vec<_> = places.iter().map(|p| (photon(1.0), [p[0] as f32, 0.0, p[1] as f32])).collect();
        Self { index: PhotonMap::build(&photons), places, middle }
    }

    fn estimate(&self, [x, z]: [f64; 2], radius: f64) -> f64 {
        let mut density = 0.0;
        self.index.within([x as f32, 0.0, z as f32], radius as f32, |found| {
            let (d2, r2) = (f64::from(found.distance2), radius * radius);
            density += f64::from(found.photon.power.powers()[0]) * DiskKernel::new(r2).at(d2).estimate;
        });
        density / self.places.len().max(1) as f64
    }

    fn exact(&self, [x, z]: [f64; 2], radius: f64) -> f64 {
        let r2 = radius * radius;
        let near = |p: &[f64; 2]| (p[0] - x).powi(2) + (p[1] - z).powi(2);
        let sum: f64 =
            self.places.iter().map(near).filter(|d2| *d2 <= r2).map(|d2| DiskKernel::new(r2).at(d2).estimate).sum();
        sum / self.places.len().max(1) as f64
    }

    fn at(&self, radius: f64) -> f64 {
        self.estimate(self.middle, radius)
    }

    /// Compares the sum of the estimates over a fine grid with the total power 1.
    fn power_error(&self) -> f64 {
        const CELLS: usize = 400;
        let cell = |i: usize| (i as f64 + 0.5) / CELLS as f64 * 4.0 - 2.0;
        let rows = (0..CELLS).flat_map(|i| (0..CELLS).map(move |j| [cell(i), cell(j)]));
        let sum: f64 = rows.map(|place| self.estimate(place, 0.1)).sum();
        (sum * (4.0 / CELLS as f64).powi(2) - 1.0).abs()
    }
}

fn few_and_many() -> f64 {
    let line: Vec<[f64; 2]> = (0..10_000).map(|i| [f64::from(i) / 10_000.0, 0.0]).collect();
    let crowds = [vec![], vec![[0.03, 0.01]], vec![[0.03, 0.01]; 10_000], line];
    let mut worst = 0.0_f64;
    for places in crowds {
        let plane = Plane::new(places, [0.0; 2]);
        let (found, truth) = (plane.at(0.1), plane.exact([0.0; 2], 0.1));
        worst = worst.max(if truth == 0.0 { found.abs() } else { (found / truth - 1.0).abs() });
        let nearest = plane.index.kth_distance([0.0; 3], NonZero::new(60).unwrap(), f32::INFINITY).map(f64::from);
        worst = worst.max(f64::from(u8::from(!radius::first(nearest, 1e-3, 1.0).is_finite())));
    }
    worst
}

/// x = a² with uniform a: the density is 1/(2√x) from the fold at x = 0 on, and uniform along z.
fn fold() -> Plane {
    let side = 700;
    let even = |i: usize| (i as f64 + 0.5) / side as f64;
    let places = (0..side * side).map(|i| [even(i % side).powi(2), 2.0 * even(i / side) - 1.0]);
    Plane::new(places.collect(), [0.0; 2])
}

/// x = a³ + a·z: two folds that meet at the origin.
fn cusp() -> Plane {
    let side = 400;
    let even = |i: usize| 2.0 * (i as f64 + 0.5) / side as f64 - 1.0;
    let places = (0..side * side).map(|i| {
        let (a, z) = (even(i % side), even(i / side));
        [0.8 * (a.powi(3) + a * z), z]
    });
    Plane::new(places.collect(), [0.0; 2])
}

fn largest_y(scene: &Value) -> f64 {
    all_y(&render(scene, Integrator::Photon, 4)).into_iter().fold(0.0, f64::max)
}

/// A thin box that a beam lights through a pane, seen from a height; positive heights are on the
/// lit side.
fn wall(height: f64) -> Value {
    json!({
        "camera": { "from": [0, height, 0.1], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 20 } } },
        "film": { "width": 12, "height": 12 },
        "materials": { "grey": diffuse(0.6), "pane": { "dielectric": { "ior": 1.5 } } },
        "objects": [
            { "shape": { "box": { "size": [4, 1e-6, 4] } }, "material": "grey" },
            { "shape": { "box": { "size": [2, 0.1, 2] } }, "material": "pane", "transform": [{ "translate": [0, 4, 0] }] }
        ],
        "lights": [{ "beam": { "from": [0, 6, 0], "to": [0, 0, 0], "radius": 0.5, "spectrum": 1, "power": 10 } }],
        "render": { "photons": 4000 }
    })
}

/// A floor lit from directly above through a pane, with a wall on it. The camera sees one of the
/// two.
fn corner(of_wall: bool) -> Value {
    let (from, at) = if of_wall { ([0.0, 0.05, 3.0], [0.0, 0.2, 0.0]) } else { ([0.0, 3.0, 0.6], [0.0, 0.0, 0.5]) };
    let mut scene = wall(3.0);
    scene["camera"] = json!({ "from": from, "at": at, "lens": { "pinhole": { "fov": 6 } } });
    scene["objects"][0] = json!({ "shape": { "rectangle": { "width": 4, "height": 4 } }, "material": "grey", "transform": [{ "translate": [0, 0, 0] }] });
    let upright = json!([{ "rotate": { "axis": [1, 0, 0], "degrees": 90 } }, { "translate": [0, 1, -0.01] }]);
    scene["objects"].as_array_mut().unwrap().push(
        json!({ "shape": { "rectangle": { "width": 4, "height": 2 } }, "material": "grey", "transform": upright }),
    );
    scene["render"]["forbid"] = json!(["indirect"]);
    scene
}

/// Returns the spread of estimates of a uniform density, 10⁵ m from the centre, with a requested
/// kernel radius of 1 mm.
fn far_from_the_middle() -> f64 {
    const FAR: f64 = 1e5;
    let mut stream = Stream::new(Seed::new(5), Purpose::FreePhoton, 0, 0);
    let mut place = |side: f64| [FAR + side * (stream.uniform() - 0.5), side * (stream.uniform() - 0.5)];
    let photons = (0..200_000).map(|_| place(1.0)).collect();
    let plane = Plane::new(photons, [FAR, 0.0]);
    let radius = radius::least(DVec3::new(FAR, 0.0, 0.0)).max(1e-3);
    let densities: Vec<f64> = (0..200).map(|_| plane.estimate(place(0.5), radius)).collect();
    let mean = densities.iter().sum::<f64>() / densities.len() as f64;
    let variance = densities.iter().map(|density| (density - mean).powi(2)).sum::<f64>() / densities.len() as f64;
    variance.sqrt() / mean
}
