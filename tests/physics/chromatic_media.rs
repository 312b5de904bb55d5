//! Media whose extinction varies by a factor of 100 over the band: no wavelength's weight may grow
//! because another wavelength drew the event.
//!
//! A photon or a camera path carries several wavelengths along one path. If each wavelength is
//! weighted by the density of the one that drew the event, the weights are ratios σ_k/σ_h ·
//! exp((σ_h − σ_k) s): a factor of 100 per scattering event and e^(σ_h s) per segment, which shows
//! as fireflies. If it is weighted by the mean density of all wavelengths (the balance heuristic),
//! the sum over the wavelengths is constant, so no path becomes heavier than it started.

use crate::common::{all_y, job, render};
use crate::furnace::surroundings;
use abbe_session::render::Integrator;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_spectra::math::warp;
use abbe_transport::emit::{
    EmissionStrata, LightSampler, MediumCollision, MediumCrossing, PhotonSource, PhotonVisitor, SurfaceArrival,
    WavelengthSampling, trace,
};
use abbe_transport::map::PhotonSpectra;
use abbe_transport::walk::NEVER_STOP;
use abbe_transport::walk::ledger::Ledger;
use serde_json::{Value, json};

/// The extinction at the ends of the band in 1/m, and their geometric mean.
const SIGMA: [f64; 2] = [6.0, 0.06];
const GREY: f64 = 0.6;

/// A ball of radius 1 m and albedo 1 in uniform surroundings that fill the picture: every pixel has
/// luminance 1.
fn white_ball(scattering: Value) -> Value {
    json!({
        "camera": { "from": [0, 0, 5], "at": [0, 0, 0], "lens": { "pinhole": { "fov": 15 } } },
        "film": { "width": 32, "height": 32 },
        "media": { "it": { "homogeneous": { "absorption": 0, "scattering": scattering, "phase": "isotropic" } } },
        "materials": { "it": { "boundary": { "medium": "it" } } },
        "objects": [{ "shape": { "sphere": { "radius": 1 } }, "material": "it" }],
        "lights": surroundings(), "render": { "photons": 3000, "camera_samples": 1, "radius": 0.2 }
    })
}

fn chromatic() -> Value {
    json!({ "table": { "nm": [360, 830], "values": SIGMA } })
}

/// The largest power of any photon at any point, and the number of scattering events.
#[derive(Default)]
struct Heaviest {
    power: f64,
    collisions: u64,
}

impl PhotonVisitor for Heaviest {
    fn on_surface(&mut self, _: &SurfaceArrival<'_>, _: &mut Stream) {}

    fn on_emission(&mut self, _: usize, _: [f64; 2]) {}

    fn on_medium_crossing(&mut self, crossing: &MediumCrossing<'_>, _: &mut Stream) {
        self.power = self.power.max(crossing.photon.power.iter().sum());
    }

    fn on_medium_collision(&mut self, collision: &MediumCollision<'_>, _: &mut Stream) {
        self.power = self.power.max(collision.photon.power.iter().sum());
        self.collisions += 1;
    }
}

/// Returns the weight of the heaviest of `count` photons, relative to a mean weight of 1, if each
/// were weighted by the density of the one wavelength that drew its path. The photons start on the
/// ball's surface and are followed until about where they leave.
fn heaviest_by_one_wavelength(count: u64) -> f64 {
    let mut heaviest = 0.0_f64;
    for index in 0..count {
        let mut stream = Stream::new(Seed::new(7), Purpose::SurveyPhoton, 0, index);
        let shift = stream.uniform();
        let sigma: [f64; 4] = std::array::from_fn(|k| SIGMA[0] + (SIGMA[1] - SIGMA[0]) * 0.25 * (k as f64 + shift));
        let hero = sigma[(4.0 * stream.uniform()) as usize];
        let mut weights = [1.0; 4];
        let (mut place, mut way) = (-glam::DVec3::Z, warp::cosine_hemisphere(stream.pair()));
        loop {
            let across = place.dot(way);
            let out = -across + (across * across + 1.0 - place.length_squared()).max(0.0).sqrt();
            let distance = -(-stream.uniform()).ln_1p() / hero;
            let scatters = distance < out;
            let gone = distance.min(out);
            for (weight, sigma) in weights.iter_mut().zip(sigma) {
                *weight *= ((hero - sigma) * gone).exp() * if scatters { sigma / hero } else { 1.0 };
            }
            heaviest = heaviest.max(weights.iter().sum::<f64>() / 4.0);
            if !scatters {
                break;
            }
            (place, way) = (place + gone * way, warp::sphere(stream.pair()));
        }
    }
    heaviest
}

#[test]
fn no_photon_grows_heavier_than_it_set_out() {
    const PHOTONS: u64 = 20_000;
    let job = job(&white_ball(chromatic()));
    let choice = LightSampler::new(&job.scene).expect("the scene is lit");
    let strata = EmissionStrata::plain(&choice.lights);
    let spectra = PhotonSpectra::new(&job.scene, false).expect("the scene has one light");
    let emitters = PhotonSource {
        scene: &job.scene,
        spectra: &spectra,
        strata: &strata,
        ray_densities: None,
        wavelengths: WavelengthSampling::Free,
        polarised: false,
        fluorescent: false,
        photons_per_ribbon: 0,
        count: PHOTONS,
        streams: Seed::new(1).streams(Purpose::FreePhoton).pass(0),
        media_plan: job.plan.media_plan,
        stop: &NEVER_STOP,
    };
    let (points, mut heaviest, mut ledger) = (emitters.points(), Heaviest::default(), Ledger::new(1));
    let mut growth = 0.0_f64;
    for index in 0..PHOTONS {
        let before = ledger.emitted;
        heaviest.power = 0.0;
        trace(&emitters, &points, index..index + 1, &mut heaviest, &mut ledger);
        growth = growth.max(heaviest.power / (ledger.emitted - before));
    }
    let (collisions, alone) = (heaviest.collisions, heaviest_by_one_wavelength(PHOTONS));
    println!(
        "100 : 1, {collisions} scatterings: no photon above {growth:.12} of what it set out with; by one wavelength's density {alone:.2e}"
    );
    assert!(collisions > PHOTONS / 2, "too few scatterings to tell");
    assert!(growth < 1.0 + 1e-9, "a photon grew: {growth}");
    assert!(alone > 100.0, "single-wavelength weights would do: {alone}");
}

/// Returns the luminance of the brightest pixel relative to the mean.
fn brightest(scattering: Value, way: Integrator, passes: u64) -> f64 {
    let y = all_y(&render(&white_ball(scattering), way, passes));
    y.iter().fold(0.0_f64, |most, y| most.max(*y)) * y.len() as f64 / y.iter().sum::<f64>()
}

/// Returns the largest luminance that one camera path can add in surroundings of luminance 1: the
/// weight of all its wavelengths, which is constant along the path, on the wavelength with the
/// largest luminous efficiency.
fn most_of_a_path() -> f64 {
    /// ∫ ȳ dλ in nm, with ȳ ≤ 1 (CIE 1931).
    const LUMINOSITY_NM: f64 = 106.857;
    let choice = LightSampler::new(&job(&white_ball(chromatic())).scene).expect("the scene is lit");
    let weight = |u: f64| {
        let drawn = (0..4).map(|k| choice.wavelengths.sample((u + f64::from(k)) / 4.0));
        drawn.map(|(_, pdf)| 0.25 / pdf).sum::<f64>() / LUMINOSITY_NM
    };
    (0..1000).map(|i| weight((f64::from(i) + 0.5) / 1000.0)).fold(0.0, f64::max)
}

#[test]
fn no_pixel_of_chromatic_fog_is_a_firefly() {
    let bound = most_of_a_path();
    for passes in [1, 16] {
        let path = brightest(chromatic(), Integrator::Path, passes);
        println!("100 : 1, {passes} paths a pixel: brightest {path:.2} of the mean, bound {bound:.2}");
        // At each scattering event, direct lighting takes half of what the path may find. Over four
        // events in a row near the surface without loss, the sum is twice the bound of one.
        assert!(path < 2.0 * bound);
    }
    // Photons become lighter with their number. Their brightest pixel exceeds the one of grey fog
    // only by the colours of single photons.
    let [chromatic, grey] = [chromatic(), json!(GREY)].map(|fog| brightest(fog, Integrator::Photon, 16));
    println!("100 : 1, photons: brightest pixel {chromatic:.2} of the mean; of grey fog {grey:.2}");
    assert!(chromatic - 1.0 < 3.0 * (grey - 1.0));
}
