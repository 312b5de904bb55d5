//! The renderer behind a page that has no server: in WebAssembly, in the workers of a web page.
//!
//! One engine shows the pictures and answers the page. The others each render a part of the passes,
//! and their exact sums move to the first one as bytes, so that each engine holds the sums of one
//! film. The bits are those of a render with the same passes by the command line.

use super::answer::{ANSWERED_OF_SCENE, Answer, Refusal, answer, answer_of_scene};
use super::loaded_scene::LoadedScene;
use super::scene_panels::ScenePanels;
use super::sketch::{SketchSize, of_bytes, to_bytes};
use super::snapshot::{Shown, Snapshot};
use super::state::{PageState, SessionState, ViewProgress};
use abbe_format::{FileAccess, parse_with_access};
use abbe_session::render::{
    CoarseLevel, CoarsePicture, Integrator, Monitor, PassPart, Progress, Request, Run, StopRules, TakenPasses,
};
use abbe_spectra::error::{Error, Result};
use std::path::Path;
use std::sync::Arc;
use web_time::Instant;

/// The name of the scene in messages.
const SCENE_NAME: &str = "scene.json";

/// The state of a page without a server.
#[derive(Debug, Default)]
pub struct PageEngine {
    state: PageState,
    loaded: Option<Arc<LoadedScene>>,
    /// The passes of the loaded scene that other engines have rendered.
    passes: Option<TakenPasses>,
    /// The number of loaded scenes.
    scenes: u64,
    /// The number of pictures.
    pictures: u64,
    size: SketchSize,
    /// The time of the last load in s.
    load_s: f64,
}

impl PageEngine {
    /// Loads the scene of a text with changes in the form `PATH=JSON`, without the named effects.
    /// After an error, the last picture stays, and the page shows the error.
    ///
    /// # Errors
    /// Returns an input error if the scene or a change is wrong, or if the scene uses files.
    pub fn load(&mut self, text: &str, changes: &[String], forbidden: &[String]) -> Result<()> {
        let start = Instant::now();
        // The memory is free before the new scene needs some.
        self.passes = None;
        let load = |changes: &[String]| parse_with_access(text, Path::new(SCENE_NAME), changes, FileAccess::default());
        let loaded = load(changes).and_then(|(scene, source)| {
            let Some(change) = LoadedScene::change_to_forbid(&scene, forbidden) else {
                return LoadedScene::new(&scene, source);
            };
            let (scene, source) = load(&[changes, &[change]].concat())?;
            LoadedScene::new(&scene, source)
        });
        let loaded = Arc::new(loaded.inspect_err(|error| {
            (self.state.session, self.state.error) = (SessionState::Failed, Some(error.to_string()));
        })?);
        self.scenes += 1;
        self.state.begin(Arc::new(ScenePanels::new(self.scenes, &loaded)));
        self.loaded = Some(loaded);
        self.load_s = start.elapsed().as_secs_f64();
        Ok(())
    }

    /// Shows a sketch of the scene. Its size depends on the time that the sketches before it took.
    ///
    /// # Errors
    /// Returns an input error if no scene is loaded, or if the scene cannot be posed.
    pub fn show_sketch(&mut self) -> Result<()> {
        let start = Instant::now();
        if let Some(coarse) = self.loaded()?.job.sketch(self.size.get())? {
            self.size.update(self.load_s, start.elapsed().as_secs_f64());
            self.show_coarse(coarse)?;
        }
        Ok(())
    }

    /// Shows a coarse picture, the bytes of which [`Self::render`] passed to `show_coarse`, unless
    /// a pass of this scene is shown.
    ///
    /// # Errors
    /// Returns an input error if no scene is loaded, or if the bytes are not a coarse picture of
    /// its size.
    pub fn show_coarse_bytes(&mut self, bytes: &[u8]) -> Result<()> {
        let film = &self.loaded()?.job.scene.film;
        let size = [film.width as usize, film.height as usize];
        let coarse = of_bytes(bytes).filter(|coarse| coarse.film == size);
        let coarse = coarse.ok_or_else(|| Error::input("the bytes are not a coarse picture of the scene"))?;
        if self.last_of_scene().is_none() { self.show_coarse(coarse) } else { Ok(()) }
    }

    fn show_coarse(&mut self, coarse: CoarsePicture) -> Result<()> {
        self.pictures += 1;
        let snapshot = Snapshot::of_render(self.pictures, self.scene()?, Shown::Coarse(coarse), None);
        self.state.snapshot = Some(Arc::new(snapshot));
        Ok(())
    }

    /// Returns the shown picture if it contains passes of this scene.
    fn last_of_scene(&self) -> Option<&Snapshot> {
        let last = self.state.snapshot.as_deref();
        last.filter(|last| last.passes > 0 && last.scene.number == self.scenes)
    }

    /// Returns the number of passes of the whole picture, before the reader wants more.
    ///
    /// # Errors
    /// Returns an input error if no scene is loaded.
    pub fn passes(&self) -> Result<u64> {
        Ok(StopRules::default().passes_wanted(&self.loaded()?.job.budget).unwrap_or(1))
    }

    /// Renders a part of the first `passes` passes, after the first `done` passes of the part.
    /// `show_coarse` receives the bytes of finer and finer pictures before the first pass.
    /// `after_pass` receives the run after each pass, and returns false to end the render. It may
    /// take the passes. Returns the run with the other ones.
    ///
    /// # Errors
    /// Returns an input error if no scene is loaded, or if the part has no passes.
    pub fn render(
        &self,
        part: PassPart,
        passes: u64,
        done: u64,
        show_coarse: Option<&mut dyn FnMut(Vec<u8>)>,
        after_pass: &mut dyn FnMut(&mut Run) -> bool,
    ) -> Result<Run> {
        let job = &self.loaded()?.job;
        let run = Run::after(job, part, done);
        let stop = StopRules { passes: Some(passes), ..StopRules::default() };
        let mut monitor = EngineMonitor { show_coarse, after_pass, goes_on: true };
        let rendered = job.continue_run(Request { integrator: Integrator::Photon, stop }, run, &mut monitor)?;
        Ok(rendered.run)
    }

    /// Adds passes that another engine has rendered of this scene. `pieces` are those of
    /// [`Run::take_passes`].
    ///
    /// # Errors
    /// Returns an input error if no scene is loaded, and the errors of [`TakenPasses::add`].
    pub fn add(&mut self, pieces: impl IntoIterator<Item = impl AsRef<[u8]>>) -> Result<()> {
        let loaded = self.loaded.clone().ok_or_else(no_scene)?;
        self.passes.get_or_insert_with(|| TakenPasses::new(&loaded.job)).add(&loaded.job, pieces)
    }

    /// Returns the number of added passes of a part.
    pub fn done(&self, part: PassPart) -> u64 {
        self.passes.as_ref().map_or(0, |passes| passes.of_part(part))
    }

    fn run(&self) -> Result<&Run> {
        self.passes.as_ref().map(TakenPasses::run).ok_or_else(|| Error::input("no passes are added"))
    }

    /// Shows the sum of the added passes, of `wanted` passes that take `elapsed_s` seconds so far.
    ///
    /// # Errors
    /// Returns an input error if no passes are added.
    pub fn show(&mut self, wanted: u64, elapsed_s: f64) -> Result<()> {
        self.pictures += 1;
        let run = self.run()?;
        let shown = Shown::Passes(run.picture_with_denoised(), run);
        let snapshot = Snapshot::of_render(self.pictures, self.scene()?, shown, self.last_of_scene());
        let is_done = run.passes() >= wanted;
        let progress = ViewProgress {
            passes: run.passes(),
            passes_wanted: Some(wanted),
            elapsed_s,
            photons_per_second: run.photons() as f64 / elapsed_s.max(1e-3),
            relative_error: run.relative_error(),
            typical_error: run.typical_error(),
        };
        self.state.session = if is_done { SessionState::Finished } else { SessionState::Rendering };
        self.state.progress = progress;
        self.state.snapshot = Some(Arc::new(snapshot));
        Ok(())
    }

    /// Returns the hash of the exact sums of the added passes, as 32 hexadecimal digits.
    ///
    /// # Errors
    /// Returns an input error if no passes are added.
    pub fn hash_of_sums(&self) -> Result<String> {
        Ok(self.run()?.hash_of_sums())
    }

    /// Keeps the shown picture as the reference of comparisons.
    pub fn keep_as_reference(&mut self) {
        self.state.keep_as_reference();
    }

    /// Returns the state of the page as JSON. `version` counts its changes.
    pub fn state(&self, version: u64) -> serde_json::Value {
        self.state.to_json(version)
    }

    /// Returns the text of the scene with all changes, as it was written, or `None` before the
    /// first scene.
    pub fn scene_text(&self) -> Option<&str> {
        self.loaded.as_ref().map(|loaded| loaded.source.written())
    }

    /// Answers a request of the page, a path with a query.
    ///
    /// # Errors
    /// Returns a refusal if there is no answer.
    pub fn answer(&self, path: &str, query: &str) -> std::result::Result<Answer, Refusal> {
        let json = |body: String| Ok(Answer { kind: "application/json", plane: None, body: body.into_bytes() });
        match path {
            "scene" => json(self.state.scene.as_ref().ok_or(Refusal::Absent)?.text.clone()),
            _ if let Some(loaded) = &self.loaded
                && ANSWERED_OF_SCENE.contains(&path) =>
            {
                answer_of_scene(loaded, self.scenes, path, query)
            }
            _ => answer(&self.state, path, query),
        }
    }

    fn loaded(&self) -> Result<&LoadedScene> {
        self.loaded.as_deref().ok_or_else(no_scene)
    }

    fn scene(&self) -> Result<(&LoadedScene, Arc<ScenePanels>)> {
        let scene = self.state.scene.as_ref().ok_or_else(no_scene)?;
        Ok((self.loaded()?, Arc::clone(scene)))
    }
}

fn no_scene() -> Error {
    Error::input("no scene is loaded")
}

struct EngineMonitor<'a, 'c> {
    show_coarse: Option<&'c mut dyn FnMut(Vec<u8>)>,
    after_pass: &'a mut dyn FnMut(&mut Run) -> bool,
    goes_on: bool,
}

impl Monitor for EngineMonitor<'_, '_> {
    fn coarse_levels(&self) -> &'static [CoarseLevel] {
        if self.show_coarse.is_some() { &[CoarseLevel::Half, CoarseLevel::Full] } else { &[] }
    }

    fn show_coarse_picture(&mut self, coarse: &CoarsePicture) {
        if let Some(show) = &mut self.show_coarse {
            show(to_bytes(coarse));
        }
    }

    fn after_pass(&mut self, _: &Progress) -> bool {
        self.goes_on
    }

    fn checkpoint(&mut self, run: &mut Run) {
        self.goes_on = (self.after_pass)(run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_session::render::NoMonitor;

    const SCENE: &str = include_str!("../../scenes/glass_ball.json");
    const SMALL: [&str; 3] = ["film.width=32", "film.height=18", "render.photons=2000"];

    fn engine() -> PageEngine {
        let mut engine = PageEngine::default();
        engine.load(SCENE, &SMALL.map(str::to_string), &[]).unwrap();
        engine
    }

    fn taken(mut run: Run) -> Vec<Vec<u8>> {
        let mut pieces = Vec::new();
        run.take_passes(&mut |piece| pieces.push(piece.to_vec()));
        pieces
    }

    #[test]
    fn the_sum_of_parts_is_the_render_of_all_passes() {
        let (mut engine, worker) = (engine(), engine());
        for part in [0, 1].map(|index| PassPart::new(index, 2).unwrap()) {
            // The render is interrupted after the first pass, so it ends with the second one.
            let first = worker.render(part, 8, 0, None, &mut |run| run.passes() < 1).unwrap();
            engine.add(taken(first)).unwrap();
            assert_eq!(engine.done(part), 2);
            let last = worker.render(part, 8, 2, None, &mut |run| {
                run.take_passes(&mut |_| {});
                true
            });
            assert!(engine.add(taken(last.unwrap())).is_err(), "the third pass is missing");
            let send = &mut |run: &mut Run| {
                let mut pieces = Vec::new();
                run.take_passes(&mut |piece| pieces.push(piece.to_vec()));
                engine.add(pieces).is_ok()
            };
            let last = worker.render(part, 8, 2, None, send).unwrap();
            engine.add(taken(last)).unwrap();
        }
        let job = &engine.loaded().unwrap().job;
        let sum = engine.run().unwrap();
        let request =
            Request { integrator: Integrator::Photon, stop: StopRules { passes: Some(8), ..StopRules::default() } };
        let whole = job.render(request, &mut NoMonitor).unwrap().run;
        assert_eq!(sum.hash_of_sums(), whole.hash_of_sums());
        assert_eq!((sum.passes(), sum.typical_error()), (8, whole.typical_error()));
        engine.show(8, 2.0).unwrap();
        let state = engine.state(7);
        assert_eq!(
            (&state["version"], &state["passes"], &state["session"]),
            (&7.into(), &8.into(), &"finished".into())
        );
        assert_eq!(engine.answer("picture", "").unwrap().plane, Some([1, 32, 18]));
        assert!(engine.answer("save.exr", "").unwrap().body.len() > 1000);
        assert!(engine.answer("band", "band=1000").unwrap().body.is_empty());
    }

    /// Coarse pictures become finer and have no errors. Passes replace them, and have the bits of a
    /// render without coarse pictures.
    #[test]
    fn coarse_pictures_come_before_the_first_pass() {
        let mut engine = PageEngine::default();
        let film = ["film.width=240", "film.height=135", "render.photons=4000", "film.spectral_bands=0"];
        engine.load(SCENE, &film.map(str::to_string), &[]).unwrap();
        let coarse = |engine: &PageEngine| engine.state(1)["picture"]["coarse"]["size"].clone();
        engine.show_sketch().unwrap();
        assert_eq!(coarse(&engine), serde_json::json!([80, 45]));
        let mut shown = Vec::new();
        let with = engine.render(PassPart::WHOLE, 1, 0, Some(&mut |bytes| shown.push(bytes)), &mut |_| true).unwrap();
        let without = engine.render(PassPart::WHOLE, 1, 0, None, &mut |_| true).unwrap();
        assert_eq!(with.hash_of_sums(), without.hash_of_sums());
        assert!(!shown.is_empty());
        engine.show_coarse_bytes(&shown[0]).unwrap();
        assert_eq!(coarse(&engine), serde_json::json!([120, 68]));
        assert!(engine.answer("save.exr", "").is_err(), "a coarse picture is not saved");
        let errors = engine.answer("errors", "").unwrap().body;
        assert!(errors.chunks(4).all(|value| f32::from_le_bytes(value.try_into().unwrap()).is_nan()));
        engine.add(taken(with)).unwrap();
        engine.show(1, 1.0).unwrap();
        engine.show_coarse_bytes(&shown[0]).unwrap();
        let state = engine.state(2);
        assert_eq!((&state["picture"]["coarse"], &state["picture"]["passes"]), (&serde_json::Value::Null, &1.into()));
        assert!(engine.show_coarse_bytes(&shown[0][1..]).is_err());
    }

    #[test]
    fn wrong_bytes_are_refused() {
        let mut engine = engine();
        assert!(engine.show(1, 1.0).is_err());
        let render = |index, of, passes| {
            taken(engine.render(PassPart::new(index, of).unwrap(), passes, 0, None, &mut |_| true).unwrap())
        };
        let (pieces, even) = (render(0, 1, 1), render(0, 2, 1));
        let job = &engine.loaded().unwrap().job;
        let mut damaged = pieces.clone();
        damaged[1].pop();
        for wrong in [&pieces[1..], &pieces[..pieces.len() - 1], &damaged, &[]] {
            assert!(TakenPasses::new(job).add(job, wrong).is_err());
        }
        engine.add(&pieces).unwrap();
        let again = engine.add(&pieces).unwrap_err();
        assert!(again.to_string().contains("do not follow"), "{again}");
        let twice = engine.add(&even).unwrap_err();
        assert!(twice.to_string().contains("same pass"), "{twice}");
    }

    #[test]
    fn a_wrong_scene_keeps_the_last_one_and_names_the_place() {
        let mut engine = engine();
        let error = engine.load("{\n \"film\": 3}", &[], &[]).unwrap_err();
        assert!(error.to_string().contains("scene.json:2:"), "{error}");
        let state = engine.state(1);
        assert_eq!((&state["session"], &state["scene"]), (&"failed".into(), &1.into()));
        assert!(engine.answer("scene", "").is_ok());
    }
}
