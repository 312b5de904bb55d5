//! Decides which effects are simulated, and builds the plan.

use super::effect_table::EFFECTS;
use super::effects::{Effect, listed};
use super::fields::Plan;
use super::negligible::NegligibleEffect;
use abbe_scene::facts::Facts;
use abbe_spectra::error::{Error, Result};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectState {
    /// The effect is simulated, because the scene needs it.
    On,
    /// Not simulated, because nothing needs it or it is negligible.
    Off,
    /// Simulated only because the user requests it.
    Forced,
    /// The effect is not simulated, because the user forbids it. The scene needs the effect.
    Forbidden,
}

impl EffectState {
    pub fn is_on(self) -> bool {
        matches!(self, Self::On | Self::Forced)
    }

    /// Returns the name of the state in reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::On => "on",
            Self::Off => "off",
            Self::Forced => "forced",
            Self::Forbidden => "forbidden",
        }
    }
}

#[derive(Debug, Clone)]
pub struct EffectRow {
    pub effect: &'static Effect,
    pub state: EffectState,
    /// The reason, in words.
    pub because: String,
}

/// Decides all effects in the order of [`EFFECTS`]. A negligible effect is on only if it is forced.
/// Returns an input error if a name in `force` or `forbid` is not an effect, or is in both.
pub(super) fn decide(
    facts: &Facts,
    negligible: &[NegligibleEffect],
    force: &[String],
    forbid: &[String],
) -> Result<(Plan, Vec<EffectRow>)> {
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
    let mut plan = Plan::EMPTY;
    let mut rows = Vec::with_capacity(EFFECTS.len());
    for effect in &EFFECTS {
        let requirers = (effect.requires)(facts);
        let negligible = negligible.iter().find(|negligible| negligible.effect == effect.id);
        let not_required = negligible.map_or(effect.not_required, |negligible| &negligible.because);
        let named = |list: &[String]| list.iter().any(|name| name == effect.name);
        let required = !requirers.is_empty() && negligible.is_none();
        let state = match (required, named(force), named(forbid)) {
            (false, _, true) | (false, false, false) => EffectState::Off,
            (true, _, true) => EffectState::Forbidden,
            (true, _, false) => EffectState::On,
            (false, true, false) => EffectState::Forced,
        };
        (effect.set)(&mut plan, facts, state.is_on());
        let because = match state {
            EffectState::On | EffectState::Forbidden => format!("{}: {}", effect.required_by, listed(&requirers)),
            EffectState::Off => not_required.to_owned(),
            EffectState::Forced => format!("forced by name; {not_required}"),
        };
        rows.push(EffectRow { effect, state, because });
    }
    Ok((plan, rows))
}
