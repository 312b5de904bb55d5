//! Refraction: limits of Fresnel's and Snell's formulas, paths through nested bodies, coincident
//! faces, and trapped light.

use std::sync::LazyLock;

use glam::DVec3;
use serde_json::{Value, json};

use abbe_optics::fresnel;
use abbe_session::render::Integrator;
use abbe_transport::walk::ledger::Ledger;

use super::common::{diffuse, glass, render};
use super::golden::golden;
use super::paths::{Body, NamedBody, wrong_sides, wrong_sides_at_coincident_faces};
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "Reflectance at 0° to 89.9999999°, n₁ = n₂ ± 1e-12, n = 1 + 1e-9, n = 4",
        naive: "(n₁c₁ − n₂c₂)/(n₁c₁ + n₂c₂) loses all digits if n₁ ≈ n₂",
        here: "(n₂ − n₁)(n₂ + n₁)/(n₁c₁ + n₂c₂)² subtracts only inputs",
        measured: "relative error against 50 digits",
        bound: Bound::AtMost(2e-14),
        pace: Pace::Fast,
        measure: || worst("interfaces", |row| (row.reflectance() / row.r - 1.0).abs()),
    },
    Case {
        name: "Transmittance at 0° to 89.9999999°",
        naive: "rounding makes R > 1 and T negative",
        here: "T = 1 − R with R clamped to 1",
        measured: "error against 50 digits",
        bound: Bound::AtMost(1e-15),
        pace: Pace::Fast,
        measure: || worst("interfaces", |row| ((1.0 - row.reflectance()) - (1.0 - row.r)).abs()),
    },
    Case {
        name: "Reflectance within 8 ulp of the critical angle",
        naive: "square root of a negative number",
        here: "one function decides total reflection for Fresnel's and Snell's formulas",
        measured: "error against 50 digits (the slope of R is infinite there, so one ulp of the cosine causes as much)",
        bound: Bound::AtMost(2e-7),
        pace: Pace::Fast,
        measure: || worst("critical", |row| (row.reflectance() - row.r).abs()),
    },
    Case {
        name: "Refraction ends where total reflection begins, within 8 ulp of the critical angle",
        naive: "two formulas disagree: light is transmitted but has no direction",
        here: "one squared cosine decides both",
        measured: "number of disagreements",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let lost = |row: &&InterfaceRow| row.refracted().is_none() && row.reflectance() < 1.0;
            rows("critical").iter().filter(lost).count() as f64
        },
    },
    Case {
        name: "Refracted direction at the same angles and indices",
        naive: "n₁c₁/n₂ − c₂ cancels if n₁ ≈ n₂, and rounding bends the ray",
        here: "the difference is written as a quotient, then the direction is normalised",
        measured: "angle to 50 digits, in radians",
        bound: Bound::AtMost(4e-16),
        pace: Pace::Fast,
        measure: || worst("interfaces", InterfaceRow::bending_error),
    },
    Case {
        name: "n₁ = n₂ exactly",
        naive: "0/0 at grazing incidence; the ray turns by an ulp at each of a thousand faces",
        here: "returns R = 0 and the unchanged direction without arithmetic",
        measured: "changed directions or reflections, of 1000",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let changed = |i: i32| {
                let w =
                    DVec3::new((f64::from(i) * 0.7).sin(), (f64::from(i) * 1.3).cos(), 1e-3 * f64::from(i)).normalize();
                let straight = fresnel::refract(w, DVec3::Z, 1.7, 1.7) == Some(-w);
                !(straight && fresnel::dielectric(w.z, 1.7, 1.7) == 0.0)
            };
            (0..1000).filter(|&i| changed(i)).count() as f64
        },
    },
    Case {
        name: "Paths through a prism, a ball, a slab of thickness 1e-6, and a glass of liquid with an air bubble",
        naive: "an epsilon at the ray's origin skips the slab or hits the same face again",
        here: "a ray stores the face on which it starts; nested objects have priorities",
        measured: "segments in the wrong medium, of 4 × 20,000 paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || wrong_side_events(20_000),
    },
    Case {
        name: "The same, a million paths each",
        naive: "as above",
        here: "as above",
        measured: "segments in the wrong medium, of 4 × 10⁶ paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Slow,
        measure: || wrong_side_events(1_000_000),
    },
    Case {
        name: "Coincident faces: glass on glass, glass in water, by priority",
        naive: "rounding decides the order of two equal distances",
        here: "surfaces within rounding of each other are crossed in one fixed order",
        measured: "paths in a wrong medium, of 40,000",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || wrong_sides_at_coincident_faces(20_000),
    },
    Case {
        name: "A light in a glass cube: endless total reflection",
        naive: "an endless loop, or power that is not accounted for",
        here: "the depth limit ends the path, and the ledger records its power",
        measured: "absolute balance of the ledger",
        bound: Bound::AtMost(1e-12),
        pace: Pace::Fast,
        measure: || TRAPPED.0,
    },
    Case {
        name: "The share of that light that never leaves the cube",
        naive: "Russian roulette that removes it without a record darkens the scene unnoticed",
        here: "recorded in the ledger's depth limit",
        measured: "standard errors from the closed form 3 cos θ_c − 2",
        bound: Bound::AtMost(4.0),
        pace: Pace::Fast,
        measure: || TRAPPED.1,
    },
];

/// A ray at an interface with its exact result.
struct InterfaceRow {
    cos: f64,
    n_i: f64,
    n_t: f64,
    r: f64,
    cos_t: f64,
    sin_t: f64,
}

impl InterfaceRow {
    fn reflectance(&self) -> f64 {
        fresnel::dielectric(self.cos, self.n_i, self.n_t)
    }

    fn refracted(&self) -> Option<DVec3> {
        let w = DVec3::new(((1.0 - self.cos) * (1.0 + self.cos)).sqrt(), 0.0, self.cos);
        fresnel::refract(w, DVec3::Z, self.n_i, self.n_t)
    }

    fn bending_error(&self) -> f64 {
        let found = self.refracted().expect("below the critical angle");
        (found - DVec3::new(-self.sin_t, 0.0, -self.cos_t)).length()
    }
}

fn rows(name: &str) -> Vec<InterfaceRow> {
    let decimal = |value: &Value| value.as_str().unwrap().parse::<f64>().unwrap();
    let row = |row: &Value| InterfaceRow {
        cos: row[0].as_f64().unwrap(),
        n_i: row[1].as_f64().unwrap(),
        n_t: row[2].as_f64().unwrap(),
        r: decimal(&row[3]),
        cos_t: decimal(&row[4]),
        sin_t: decimal(&row[5]),
    };
    golden("hard_cases.json")[name].as_array().unwrap().iter().map(row).collect()
}

fn worst(name: &str, error: impl Fn(&InterfaceRow) -> f64) -> f64 {
    rows(name).iter().map(error).fold(0.0, f64::max)
}

/// Counts events on the wrong side, on random paths through four arrangements of bodies.
fn wrong_side_events(paths: u64) -> f64 {
    let named = |name: &str, shape: Value, ior: Value, priority: i32| {
        let material = json!({ "dielectric": { "ior": ior, "priority": priority } });
        (name.to_string(), shape, material)
    };
    let ball = |radius: f64| json!({ "sphere": { "radius": radius } });
    let arrangements: [Vec<NamedBody>; 4] = [
        vec![(
            Body::prism(1.0, 1.0),
            named("prism", json!({ "prism": { "side": 1, "length": 1 } }), json!("N-SF10"), 0),
        )],
        vec![(Body::Ball(0.5), named("ball", ball(0.5), json!(1.5), 0))],
        vec![(Body::slab(1e-6), named("slab", json!({ "box": { "size": [1, 1e-6, 1] } }), json!("N-BK7"), 0))],
        vec![
            (Body::Ball(0.5), named("glass", ball(0.5), json!("N-BK7"), 0)),
            (Body::Ball(0.45), named("liquid", ball(0.45), json!("water"), 1)),
            (Body::Ball(0.1), named("bubble", ball(0.1), json!(1.0), 2)),
        ],
    ];
    arrangements.iter().map(|arrangement| wrong_sides(arrangement, paths)).sum()
}

/// A point light in a glass cube: the ledger's balance, and the error of the trapped share in
/// standard errors.
static TRAPPED: LazyLock<(f64, f64)> = LazyLock::new(|| {
    const RUNS: u64 = 6;
    let scene = |seed: u64| {
        json!({
            "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 40 } } },
            "film": { "width": 4, "height": 4 },
            "materials": { "glass": glass(1.5), "grey": diffuse(0.5) },
            "objects": [
                { "name": "cube", "shape": { "box": { "size": [1, 1, 1] } }, "material": "glass" },
                { "name": "wall", "shape": { "rectangle": { "width": 9, "height": 9 } }, "material": "grey",
                  "transform": [{ "translate": [0, -2, 0] }] }
            ],
            "lights": [{ "point": { "at": [0.11, 0.07, -0.03], "spectrum": 1, "power": 1 } }],
            "render": { "photons": 5000, "seed": seed }
        })
    };
    let ledgers: Vec<Ledger> = (0..RUNS).map(|seed| render(&scene(seed), Integrator::Photon, 1).ledger).collect();
    let balance = ledgers.iter().map(|ledger| ledger.balance().abs()).fold(0.0, f64::max);
    let shares: Vec<f64> = ledgers.iter().map(|ledger| ledger.depth_limit / ledger.emitted).collect();
    let mean = shares.iter().sum::<f64>() / RUNS as f64;
    let spread = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / (RUNS * (RUNS - 1)) as f64;
    let truth = 3.0 * (1.0 - 1.0 / (1.5 * 1.5_f64)).sqrt() - 2.0;
    (balance, (mean - truth).abs() / spread.sqrt())
});
