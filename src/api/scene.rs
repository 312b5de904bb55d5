//! Scenes: load, change, check and render.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use super::Image;
use super::observer::{self, ProgressFunction, RenderObserver};
use super::options::RenderOptions;
use super::provenance::{self, SceneFiles};
use super::scene_inputs;
use abbe_format::resolve::resolve;
use abbe_format::{self as format, FileAccess, JsonSource, SceneFile};
use abbe_scene as model;
use abbe_session::render::{Job, Progress, on_threads};
use abbe_spectra::error::{Error, Result};
use abbe_transport::plan::explain::{self, Details};

/// A scene that can be rendered.
///
/// A scene comes from a file ([`load`](Self::load)), from JSON text ([`parse`](Self::parse)), or
/// from the structs of [`mod@abbe_format`] ([`TryFrom<SceneFile>`](SceneFile)).
///
/// ```
/// use abbe::{RenderOptions, Scene};
///
/// let scene = Scene::parse(
///     r#"{
///       "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
///       "film": {"width": 16, "height": 9},
///       "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
///       "objects": [{"shape": {"rectangle": {"width": 10, "height": 10}}, "material": "grey"}],
///       "lights": [{"point": {"at": [0, 3, 0], "spectrum": "D65", "power": 10}}]
///     }"#,
/// )?;
/// let image = scene.render(&RenderOptions::default().passes(2))?;
/// assert_eq!((image.width(), image.height()), (16, 9));
/// # Ok::<(), abbe::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Scene {
    origin: SceneOrigin,
}

#[derive(Debug, Clone)]
enum SceneOrigin {
    /// JSON text, and the changes that are applied to this text in order.
    Text { text: String, path: PathBuf, changes: Vec<String>, access: FileAccess },
    /// A resolved scene.
    Model(Box<model::Scene>),
}

impl Scene {
    /// Reads and checks a scene file.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, is not valid JSON, or contains an unknown key,
    /// a value of a wrong type or a value out of range. The error contains the file, the line, the
    /// column and the JSON path.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        Self::load_with_changes(path.as_ref(), &[], FileAccess::default())
    }

    /// Reads a scene file, applies changes of the form `PATH=JSON`, and checks the changed scene.
    ///
    /// # Errors
    /// Returns the errors of [`load`](Self::load) and of [`with_change`](Self::with_change).
    #[doc(hidden)]
    pub fn load_with_changes(path: &Path, changes: &[String], access: FileAccess) -> Result<Self> {
        let text = super::read_scene_text(path, access, None)?.text;
        Self::parse_with_changes(&text, path, changes, access)
    }

    /// Reads a scene from JSON text, applies changes of the form `PATH=JSON`, and checks the
    /// changed scene. Errors name the text `path`, and the folder of `path` contains the files of
    /// the scene.
    ///
    /// # Errors
    /// Returns the errors of [`load`](Self::load) and of [`with_change`](Self::with_change).
    #[doc(hidden)]
    pub fn parse_with_changes(text: &str, path: &Path, changes: &[String], access: FileAccess) -> Result<Self> {
        format::parse_with_access(text, path, changes, access)?;
        let (text, path, changes) = (text.to_string(), path.to_path_buf(), changes.to_vec());
        Ok(Self { origin: SceneOrigin::Text { text, path, changes, access } })
    }

    /// Reads and checks a scene from JSON text. The paths of files in the scene are relative to the
    /// working directory.
    ///
    /// # Errors
    /// Returns the same errors as [`load`](Self::load).
    pub fn parse(text: &str) -> Result<Self> {
        Self::parse_with_changes(text, Path::new("scene"), &[], FileAccess::default())
    }

    /// Changes one value of the scene. `change` has the form `PATH=JSON`, such as
    /// `objects.prism.material="crown"` or `render.max_depth=8`.
    ///
    /// # Errors
    /// Returns an error if the change is malformed, if its path does not exist, if the value is
    /// invalid at this path, or if the scene was not made from text.
    pub fn with_change(mut self, change: &str) -> Result<Self> {
        match &mut self.origin {
            SceneOrigin::Text { text, path, changes, .. } => {
                changes.push(change.to_string());
                format::parse(text.as_str(), path, changes)?;
                Ok(self)
            }
            SceneOrigin::Model(_) => Err(Error::input("the scene has no text that could be changed")),
        }
    }

    /// Allows the scene to use files outside the folder that contains the scene file. By default,
    /// the use of files outside this folder is an error.
    #[must_use]
    pub fn allow_outside_files(mut self) -> Self {
        match &mut self.origin {
            SceneOrigin::Text { access, .. } => *access = FileAccess::Anywhere,
            SceneOrigin::Model(_) => {}
        }
        self
    }

    /// Checks that the scene can be rendered. The check covers names, files, and values that depend
    /// on each other. Returns notes for the user, for example about approximated materials.
    ///
    /// # Errors
    /// Returns an error if a name is unknown, if a file cannot be read, if values contradict each
    /// other, or if no light of the scene has power within 360–830 nm.
    pub fn check(&self) -> Result<Vec<String>> {
        Ok(self.job(&RenderOptions::default())?.0.scene.notes)
    }

    /// Describes in words which effects the renderer simulates for this scene, and why.
    ///
    /// # Errors
    /// Returns the same errors as [`check`](Self::check).
    pub fn explain(&self) -> Result<String> {
        let (job, _) = self.job(&RenderOptions::default())?;
        Ok(explain::text(&job.scene, &job.plan, &job.rows, &job.budget, Details::ALL))
    }

    /// Renders the scene.
    ///
    /// # Errors
    /// Returns the same errors as [`check`](Self::check). Also returns an error if an option is out
    /// of range.
    pub fn render(&self, options: &RenderOptions) -> Result<Image> {
        self.render_with(options, |_| ControlFlow::Continue(()))
    }

    /// Renders the scene, and calls `progress` after every pass. If `progress` returns
    /// [`ControlFlow::Break`], the render stops, and the image contains the passes so far.
    ///
    /// ```no_run
    /// use abbe::{RenderOptions, Scene};
    /// use std::ops::ControlFlow;
    ///
    /// let scene = Scene::load("scenes/prism.json")?;
    /// let image = scene.render_with(&RenderOptions::default(), |progress| {
    ///     println!("{} passes in {:?}", progress.passes, progress.elapsed);
    ///     if progress.passes >= 8 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    /// })?;
    /// image.write_exr("newton.exr")?;
    /// # Ok::<(), abbe::Error>(())
    /// ```
    ///
    /// # Errors
    /// Returns the same errors as [`render`](Self::render).
    pub fn render_with(
        &self,
        options: &RenderOptions,
        progress: impl FnMut(&Progress) -> ControlFlow<()> + Send,
    ) -> Result<Image> {
        self.render_observed(options, &mut ProgressFunction(progress))
    }

    /// Renders the scene, and calls the methods of `observer`.
    ///
    /// # Errors
    /// Returns the same errors as [`render`](Self::render), and the error of
    /// [`RenderObserver::planned`].
    #[doc(hidden)]
    pub fn render_observed(&self, options: &RenderOptions, observer: &mut dyn RenderObserver) -> Result<Image> {
        let (job, source) = self.job(options)?;
        observer.planned(&job.budget)?;
        let files = source.as_ref().map(SceneFiles::of);
        let metadata = provenance::of_scene(source.as_ref().zip(files.as_ref()), &job, options.request.integrator);
        let checkpoint =
            options.checkpoint.as_deref().map(|path| observer::Checkpoint { path, resume: options.resume });
        let threads = job.scene.settings.threads;
        let rendered =
            on_threads(threads, || observer::render(&job, options.request, &metadata, checkpoint, observer))?;
        let rendered =
            rendered.map_err(|error| self.path().map_or_else(|| error.clone(), |path| error.clone().in_file(path)))?;
        let inputs = files.iter().flat_map(|files| &files.paths).cloned();
        let inputs: Vec<PathBuf> = inputs.chain(self.path().into_iter().flat_map(scene_inputs)).collect();
        Ok(Image::of_render(rendered, &job, &metadata).with_inputs(&inputs))
    }

    /// The path of the scene's text.
    fn path(&self) -> Option<&Path> {
        match &self.origin {
            SceneOrigin::Text { path, .. } => Some(path),
            SceneOrigin::Model(_) => None,
        }
    }

    /// Resolves and plans the scene. Also returns the text of the scene, if it has one.
    fn job(&self, options: &RenderOptions) -> Result<(Job, Option<JsonSource>)> {
        match &self.origin {
            SceneOrigin::Text { text, path, changes, access } => {
                let changes = [changes.clone(), options.changes()].concat();
                let (file, source) = format::parse_with_access(text, path, &changes, *access)?;
                let job = Job::of_picture(resolve(&file, &source)?).map_err(|error| error.in_file(path))?;
                Ok((job, Some(source)))
            }
            SceneOrigin::Model(scene) => {
                if options.size.is_some() {
                    return Err(Error::input("the size of a scene without text cannot be changed"));
                }
                let mut scene = model::Scene::clone(scene);
                let settings = &mut scene.settings;
                settings.photons = options.photons.or(settings.photons);
                settings.seed = options.seed.or(settings.seed);
                settings.threads = options.threads.or(settings.threads);
                scene.film.spectral_bands = options.spectral_bands.unwrap_or(scene.film.spectral_bands);
                Ok((Job::of_picture(scene)?, None))
            }
        }
    }
}

impl TryFrom<&SceneFile> for Scene {
    type Error = Error;

    /// Checks a scene built from the structs of the scene file.
    fn try_from(file: &SceneFile) -> Result<Self> {
        let text = serde_json::to_string_pretty(file)
            .map_err(|error| Error::input(format!("the scene cannot be written as JSON: {error}")))?;
        Self::parse(&text)
    }
}

impl From<model::Scene> for Scene {
    /// Creates a scene from a resolved scene model.
    fn from(scene: model::Scene) -> Self {
        Self { origin: SceneOrigin::Model(Box::new(scene)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{
      "camera": {"from": [0, 1, 5], "at": [0, 1, 0], "lens": {"pinhole": {"fov": 40}}},
      "film": {"width": 6, "height": 4},
      "materials": {"grey": {"diffuse": {"reflectance": 0.5}}},
      "objects": [{"shape": {"rectangle": {"width": 10, "height": 10}}, "material": "grey"}],
      "lights": [{"point": {"at": [0, 3, 0], "spectrum": "D65", "power": 10}}]
    }"#;

    #[test]
    fn changes_and_options_apply_to_the_text() {
        let scene = Scene::parse(TEXT).unwrap().with_change("film.width=8").unwrap();
        let options = RenderOptions::default().passes(1).photons(100).spectral_bands(4);
        let image = scene.render(&options).unwrap();
        assert_eq!((image.width(), image.height()), (8, 4));
        assert_eq!(image.spectrum(7, 3).unwrap().values.len(), 4);
        let image = scene.render(&options.size(3, 2)).unwrap();
        assert_eq!((image.width(), image.height()), (3, 2));
        assert!(Scene::parse(TEXT).unwrap().with_change("film.width=-1").is_err());
    }

    #[test]
    fn a_callback_stops_the_render() {
        let options = RenderOptions::default().passes(5).photons(100);
        let image = Scene::parse(TEXT).unwrap().render_with(&options, |_| ControlFlow::Break(())).unwrap();
        assert!(image.is_interrupted());
        assert_eq!(image.stats().map(|stats| stats.passes), Some(1));
    }

    #[test]
    fn a_checkpoint_continues_with_equal_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.exr");
        let scene = Scene::parse(TEXT).unwrap();
        let options = RenderOptions::default().passes(5).photons(100);
        let kept = options.clone().checkpoint(&path).resume(true);
        let stop =
            |progress: &Progress| if progress.passes < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
        let part = scene.render_with(&kept, stop).unwrap();
        assert!(part.is_interrupted() && path.exists());
        let whole = scene.render(&kept).unwrap();
        assert!(!path.exists() && whole.stats().map(|stats| stats.passes) == Some(5));
        let direct = scene.render(&options).unwrap();
        let pixels = |image: &Image| (0..24).map(|i| image.xyz(i % 6, i / 6)).collect::<Vec<_>>();
        assert_eq!(pixels(&whole), pixels(&direct));
        // A file that is no checkpoint is an error.
        std::fs::write(&path, "no picture").unwrap();
        assert!(scene.render(&kept).is_err());
    }

    #[test]
    fn an_image_replaces_no_file_of_its_scene() {
        let folder = tempfile::tempdir().unwrap();
        let [scene, texture] = ["scene.json", "wood.png"].map(|name| folder.path().join(name));
        let options = RenderOptions::default().passes(1).photons(100);
        Scene::parse(TEXT).unwrap().render(&options).unwrap().write_png(&texture).unwrap();
        std::fs::write(&scene, TEXT.replace("0.5}", r#"{"image": "wood.png"}}"#)).unwrap();
        let image = Scene::load(&scene).unwrap().render(&options).unwrap();
        for path in [&scene, &texture] {
            let before = std::fs::read(path).unwrap();
            let error = image.write_png(path).unwrap_err().to_string();
            assert!(error.contains("would replace"), "{error}");
            assert!(image.write_exr(path).is_err() && std::fs::read(path).unwrap() == before);
        }
        image.write_png(folder.path().join("other.png")).unwrap();
    }

    #[test]
    fn an_observer_sees_the_unfinished_images() {
        struct Shown(Vec<u64>);
        impl RenderObserver for Shown {
            fn after_pass(&mut self, _: &Progress) -> ControlFlow<()> {
                ControlFlow::Continue(())
            }
            fn show(&mut self, unfinished: &crate::api::UnfinishedRender<'_>) {
                assert_eq!(unfinished.image().width(), 6);
                self.0.push(unfinished.progress().passes);
            }
        }
        let mut shown = Shown(Vec::new());
        let options = RenderOptions::default().passes(3).photons(100);
        Scene::parse(TEXT).unwrap().render_observed(&options, &mut shown).unwrap();
        assert_eq!(shown.0, [1, 2]);
    }

    #[test]
    fn text_structs_and_model_give_equal_pixels() {
        let (file, source) = format::parse(TEXT, Path::new("scene"), &[]).unwrap();
        let options = RenderOptions::default().passes(1).photons(100).seed(3);
        let scenes = [
            Scene::parse(TEXT).unwrap(),
            Scene::try_from(&file).unwrap(),
            Scene::from(resolve(&file, &source).unwrap()),
        ];
        let [a, b, c] = scenes.map(|scene| scene.render(&options).unwrap());
        assert!(a.xyz(3, 2) == b.xyz(3, 2) && a.xyz(3, 2) == c.xyz(3, 2));
    }
}
