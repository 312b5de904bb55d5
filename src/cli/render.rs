//! `abbe render`: renders a scene and saves the picture.

use std::path::{Path, PathBuf};
use std::time::Duration;

use abbe::error::{Error, Result};
use abbe::output::exr::write as write_exr;
use abbe::output::file as files;
use abbe::output::png::write as write_png;
use abbe::render::{Integrator, Job, Rendered, Request, StopRules, on_threads};
use abbe::scene::file::{self, Source};
use abbe::scene::{Exposure, FilmSpec, resolve};
use abbe::sensor::{Development, Picture, develop, exposure};

use super::progress::{Display, percent, time};
use super::{Outcome, interrupt, origin, print, values};

#[derive(Debug, clap::Args)]
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
    /// Keep the spectrum of every pixel in this many bands
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1024))]
    spectral_bands: Option<u32>,
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
    let outputs = Outputs::of(arguments)?;
    let (source, job) = plan(arguments)?;
    check_memory(job.budget.memory_bytes)?;
    outputs.check()?;
    if !arguments.quiet {
        job.scene.notes.iter().for_each(|note| print::remark(&format!("note: {note}")));
    }
    let request = arguments.request();
    interrupt::watch()?;
    let threads = job.scene.settings.threads;
    let mut display = Display::new(arguments.quiet);
    let rendered = on_threads(threads, || job.render(request, &mut display));
    display.finish();
    let rendered = rendered?.map_err(|error| error.in_file(&arguments.scene))?;
    on_threads(threads, || outputs.save(&source, &job, request.integrator, &rendered))??;
    if rendered.interrupted {
        let passes = rendered.stats.passes;
        print::remark(&format!("interrupted after {passes} passes; saved in {}", outputs.named()));
        return Ok(Outcome::Interrupted);
    }
    if !arguments.quiet {
        print::remark(&summary(&rendered, &outputs));
    }
    Ok(Outcome::Done)
}

impl Arguments {
    fn request(&self) -> Request {
        let integrator = match self.integrator {
            IntegratorName::Photon => Integrator::Photon,
            IntegratorName::Path => Integrator::Path,
        };
        let stop = StopRules { passes: self.passes, time: self.time, target_error: self.target_error };
        Request { integrator, stop }
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
    let (mut scene, mut source) = file::read(path, &patches)?;
    if !(arguments.force.is_empty() && arguments.forbid.is_empty()) {
        // Effects of the command line come on top of the scene's own.
        for (key, own, more) in
            [("force", &scene.render.force, &arguments.force), ("forbid", &scene.render.forbid, &arguments.forbid)]
        {
            let all: Vec<&String> = own.iter().chain(more).collect();
            let list = serde_json::to_string(&all).expect("a list of texts is JSON");
            patches.push(format!("render.{key}={list}"));
        }
        (scene, source) = file::read(path, &patches)?;
    }
    let resolved = resolve::resolve(&scene, &source)?;
    let job = Job::new(resolved).map_err(|error| error.in_file(path))?;
    Ok((source, job))
}

/// Refuses a render that the machine cannot hold, rather than being killed in the middle of it.
fn check_memory(bytes: u64) -> Result<()> {
    let text = std::fs::read_to_string("/proc/meminfo").unwrap_or_default();
    let line = text.lines().find_map(|line| line.strip_prefix("MemTotal:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()).and_then(|n| n.parse::<u64>().ok());
    match kilobytes.map(|kilobytes| kilobytes.saturating_mul(1024)) {
        Some(present) if bytes > present => {
            let gigabytes = |bytes: u64| bytes as f64 * 1e-9;
            let what = format!("out of memory: picture and photons need {:.1} GB", gigabytes(bytes));
            Err(Error::machine(what).expected(format!("at most this machine's {:.1} GB", gigabytes(present))))
        }
        Some(_) | None => Ok(()),
    }
}

/// The files to be written.
#[derive(Debug)]
struct Outputs {
    exr: PathBuf,
    png: PathBuf,
    stats: Option<PathBuf>,
}

impl Outputs {
    fn of(arguments: &Arguments) -> Result<Self> {
        let exr = match &arguments.output {
            Some(path) => path.clone(),
            None => PathBuf::from(arguments.scene.file_stem().unwrap_or("scene".as_ref())).with_added_extension("exr"),
        };
        if !exr.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr")) {
            let what = format!("the output {}", exr.display());
            return Err(Error::input(what).expected("a name that ends in .exr (a PNG is written beside it)"));
        }
        Ok(Self { png: exr.with_extension("png"), exr, stats: arguments.stats.clone() })
    }

    fn all(&self) -> impl Iterator<Item = &Path> {
        [&self.exr, &self.png].into_iter().chain(&self.stats).map(PathBuf::as_path)
    }

    fn check(&self) -> Result<()> {
        self.all().try_for_each(files::check_writable)
    }

    fn named(&self) -> String {
        format!("{} and {}", self.exr.display(), self.png.display())
    }

    fn save(&self, source: &Source, job: &Job, integrator: Integrator, rendered: &Rendered) -> Result<()> {
        let picture = &rendered.picture;
        write_exr(&self.exr, picture, &origin::metadata(source, job, integrator, rendered))?;
        let film = &job.scene.film;
        let development = Development { space: film.space, white: film.white, gamut: film.gamut };
        let exposure = exposure_factor(film, picture, &development);
        write_png(&self.png, &develop(picture, exposure, &development))?;
        if let Some(path) = &self.stats {
            let json = serde_json::to_string_pretty(&rendered.stats).expect("statistics have text keys");
            files::write_whole(path, (json + "\n").as_bytes())?;
        }
        Ok(())
    }
}

/// The factor on luminance that the film asks for.
fn exposure_factor(film: &FilmSpec, picture: &Picture, development: &Development) -> f64 {
    match film.exposure {
        Exposure::Auto => exposure::automatic(picture, development),
        Exposure::Ev(ev) => ev.exp2(),
        Exposure::White(luminance) => luminance.recip(),
        Exposure::None => 1.0,
    }
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
        let named = |words: &[&str]| Outputs::of(&arguments(words)).map(|outputs| outputs.named());
        assert_eq!(named(&["far/away/newton.v2.json"]).unwrap(), "newton.v2.exr and newton.v2.png");
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

    #[test]
    fn more_memory_than_the_machine_has_is_refused() {
        assert!(check_memory(1 << 20).is_ok());
        if Path::new("/proc/meminfo").exists() {
            assert_eq!(check_memory(u64::MAX).unwrap_err().exit_status(), 1);
        }
    }
}
