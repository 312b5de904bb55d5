//! Refraction: Fresnel and Snell at their ends, paths through nested bodies, coincident faces, light that cannot get out.

use std::sync::LazyLock;

use glam::DVec3;
use serde_json::{Value, json};

use abbe::optics::fresnel;
use abbe::render::Integrator;
use abbe::walk::ledger::Ledger;

use super::common::{diffuse, glass, render};
use super::golden::golden;
use super::paths::{Body, Placed, wrong_sides, wrong_sides_at_coincident_faces};
use super::table::{Bound, Case, Pace};

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "Reflectance at 0° to 89.9999999°, n₁ = n₂ ± 1e-12, n = 1 + 1e-9, n = 4",
        naive: "(n₁c₁ − n₂c₂)/(n₁c₁ + n₂c₂) keeps no digit where n₁ ≈ n₂",
        here: "(n₂ − n₁)(n₂ + n₁)/(n₁c₁ + n₂c₂)², a difference of inputs",
        measured: "relative error against 50 digits",
        bound: Bound::AtMost(2e-14),
        pace: Pace::Fast,
        measure: || worst("interfaces", |row| (row.reflectance() / row.r - 1.0).abs()),
    },
    Case {
        name: "Transmittance at 0° to 89.9999999°",
        naive: "R > 1 by rounding makes it negative",
        here: "T = 1 − R with R held to 1",
        measured: "error against 50 digits",
        bound: Bound::AtMost(1e-15),
        pace: Pace::Fast,
        measure: || worst("interfaces", |row| ((1.0 - row.reflectance()) - (1.0 - row.r)).abs()),
    },
    Case {
        name: "Reflectance within 8 ulp of the critical angle",
        naive: "the root of a negative number",
        here: "one function tells refraction's end to Fresnel and Snell",
        measured: "error against 50 digits (R falls there with an infinite slope: an ulp of the cosine is as much)",
        bound: Bound::AtMost(2e-7),
        pace: Pace::Fast,
        measure: || worst("critical", |row| (row.reflectance() - row.r).abs()),
    },
    Case {
        name: "Refraction ends where total reflection begins, within 8 ulp of the critical angle",
        naive: "two formulas disagree: light is to go on and has no direction",
        here: "the same squared cosine decides both",
        measured: "disagreements",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let lost = |row: &&Row| row.refracted().is_none() && row.reflectance() < 1.0;
            rows("critical").iter().filter(lost).count() as f64
        },
    },
    Case {
        name: "Refracted direction at the same angles and indices",
        naive: "n₁c₁/n₂ − c₂ cancels where n₁ ≈ n₂; the ray bends by rounding",
        here: "the difference as a quotient, then normalised",
        measured: "angle to 50 digits, in radians",
        bound: Bound::AtMost(4e-16),
        pace: Pace::Fast,
        measure: || worst("interfaces", Row::bending_error),
    },
    Case {
        name: "n₁ = n₂ exactly",
        naive: "0/0 at grazing; the ray turns by an ulp at each of a thousand faces",
        here: "R = 0 and the direction itself, without arithmetic",
        measured: "directions changed, or light reflected, of 1000",
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
        name: "Paths through a prism, a ball, a slab of 1e-6 and glass with liquid with an air bubble",
        naive: "an epsilon on the ray's start steps over the slab, or back into the face",
        here: "a ray knows the face it starts on; nested bodies by priority",
        measured: "legs in the wrong medium, of 4 × 20,000 paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || wrong_side_events(20_000),
    },
    Case {
        name: "The same, a million paths each",
        naive: "as above",
        here: "as above",
        measured: "legs in the wrong medium, of 4 × 10⁶ paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Slow,
        measure: || wrong_side_events(1_000_000),
    },
    Case {
        name: "Coincident faces: glass on glass, glass in water, by priority",
        naive: "the order of two equal distances is rounding's",
        here: "surfaces nearer than rounding are passed in one fixed order",
        measured: "media wrong, of 40,000 paths",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || wrong_sides_at_coincident_faces(20_000),
    },
    Case {
        name: "A lamp in a glass cube: total reflection for ever",
        naive: "an endless loop, or power that is in no account",
        here: "the depth limit ends the path and books its power",
        measured: "|balance| of the ledger",
        bound: Bound::AtMost(1e-12),
        pace: Pace::Fast,
        measure: || TRAPPED.0,
    },
    Case {
        name: "The share of its light that never gets out",
        naive: "roulette that takes it without an account darkens the scene unseen",
        here: "booked under depth limit",
        measured: "standard errors from the closed form 3 cos θ_c − 2",
        bound: Bound::AtMost(4.0),
        pace: Pace::Fast,
        measure: || TRAPPED.1,
    },
];

/// A ray at an interface, and the truth about it.
struct Row {
    cos: f64,
    n_i: f64,
    n_t: f64,
    r: f64,
    cos_t: f64,
    sin_t: f64,
}

impl Row {
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

fn rows(name: &str) -> Vec<Row> {
    let decimal = |value: &Value| value.as_str().unwrap().parse::<f64>().unwrap();
    let row = |row: &Value| Row {
        cos: row[0].as_f64().unwrap(),
        n_i: row[1].as_f64().unwrap(),
        n_t: row[2].as_f64().unwrap(),
        r: decimal(&row[3]),
        cos_t: decimal(&row[4]),
        sin_t: decimal(&row[5]),
    };
    golden("hard_cases.json")[name].as_array().unwrap().iter().map(row).collect()
}

fn worst(name: &str, error: impl Fn(&Row) -> f64) -> f64 {
    rows(name).iter().map(error).fold(0.0, f64::max)
}

/// Events on the wrong side on random paths through four arrangements.
fn wrong_side_events(paths: u64) -> f64 {
    let named = |name: &str, shape: Value, ior: Value, priority: i32| {
        let material = json!({ "dielectric": { "ior": ior, "priority": priority } });
        (name.to_string(), shape, material)
    };
    let ball = |radius: f64| json!({ "sphere": { "radius": radius } });
    let arrangements: [Vec<Placed>; 4] = [
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

/// A point in a glass cube: the ledger's balance, and how many standard errors the trapped share is off.
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
