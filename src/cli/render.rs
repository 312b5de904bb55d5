//! `abbe render`: renders a scene and saves the picture.

use std::path::{Path, PathBuf};
use std::time::Duration;

use abbe_format::JsonSource;
use abbe_format::resolve;
use abbe_session::output::Metadata;
use abbe_session::output::exr::write as write_exr;
use abbe_session::output::file as files;
use abbe_session::output::metadata::names;
use abbe_session::output::png::write_animation;
use abbe_session::render::{
    DisplaySettings, Integrator, Job, PassPart, RenderIdentity, Rendered, Request, StopRules, on_threads,
};
use abbe_spectra::error::{Error, Result};

use super::checkpoint::{CheckpointFile, CheckpointInterval, RenderMonitor};
use super::develop::DenoiseArgs;
use super::display_server::{DisplayServer, ServerAddress};
use super::frames::{self, SequenceArgs, SequenceFrame};
use super::outputs::OutputFiles;
use super::preview::Preview;
use super::progress::{ProgressDisplay, time};
use super::scene_file::SceneFileArgs;
use super::{Outcome, interrupt, print, values};
use crate::api::memory;
use crate::api::provenance::{self, SceneFiles};

#[derive(Debug, Clone, clap::Args)]
pub(crate) struct RenderArgs {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// The file of the picture; a PNG file is written beside it [default: the name of the scene, in
    /// the working directory]
    #[arg(short, long, value_name = "OUT.exr")]
    output: Option<PathBuf>,
    /// Stop after this many passes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    passes: Option<u64>,
    /// Stop after this time, such as 90s, 5m or 1h30m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    time: Option<Duration>,
    /// Stop when the relative error of a typical pixel falls to this value, such as 2%
    #[arg(long, value_name = "RATIO", value_parser = values::fraction)]
    target_error: Option<f64>,
    /// The number of photon paths in a pass
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    photons: Option<u64>,
    /// The size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// The seed of all random streams
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// The number of worker threads [default: the number of logical processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// The integrator: photon mapping, or the path tracer for reference pictures
    #[arg(long, value_enum, default_value_t)]
    integrator: IntegratorName,
    /// Simulate an effect even if the scene does not need it; `abbe explain` lists the effects
    /// (repeatable)
    #[arg(long, value_name = "EFFECT")]
    force: Vec<String>,
    /// Leave out an effect even if the scene needs it (repeatable)
    #[arg(long, value_name = "EFFECT")]
    forbid: Vec<String>,
    #[arg(
        long,
        value_name = "PATH=JSON",
        help = "Change a value of the scene, such as 'objects.prism.material=\"crown\"' (repeatable)"
    )]
    set: Vec<String>,
    #[command(flatten)]
    scene_file: SceneFileArgs,
    /// Store the spectrum of every pixel in this many bands
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1024))]
    spectral_bands: Option<u32>,
    /// Store these layers in the EXR file in addition to the colours: albedo, normal, depth,
    /// object, material, uv, samples, paths, lights
    #[arg(long, value_name = "LAYER,...", value_delimiter = ',', value_parser = clap::builder::NonEmptyStringValueParser::new())]
    layers: Option<Vec<String>>,
    #[command(flatten)]
    denoise: DenoiseArgs,
    /// Render only one of N parts: the passes whose index modulo N is I, with I from 0 to N-1.
    /// `abbe merge` merges the parts
    #[arg(long, value_name = "I/N", value_parser = values::part, default_value = "0/1", hide_default_value = true)]
    #[arg(conflicts_with = "target_error")]
    part: PassPart,
    /// Continue from the checkpoint beside the output. This finishes an interrupted render, or
    /// extends a render with more --passes, more --time or a smaller --target-error. All limits
    /// count from the beginning of the first run. With `--resume auto`, a render without a
    /// checkpoint starts from the beginning, as on the first start of a batch job
    #[arg(long, value_enum, value_name = "auto", num_args = 0..=1, require_equals = true, hide_possible_values = true)]
    #[arg(default_missing_value = "always", default_value_t, hide_default_value = true)]
    resume: Resume,
    /// Keep the checkpoint OUT.checkpoint.exr when the picture is complete
    #[arg(long)]
    keep_checkpoint: bool,
    /// The time between checkpoints, such as 10m [default: the scene's setting, or 60s; longer if
    /// saving takes more than 3s]
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    checkpoint_every: Option<Duration>,
    #[command(flatten)]
    sequence: SequenceArgs,
    /// Write the statistics of the render as JSON
    #[arg(long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    /// Send the growing picture to a running tev at this address. The port is 14158 unless the
    /// address contains another one
    #[arg(long, value_name = "HOST:PORT", value_parser = ServerAddress::parse)]
    display_server: Option<ServerAddress>,
    #[command(flatten)]
    header: HeaderArgs,
    /// Print only warnings and errors
    #[arg(long)]
    quiet: bool,
}

/// The content of the EXR file's header.
#[derive(Debug, Clone, Copy, clap::Args)]
struct HeaderArgs {
    /// Leave times and facts about the machine out of the EXR file, so that equal renders are equal
    /// files
    #[arg(long, conflicts_with = "part")]
    reproducible: bool,
}

impl HeaderArgs {
    fn apply(self, metadata: Metadata) -> Metadata {
        if self.reproducible { provenance::reproducible(metadata) } else { metadata }
    }
}

/// Tells whether a render continues from its checkpoint.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
enum Resume {
    #[default]
    Never,
    /// A missing checkpoint is an error.
    Always,
    /// If there is a checkpoint.
    Auto,
}

#[derive(Debug, Clone, Copy, Default, clap::ValueEnum)]
pub(crate) enum IntegratorName {
    #[default]
    Photon,
    Path,
}

impl IntegratorName {
    pub(crate) fn integrator(self) -> Integrator {
        match self {
            Self::Photon => Integrator::Photon,
            Self::Path => Integrator::Path,
        }
    }
}

pub(crate) fn run(arguments: &RenderArgs) -> Result<Outcome> {
    interrupt::watch()?;
    let server = arguments.display_server.as_ref().map(DisplayServer::connect).transpose()?;
    let outcome = pictures(arguments, server.as_ref());
    server.iter().for_each(DisplayServer::finish);
    outcome
}

/// Checks the scene and the options of a render whose parts are jobs of a cluster. Returns the
/// number of passes and the files that the scene is read from, or an input error if the scene is
/// wrong or the scripts of the jobs set an option themselves.
pub(crate) fn check_part_options(arguments: &RenderArgs) -> Result<(Option<u64>, Vec<PathBuf>)> {
    let owned = [
        ("--output", arguments.output.is_some()),
        ("--passes", arguments.passes.is_some()),
        ("--time", arguments.time.is_some()),
        ("--target-error", arguments.target_error.is_some()),
        ("--threads", arguments.threads.is_some()),
        ("--part", arguments.part != PassPart::WHOLE),
        ("--resume", arguments.resume != Resume::Never),
        ("--keep-checkpoint", arguments.keep_checkpoint),
        ("--frames or --sweep", arguments.sequence.frames().is_some()),
        ("--stats", arguments.stats.is_some()),
        ("--display-server", arguments.display_server.is_some()),
        ("--reproducible", arguments.header.reproducible),
        ("--quiet", arguments.quiet),
    ];
    if let Some((option, _)) = owned.iter().find(|(_, is_given)| *is_given) {
        let what = format!("{option} after --: the scripts of the jobs do not allow this option");
        return Err(Error::input(what).expected("options that change the picture, such as --size"));
    }
    let (source, job) = plan(arguments)?;
    let inputs = arguments.scene_file.inputs(&SceneFiles::of(&source), &arguments.scene);
    Ok((arguments.request().stop.passes_wanted(&job.budget), inputs))
}

/// Renders the picture, or all frames of an image sequence and their animation.
fn pictures(arguments: &RenderArgs, server: Option<&DisplayServer>) -> Result<Outcome> {
    let Some(frames) = arguments.sequence.frames() else { return picture(arguments, None, server) };
    let mut pngs = Vec::new();
    let animation = frames::animation(&arguments.pattern());
    for frame in &frames {
        let arguments = arguments.of_frame(frame)?;
        let outcome = picture(&arguments, Some(frame), server)?;
        if outcome != Outcome::Done {
            return Ok(outcome);
        }
        pngs.push(arguments.outputs()?.png().to_path_buf());
    }
    write_animation(&animation, &pngs, arguments.sequence.fps)?;
    if !arguments.quiet {
        print::remark(&format!("wrote {}", animation.display()));
    }
    Ok(Outcome::Done)
}

/// Renders one picture, which may be a frame of an image sequence.
fn picture(arguments: &RenderArgs, frame: Option<&SequenceFrame>, server: Option<&DisplayServer>) -> Result<Outcome> {
    let outputs = arguments.outputs()?;
    let (source, job) = plan(arguments)?;
    memory::check(&job.budget)?;
    let request = arguments.request();
    let scene_files = SceneFiles::of(&source);
    let of_scene =
        arguments.header.apply(provenance::of_scene(Some((&source, &scene_files)), &job, request.integrator));
    let identity = RenderIdentity::of(&job, request.integrator, &of_scene);
    let checkpoint = CheckpointFile { path: outputs.checkpoint(), job: &job, identity: &identity, metadata: &of_scene };
    outputs.check(&arguments.scene_file.inputs(&scene_files, &arguments.scene))?;
    files::remove_temporary_files(&checkpoint.path);
    files::check_writable(&checkpoint.path)?;
    let label = frame.map(SequenceFrame::label);
    // With `--resume`, some frames may be finished, and others may have no checkpoint yet.
    let resume = match arguments.resume {
        Resume::Never => false,
        Resume::Always if frame.is_none() => true,
        Resume::Always | Resume::Auto => checkpoint.path.exists(),
    };
    if arguments.resume != Resume::Never
        && !resume
        && let Some(found) = provenance::finished(&outputs.exr, &of_scene, request, &job)
    {
        let develops = found.get(names::DISPLAY) != of_scene.get(names::DISPLAY);
        if develops {
            outputs.develop_again(&of_scene, &DisplaySettings::of(&job))?;
        }
        if !arguments.quiet {
            let again = if develops { "; its PNG was developed again" } else { "" };
            print::remark(&format!("{} is already finished{again}", outputs.exr.display()));
        }
        return Ok(Outcome::Done);
    }
    let begin = checkpoint.start(arguments.part, resume)?;
    print::notes(&job.scene.notes, &job.scene.warnings, arguments.quiet);
    if !arguments.quiet {
        let path = checkpoint.path.display();
        if resume {
            print::remark(&format!("resuming after {}, from {path}", print::passes(begin.passes())));
        } else if checkpoint.path.exists() {
            print::remark(&format!(
                "note: starting from the beginning and replacing {path}; --resume would continue from it"
            ));
        } else if arguments.resume == Resume::Auto {
            let preview = if outputs.holds_preview() { ", and its preview is replaced" } else { "" };
            print::remark(&format!("note: there is no {path}, so the render starts from the beginning{preview}"));
        }
    }
    let threads = job.scene.settings.threads;
    let mut watch = RenderMonitor::new(
        ProgressDisplay::new(arguments.quiet, label),
        &checkpoint,
        Preview::new(&outputs, &of_scene, DisplaySettings::of(&job), server),
        arguments.checkpoint_interval(&job),
    );
    let rendered = on_threads(threads, || job.continue_run(request, begin, &mut watch));
    watch.display.finish();
    let rendered = rendered?.map_err(|error| error.in_file(&arguments.scene))?;
    if rendered.stats.passes == 0 {
        print::remark("interrupted before the first pass was done, so there is nothing to save");
        return Ok(Outcome::Interrupted);
    }
    watch.preview.send(&rendered.picture);
    let exposure = on_threads(threads, || save(arguments, &outputs, &checkpoint, &rendered))??;
    if rendered.stats.rejected_samples > 0 {
        let count = rendered.stats.rejected_samples;
        print::remark(&format!(
            "warning: {count} samples were NaN, infinite or negative and were discarded; this is a bug in abbe, please report it"
        ));
    }
    if rendered.interrupted {
        let (passes, path) = (print::passes(rendered.stats.passes), checkpoint.path.display());
        let named = outputs.named();
        print::remark(&format!("interrupted after {passes}; saved {named}; --resume continues from {path}"));
        return Ok(Outcome::Interrupted);
    }
    print::notes(&rendered.stats.notes, &rendered.stats.warnings, arguments.quiet);
    if !arguments.quiet {
        print::remark(&summary(&rendered, &outputs, &DisplaySettings::of(&job), exposure));
    }
    Ok(Outcome::Done)
}

/// Saves the picture, with the exact film sums if it contains only a part of the passes. Keeps the
/// checkpoint if the render was interrupted, if `--keep-checkpoint` is given, or if saving failed.
/// Returns the exposure of the PNG in 1/(cd/m²).
fn save(
    arguments: &RenderArgs,
    outputs: &OutputFiles,
    checkpoint: &CheckpointFile<'_>,
    rendered: &Rendered,
) -> Result<f64> {
    let (picture, run) = (&rendered.picture, &rendered.run);
    let metadata = arguments.header.apply(provenance::of_render(checkpoint.metadata, &rendered.stats));
    let write = |path: &Path| match arguments.part {
        PassPart::WHOLE => write_exr(path, picture, &metadata),
        _ => checkpoint.write_to(path, run, metadata.clone()),
    };
    let saved = outputs.save(write, picture, &DisplaySettings::of(checkpoint.job), &rendered.stats);
    let keep = rendered.interrupted || arguments.keep_checkpoint || saved.is_err();
    let ended = checkpoint.finish(run, keep);
    match (saved, ended) {
        (Err(error), Ok(())) => {
            let what = format!("{}; all passes are saved in {}", error.what, checkpoint.path.display());
            Err(Error { what, ..error })
        }
        (Err(error), Err(_)) => Err(error),
        (Ok(exposure), ended) => ended.map(|()| exposure),
    }
}

impl RenderArgs {
    fn of_frame(&self, frame: &SequenceFrame) -> Result<Self> {
        let mut arguments = Self { output: Some(frame.name(&self.pattern())?), ..self.clone() };
        arguments.stats = self.stats.as_deref().map(|pattern| frame.name(pattern)).transpose()?;
        arguments.set.extend_from_slice(frame.patches());
        Ok(arguments)
    }

    /// The name of the frames of a sequence, with `#` signs for their numbers.
    fn pattern(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| self.stem().with_added_extension("####.exr"))
    }

    /// The name of the scene without folder and extension.
    fn stem(&self) -> PathBuf {
        PathBuf::from(self.scene.file_stem().unwrap_or("scene".as_ref()))
    }

    fn request(&self) -> Request {
        let integrator = self.integrator.integrator();
        let stop = StopRules { passes: self.passes, time: self.time, target_error: self.target_error };
        Request { integrator, stop }
    }

    /// The output files. The default file name of a part contains the number of this part.
    fn outputs(&self) -> Result<OutputFiles> {
        let exr = match (&self.output, self.part) {
            (Some(path), _) => path.clone(),
            (None, PassPart::WHOLE) => self.stem().with_added_extension("exr"),
            (None, part) => {
                self.stem().with_added_extension(format!("part-{}.exr", part.to_string().replace('/', "-of-")))
            }
        };
        OutputFiles::new(exr, self.stats.clone())
    }

    fn checkpoint_interval(&self, job: &Job) -> CheckpointInterval {
        let of_scene = || Duration::try_from_secs_f64(job.scene.settings.checkpoint_seconds?).ok();
        self.checkpoint_every.or_else(of_scene).map_or(CheckpointInterval::Automatic, CheckpointInterval::Fixed)
    }

    /// Returns the changes in the form `PATH=JSON`: of `--set`, and then of other options.
    fn patches(&self) -> Vec<String> {
        let mut patches = self.set.clone();
        let mut add = |path: &str, value: Option<String>| patches.extend(value.map(|value| format!("{path}={value}")));
        add("film.width", self.size.map(|(width, _)| width.to_string()));
        add("film.height", self.size.map(|(_, height)| height.to_string()));
        add("film.spectral_bands", self.spectral_bands.map(|bands| bands.to_string()));
        add("film.layers", self.layers.as_ref().map(|layers| format!("{layers:?}")));
        add("film.denoise", self.denoise.choice().map(|denoise| denoise.to_string()));
        add("render.photons", self.photons.map(|photons| photons.to_string()));
        add("render.seed", self.seed.map(|seed| seed.to_string()));
        add("render.threads", self.threads.map(|threads| threads.to_string()));
        patches
    }
}

/// Reads the scene and applies the options. Then resolves and plans the scene.
fn plan(arguments: &RenderArgs) -> Result<(JsonSource, Job)> {
    let path = &arguments.scene;
    let mut patches = arguments.patches();
    let (mut scene, mut source) = arguments.scene_file.read(path, &patches, arguments.quiet)?;
    if !(arguments.force.is_empty() && arguments.forbid.is_empty()) {
        // The effects that the options force or forbid are added to the lists of the scene.
        for (key, own, more) in
            [("force", &scene.render.force, &arguments.force), ("forbid", &scene.render.forbid, &arguments.forbid)]
        {
            let all: Vec<&String> = own.iter().chain(more).collect();
            let list = serde_json::to_string(&all).expect("a list of texts is JSON");
            patches.push(format!("render.{key}={list}"));
        }
        (scene, source) = arguments.scene_file.read(path, &patches, arguments.quiet)?;
    }
    let job = Job::of_picture(resolve::resolve(&scene, &source)?).map_err(|error| error.in_file(path))?;
    Ok((source, job))
}

fn summary(rendered: &Rendered, outputs: &OutputFiles, display: &DisplaySettings, exposure: f64) -> String {
    let stats = &rendered.stats;
    let spent = time(Duration::try_from_secs_f64(stats.seconds.total).unwrap_or_default());
    let error = print::picture_error(&stats.error);
    let (passes, exposure) = (print::passes(stats.passes), print::exposure(exposure));
    let mut text = format!("wrote {}: {passes} in {spent}, exposure {exposure}\n{error}", outputs.named());
    if let Some(denoised) = rendered.picture.denoised() {
        text += &format!("\n{}", print::denoised(&denoised, display.shows_denoised(&rendered.picture)));
    } else if rendered.run.denoises() {
        text += "\nthe PNG shows the picture as rendered: the denoiser needs four passes in a row";
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Debug, Parser)]
    struct RenderCli {
        #[command(flatten)]
        arguments: RenderArgs,
    }

    fn arguments(words: &[&str]) -> RenderArgs {
        RenderCli::try_parse_from([&["render"], words].concat()).unwrap().arguments
    }

    #[test]
    fn options_apply_after_set() {
        let given =
            arguments(&["a.json", "--size", "64x32", "--set", "film.width=7", "--seed", "3", "--spectral-bands", "8"]);
        assert_eq!(
            given.patches(),
            ["film.width=7", "film.width=64", "film.height=32", "film.spectral_bands=8", "render.seed=3"]
        );
    }

    #[test]
    fn the_default_output_has_the_name_of_the_scene() {
        let named = |words: &[&str]| arguments(words).outputs().map(|outputs| outputs.named());
        assert_eq!(named(&["far/away/newton.v2.json"]).unwrap(), "newton.v2.exr and newton.v2.png");
        let part = named(&["a.v2.json", "--part", "1/4"]).unwrap();
        assert_eq!(part, "a.v2.part-1-of-4.exr and a.v2.part-1-of-4.png");
        assert_eq!(named(&["a.json", "-o", "out/b.EXR"]).unwrap(), "out/b.EXR and out/b.png");
        assert_eq!(named(&["a.json", "-o", "b.png"]).unwrap_err().exit_status(), 2);
    }

    #[test]
    fn options_become_stop_rules() {
        let stop = arguments(&["a.json", "--time", "5m", "--target-error", "2%"]).request().stop;
        let known = StopRules { passes: None, time: Some(Duration::from_secs(300)), target_error: Some(0.02) };
        assert_eq!(stop, known);
        assert!(RenderCli::try_parse_from(["render", "a.json", "--passes", "0"]).is_err());
        assert!(RenderCli::try_parse_from(["render", "a.json", "--integrator", "bidirectional"]).is_err());
    }
}
