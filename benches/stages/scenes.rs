//! The benchmark scenes, and what the stages make of them.

use abbe_scene::Scene;
use abbe_spectra::math::random::{Purpose, Seed, Stream};
use abbe_transport::emit::{
    EmissionStrata, LightSampler, PhotonSource, PhotonVisitor, SurfaceArrival, WavelengthSampling, trace,
};
use abbe_transport::gather::{CameraPass, DirectLighting, LightSelector, SurfaceExtents};
use abbe_transport::map::radius::PerKernel;
use abbe_transport::map::{ClassMaps, LightMaps, Photon, PhotonMap, PhotonPower, PhotonSpectra, SetMaps};
use abbe_transport::plan::partition::PerSet;
use abbe_transport::plan::partition::{LightPath, kept_in_map};
use abbe_transport::plan::{LightOrigin, PathClass, Plan, prepare};
use abbe_transport::walk::ledger::Ledger;
use abbe_transport::walk::{NEVER_STOP, SensorResponse, Sink};
use std::path::Path;

/// A scene with what transport needs to know of it.
pub(crate) struct Prepared {
    pub(crate) scene: Scene,
    pub(crate) plan: Plan,
    pub(crate) choice: LightSampler,
    pub(crate) selector: LightSelector,
    strata: EmissionStrata,
    pub(crate) spectra: PhotonSpectra,
}

/// A benchmark scene by its file's name, with changes as by `--set`.
pub(crate) fn load(name: &str, changes: &[&str]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/scenes").join(name);
    let changes: Vec<String> = changes.iter().map(ToString::to_string).collect();
    abbe_format::resolve::load(&path, &changes).expect("a benchmark scene is valid")
}

impl Prepared {
    pub(crate) fn new(name: &str) -> Self {
        let mut scene = load(name, &[]);
        let (plan, _) = prepare(&mut scene).expect("a benchmark scene can be planned");
        let choice = LightSampler::new(&scene).expect("a benchmark scene is lit");
        let selector = LightSelector::new(&scene, &choice.lights);
        let strata = EmissionStrata::plain(&choice.lights);
        let spectra = PhotonSpectra::new(&scene, false).expect("a benchmark scene has few spectra");
        Self { scene, plan, choice, selector, strata, spectra }
    }

    /// Hands what emits `count` unaimed photons of pass 0 to `then`.
    pub(crate) fn with_source<T>(&self, count: u64, then: impl FnOnce(&PhotonSource<'_>) -> T) -> T {
        then(&PhotonSource {
            scene: &self.scene,
            spectra: &self.spectra,
            strata: &self.strata,
            ray_densities: None,
            wavelengths: WavelengthSampling::Free,
            polarised: false,
            fluorescent: false,
            photons_per_ribbon: 0,
            count,
            streams: Seed::new(1).streams(Purpose::FreePhoton).pass(0),
            media_plan: self.plan.media_plan,
            stop: &NEVER_STOP,
        })
    }

    /// Emits the photons and hands them to the receiver.
    pub(crate) fn emit(&self, count: u64, receiver: &mut impl PhotonVisitor) -> Ledger {
        let mut ledger = Ledger::new(self.scene.materials.len());
        self.with_source(count, |source| {
            let points = source.points();
            trace(source, &points, 0..count, receiver, &mut ledger);
        });
        ledger
    }

    /// The photons of a pass of `count` paths, as they are kept for the maps.
    pub(crate) fn harvest(&self, count: u64) -> Harvest {
        let mut harvest = Harvest::default();
        self.emit(count, &mut harvest);
        harvest
    }
}

/// Keeps what the maps keep.
#[derive(Default)]
pub(crate) struct Harvest {
    caustic: Vec<(Photon, [f32; 3])>,
    pub(crate) indirect: Vec<(Photon, [f32; 3])>,
}

impl Harvest {
    pub(crate) fn maps(&self) -> SetMaps {
        let of_class = |photons: &[_]| ClassMaps { surface: PhotonMap::build(photons), ..ClassMaps::default() };
        SetMaps { caustic: of_class(&self.caustic), indirect: of_class(&self.indirect) }
    }
}

impl PhotonVisitor for Harvest {
    #[inline(always)]
    fn on_surface(&mut self, arrival: &SurfaceArrival<'_>, stream: &mut Stream) {
        let hit = &arrival.interaction.hit;
        if !kept_in_map(arrival.photon.light_path, arrival.interaction.bsdf.class()) {
            return;
        }
        let facing = if arrival.to_light().dot(hit.normal) >= 0.0 { hit.normal } else { -hit.normal };
        let load = PhotonPower::new(arrival.photon.wavelength_code, arrival.photon.power, None, stream.uniform());
        let photon = Photon::new(load, arrival.to_light(), facing);
        let list = if arrival.photon.light_path == LightPath::Caustic { &mut self.caustic } else { &mut self.indirect };
        list.push((photon, hit.position.as_vec3().to_array()));
    }

    fn on_emission(&mut self, _: usize, _: [f64; 2]) {}
}

/// Adds all light up.
pub(crate) struct Total(pub(crate) f64);

impl Sink for Total {
    fn radiance(&mut self, _: LightOrigin, _: f64, weight: f64) {
        self.0 += weight;
    }

    fn biased(&mut self, _: LightOrigin, _: f64, weight: f64, _: f64) {
        self.0 += weight;
    }

    fn respond(&mut self, _: PathClass, radiance: SensorResponse, _: SensorResponse) {
        self.0 += radiance.0.iter().sum::<f64>();
    }
}

/// What gathers by free photons alone, unless the plan asks for shared ones.
pub(crate) fn camera_pass<'a>(
    prepared: &'a Prepared,
    (maps, surface_extents, light_maps): (&'a SetMaps, &'a SurfaceExtents, &'a LightMaps<'a>),
) -> CameraPass<'a> {
    let wavelengths = [450.0, 520.0, 590.0, 650.0];
    CameraPass {
        scene: &prepared.scene,
        plan: &prepared.plan,
        direct: DirectLighting::new(&prepared.scene, &prepared.selector, prepared.plan.media_plan),
        maps: PerSet { free: maps, shared: maps },
        shared_nm: wavelengths,
        shared_pdf: wavelengths.map(|nm| prepared.choice.wavelengths.pdf(nm)),
        lens_systems: None,
        light_maps,
        surface_extents,
        final_gather: false,
        sensors: &[],
        spectra: &prepared.spectra,
        responses: None,
        scales: PerKernel::splat(1.0),
        explicit_radius_m: None,
        photons_per_sample: PerSet { free: 1.0, shared: 1.0 },
        truncated: None,
        stop: &NEVER_STOP,
    }
}
