//! The table of effects: the fact that calls for each, the field of the plan, the code that reads it, and what its absence means.

use super::negligible::Negligible;
use super::{
    AimPlan, AperturePlan, BetweenPlan, CausticPlan, DirectPlan, IndirectPlan, LampsInside, MotionPlan, Plan, Rim,
    VolumePlan, WavelengthPlan,
};
use crate::error::{Error, Result};
use crate::scene::facts::Facts;

/// One effect that a scene may call for.
#[derive(Debug, Clone, Copy)]
pub struct Effect {
    /// Its name for `--force`, `--forbid` and reports.
    pub name: &'static str,
    /// The field of the plan that switches it, or what of the scene does.
    pub field: &'static str,
    /// The code that reads it.
    pub read_by: &'static str,
    /// What it costs where it is on.
    pub cost: &'static str,
    /// What its absence means.
    pub absent: &'static str,
    /// What calls for it.
    called_by: &'static str,
    /// Why it is off where nothing does.
    uncalled: &'static str,
    /// The names of the scene's things that call for it; empty if nothing does.
    calls: fn(&Facts) -> Vec<String>,
    /// Switches it on or off in a plan.
    set: fn(&mut Plan, &Facts, bool),
}

impl Effect {
    /// The names of the scene's things that call for it.
    pub(super) fn callers(&self, facts: &Facts) -> Vec<String> {
        (self.calls)(facts)
    }
}

/// All effects.
pub const EFFECTS: [Effect; 17] = [
    Effect {
        name: "dispersion",
        field: "wavelengths",
        read_by: "gather (camera paths), emit (the shared photon set)",
        cost: "four camera paths behind dispersive glass, and a second photon set on the pass's shared wavelengths",
        absent: "one photon set; camera paths stay functions of wavelength; no shared wavelength is drawn",
        called_by: "dispersive glass",
        uncalled: "no glass whose index depends on the wavelength",
        calls: |facts| facts.dispersive.clone(),
        set: |plan, _, on| plan.wavelengths = if on { WavelengthPlan::Both } else { WavelengthPlan::Free },
    },
    Effect {
        name: "shared",
        field: "wavelengths",
        read_by: "gather (camera paths), emit (the shared photon set)",
        cost: "four camera paths at the pass's shared wavelengths from the start: more colour noise",
        absent: "camera paths stay wavelength-free until they refract dispersively",
        called_by: "a camera lens of real glass",
        uncalled: "no camera lens of real glass, whose rays part by wavelength",
        calls: |facts| facts.lens_system.iter().cloned().collect(),
        set: |plan, _, on| {
            if on {
                plan.wavelengths = WavelengthPlan::Shared;
            }
        },
    },
    Effect {
        name: "caustics",
        field: "caustics",
        read_by: "emit (what photons are kept or connected)",
        cost: "a photon's path through the glass, a shadow ray to the camera, 56 bytes in the map",
        absent: "no photon is kept or connected on its way from mirrors and glass",
        called_by: "mirrors or glass",
        uncalled: "no mirror or glass, or no surface for its light to fall on",
        calls: |facts| if facts.scatters() { facts.specular.clone() } else { Vec::new() },
        set: |plan, _, on| plan.caustics = if on { CausticPlan::Photons } else { CausticPlan::Absent },
    },
    Effect {
        name: "indirect",
        field: "indirect",
        read_by: "emit (what photons are kept), gather (map queries)",
        cost: "56 bytes a photon event, the tree, one query a camera path",
        absent: "no photon is kept once it has been scattered",
        called_by: "surfaces that pass light on",
        uncalled: "no surface passes light on",
        calls: |facts| [facts.diffuse.as_slice(), &facts.glossy].concat(),
        set: |plan, _, on| plan.indirect = if on { IndirectPlan::Photons } else { IndirectPlan::Absent },
    },
    Effect {
        name: "direct",
        field: "direct",
        read_by: "gather (shadow rays)",
        cost: "a shadow ray for each lamp, and a scattered ray where a lamp can be hit",
        absent: "no shadow ray",
        called_by: "lamps within reach of shadow rays",
        uncalled: "no surface or particle for a lamp to light, or no lamp",
        calls: |facts| {
            let particles = facts.dense_media.iter().chain(&facts.thin_media).next();
            if facts.scatters() || particles.is_some() { facts.lights.clone() } else { Vec::new() }
        },
        set: |plan, facts, on| {
            plan.direct = match (on, facts.hittable_lights.is_empty()) {
                (false, _) => DirectPlan::Absent,
                (true, true) => DirectPlan::ShadowRays,
                (true, false) => DirectPlan::ShadowAndScatteredRays,
            }
        },
    },
    Effect {
        name: "depth-of-field",
        field: "aperture",
        read_by: "gather (camera rays), emit (connections)",
        cost: "a point on the lens for each camera ray and connection",
        absent: "all rays start at the pinhole; no lens point is drawn",
        called_by: "the camera's opening",
        uncalled: "the camera is a pinhole",
        calls: |facts| {
            let opening = facts.aperture_nm.map(|nm| format!("of radius {:.3} mm", nm as f64 * 1e-6));
            opening.into_iter().collect()
        },
        set: |plan, facts, on| {
            plan.aperture = match (on, &facts.lens_system) {
                (false, _) => AperturePlan::Pinhole,
                (true, None) => AperturePlan::ThinLens(Rim::Stops),
                (true, Some(_)) => AperturePlan::LensSystem(Rim::Stops),
            }
        },
    },
    Effect {
        name: "diffraction",
        field: "aperture",
        read_by: "render (what the film keeps apart), sensor (develop)",
        cost: "48 bytes a pixel for each slice of the spectrum, up to 16; developing takes a convolution for each",
        absent: "no slice of the spectrum is kept, nothing is convolved",
        called_by: "the camera's opening",
        uncalled: "not asked for by the camera's lens",
        calls: |facts| facts.diffracting.iter().cloned().collect(),
        set: |plan, _, on| {
            let rim = if on { Rim::Diffracts } else { Rim::Stops };
            plan.aperture = match plan.aperture {
                AperturePlan::Pinhole => AperturePlan::Pinhole,
                AperturePlan::ThinLens(_) => AperturePlan::ThinLens(rim),
                AperturePlan::LensSystem(_) => AperturePlan::LensSystem(rim),
            };
        },
    },
    Effect {
        name: "environment",
        field: "scene.distant_lights",
        read_by: "gather (rays that leave the scene)",
        cost: "a look at the surroundings for each ray that leaves the scene",
        absent: "rays that leave the scene find nothing",
        called_by: "light from infinity",
        uncalled: "no light from infinity",
        calls: |facts| facts.surroundings.clone(),
        set: |_, _, _| {},
    },
    Effect {
        name: "roughness",
        field: "scene.materials",
        read_by: "gather (camera paths go on)",
        cost: "a longer camera path with shadow rays at each rough surface",
        absent: "no such event",
        called_by: "rough or coated surfaces",
        uncalled: "no rough or coated surface",
        calls: |facts| facts.glossy.clone(),
        set: |_, _, _| {},
    },
    Effect {
        name: "bodies",
        field: "between",
        read_by: "walk (the bodies around each ray), emit and gather (which of their loops runs)",
        cost: "a list of the bodies around each ray, a look at each face whether it shows, a wavelength count for each path",
        absent: "every surface has air on both sides, and every photon keeps its wavelengths",
        called_by: "things with an inside",
        uncalled: "nothing has an inside: no glass, no liquid, no medium",
        calls: |facts| facts.bodies.clone(),
        set: |plan, _, on| plan.between = if on { BetweenPlan::Clear } else { BetweenPlan::Air },
    },
    Effect {
        name: "absorption",
        field: "between",
        read_by: "walk (stretches inside bodies)",
        cost: "an exponential per wavelength and stretch",
        absent: "bodies are clear",
        called_by: "absorbing glass or liquid",
        uncalled: "no absorbing glass or liquid",
        calls: |facts| facts.absorbing_bodies.clone(),
        set: |plan, _, on| {
            if on {
                plan.between = BetweenPlan::Absorbing;
            }
        },
    },
    Effect {
        name: "media",
        field: "between",
        read_by: "walk (stretches of fog and smoke), gather (light scattered into camera rays), emit (photons that meet particles)",
        cost: "a drawn place and a shadow ray for each lamp and stretch of a camera ray; a drawn distance for each stretch of a photon's way",
        absent: "light passes between surfaces as if nothing were there",
        called_by: "media",
        uncalled: "nothing fills the space between surfaces",
        calls: |facts| facts.media.clone(),
        set: |plan, _, on| {
            if on {
                plan.between = BetweenPlan::Scattering(LampsInside::Asked);
            }
        },
    },
    Effect {
        name: "light-map",
        field: "between",
        read_by: "map (a grid around each medium for each lamp), gather (light scattered into camera rays)",
        cost: "a shadow ray and 5 bytes for each node of a grid around each medium, for each lamp; 8 looks and shadow rays for each lamp and stretch of a camera ray",
        absent: "camera rays ask lamps by shadow rays from drawn places",
        called_by: "thin fog that is the same everywhere around lamps without extent, which maps know without error, or a stated resolution",
        uncalled: "no thin fog that is the same everywhere around lamps without extent, or mirrors or glass beside it: drawn places know more media without error, as fast",
        calls: |facts| facts.light_map.clone(),
        set: |plan, _, on| {
            if let BetweenPlan::Scattering(lamps) = &mut plan.between {
                *lamps = if on && !plan.direct.is_absent() { LampsInside::Mapped } else { LampsInside::Asked };
            }
        },
    },
    Effect {
        name: "volume-photons",
        field: "volume",
        read_by: "emit (what is kept where photons meet particles), gather (along camera rays)",
        cost: "52 bytes a scattering, the tree of boxes, one look along each camera ray",
        absent: "no photon is kept where it meets a particle",
        called_by: "dense media that scatter light again and again",
        uncalled: "no dense medium that scatters",
        calls: |facts| facts.dense_media.clone(),
        set: |plan, _, on| plan.volume = VolumePlan::of(on, plan.volume.keeps_beams(false)),
    },
    Effect {
        name: "photon-beams",
        field: "volume",
        read_by: "emit (photons' ways through media), gather (along camera rays)",
        cost: "64 bytes a way, the tree of its pieces' boxes, one look along each camera ray",
        absent: "no photon's way is kept",
        called_by: "thin media that scatter light",
        uncalled: "no thin medium that scatters",
        calls: |facts| facts.thin_media.clone(),
        set: |plan, _, on| plan.volume = VolumePlan::of(plan.volume.keeps_points(true), on),
    },
    Effect {
        name: "aim",
        field: "aim",
        read_by: "emit (where lights send photons)",
        cost: "a pilot of some photons, and a table look-up a photon",
        absent: "photons start as the lights shine",
        called_by: "mirrors or glass that fill only a part of the lights' view",
        uncalled: "no mirror or glass to aim at, or no surface for its light to fall on",
        calls: |facts| if facts.scatters() { facts.specular.clone() } else { Vec::new() },
        set: |plan, _, on| plan.aim = if on { AimPlan::Learned } else { AimPlan::Plain },
    },
    Effect {
        name: "motion",
        field: "motion",
        read_by: "render (each pass poses the scene at a moment of its own), the pilot",
        cost: "a new tree of boxes each pass if objects move, a pilot at several moments, and as many passes as nothing strobes",
        absent: "all passes share one scene; no moment is drawn",
        called_by: "things that move while the shutter is open",
        uncalled: "nothing moves while the shutter is open",
        calls: |facts| facts.moving.clone(),
        set: |plan, _, on| plan.motion = if on { MotionPlan::PosedPerPass } else { MotionPlan::Still },
    },
];

/// Whether an effect is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Yes: the scene calls for it.
    On,
    /// No: nothing calls for it.
    Off,
    /// Yes, though nothing calls for it.
    Forced,
    /// No, though something calls for it.
    Forbidden,
}

impl State {
    /// Whether the effect is simulated.
    pub fn is_on(self) -> bool {
        matches!(self, Self::On | Self::Forced)
    }

    /// The word for reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::On => "on",
            Self::Off => "off",
            Self::Forced => "forced",
            Self::Forbidden => "forbidden",
        }
    }
}

/// One row of the explanation.
#[derive(Debug, Clone)]
pub struct Row {
    /// The effect.
    pub effect: &'static Effect,
    /// Its state.
    pub state: State,
    /// Why.
    pub because: String,
}

/// Decides every effect; those that are `negligible` are on only by force.
pub(super) fn decide(
    facts: &Facts,
    negligible: &[Negligible],
    force: &[String],
    forbid: &[String],
) -> Result<(Plan, Vec<Row>)> {
    for name in force.iter().chain(forbid) {
        if !EFFECTS.iter().any(|effect| effect.name == name) {
            let names: Vec<&str> = EFFECTS.iter().map(|effect| effect.name).collect();
            return Err(Error::unknown_name("effect", name, names.iter().copied())
                .expected(format!("one of {}", names.join(", "))));
        }
    }
    if let Some(name) = force.iter().find(|name| forbid.contains(name)) {
        return Err(Error::input(format!("the effect \"{name}\" is both forced and forbidden")));
    }
    let mut plan = Plan {
        wavelengths: WavelengthPlan::Free,
        caustics: CausticPlan::Absent,
        indirect: IndirectPlan::Absent,
        direct: DirectPlan::Absent,
        aperture: AperturePlan::Pinhole,
        between: BetweenPlan::Air,
        volume: VolumePlan::Absent,
        aim: AimPlan::Plain,
        motion: MotionPlan::Still,
    };
    let mut rows = Vec::with_capacity(EFFECTS.len());
    for effect in &EFFECTS {
        let callers = effect.callers(facts);
        let negligible = negligible.iter().find(|negligible| negligible.effect == effect.name);
        let uncalled = negligible.map_or(effect.uncalled, |negligible| &negligible.because);
        let named = |list: &[String]| list.iter().any(|name| name == effect.name);
        let called = !callers.is_empty() && negligible.is_none();
        let state = match (called, named(force), named(forbid)) {
            (false, _, true) | (false, false, false) => State::Off,
            (true, _, true) => State::Forbidden,
            (true, _, false) => State::On,
            (false, true, false) => State::Forced,
        };
        (effect.set)(&mut plan, facts, state.is_on());
        let because = match state {
            State::On | State::Forbidden => format!("{}: {}", effect.called_by, listed(&callers)),
            State::Off => uncalled.to_owned(),
            State::Forced => format!("asked for by name; {uncalled}"),
        };
        rows.push(Row { effect, state, because });
    }
    Ok((plan, rows))
}

/// The first few names.
pub(super) fn listed(names: &[String]) -> String {
    const SHOWN: usize = 3;
    let shown = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{shown} and {} more", names.len() - SHOWN) } else { shown }
}
