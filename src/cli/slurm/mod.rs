//! `abbe slurm`: writes the scripts of an array job that renders the parts of a picture.

use std::path::{Path, PathBuf};
use std::process::Command as Process;
use std::time::Duration;

use abbe_session::output::file;
use abbe_spectra::error::{Error, Result};
use clap::Parser;

use super::{Cli, Command, Outcome, interrupt, print, render, values};

/// The scripts and their names. `settings.sh` is preceded by the settings.
const SCRIPTS: [(&str, &str); 3] = [
    ("part.sh", include_str!("part.sh")),
    ("merge.sh", include_str!("merge.sh")),
    ("submit.sh", include_str!("submit.sh")),
];

/// A missing part is submitted again at most this many times.
const RETRIES: u32 = 3;

/// The first round of a render with a target error has at least this many passes in each part.
const FIRST_PASSES: u64 = 4;

/// A target error decides only after a multiple of this number of passes.
const ROUND_STEP: u64 = 8;

/// The error is known from this number of passes on.
const LEAST_PASSES: u64 = 16;

#[derive(Debug, Clone, clap::Args)]
#[command(override_usage = "abbe slurm SCENE --parts N [OPTIONS] [-- RENDER OPTIONS]")]
pub(crate) struct SlurmArgs {
    /// The scene file
    #[arg(value_name = "SCENE")]
    scene: PathBuf,
    /// The number of parts, at least 2
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    parts: u32,
    /// The folder of the scripts, the parts, the logs and the picture [default: SCENE-slurm]
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// The number of passes of the picture; with --target-error, its largest number [default: the
    /// scene's setting; no limit with --target-error]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    passes: Option<u64>,
    /// Render in rounds until the relative error of the picture falls to this value, such as 2%
    #[arg(long, value_name = "RATIO", value_parser = values::fraction)]
    target_error: Option<f64>,
    /// The time limit of a job, such as 2h. A part that needs longer saves its passes and queues
    /// itself again [default: the limit of the partition]
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    time: Option<Duration>,
    /// The number of processors of a job
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4096))]
    cpus: u32,
    /// An option of sbatch, such as --sbatch=--partition=long (repeatable)
    #[arg(long, value_name = "OPTION", allow_hyphen_values = true)]
    sbatch: Vec<String>,
    /// The program that the jobs run [default: this program]
    #[arg(long, value_name = "PROGRAM")]
    abbe: Option<PathBuf>,
    /// Submit the jobs
    #[arg(long)]
    submit: bool,
    /// Options of `abbe render`, such as --size 640x360
    #[arg(last = true, value_name = "RENDER OPTIONS")]
    render_options: Vec<String>,
}

pub(crate) fn run(arguments: &SlurmArgs) -> Result<Outcome> {
    let (passes, inputs) = arguments.check_render()?;
    let folder = match &arguments.output {
        Some(folder) => folder.clone(),
        None => PathBuf::from(format!("{}-slurm", arguments.name())),
    };
    let outputs: Vec<PathBuf> = arguments.outputs().iter().map(|name| folder.join(name)).collect();
    file::check_keeps_inputs(outputs.iter().map(PathBuf::as_path), &inputs)?;
    std::fs::create_dir_all(&folder)
        .map_err(|error| Error::machine(format!("cannot be created: {error}")).in_file(&folder))?;
    file::write_whole(&folder.join("settings.sh"), arguments.settings(passes)?.as_bytes())?;
    for (name, text) in SCRIPTS {
        file::write_whole(&folder.join(name), text.as_bytes())?;
    }
    let submit = folder.join("submit.sh");
    if !arguments.submit {
        let (parts, script) = (print::counted(arguments.parts as usize, "part"), quoted_path(&submit)?);
        print::remark(&format!("wrote the scripts for {parts} to {}; `bash {script}` submits them", folder.display()));
        return Ok(Outcome::Done);
    }
    interrupt::watch()?;
    let status = Process::new("bash").arg(&submit).status();
    match status {
        Ok(status) if status.success() => Ok(Outcome::Done),
        Ok(_) => Err(Error::machine("the jobs were not submitted").in_file(&submit)),
        Err(error) => Err(Error::machine(format!("bash cannot be started: {error}"))),
    }
}

impl SlurmArgs {
    fn name(&self) -> String {
        self.scene.file_stem().unwrap_or("scene".as_ref()).to_string_lossy().into_owned()
    }

    /// Returns the names of the files in the folder: the scripts, and what the last job merges.
    fn outputs(&self) -> Vec<String> {
        let merged = ["exr", "png", "json"].map(|extension| format!("{}.{extension}", self.name()));
        SCRIPTS.iter().map(|(name, _)| (*name).to_owned()).chain(["settings.sh".to_owned()]).chain(merged).collect()
    }

    /// Checks the scene and the options. Returns the number of passes, `None` without limit, and
    /// the files that the scene is read from.
    fn check_render(&self) -> Result<(Option<u64>, Vec<PathBuf>)> {
        let words = ["abbe".into(), "render".into(), self.scene.clone().into_os_string()];
        let options = self.render_options.iter().map(Into::into);
        let cli = Cli::try_parse_from(words.into_iter().chain(options));
        let cli = cli.map_err(|error| Error::input(super::one_line(&error.to_string())))?;
        let Command::Render(arguments) = cli.command else {
            return Err(Error::input("the options after -- are not options of a render"));
        };
        let (passes, inputs) = render::check_part_options(&arguments)?;
        let passes = self.passes.or(passes.filter(|_| self.target_error.is_none()));
        if let Some(passes) = passes.filter(|&passes| passes < u64::from(self.parts)) {
            let what = format!("{} for {} parts", print::passes(passes), self.parts);
            return Err(Error::input(what).expected("more passes, or fewer parts"));
        }
        Ok((passes, inputs))
    }

    fn settings(&self, passes: Option<u64>) -> Result<String> {
        let absolute = |path: &Path| {
            path.canonicalize().map_err(|error| Error::input(format!("cannot be found: {error}")).in_file(path))
        };
        let step = lcm(ROUND_STEP, u64::from(self.parts));
        let first = match (self.target_error, passes) {
            (None, Some(passes)) => passes,
            (Some(_), limit) => {
                let first = LEAST_PASSES.max(FIRST_PASSES * u64::from(self.parts)).next_multiple_of(step);
                limit.map_or(first, |limit| first.min(limit))
            }
            (None, None) => return Err(Error::input("the number of passes is unknown").expected("--passes")),
        };
        let mut sbatch = vec![format!("--cpus-per-task={}", self.cpus)];
        sbatch.extend(self.time.map(|time| format!("--time={}", time.as_secs().div_ceil(60))));
        sbatch.extend(self.sbatch.iter().cloned());
        let merge: Vec<String> =
            self.target_error.map(|error| format!("--target-error={}%", 100.0 * error)).into_iter().collect();
        // A job's name may be part of a file name.
        let name: String =
            self.name().chars().map(|c| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' }).collect();
        let picture = format!("{}.exr", self.name());
        Ok(format!(
            "# The settings of the scripts in this folder. `abbe slurm` has written this file.\n\
             abbe={}\nscene={}\nrender_options=({})\nmerge_options=({})\nsbatch_options=({})\n\
             name={name}\npicture={}\nparts={}\nretries={RETRIES}\n\
             # The passes of the first round, the largest number of passes (0: no limit), and the step.\n\
             first={first}\nlimit={}\nstep={step}\n{}",
            quoted_path(&self.program()?)?,
            quoted_path(&absolute(&self.scene)?)?,
            words(&self.render_options),
            words(&merge),
            words(&sbatch),
            quoted(&picture),
            self.parts,
            passes.unwrap_or(0),
            include_str!("settings.sh"),
        ))
    }

    /// Returns the program that the jobs run. From the Python package, whose process is Python,
    /// they find `abbe` in their path.
    fn program(&self) -> Result<PathBuf> {
        if let Some(program) = &self.abbe {
            return Ok(program.clone());
        }
        let own = std::env::current_exe()
            .map_err(|error| Error::machine(format!("the path of this program is unknown: {error}")))?;
        let is_abbe = own.file_stem().is_some_and(|stem| stem == "abbe");
        Ok(if is_abbe { own } else { PathBuf::from("abbe") })
    }
}

fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

/// Returns a path as one word of a shell.
fn quoted_path(path: &Path) -> Result<String> {
    let text = path.to_str().ok_or_else(|| Error::input("the path is not Unicode").in_file(path))?;
    Ok(quoted(text))
}

fn words(texts: &[String]) -> String {
    texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(" ")
}

/// Returns the least common multiple of two positive numbers.
fn lcm(a: u64, b: u64) -> u64 {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_shell_are_quoted() {
        assert_eq!(quoted("it's $(here)"), r"'it'\''s $(here)'");
        assert_eq!(words(&["a b".to_string(), "`c`".to_string()]), "'a b' '`c`'");
    }

    #[test]
    fn rounds_fill_replicates_and_parts() {
        assert_eq!([(8, 3), (8, 8), (8, 64), (8, 6)].map(|(a, b)| lcm(a, b)), [24, 8, 64, 24]);
    }
}
