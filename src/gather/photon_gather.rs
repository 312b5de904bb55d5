//! One camera sample: along mirrors and glass to the first surface that scatters, then light from lamps and photons there.

use super::CameraNumbers;
use super::camera_path::{CameraPath, REFERENCE_NM, Scratch};
use super::direct::{Asking, Counts, Direct, Found, Lit};
use super::estimate::{Maps, Radii, RadiusKind};
use super::landing::Landing;
use super::outline::Outlines;
use super::throughput::{Colour, Factor, product, relative_n2};
use crate::map::LightMaps;
use crate::map::kernel::Shares;
use crate::map::radius::{self, Scales};
use crate::math::random::ONE_MINUS_ULP;
use crate::optics::surface::{Class, Event, Surface, Transport};
use crate::plan::partition::{Estimator, LightPath, View, estimator};
use crate::plan::{BetweenPlan, IndirectPlan, Plan, WavelengthPlan};
use crate::scene::Scene;
use crate::scene::camera::SystemAt;
use crate::spectrum::{LANES, Lanes};
use crate::walk::{Encounter, Sink, Tally, bias_of_excess, draw_consistently, excess_depth, next, next_in_air, passes};

/// All that camera paths of a pass need.
#[derive(Debug)]
pub struct Gatherer<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What the scene calls for.
    pub plan: &'a Plan,
    /// Who asks which lamps.
    pub direct: Direct<'a>,
    /// Photons with wavelengths of their own.
    pub free: &'a Maps,
    /// Photons on the shared wavelengths.
    pub shared: &'a Maps,
    /// The pass's shared wavelengths in nm.
    pub shared_nm: Lanes,
    /// Densities of the shared wavelengths, per nm.
    pub shared_pdf: Lanes,
    /// The camera's lens at each of them, if it is one of real glass.
    pub glass: Option<[SystemAt<'a>; LANES]>,
    /// Maps of lamps in media; none where lamps are asked.
    pub light_maps: &'a LightMaps<'a>,
    /// How far surfaces go on around what pixels see directly.
    pub outlines: &'a Outlines,
    /// How far kernels have shrunk since the first pass.
    pub scales: Scales,
    /// The first radius, in m, if the scene states it; else pixels have their own.
    pub radius_m: Option<f64>,
    /// Surface events a path may have.
    pub max_depth: u32,
}

/// What one camera sample uses from end to end.
pub(super) struct Sample<'s, 'a, S> {
    pub(super) pixel: u64,
    pub(super) numbers: CameraNumbers,
    pub(super) radii: &'s Radii,
    pub(super) scratch: &'s mut Scratch<'a>,
    pub(super) sink: &'s mut S,
    pub(super) tally: &'s mut Tally,
}

impl<'a> Gatherer<'a> {
    /// Estimates the radiance of one sample of a pixel and hands it to the sink.
    pub fn sample<S: Sink>(
        &self,
        pixel: u64,
        numbers: CameraNumbers,
        radii: &Radii,
        (scratch, tally): (&mut Scratch<'a>, &mut Tally),
        sink: &mut S,
    ) {
        scratch.factors.clear();
        scratch.landings.clear();
        scratch.sightlines.clear();
        let camera = &self.scene.camera;
        tally.lens_rays += u64::from(self.plan.aperture.is_finite());
        let path = |ray| CameraPath::new(ray, camera.interior);
        let mut sample = Sample { pixel, numbers, radii, scratch, sink, tally };
        match (&self.glass, self.plan.wavelengths) {
            (Some(lanes), _) => {
                for (lane, glass) in lanes.iter().enumerate() {
                    let through = sample.numbers.ray_through(glass, camera, pixel);
                    let Some((ray, weight)) = through else { continue };
                    if let Some(mut single) = self.on_lane(path(ray), lane, &mut sample) {
                        single.multiply(Factor::Grey(weight), sample.scratch);
                        self.follow(single, &mut sample);
                    }
                }
            }
            (None, WavelengthPlan::Shared) => self.split(path(sample.numbers.ray(camera, pixel)), &mut sample),
            (None, WavelengthPlan::Free | WavelengthPlan::Both) => {
                self.follow(path(sample.numbers.ray(camera, pixel)), &mut sample);
            }
        }
    }

    /// Sends a path on once for each shared wavelength.
    fn split<S: Sink>(&self, path: CameraPath, sample: &mut Sample<'_, 'a, S>) {
        for lane in 0..LANES {
            if let Some(single) = self.on_lane(path, lane, sample) {
                self.follow(single, sample);
            }
        }
    }

    /// A wavelength-free path, taken to one of the shared wavelengths; `None` where the lights have no power there.
    fn on_lane<S: Sink>(&self, path: CameraPath, lane: usize, sample: &mut Sample<'_, 'a, S>) -> Option<CameraPath> {
        let (nm, pdf) = (self.shared_nm[lane], self.shared_pdf[lane]);
        if pdf <= 0.0 {
            return None;
        }
        sample.tally.shared_paths += 1;
        let throughput = product(&sample.scratch.factors, nm) / (pdf * LANES as f64);
        Some(CameraPath { colour: Colour::Shared { lane, nm, throughput }, ..path })
    }

    fn follow<S: Sink>(&self, mut path: CameraPath, sample: &mut Sample<'_, 'a, S>) {
        let factors_before = sample.scratch.factors.len();
        while path.depth < self.max_depth {
            let met = match self.plan.between {
                BetweenPlan::Air => {
                    next_in_air(self.scene, path.start, &mut sample.numbers.stream.uniform())
                }
                BetweenPlan::Clear => next(self.scene, path.start, &mut sample.numbers.stream.uniform()),
                BetweenPlan::Absorbing | BetweenPlan::Scattering(_) => self.advance(&mut path, sample),
            };
            let Some(encounter) = &met else {
                self.look_outside(&path, sample);
                break;
            };
            path.depth += 1;
            path.distance += encounter.distance;
            if encounter.crossed_hidden {
                path.view = View::Relayed;
                path.counts = match path.counts {
                    Counts::Fully => Counts::Fully,
                    Counts::Shared { .. } | Counts::Not => Counts::Not,
                };
            }
            if let Some(lamp) = self.direct.found_on_surface(encounter.incoming, &encounter.hit, path.counts) {
                add_lamp(&path, &sample.scratch.factors, &lamp, sample.numbers.wavelength, sample.sink);
            }
            let goes_on = match encounter.surface.class() {
                Class::Absorbing => false,
                Class::Diffuse => {
                    self.land(&path, encounter, sample);
                    false
                }
                Class::Glossy => {
                    sample.tally.rough_events += 1;
                    self.gather_lamps(&path, encounter, sample);
                    self.gather_photons(&path, encounter, sample);
                    self.go_on(&mut path, encounter, sample)
                }
                Class::Specular => self.go_on(&mut path, encounter, sample),
            };
            if !goes_on || !survives(self.scene, &mut path, sample) {
                break;
            }
        }
        sample.scratch.factors.truncate(factors_before);
    }

    /// The lamps at infinity.
    fn look_outside<S: Sink>(&self, path: &CameraPath, sample: &mut Sample<'_, 'a, S>) {
        let u = sample.numbers.wavelength;
        let Sample { scratch, sink, tally, .. } = sample;
        self.direct.found_outside(path.start.ray.direction, path.counts, tally, |lamp| {
            add_lamp(path, &scratch.factors, &lamp, u, *sink);
        });
    }

    /// The end of a path at a diffuse surface: lamps and photons.
    fn land<S: Sink>(&self, path: &CameraPath, encounter: &Encounter<'a>, sample: &mut Sample<'_, 'a, S>) {
        sample.scratch.landings.push(self.landing(path, encounter));
        self.gather_lamps(path, encounter, sample);
        self.gather_scattered_lamps(path, encounter, sample);
        self.gather_photons(path, encounter, sample);
    }

    fn landing(&self, path: &CameraPath, encounter: &Encounter<'a>) -> Landing {
        let normal = encounter.hit.normal;
        Landing {
            position: encounter.hit.position,
            facing: if encounter.leads_back(normal) { normal } else { -normal },
            footprint_m: path.distance * self.scene.camera.pixel_angle(),
            view: path.view,
            shared: matches!(path.colour, Colour::Shared { .. }),
        }
    }

    /// Light straight from lamps, by shadow rays.
    fn gather_lamps<S: Sink>(&self, path: &CameraPath, encounter: &Encounter<'a>, sample: &mut Sample<'_, 'a, S>) {
        if self.plan.direct.is_absent() {
            return;
        }
        let (u, lamp) = (sample.numbers.wavelength, sample.numbers.lamp());
        let asking = Asking { encounter, nm: path.reference_nm(), u: lamp };
        let Sample { scratch, sink, tally, .. } = sample;
        self.direct.ask(asking, tally, |Lit { light, wi, strength, tint, through }| {
            let bias = bias_of_excess(path.excess_depth + excess_depth(through, path.reference_nm()));
            let (surface, wo, sides) = (encounter.surface, encounter.wo, encounter.sides);
            each_wavelength(path.colour, &scratch.factors, light, u, |nm, share| {
                let f = surface.eval(wo, wi, sides, Transport::Radiance, nm);
                let weight = share * light.shape_at(tint, nm) * strength * f * passes(through, nm);
                sink.biased(nm, weight, weight * bias);
            });
        });
    }

    /// Light straight from lamps, by a scattered ray that may find one. (Glossy surfaces' own continuation does this for them.)
    fn gather_scattered_lamps<S: Sink>(
        &self,
        path: &CameraPath,
        encounter: &Encounter<'a>,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        if !self.plan.direct.scatters_to_lamps() {
            return;
        }
        let nm = path.reference_nm();
        let u = sample.numbers.stream.triple();
        let (surface, wo, sides) = (encounter.surface, encounter.wo, encounter.sides);
        let Some(scatter) = surface.sample(wo, sides, nm, Transport::Radiance, u) else {
            return;
        };
        let direction = encounter.frame.to_world(scatter.wi);
        let start = encounter.leave(direction, encounter.interior_towards(direction));
        let wavelength = sample.numbers.wavelength;
        let Sample { scratch, sink, tally, .. } = sample;
        self.direct.look(start, scatter.probability, tally, |lamp| {
            let bias = bias_of_excess(path.excess_depth + excess_depth(lamp.through, nm));
            each_wavelength(path.colour, &scratch.factors, lamp.light, wavelength, |nm, share| {
                let response = surface.response(wo, &scatter, sides, Transport::Radiance, nm) / scatter.probability;
                let arriving = lamp.light.shape_at(lamp.tint, nm) * lamp.radiance * passes(lamp.through, nm);
                let weight = share * arriving * response;
                sink.biased(nm, weight, weight * bias);
            });
        });
    }

    /// Light that photons brought, as far as the partition leaves it to the maps.
    fn gather_photons<S: Sink>(&self, path: &CameraPath, encounter: &Encounter<'a>, sample: &mut Sample<'_, 'a, S>) {
        let class = encounter.surface.class();
        let (maps, kinds) = match path.colour {
            Colour::Free => (self.free, [RadiusKind::FreeCaustic, RadiusKind::FreeIndirect]),
            Colour::Shared { .. } => (self.shared, [RadiusKind::SharedCaustic, RadiusKind::SharedIndirect]),
        };
        // Only free photons are connected to the camera, so a shared camera path that sees the surface directly takes the map.
        let view = match path.colour {
            Colour::Free => path.view,
            Colour::Shared { .. } => View::Relayed,
        };
        let classes = [(LightPath::Caustic, &maps.caustic, kinds[0]), (LightPath::Indirect, &maps.indirect, kinds[1])];
        for (light_path, map, kind) in classes {
            let wanted = light_path != LightPath::Indirect || self.plan.indirect != IndirectPlan::Absent;
            if wanted && !map.is_empty() && estimator(light_path, class, view) == Estimator::PhotonMap {
                sample.tally.map_queries += 1;
                let radius = f64::from(sample.radii[kind as usize]) * self.scales.surface;
                let radius = radius.max(radius::least(encounter.hit.position));
                let shares = match path.view {
                    View::Seen => self.outlines.shares(sample.pixel as usize, &self.landing(path, encounter), radius),
                    View::Relayed => Shares::WHOLE,
                };
                self.estimate(
                    encounter,
                    (map, radius, shares),
                    (path.colour, bias_of_excess(path.excess_depth)),
                    &sample.scratch.factors,
                    sample.sink,
                );
            }
        }
    }

    /// Scatters the path at a mirror, at glass or at a rough surface; false where it ends.
    fn go_on<S: Sink>(&self, path: &mut CameraPath, encounter: &Encounter<'a>, sample: &mut Sample<'_, 'a, S>) -> bool {
        if let (Colour::Free, true) = (path.colour, self.disperses(encounter)) {
            return self.go_on_through_dispersive(path, encounter, sample);
        }
        let u = sample.numbers.stream.triple();
        self.scatter_once(path, encounter, u, sample)
    }

    /// Whether refraction here would send wavelengths different ways.
    fn disperses(&self, encounter: &Encounter<'a>) -> bool {
        self.plan.wavelengths != WavelengthPlan::Free
            && matches!(encounter.surface, Surface::Dielectric(_))
            && (encounter.sides.here.is_dispersive() || encounter.sides.there.is_dispersive())
    }

    /// A wavelength-free path at dispersive glass: reflected it stays free, refracted it goes on once for each shared wavelength.
    fn go_on_through_dispersive<S: Sink>(
        &self,
        path: &mut CameraPath,
        encounter: &Encounter<'a>,
        sample: &mut Sample<'_, 'a, S>,
    ) -> bool {
        let surface = encounter.surface;
        if surface.class() == Class::Glossy {
            // Rough dispersive glass: each wavelength scatters for itself, reflections included.
            sample.tally.dispersions += 1;
            self.split_at(*path, encounter, None, sample);
            return false;
        }
        // At the first surface both ways are followed; further on, one is drawn.
        let reflectance = self.reflectance(encounter);
        let both = path.depth == 1;
        let reflects = both || sample.numbers.stream.uniform() < reflectance;
        let refracts = both || !reflects;
        if refracts && reflectance < 1.0 {
            let probability = if both { 1.0 } else { 1.0 - reflectance };
            sample.tally.dispersions += 1;
            self.split_at(*path, encounter, Some(probability), sample);
        }
        if !reflects {
            return false;
        }
        let probability = if both { 1.0 } else { reflectance };
        self.scatter_forced(path, encounter, Event::Reflection, probability, sample)
    }

    /// Reflectance of a smooth interface at the reference wavelength.
    fn reflectance(&self, encounter: &Encounter<'a>) -> f64 {
        let sides = encounter.sides;
        crate::optics::fresnel::dielectric(
            encounter.wo.z.abs(),
            sides.here.n(REFERENCE_NM),
            sides.there.n(REFERENCE_NM),
        )
    }

    /// Sends the path on from here once for each shared wavelength; `refracted` says with which probability refraction was chosen, or that
    /// each wavelength chooses for itself.
    fn split_at<S: Sink>(
        &self,
        path: CameraPath,
        encounter: &Encounter<'a>,
        refracted: Option<f64>,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let u = sample.numbers.stream.triple();
        for lane in 0..LANES {
            let Some(mut single) = self.on_lane(path, lane, sample) else {
                continue;
            };
            let goes_on = match refracted {
                Some(probability) => {
                    self.scatter_forced(&mut single, encounter, Event::Transmission, probability, sample)
                }
                None => self.scatter_once(&mut single, encounter, u, sample),
            };
            if goes_on && survives(self.scene, &mut single, sample) {
                self.follow(single, sample);
            }
        }
    }

    /// Scatters into the reflection or the refraction of a smooth interface, whichever is told; false where there is none.
    fn scatter_forced<S: Sink>(
        &self,
        path: &mut CameraPath,
        encounter: &Encounter<'a>,
        event: Event,
        probability: f64,
        sample: &mut Sample<'_, 'a, S>,
    ) -> bool {
        let u = match event {
            Event::Reflection => [0.0; 3],
            Event::Transmission => [ONE_MINUS_ULP; 3],
        };
        let nm = path.reference_nm();
        let draw = |wo| encounter.surface.sample(wo, encounter.sides, nm, Transport::Radiance, u);
        match draw_consistently(encounter, draw) {
            Some(mut drawn) if drawn.scatter.event == event => {
                drawn.scatter.probability = probability;
                path.continue_along(encounter, &drawn, sample.scratch)
            }
            Some(_) | None => false,
        }
    }

    /// Scatters as the surface draws it.
    fn scatter_once<S: Sink>(
        &self,
        path: &mut CameraPath,
        encounter: &Encounter<'a>,
        u: [f64; 3],
        sample: &mut Sample<'_, 'a, S>,
    ) -> bool {
        let nm = path.reference_nm();
        let draw = |wo| encounter.surface.sample(wo, encounter.sides, nm, Transport::Radiance, u);
        match draw_consistently(encounter, draw) {
            Some(drawn) => {
                let goes_on = path.continue_along(encounter, &drawn, sample.scratch);
                // What a rough surface's scattered ray finds is a part of the light straight from lamps.
                if self.plan.direct.is_absent() && matches!(path.counts, Counts::Shared { .. }) {
                    path.counts = Counts::Not;
                }
                goes_on
            }
            None => false,
        }
    }
}

/// Russian roulette for paths that have lost most of their light (by more than glass takes and gives back with its n²).
fn survives<S: Sink>(scene: &Scene, path: &mut CameraPath, sample: &mut Sample<'_, '_, S>) -> bool {
    const FREE_EVENTS: u32 = 8;
    if path.level <= 0.0 && matches!(path.colour, Colour::Shared { .. }) {
        return false;
    }
    if path.depth < FREE_EVENTS {
        return true;
    }
    let level = path.level * relative_n2(scene, &path.start, path.reference_nm());
    if level >= 0.5 {
        return true;
    }
    let survival = level.max(0.05);
    if sample.numbers.stream.uniform() >= survival {
        return false;
    }
    path.multiply(Factor::Grey(1.0 / survival), sample.scratch);
    true
}

/// Adds a lamp that a path sees; `u` shifts the wavelengths at which it is looked at.
fn add_lamp<S: Sink>(path: &CameraPath, factors: &[Factor<'_>], lamp: &Found<'_, '_>, u: f64, sink: &mut S) {
    let bias = bias_of_excess(path.excess_depth);
    each_wavelength(path.colour, factors, lamp.light, u, |nm, share| {
        let weight = share * lamp.light.shape_at(lamp.tint, nm) * lamp.radiance;
        sink.biased(nm, weight, weight * bias);
    });
}

/// Calls `f` with wavelengths (nm) and what the path lets through there divided by their density: a stratified set drawn from the
/// lamp for free paths, the path's own wavelength for shared ones.
#[inline]
pub(super) fn each_wavelength(
    colour: Colour,
    factors: &[Factor<'_>],
    light: &crate::scene::light::Light,
    u: f64,
    mut f: impl FnMut(f64, f64),
) {
    match colour {
        Colour::Free => {
            for k in 0..LANES {
                let (nm, pdf) = light.wavelengths.sample((u + k as f64) / LANES as f64);
                f(nm, product(factors, nm) / (pdf * LANES as f64));
            }
        }
        Colour::Shared { nm, throughput, .. } => f(nm, throughput),
    }
}
