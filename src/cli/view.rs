//! `abbe view`: renders a scene and shows it on a page in the browser, or shows saved pictures.

use std::net::{IpAddr, Ipv4Addr};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::api::provenance::{self, SceneFiles};
use crate::page::LoadedScene;
use crate::view::{Example, LiveView, SessionEnd, ViewHost};
use abbe_session::output::exr::write as write_exr;
use abbe_session::output::file as files;
use abbe_session::render::{DisplaySettings, Integrator, RenderIdentity, Rendered, StopRules};
use abbe_spectra::error::{Error, Result};

use super::checkpoint::CheckpointFile;
use super::outputs::OutputFiles;
use super::scene_file::SceneFileArgs;
use super::{Outcome, interrupt, print, values};

#[derive(Debug, clap::Args)]
pub(crate) struct ViewArgs {
    /// The scene file, which the view renders again when it changes; or the EXR file of a picture.
    /// Without it, the page offers example scenes
    #[arg(value_name = "SCENE|A.exr")]
    scene: Option<PathBuf>,
    /// The EXR file of a reference with which the page compares the render, or the picture A
    #[arg(value_name = "B.exr")]
    reference: Option<PathBuf>,
    /// The port of the page; 0 chooses a free port
    #[arg(long, value_name = "N", default_value_t = 0)]
    port: u16,
    /// The IP address on which the page is served. Other machines can open the page if this is
    /// not a loopback address and if they know the page's address with its token
    #[arg(long, value_name = "ADDRESS", default_value_t = IpAddr::V4(Ipv4Addr::LOCALHOST))]
    bind: IpAddr,
    /// Print the address of the page, but do not open a browser
    #[arg(long)]
    no_open: bool,
    /// Finish after this many passes. The page can continue the render
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    passes: Option<u64>,
    /// The size of the picture in pixels
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    size: Option<(u32, u32)>,
    /// The number of worker threads [default: the number of logical processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
    /// The number of spectral bands of every pixel
    #[arg(long, value_name = "N", default_value_t = 47, value_parser = clap::value_parser!(u32).range(1..=1024))]
    spectral_bands: u32,
    #[arg(
        long,
        value_name = "PATH=JSON",
        help = "Change a value of the scene, such as 'objects.prism.material=\"crown\"' (repeatable)"
    )]
    set: Vec<String>,
    /// Save the picture in this file at Ctrl-C, with a PNG file and, if passes are missing, a
    /// checkpoint beside it. Without this option, the view leaves no files
    #[arg(short, long, value_name = "OUT.exr")]
    output: Option<PathBuf>,
    #[command(flatten)]
    scene_file: SceneFileArgs,
}

pub(crate) fn run(arguments: &ViewArgs) -> Result<Outcome> {
    interrupt::watch()?;
    let is_exr = |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let picture = arguments.scene.as_deref().filter(|path| is_exr(path));
    let outputs = arguments.outputs()?;
    let has_examples = arguments.scene.is_none();
    if has_examples && (arguments.scene_file.overlay.is_some() || arguments.scene_file.allow_outside) {
        return Err(Error::input("--overlay and --allow-outside are for a scene file").expected("SCENE"));
    }
    let view = LiveView::listen(arguments.bind, arguments.port, has_examples)?;
    if let Some(reference) = &arguments.reference {
        view.compare_with(reference, picture)?;
    }
    let url = view.url();
    print::result(&format!("{url}\n"))?;
    if !arguments.no_open && !open_browser(&url) {
        print::remark("note: no browser could be opened; open the address above");
    }
    if let Some(picture) = picture {
        return view.show(picture, interrupt::is_requested).map(|()| Outcome::Done);
    }
    let stop = StopRules { passes: arguments.passes, ..StopRules::default() };
    let SessionEnd { last } = view.run(arguments, stop)?;
    match (last, outputs) {
        (Some((loaded, rendered)), Some(outputs)) => save(&outputs, &loaded, &rendered),
        (Some((_, rendered)), None) => {
            let passes = print::passes(rendered.stats.passes);
            print::remark(&format!("ended after {passes}; -o OUT.exr or the page saves a picture"));
            Ok(if rendered.interrupted { Outcome::Interrupted } else { Outcome::Done })
        }
        (None, _) => Ok(Outcome::Interrupted),
    }
}

/// Saves the picture, and a checkpoint if the render has passes left.
fn save(outputs: &OutputFiles, loaded: &LoadedScene, rendered: &Rendered) -> Result<Outcome> {
    let LoadedScene { job, metadata: of_scene, .. } = loaded;
    let identity = RenderIdentity::of(job, Integrator::Photon, of_scene);
    let checkpoint = CheckpointFile { path: outputs.checkpoint(), job, identity: &identity, metadata: of_scene };
    outputs.check(&[])?;
    files::check_writable(&checkpoint.path)?;
    let metadata = provenance::reproducible(provenance::of_render(of_scene, &rendered.stats));
    let write = |path: &Path| write_exr(path, &rendered.picture, &metadata);
    let saved = outputs.save(write, &rendered.picture, &DisplaySettings::of(job), &rendered.stats);
    checkpoint.finish(&rendered.run, rendered.interrupted || saved.is_err())?;
    saved?;
    let (passes, named) = (print::passes(rendered.stats.passes), outputs.named());
    if rendered.interrupted {
        let path = checkpoint.path.display();
        print::remark(&format!("interrupted after {passes}; saved {named}, and {path} for `abbe render --resume`"));
        return Ok(Outcome::Interrupted);
    }
    print::remark(&format!("saved {named}: {passes}"));
    Ok(Outcome::Done)
}

impl ViewArgs {
    /// Returns the files that the view saves at its end.
    fn outputs(&self) -> Result<Option<OutputFiles>> {
        self.output.clone().map(|exr| OutputFiles::new(exr, None)).transpose()
    }

    /// Returns the changes to the scene, in the order of the changes of `abbe render`.
    fn patches(&self, changes: &[String]) -> Vec<String> {
        let mut patches = [&self.set[..], changes].concat();
        let mut add = |path: &str, value: Option<u32>| patches.extend(value.map(|value| format!("{path}={value}")));
        add("film.width", self.size.map(|(width, _)| width));
        add("film.height", self.size.map(|(_, height)| height));
        add("film.spectral_bands", Some(self.spectral_bands));
        add("render.threads", self.threads);
        patches
    }
}

impl ViewHost for ViewArgs {
    fn scene_path(&self) -> Option<&Path> {
        self.scene.as_deref()
    }

    fn load(&self, example: Option<&Example>, changes: &[String], forbidden: &[String]) -> Result<LoadedScene> {
        let mut patches = self.patches(changes);
        let read = |patches: &[String]| match (&self.scene, example) {
            (Some(path), _) => self.scene_file.read(path, patches, false),
            (None, Some(example)) => example.read(patches),
            (None, None) => Err(Error::input("no scene is chosen")),
        };
        let (mut scene, mut source) = read(&patches)?;
        if let Some(change) = LoadedScene::change_to_forbid(&scene, forbidden) {
            patches.push(change);
            (scene, source) = read(&patches)?;
        }
        // The picture is written at the end, but it is too late then to refuse its name.
        if let (Some(outputs), Some(path)) = (self.outputs()?, &self.scene) {
            outputs.check_keeps(&self.scene_file.inputs(&SceneFiles::of(&source), path))?;
        }
        LoadedScene::new(&scene, source)
    }

    fn interruption(&self) -> fn() -> bool {
        interrupt::is_requested
    }
}

/// Opens an address in the browser. Returns false if no program starts.
fn open_browser(url: &str) -> bool {
    let (program, arguments): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(program);
    command.args(arguments).arg(url).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.spawn().is_ok()
}
