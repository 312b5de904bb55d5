//! `abbe render`: renders a scene and saves the picture.

use std::path::{Path, PathBuf};
use std::time::Duration;

use abbe::error::{Error, Result};
use abbe::output::exr::write as write_exr;
use abbe::output::file as files;
use abbe::output::metadata::names;
use abbe::render::{Identity, Integrator, Job, Part, Rendered, Request, Showing, StopRules, on_threads};
use abbe::scene::file::Source;
use abbe::scene::resolve;

use super::checkpoint::{Checkpoint, Rhythm, Watch};
use super::frames::{Frame, Sequence};
use super::outputs::Outputs;
use super::progress::{Display, percent, time};
use super::{Outcome, interrupt, memory, opening, origin, print, values};

#[derive(Debug, Clone, clap::Args)]
pub(crate) struct Arguments {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// The picture's file; a PNG is written beside it [default: the scene's name in the working directory]
    #[arg(short, long, value_name = "OUT.exr")]
    output: Option<PathBuf>,
    /// Stop after this many passes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    passes: Option<u64>,
    /// Stop after this time, such as 90s or 5m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    time: Option<Duration>,
    /// Stop when the picture's relative error falls to this, such as 2%
    #[arg(long, value_name = "SHARE", value_parser = values::share)]
    target_error: Option<f64>,
    /// Photon paths in a pass
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    photons: Option<u64>,
    /// The picture's size in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// The seed of all randomness
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Worker threads [default: as many as the machine runs at once]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// Who solves the transport: photon mapping, or the plain path tracer for reference
    #[arg(long, value_enum, default_value_t)]
    integrator: IntegratorName,
    /// Simulate an effect though nothing in the scene calls for it (repeatable; see `abbe explain`)
    #[arg(long, value_name = "EFFECT")]
    force: Vec<String>,
    /// Leave out an effect though the scene calls for it (repeatable)
    #[arg(long, value_name = "EFFECT")]
    forbid: Vec<String>,
    /// Change a value of the scene, such as 'objects[0].material="crown"' (repeatable)
    #[arg(long, value_name = "PATH=JSON")]
    set: Vec<String>,
    #[command(flatten)]
    opening: opening::Arguments,
    /// Keep the spectrum of every pixel in this many bands
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1024))]
    spectral_bands: Option<u32>,
    /// Render only the passes whose index leaves remainder I when divided by N, from 0/N on; `abbe merge` joins the parts
    #[arg(long, value_name = "I/N", value_parser = values::part, default_value = "0/1", hide_default_value = true)]
    #[arg(conflicts_with = "target_error")]
    part: Part,
    /// Go on from the checkpoint beside the output: finish an interrupted render, or extend it with a larger --passes,
    /// --time or smaller --target-error (all count from the render's very beginning)
    #[arg(long)]
    resume: bool,
    /// Keep the checkpoint, OUT.checkpoint.exr, when the picture is complete
    #[arg(long)]
    keep_checkpoint: bool,
    /// Write a checkpoint this often, such as 10m [default: as the scene says, or 60s, or more where saving takes over 3s]
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    checkpoint_every: Option<Duration>,
    #[command(flatten)]
    sequence: Sequence,
    /// Write what was measured on the way, as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Say nothing unless something goes wrong
    #[arg(long)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
enum IntegratorName {
    #[default]
    Photon,
    Path,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    interrupt::watch()?;
    let Some(frames) = arguments.sequence.frames() else {
        return picture(arguments, None);
    };
    for frame in frames {
        let outcome = picture(&arguments.of_frame(&frame)?, Some(&frame))?;
        if outcome != Outcome::Done {
            return Ok(outcome);
        }
    }
    Ok(Outcome::Done)
}

/// Renders one picture; of a sequence the frame is told.
fn picture(arguments: &Arguments, frame: Option<&Frame>) -> Result<Outcome> {
    let outputs = arguments.outputs()?;
    let (source, job) = plan(arguments)?;
    memory::check(&job.budget)?;
    let request = arguments.request();
    let of_scene = origin::of_scene(&source, &job, request.integrator);
    let identity = Identity::of(&job, request.integrator, of_scene.get(names::SCENE_HASH).unwrap_or_default());
    let checkpoint = Checkpoint { path: outputs.checkpoint(), job: &job, identity: &identity, metadata: &of_scene };
    outputs.check()?;
    files::clear_unfinished(&checkpoint.path);
    files::check_writable(&checkpoint.path)?;
    let label = frame.map(Frame::label);
    // Of a sequence some frames may be finished, and some not begun.
    let resume = arguments.resume && (frame.is_none() || checkpoint.path.exists());
    if frame.is_some() && arguments.resume && !resume && origin::is_finished(&outputs.exr, &of_scene, request, &job) {
        if !arguments.quiet {
            print::remark(&format!("{} is finished", outputs.exr.display()));
        }
        return Ok(Outcome::Done);
    }
    let begin = checkpoint.start(arguments.part, resume)?;
    if !arguments.quiet {
        job.scene.notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
        let path = checkpoint.path.display();
        if resume {
            print::remark(&format!("resuming after {} passes, from {path}", begin.passes()));
        } else if checkpoint.path.exists() {
            print::remark(&format!("note: starting anew; {path}, from which --resume would go on, will be replaced"));
        }
    }
    let threads = job.scene.settings.threads;
    let mut watch = Watch::new(Display::new(arguments.quiet, label), &checkpoint, arguments.rhythm(&job));
    let rendered = on_threads(threads, || job.go_on(request, begin, &mut watch));
    watch.display.finish();
    let rendered = rendered?.map_err(|error| error.in_file(&arguments.scene))?;
    on_threads(threads, || save(arguments, &outputs, &checkpoint, &rendered))??;
    if rendered.stats.rejected_samples > 0 {
        let count = rendered.stats.rejected_samples;
        print::remark(&format!(
            "warning: {count} contributions were no light and were left out; this is a bug in abbe, please report it"
        ));
    }
    if rendered.interrupted {
        let (passes, path) = (rendered.stats.passes, checkpoint.path.display());
        let named = outputs.named();
        print::remark(&format!("interrupted after {passes} passes; saved in {named}; --resume goes on from {path}"));
        return Ok(Outcome::Interrupted);
    }
    if !arguments.quiet {
        print::remark(&summary(&rendered, &outputs));
    }
    Ok(Outcome::Done)
}

/// Saves the picture, with its exact sums if it is a part, and keeps the checkpoint if anything is left to do.
fn save(arguments: &Arguments, outputs: &Outputs, checkpoint: &Checkpoint<'_>, rendered: &Rendered) -> Result<()> {
    let (picture, run) = (&rendered.picture, &rendered.run);
    let metadata = origin::of_render(checkpoint.metadata, &rendered.stats);
    let write = |path: &Path| match arguments.part {
        Part::WHOLE => write_exr(path, picture, &metadata),
        _ => checkpoint.write_to(path, run, metadata.clone()),
    };
    let saved = outputs.save(write, picture, &Showing::of(checkpoint.job), &rendered.stats);
    let keep = rendered.interrupted || arguments.keep_checkpoint || saved.is_err();
    let ended = checkpoint.end(run, keep);
    match (saved, ended) {
        (Err(error), Ok(())) => {
            let what = format!("{}; all passes are kept in {}", error.what, checkpoint.path.display());
            Err(Error { what, ..error })
        }
        (Err(error), Err(_)) => Err(error),
        (Ok(()), ended) => ended,
    }
}

impl Arguments {
    /// The command that renders one frame of a sequence.
    fn of_frame(&self, frame: &Frame) -> Result<Self> {
        let pattern = self.output.clone().unwrap_or_else(|| self.stem().with_added_extension("####.exr"));
        let mut arguments = Self { output: Some(frame.name(&pattern)?), ..self.clone() };
        arguments.stats = self.stats.as_deref().map(|pattern| frame.name(pattern)).transpose()?;
        arguments.set.extend(frame.patches());
        Ok(arguments)
    }

    /// The scene's name, in the working directory.
    fn stem(&self) -> PathBuf {
        PathBuf::from(self.scene.file_stem().unwrap_or("scene".as_ref()))
    }

    fn request(&self) -> Request {
        let integrator = match self.integrator {
            IntegratorName::Photon => Integrator::Photon,
            IntegratorName::Path => Integrator::Path,
        };
        let stop = StopRules { passes: self.passes, time: self.time, target_error: self.target_error };
        Request { integrator, stop }
    }

    /// The files to be written; parts without a name of their own are named apart.
    fn outputs(&self) -> Result<Outputs> {
        let exr = match (&self.output, self.part) {
            (Some(path), _) => path.clone(),
            (None, Part::WHOLE) => self.stem().with_added_extension("exr"),
            (None, part) => {
                self.stem().with_added_extension(format!("part-{}.exr", part.to_string().replace('/', "-of-")))
            }
        };
        Outputs::new(exr, self.stats.clone())
    }

    fn rhythm(&self, job: &Job) -> Rhythm {
        let of_scene = || Duration::try_from_secs_f64(job.scene.settings.checkpoint_seconds?).ok();
        self.checkpoint_every.or_else(of_scene).map_or(Rhythm::Sparing, Rhythm::Every)
    }

    /// The command line as patches of the scene; options override what `--set` sets.
    fn patches(&self) -> Vec<String> {
        let mut patches = self.set.clone();
        let mut add = |path: &str, value: Option<String>| patches.extend(value.map(|value| format!("{path}={value}")));
        add("film.width", self.size.map(|(width, _)| width.to_string()));
        add("film.height", self.size.map(|(_, height)| height.to_string()));
        add("film.spectral_bands", self.spectral_bands.map(|bands| bands.to_string()));
        add("render.photons", self.photons.map(|photons| photons.to_string()));
        add("render.seed", self.seed.map(|seed| seed.to_string()));
        add("render.threads", self.threads.map(|threads| threads.to_string()));
        patches
    }
}

/// Reads, resolves and plans the scene as the command line changes it.
fn plan(arguments: &Arguments) -> Result<(Source, Job)> {
    let path = &arguments.scene;
    let mut patches = arguments.patches();
    let (mut scene, mut source) = arguments.opening.read(path, &patches)?;
    if !(arguments.force.is_empty() && arguments.forbid.is_empty()) {
        // Effects of the command line come on top of the scene's own.
        for (key, own, more) in
            [("force", &scene.render.force, &arguments.force), ("forbid", &scene.render.forbid, &arguments.forbid)]
        {
            let all: Vec<&String> = own.iter().chain(more).collect();
            let list = serde_json::to_string(&all).expect("a list of texts is JSON");
            patches.push(format!("render.{key}={list}"));
        }
        (scene, source) = arguments.opening.read(path, &patches)?;
    }
    let resolved = resolve::resolve(&scene, &source)?;
    let job = Job::new(resolved).map_err(|error| error.in_file(path))?;
    Ok((source, job))
}

fn summary(rendered: &Rendered, outputs: &Outputs) -> String {
    let stats = &rendered.stats;
    let spent = time(Duration::try_from_secs_f64(stats.seconds.total).unwrap_or_default());
    let error = stats.error.relative.map_or(String::new(), |error| format!(", error {}", percent(error)));
    format!("{}: {} passes in {spent}{error}", outputs.named(), stats.passes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        arguments: Arguments,
    }

    fn arguments(words: &[&str]) -> Arguments {
        Line::try_parse_from([&["render"], words].concat()).unwrap().arguments
    }

    #[test]
    fn options_become_patches_after_those_of_set() {
        let given =
            arguments(&["a.json", "--size", "64x32", "--set", "film.width=7", "--seed", "3", "--spectral-bands", "8"]);
        assert_eq!(
            given.patches(),
            ["film.width=7", "film.width=64", "film.height=32", "film.spectral_bands=8", "render.seed=3"]
        );
    }

    #[test]
    fn the_output_is_named_for_the_scene_in_the_working_directory() {
        let named = |words: &[&str]| arguments(words).outputs().map(|outputs| outputs.named());
        assert_eq!(named(&["far/away/newton.v2.json"]).unwrap(), "newton.v2.exr and newton.v2.png");
        let part = named(&["a.v2.json", "--part", "1/4"]).unwrap();
        assert_eq!(part, "a.v2.part-1-of-4.exr and a.v2.part-1-of-4.png");
        assert_eq!(named(&["a.json", "-o", "out/b.EXR"]).unwrap(), "out/b.EXR and out/b.png");
        assert_eq!(named(&["a.json", "-o", "b.png"]).unwrap_err().exit_status(), 2);
    }

    #[test]
    fn stop_rules_are_those_of_the_command_line() {
        let stop = arguments(&["a.json", "--time", "5m", "--target-error", "2%"]).request().stop;
        let known = StopRules { passes: None, time: Some(Duration::from_secs(300)), target_error: Some(0.02) };
        assert_eq!(stop, known);
        assert!(Line::try_parse_from(["render", "a.json", "--passes", "0"]).is_err());
        assert!(Line::try_parse_from(["render", "a.json", "--integrator", "bidirectional"]).is_err());
    }
}
