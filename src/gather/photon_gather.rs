//! One camera sample: along mirrors and glass to the first surface that scatters, then light from lamps and photons there.
//!
//! The loop is compiled for scenes with bodies and for scenes without. What every path needs is inlined into it, so that path and encounter stay in
//! registers; what few need (a mirror, a lamp in view) is called, with copies of both.

use super::CameraNumbers;
use super::camera_path::{CameraPath, Scratch};
use super::direct::{Asking, Counts, Direct, Found};
use super::estimate::{Maps, Radii, RadiusKind, Receiver};
use super::landing::Landing;
use super::outline::Outlines;
use super::throughput::{Colour, Factor, product};
use crate::map::LightMaps;
use crate::map::kernel::Shares;
use crate::map::radius::{self, Scales};
use crate::optics::surface::{Class, Transport};
use crate::plan::partition::{Estimator, LightPath, View, estimator};
use crate::plan::{BetweenPlan, IndirectPlan, Plan, WavelengthPlan};
use crate::scene::Scene;
use crate::scene::camera::SystemAt;
use crate::scene::geometry::{Hit, Ray};
use crate::spectrum::{LANES, Lanes};
use crate::walk::{Encounter, Sink, Tally, bias_of_excess, excess_depth, next, next_in_air, passes};
use glam::DVec3;

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
    pub(super) numbers: &'s mut CameraNumbers,
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
        mut numbers: CameraNumbers,
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
        let mut sample = Sample { pixel, numbers: &mut numbers, radii, scratch, sink, tally };
        match (&self.glass, self.plan.wavelengths) {
            (Some(lanes), _) => {
                for (lane, glass) in lanes.iter().enumerate() {
                    let through = sample.numbers.ray_through(glass, camera, pixel);
                    let Some((ray, weight)) = through else { continue };
                    if let Some(mut single) = self.on_lane(path(ray), lane, &mut sample) {
                        single.multiply(Factor::Grey(weight), sample.scratch);
                        self.follow_lane(&single, &mut sample);
                    }
                }
            }
            (None, WavelengthPlan::Shared) => self.split(path(sample.numbers.ray(camera, pixel)), &mut sample),
            (None, WavelengthPlan::Free | WavelengthPlan::Both) => {
                self.follow(&path(sample.numbers.ray(camera, pixel)), &mut sample);
            }
        }
    }

    /// Sends a path on once for each shared wavelength.
    fn split<S: Sink>(&self, path: CameraPath, sample: &mut Sample<'_, 'a, S>) {
        for lane in 0..LANES {
            if let Some(single) = self.on_lane(path, lane, sample) {
                self.follow_lane(&single, sample);
            }
        }
    }

    /// A wavelength-free path, taken to one of the shared wavelengths; `None` where the lights have no power there.
    pub(super) fn on_lane<S: Sink>(
        &self,
        path: CameraPath,
        lane: usize,
        sample: &mut Sample<'_, 'a, S>,
    ) -> Option<CameraPath> {
        let (nm, pdf) = (self.shared_nm[lane], self.shared_pdf[lane]);
        if pdf <= 0.0 {
            return None;
        }
        sample.tally.shared_paths += 1;
        let throughput = product(&sample.scratch.factors, nm) / (pdf * LANES as f64);
        Some(CameraPath { colour: Colour::Shared { lane, nm, throughput }, ..path })
    }

    /// Follows a path at one wavelength to its end; called from several places, and compiled once for all of them.
    pub(super) fn follow_lane<S: Sink>(&self, path: &CameraPath, sample: &mut Sample<'_, 'a, S>) {
        self.follow(path, sample);
    }

    /// Follows a path to its end.
    #[inline(always)]
    fn follow<S: Sink>(&self, path: &CameraPath, sample: &mut Sample<'_, 'a, S>) {
        let factors_before = sample.scratch.factors.len();
        match self.plan.between {
            BetweenPlan::Air => self.follow_among::<false, S>(path, sample),
            BetweenPlan::Clear | BetweenPlan::Absorbing | BetweenPlan::Scattering(_) => {
                self.follow_among::<true, S>(path, sample);
            }
        }
        sample.scratch.factors.truncate(factors_before);
    }

    /// The same; without `BODIES` nothing has an inside, and there is air on both sides of every surface.
    #[inline(always)]
    fn follow_among<const BODIES: bool, S: Sink>(&self, path: &CameraPath, sample: &mut Sample<'_, 'a, S>) {
        let mut path = *path;
        while path.depth < self.max_depth {
            let met = match self.plan.between {
                BetweenPlan::Absorbing | BetweenPlan::Scattering(_) if BODIES => self.advance(&mut path, sample),
                BetweenPlan::Clear if BODIES => next(self.scene, path.start, sample.numbers.stream.uniform()),
                BetweenPlan::Air | BetweenPlan::Clear | BetweenPlan::Absorbing | BetweenPlan::Scattering(_) => {
                    next_in_air(self.scene, path.start, sample.numbers.stream.uniform())
                }
            };
            if BODIES {
                let face = met.as_ref().is_some_and(|met| self.scene.body_of(met.hit.object).is_some());
                sample.tally.body_events += u64::from(face);
            }
            let Some(encounter) = met else {
                return self.see_lamps(&path, (path.start.ray.direction, None), sample);
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
            self.see_lamps(&path, (encounter.incoming, Some(&encounter.hit)), sample);
            let class = encounter.surface.class();
            if class >= Class::Glossy {
                self.gather_light::<BODIES, S>(&path, &encounter, class, sample);
            }
            if matches!(class, Class::Absorbing | Class::Diffuse) {
                return;
            }
            let (here, at) = (path, encounter);
            match self.go_on(&here, &at, sample) {
                Some(onward) => path = onward,
                None => return,
            }
        }
    }

    /// The lamps that a path sees where a leg ends: on a surface, or at infinity.
    #[inline(always)]
    fn see_lamps<S: Sink>(
        &self,
        path: &CameraPath,
        (direction, hit): (DVec3, Option<&Hit>),
        sample: &mut Sample<'_, 'a, S>,
    ) {
        for &number in self.direct.seen(hit) {
            if let Some(lamp) = self.direct.found(number, (direction, hit.copied()), path.counts, sample.tally) {
                add_lamp(*path, &lamp, sample);
            }
        }
    }

    /// Light at a surface that spreads it: from lamps, and what photons brought. At a diffuse one the path ends.
    #[inline(always)]
    fn gather_light<const BODIES: bool, S: Sink>(
        &self,
        path: &CameraPath,
        encounter: &Encounter<'a>,
        class: Class,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let ends = class == Class::Diffuse;
        sample.tally.rough_events += u64::from(!ends);
        if ends && sample.scratch.notes {
            sample.scratch.landings.push(self.landing(path, encounter));
        }
        if !self.plan.direct.is_absent() {
            self.gather_lamps::<BODIES, S>(path, encounter, sample);
        }
        // Glossy surfaces' own continuation does this for them.
        if ends && self.plan.direct.scatters_to_lamps() {
            self.gather_scattered_lamps::<BODIES, S>(path, encounter, sample);
        }
        self.gather_photons::<BODIES, S>(path, encounter, class, sample);
    }

    #[inline]
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
    #[inline(always)]
    fn gather_lamps<const BODIES: bool, S: Sink>(
        &self,
        path: &CameraPath,
        encounter: &Encounter<'a>,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let (wavelength, mut u, nm) = (sample.numbers.wavelength, sample.numbers.lamp(), path.reference_nm());
        let (surface, wo, sides) = (encounter.surface, encounter.wo, encounter.sides);
        for number in self.direct.asked(&mut u) {
            let asking = Asking { encounter, nm, u };
            let Some(lit) = self.direct.ask(asking, number, sample.tally) else { continue };
            let through = self.direct.through::<BODIES>(encounter, (lit.direction, lit.distance), u);
            let bias = bias_of_excess(path.excess_depth + excess_depth(&through, nm));
            each_wavelength(path.colour, &sample.scratch.factors, lit.light, wavelength, |nm, share| {
                let f = surface.eval(wo, lit.wi, sides, Transport::Radiance, nm);
                let weight = share * lit.light.shape_at(lit.tint, nm) * lit.strength * f * passes(&through, nm);
                sample.sink.biased(nm, weight, weight * bias);
            });
        }
    }

    /// Light straight from lamps, by a scattered ray that may find one.
    #[inline(always)]
    fn gather_scattered_lamps<const BODIES: bool, S: Sink>(
        &self,
        path: &CameraPath,
        encounter: &Encounter<'a>,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let nm = path.reference_nm();
        let u = sample.numbers.stream.triple();
        let (surface, wo, sides) = (encounter.surface, encounter.wo, encounter.sides);
        let Some(scatter) = surface.sample(wo, sides, nm, Transport::Radiance, u) else {
            return;
        };
        let direction = encounter.frame.to_world(scatter.wi);
        let ray = Ray { origin: encounter.hit.position, direction };
        let hit = self.scene.geometry.intersect(&ray, Some(encounter.hit.surface), f64::INFINITY);
        let counts = Counts::Shared { place: ray.origin, pdf: scatter.probability };
        for &number in self.direct.seen(hit.as_ref()) {
            let Some(lamp) = self.direct.found(number, (direction, hit), counts, sample.tally) else { continue };
            let length_m = hit.map_or(f64::INFINITY, |hit| hit.t);
            let through = self.direct.through::<BODIES>(encounter, (direction, length_m), direction.to_array());
            let bias = bias_of_excess(path.excess_depth + excess_depth(&through, nm));
            each_wavelength(
                path.colour,
                &sample.scratch.factors,
                lamp.light,
                sample.numbers.wavelength,
                |nm, share| {
                    let response = surface.response(wo, &scatter, sides, Transport::Radiance, nm) / scatter.probability;
                    let arriving = lamp.light.shape_at(lamp.tint, nm) * lamp.radiance * passes(&through, nm);
                    let weight = share * arriving * response;
                    sample.sink.biased(nm, weight, weight * bias);
                },
            );
        }
    }

    /// Light that photons brought, as far as the partition leaves it to the maps.
    #[inline(always)]
    fn gather_photons<const BODIES: bool, S: Sink>(
        &self,
        path: &CameraPath,
        encounter: &Encounter<'a>,
        class: Class,
        sample: &mut Sample<'_, 'a, S>,
    ) {
        let (maps, kinds) = match path.colour {
            Colour::Free => (self.free, [RadiusKind::FreeCaustic, RadiusKind::FreeIndirect]),
            Colour::Shared { .. } => (self.shared, [RadiusKind::SharedCaustic, RadiusKind::SharedIndirect]),
        };
        // Only free photons are connected to the camera, so a shared camera path that sees the surface directly takes the map.
        let view = match path.colour {
            Colour::Free => path.view,
            Colour::Shared { .. } => View::Relayed,
        };
        for light_path in [LightPath::Caustic, LightPath::Indirect] {
            let (map, kind, wanted) = match light_path {
                LightPath::Indirect => (&maps.indirect, kinds[1], self.plan.indirect != IndirectPlan::Absent),
                LightPath::Direct | LightPath::Caustic => (&maps.caustic, kinds[0], true),
            };
            if map.is_empty() || !wanted || estimator(light_path, class, view) != Estimator::PhotonMap {
                continue;
            }
            sample.tally.map_queries += 1;
            let radius = f64::from(sample.radii[kind as usize]) * self.scales.surface;
            let radius = radius.max(radius::least(encounter.hit.position));
            let shares = match path.view {
                _ if self.outlines.is_empty() => Shares::WHOLE,
                View::Seen => self.outlines.shares(sample.pixel as usize, &self.landing(path, encounter), radius),
                View::Relayed => Shares::WHOLE,
            };
            let receiver = Receiver::new(encounter, (radius, shares), path, &sample.scratch.factors);
            map.within(encounter.hit.position.as_vec3().to_array(), radius as f32, |found| {
                receiver.add::<BODIES, S>(&found, sample.sink);
            });
        }
    }
}

/// Adds a lamp that a path sees.
fn add_lamp<S: Sink>(path: CameraPath, lamp: &Found<'_>, sample: &mut Sample<'_, '_, S>) {
    let bias = bias_of_excess(path.excess_depth);
    each_wavelength(path.colour, &sample.scratch.factors, lamp.light, sample.numbers.wavelength, |nm, share| {
        let weight = share * lamp.light.shape_at(lamp.tint, nm) * lamp.radiance;
        sample.sink.biased(nm, weight, weight * bias);
    });
}

/// Calls `f` with wavelengths (nm) and what the path lets through there divided by their density: a stratified set drawn from the
/// lamp for free paths, the path's own wavelength for shared ones.
#[inline(always)]
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
