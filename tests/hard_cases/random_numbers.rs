//! Random numbers: the ends of their range in every sampler, and the independence of streams.

use glam::{DVec2, DVec3};
use serde_json::json;

use abbe_optics::bsdf::{Bsdf, DiffractionGrating, Grooves, InterfaceIors, TransportMode};
use abbe_optics::glass::RefractiveIndex;
use abbe_optics::grating::{Grating, GratingProfile};
use abbe_optics::texture::SurfaceScalar;
use abbe_optics::thin_film::{FilmLayer, FilmStack, OpticalIndex};
use abbe_scene::Scene;
use abbe_scene::light::LeRandoms;
use abbe_spectra::math::distribution::{DiscreteDistribution, PiecewiseConstant2d};
use abbe_spectra::math::random::{ONE_MINUS_ULP, Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use abbe_spectra::spectrum::Spectrum;
use abbe_transport::emit::{Aim, CELLS, LightSampler};

use super::common::job;
use super::table::{Bound, Case, Pace};

/// The ends of the range, their neighbours in both precisions, and the middle.
const ENDS: [f64; 6] = [0.0, 1e-300, 1.0 / 4_294_967_296.0, 0.5, 1.0 - 1.0 / 4_294_967_296.0, ONE_MINUS_ULP];

pub(crate) const CASES: &[Case] = &[
    Case {
        name: "u = 0 to 1 − ulp in warps and distributions",
        naive: "√−ε, an index beyond the end, an entry of probability 0",
        here: "square roots are clamped at 0, and indices at the last entry of positive probability",
        measured: "results outside their domains",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: warps_and_distributions,
    },
    Case {
        name: "The same in every BSDF, from above, below and grazing",
        naive: "directions in the surface plane, densities of 0, infinite weights",
        here: "cosines stay above 0, and quotients of masking and cosine are in closed form",
        measured: "non-unit directions, densities that are not positive, weights that are not finite",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: surfaces,
    },
    Case {
        name: "The same in every light, shape and camera of a scene",
        naive: "the edge of a light at u = 1, a pole at u = 0",
        here: "closed forms that hold at both ends of the interval",
        measured: "non-unit rays, powers or densities that are negative or not finite",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: lamps_and_cameras,
    },
    Case {
        name: "Random streams of 10⁶ passes, for all purposes",
        naive: "seed + pass, or adjacent sequences of one state: passes repeat each other",
        here: "state and sequence are hashes of (seed, purpose, pass, path)",
        measured: "streams that start with the same 64 bits",
        bound: Bound::AtMost(0.0),
        pace: Pace::Fast,
        measure: || {
            let bits = |u: f64| (u * 4_294_967_296.0) as u64;
            let first = |purpose, pass| {
                let [a, b] = Stream::new(Seed::new(0), purpose, pass, 0).pair();
                bits(a) << 32 | bits(b)
            };
            let mut all: Vec<u64> =
                (0..1_000_000).flat_map(|pass| PURPOSES.map(|purpose| first(purpose, pass))).collect();
            all.sort_unstable();
            all.windows(2).filter(|pair| pair[0] == pair[1]).count() as f64
        },
    },
    Case {
        name: "Correlation of streams at distances of 1, 8 and 2¹⁶ passes and between purposes",
        naive: "as above: a pattern that does not average out over passes",
        here: "as above",
        measured: "largest of 15 correlations, in standard deviations",
        bound: Bound::AtMost(4.0),
        pace: Pace::Fast,
        measure: correlation,
    },
];

const PURPOSES: [Purpose; 4] = [Purpose::FreePhoton, Purpose::SharedPhoton, Purpose::Camera, Purpose::SurveyPhoton];

fn pairs() -> impl Iterator<Item = [f64; 2]> {
    ENDS.into_iter().flat_map(|a| ENDS.into_iter().map(move |b| [a, b]))
}

fn triples() -> impl Iterator<Item = [f64; 3]> {
    pairs().flat_map(|[a, b]| ENDS.into_iter().map(move |c| [a, b, c]))
}

fn count(faults: impl Iterator<Item = bool>) -> f64 {
    faults.filter(|&fault| fault).count() as f64
}

fn is_unit(v: DVec3) -> bool {
    (v.length() - 1.0).abs() < 1e-12
}

fn warps_and_distributions() -> f64 {
    let warped = pairs().map(|u| {
        let disks = [warp::disk(u), warp::regular_polygon(3, u), warp::regular_polygon(64, u)];
        let directions =
            [warp::cosine_hemisphere(u), warp::sphere(u), warp::cone(1e-15, u), warp::cone(1.0, u), warp::cone(2.0, u)];
        let in_disk = disks.iter().all(|place| place.length() <= 1.0 + 1e-15);
        !(in_disk && directions.into_iter().all(is_unit) && warp::cosine_hemisphere(u).z >= 0.0)
    });
    let discrete = DiscreteDistribution::new([0.0, 1e-300, 1.0, 0.0, 1e300, 0.0]).unwrap();
    let grid = PiecewiseConstant2d::new(3, &[0.0, 1.0, 0.0, 1e-200, 0.0, 0.0]).unwrap();
    let mut scores = vec![0.0; CELLS * CELLS];
    scores[CELLS * CELLS - 1] = 1.0;
    let aim = Aim::learned(CELLS, &scores);
    let drawn = pairs().map(|u| {
        let mut rest = u[0];
        let entry = discrete.sample(&mut rest);
        let ([x, y], density) = grid.sample(u);
        let (at, aimed) = aim.sample(u);
        let inside = [x, y, at[0], at[1]].iter().all(|c| (0.0..=1.0).contains(c));
        let positive = discrete.probability(entry) > 0.0 && density > 0.0 && aimed > 0.0 && aimed.is_finite();
        !(inside && positive && (0.0..1.0).contains(&rest) && Aim::cell(at, CELLS) < CELLS * CELLS)
    });
    count(warped) + count(drawn)
}

fn surfaces() -> f64 {
    let half = || Spectrum::constant(0.5);
    let index = |n: f64| RefractiveIndex::constant(n).unwrap();
    let mut all = vec![
        Bsdf::Absorber,
        Bsdf::diffuse(half()).unwrap(),
        Bsdf::translucent(half(), Spectrum::constant(0.4)).unwrap(),
        Bsdf::mirror(half()).unwrap(),
        Bsdf::thin_dielectric(index(1.5), None).unwrap(),
        Bsdf::thin_dielectric(index(1.5), Some(Spectrum::constant(0.3))).unwrap(),
    ];
    let films = |n: f64, k: f64| {
        let index = OpticalIndex::absorbing(Spectrum::constant(n), Spectrum::constant(k)).unwrap();
        FilmStack::new(vec![FilmLayer { index, thickness_nm: SurfaceScalar::Uniform(100.0) }]).unwrap()
    };
    for alpha in [0.0, 1e-3, 0.3, 1.0] {
        let coated = |films| Bsdf::coated_dielectric(films, &index(1.5), alpha).unwrap();
        all.extend([coated(films(1.3, 0.0)), coated(films(0.1, 4.0))]);
    }
    all.extend([Bsdf::thin_film(films(1.3, 0.0)), Bsdf::thin_film(films(0.1, 4.0))]);
    for profile in [GratingProfile::Blazed { order: 1, blaze_nm: 550.0 }, GratingProfile::BinaryAmplitude { duty: 0.5 }]
    {
        let grating = Grating::new(600.0, profile).unwrap();
        let grating = DiffractionGrating::new(grating, half(), Spectrum::constant(0.4), Grooves::Circular);
        all.push(Bsdf::Grating(grating.unwrap()));
    }
    for alpha in [0.0, 1e-3, 0.3, 1.0] {
        all.push(Bsdf::conductor(Spectrum::constant(0.2), Spectrum::constant(3.0), alpha).unwrap());
        all.push(Bsdf::dielectric(alpha).unwrap());
        all.push(Bsdf::glossy(half(), index(1.5), alpha).unwrap());
    }
    all.push(Bsdf::mix(vec![(1.0, all[1].clone()), (1.0, all[5].clone())]).unwrap());
    let (air, glass) = (index(1.0), index(1.5));
    let sides = [InterfaceIors { here: &air, there: &glass }, InterfaceIors { here: &glass, there: &air }];
    let cosines = [1.0_f64, 0.3, 1e-3, 1e-9, 1e-300, -1e-300, -1e-9, -0.5, -1.0];
    let mut faults = 0.0;
    for surface in &all {
        for (sides, cos) in sides.iter().flat_map(|sides| cosines.map(|cos| (*sides, cos))) {
            let wo = DVec3::new(((1.0 - cos) * (1.0 + cos)).sqrt(), 0.0, cos);
            for (u, transport) in triples().flat_map(|u| [(u, TransportMode::Radiance), (u, TransportMode::Importance)])
            {
                let surface = surface.at(u[2]);
                let Some(scatter) = surface.sample(wo, sides, 550.0, u) else { continue };
                let weight = surface.eval_sample(wo, &scatter, sides, transport, 550.0) / scatter.probability;
                let absorbed = surface.absorbed_fraction(wo, &scatter, sides, 550.0);
                let sound = is_unit(scatter.wi) && scatter.probability > 0.0 && weight.is_finite() && weight >= 0.0;
                faults += f64::from(u8::from(!(sound && absorbed.is_finite())));
            }
        }
    }
    faults
}

/// A light of every kind, and every shape as an area light.
fn lit_by_everything() -> Scene {
    let shapes = [
        json!({ "sphere": { "radius": 0.3 } }),
        json!({ "rectangle": { "width": 0.3, "height": 1e-4 } }),
        json!({ "disk": { "radius": 0.3 } }),
        json!({ "box": { "size": [0.3, 1e-6, 0.2] } }),
        json!({ "cylinder": { "radius": 0.1, "height": 0.5 } }),
        json!({ "prism": { "side": 0.3, "length": 0.3 } }),
        json!({ "lens": { "radius1": 0.5, "radius2": -0.5, "thickness": 0.1, "diameter": 0.3 } }),
    ];
    let objects: Vec<_> = shapes
        .iter()
        .zip(0..)
        .map(|(shape, i)| {
            json!({ "shape": shape, "material": "black", "emission": { "spectrum": "A", "power": 1 },
                "transform": [{ "translate": [i, 1, 0] }] })
        })
        .collect();
    job(&json!({
        "camera": { "from": [3, 3, 9], "at": [3, 1, 0], "lens": { "thin": { "fov": 60, "focus_distance": 9, "defocus_angle": 2, "blades": 5 } } },
        "film": { "width": 4, "height": 4 }, "materials": { "black": "absorber" }, "objects": objects,
        "lights": [
            { "point": { "at": [0, 4, 0], "spectrum": "sodium-low-pressure", "power": 1 } },
            { "spot": { "at": [0, 4, 0], "to": [0, 0, 0], "half_angle": 30, "penumbra": 5, "spectrum": "D65", "power": 1 } },
            { "beam": { "from": [0, 4, 0], "to": [1, 0, 0], "radius": 1e-6, "spectrum": "D65", "power": 1 } },
            { "beam": { "from": [0, 4, 0], "to": [0, 0, 0], "radius": 0.1, "divergence": 1e-5, "spectrum": "D65", "power": 1 } },
            { "directional": { "toward": [0, -1, 0], "spectrum": "D65", "irradiance": 1 } },
            { "directional": { "toward": [0, -1, 0.1], "angular_diameter": 0.53, "spectrum": "D65", "irradiance": 1 } },
            { "environment": { "spectrum": "D65", "irradiance": 1 } }]
    }))
    .scene
}

fn lamps_and_cameras() -> f64 {
    let scene = lit_by_everything();
    let choice = LightSampler::new(&scene).unwrap();
    let sound = |value: f64| value.is_finite() && value >= 0.0;
    let mut faults = 0.0;
    let places = [DVec3::ZERO, DVec3::new(0.0, 4.0, 0.0), DVec3::new(2.0, -3.0, 1e-12), DVec3::new(1e6, 0.0, 0.0)];
    for light in &scene.lights {
        for (aim, rest) in pairs().flat_map(|aim| triples().map(move |rest| (aim, rest))) {
            let emission = light.sample_le(scene.extent(), LeRandoms { aim, rest });
            let is_sound = is_unit(emission.direction) && emission.origin.is_finite() && sound(emission.flux_w);
            faults += f64::from(u8::from(!is_sound));
        }
        for (place, u) in places.iter().flat_map(|place| triples().map(move |u| (*place, u))) {
            let Some(incident) = light.sample_li(scene.extent(), place, u) else { continue };
            let density = incident.pdf_solid_angle.unwrap_or(1.0);
            let is_sound =
                is_unit(incident.direction) && incident.distance > 0.0 && sound(incident.irradiance) && density > 0.0;
            faults += f64::from(u8::from(!is_sound));
        }
        faults += count(ENDS.into_iter().map(|u| {
            let (nm, density) = light.wavelengths.sample(u);
            !((360.0..=830.0).contains(&nm) && density > 0.0 && sound(light.spectrum.at(nm) / density))
        }));
    }
    faults += count(ENDS.into_iter().map(|u| {
        let (nm, density) = choice.wavelengths.sample(u);
        !((360.0..=830.0).contains(&nm) && density > 0.0 && density.is_finite())
    }));
    let rays = pairs().flat_map(|film| pairs().map(move |lens| (film, lens)));
    faults + count(rays.map(|(film, lens)| !is_unit(scene.camera.ray(DVec2::from(film) * 4.0, lens).direction)))
}

/// Returns the largest correlation of first numbers in standard deviations: 1/√n for n products of
/// centred uniform numbers, relative to their variance.
fn correlation() -> f64 {
    const PASSES: u64 = 250_000;
    let first = |purpose, pass| Stream::new(Seed::new(0), purpose, pass, 7).uniform() - 0.5;
    let correlate = |a: &dyn Fn(u64) -> f64, b: &dyn Fn(u64) -> f64| {
        let sum: f64 = (0..PASSES).map(|pass| 12.0 * a(pass) * b(pass)).sum();
        (sum / (PASSES as f64).sqrt()).abs()
    };
    let mut largest = 0.0_f64;
    for purpose in PURPOSES {
        for distance in [1, 8, 1 << 16] {
            largest = largest.max(correlate(&|pass| first(purpose, pass), &|pass| first(purpose, pass + distance)));
        }
    }
    for (a, b) in [(0, 1), (0, 2), (2, 3)] {
        largest = largest.max(correlate(&|pass| first(PURPOSES[a], pass), &|pass| first(PURPOSES[b], pass)));
    }
    largest
}
