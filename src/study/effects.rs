//! Effect by effect: what each costs, and how much of the picture it makes.

use super::course::{Done, Order, Workshop};
use super::reference::Estimate;
use super::truth::{Truth, seed};
use super::{Halt, SHARES};
use crate::output::compare::{DeltaE, Selection, compare};
use crate::plan::{Row, State};
use crate::render::Job;
use crate::scene::file::SceneFile;
use crate::sensor::Picture;
use serde::Serialize;

/// An effect that the plan switched on, and the picture without it.
#[derive(Debug, Clone, Serialize)]
pub struct Without {
    /// Its name.
    pub name: &'static str,
    /// `on` or `forced`.
    pub state: &'static str,
    /// What calls for it.
    pub because: String,
    /// How often it was at work.
    pub events: u64,
    /// What leaving it out does, or why it cannot be left out.
    pub left_out: LeftOut,
    /// The picture without it.
    #[serde(skip)]
    pub picture: Option<Picture>,
}

/// What leaving an effect out does.
#[derive(Debug, Clone, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LeftOut {
    /// It saves this, and the picture changes so.
    Measured {
        /// Seconds and memory without it.
        cost: Cost,
        /// How far the picture without it is from the one with it, after as many passes of the same seed.
        relative_mse: f64,
        /// The same as colours.
        delta_e_2000: DeltaE,
        /// How wrong the picture without it is.
        wrong: Estimate,
    },
    /// It cannot.
    Refused(String),
    /// There was no time for it.
    NoTime,
}

/// What a render costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Seconds in all, pilot included.
    pub seconds: f64,
    /// Seconds of a pass.
    pub seconds_per_pass: f64,
    /// Memory of film, scene and photons, by the number of photons that were kept.
    pub memory_bytes: u64,
}

/// An effect that is off.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Off {
    /// Its name.
    pub name: &'static str,
    /// `off` or `forbidden`.
    pub state: &'static str,
    /// Why.
    pub because: String,
    /// How often it was at work: 0.
    pub events: u64,
}

/// What was found of all effects.
#[derive(Debug, Clone, Serialize)]
pub struct Effects {
    /// Passes of every picture that is compared.
    pub passes: u64,
    /// What the whole picture costs.
    pub with: Cost,
    /// How wrong the whole picture is.
    pub wrong: Estimate,
    /// What noise alone makes of a comparison: the whole picture against one of another seed.
    pub noise_relative_mse: f64,
    /// The same as colours.
    pub noise_delta_e_2000: DeltaE,
    /// Those that are on.
    pub on: Vec<Without>,
    /// Those that are off.
    pub off: Vec<Off>,
    /// The whole picture.
    #[serde(skip)]
    pub picture: Picture,
}

const OTHER_SEED: u64 = 301;

/// How many renders it takes at most.
pub(super) fn steps(job: &Job) -> usize {
    2 + job.rows.iter().filter(|row| row.state.is_on()).count()
}

impl Cost {
    fn of(done: &Done) -> Self {
        let stats = &done.found.stats;
        let passing = stats.seconds.total - stats.seconds.pilot;
        Self {
            seconds: stats.seconds.total,
            seconds_per_pass: passing / stats.passes.max(1) as f64,
            memory_bytes: done.found.memory_bytes,
        }
    }
}

impl Effects {
    /// Renders the whole picture, once more with another seed, and then without each effect that is on.
    pub(super) fn of(
        workshop: &mut Workshop<'_>,
        (written, job): (&SceneFile, &Job),
        (truth, budget): (&Truth, f64),
    ) -> Result<Self, Halt> {
        let share = SHARES.effects * budget;
        let before = workshop.spent;
        let seconds = share / steps(job) as f64;
        let whole = workshop.render(&Order::new("effects-all", "all effects", seconds), truth.measure())?;
        let stats = &whole.found.stats;
        let order = Order::new("effects-other-seed", "all effects, another seed", seconds).until(stats.passes);
        let other = workshop.render(&order.changed([seed(job, OTHER_SEED)]), None)?;
        let noise = compare(&other.picture, &whole.picture, &Selection::default())?;
        let events = |row: &Row| stats.effects.get(row.effect.name).map_or(0, |effect| effect.events);
        let (mut on, mut off) = (Vec::new(), Vec::new());
        for row in &job.rows {
            let (name, state, because, events) = (row.effect.name, row.state.word(), row.because.clone(), events(row));
            if !row.state.is_on() {
                off.push(Off { name, state, because, events });
                continue;
            }
            // What is left out may also make passes slower.
            let (left_out, picture) = if workshop.spent - before > 2.0 * share {
                workshop.step.0 += 1;
                (LeftOut::NoTime, None)
            } else {
                without(workshop, (written, row), &whole, truth)?
            };
            on.push(Without { name, state, because, events, left_out, picture });
        }
        Ok(Self {
            passes: stats.passes,
            with: Cost::of(&whole),
            wrong: wrong(&whole),
            noise_relative_mse: noise.relative_mse,
            noise_delta_e_2000: noise.delta_e_2000,
            on,
            off,
            picture: whole.picture,
        })
    }
}

/// The error at the end, over the whole picture.
fn wrong(done: &Done) -> Estimate {
    let none = Estimate { value: f64::NAN, standard_error: f64::NAN };
    done.found.points.last().map_or(none, |point| point.wrong.whole)
}

/// The picture without an effect, after as many passes as the whole one.
fn without(
    workshop: &mut Workshop<'_>,
    (written, row): (&SceneFile, &Row),
    whole: &Done,
    truth: &Truth,
) -> Result<(LeftOut, Option<Picture>), Halt> {
    let name = row.effect.name;
    let changes = leaving_out(written, row);
    let planned = workshop.film.iter().chain(&changes).cloned().collect::<Vec<String>>();
    if let Err(error) = workshop.subject.job(&planned) {
        workshop.step.0 += 1;
        let reason =
            error.expected.map_or(error.what.clone(), |expected| format!("{}; expected {expected}", error.what));
        return Ok((LeftOut::Refused(reason), None));
    }
    let order = Order::new(&format!("effects-without-{name}"), &format!("without {name}"), 1.0);
    let order = order.until(whole.found.stats.passes).changed(changes);
    let done = workshop.render(&order, truth.measure())?;
    let difference = compare(&done.picture, &whole.picture, &Selection::default())?;
    let measured = LeftOut::Measured {
        cost: Cost::of(&done),
        relative_mse: difference.relative_mse,
        delta_e_2000: difference.delta_e_2000,
        wrong: wrong(&done),
    };
    Ok((measured, Some(done.picture)))
}

/// The changes that leave an effect out: it is forbidden, or no longer forced.
fn leaving_out(written: &SceneFile, row: &Row) -> Vec<String> {
    let name = row.effect.name;
    let list = |names: Vec<&str>| {
        format!("[{}]", names.iter().map(|name| format!("\"{name}\"")).collect::<Vec<_>>().join(","))
    };
    let (force, forbid) = (&written.render.force, &written.render.forbid);
    if row.state == State::Forced {
        let others = force.iter().map(String::as_str).filter(|&other| other != name);
        return vec![format!("render.force={}", list(others.collect()))];
    }
    // One that the scene both calls for and forces cannot be forced any more.
    let others = force.iter().map(String::as_str).filter(|&other| other != name).collect();
    let forbidden = forbid.iter().map(String::as_str).chain([name]).collect();
    vec![format!("render.force={}", list(others)), format!("render.forbid={}", list(forbidden))]
}
