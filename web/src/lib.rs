//! The bindings of [`PageEngine`] for JavaScript. `web/build` makes a page of this module and of
//! the scripts beside it.

use abbe::page::{PageEngine, Refusal};
use abbe_session::render::{PassPart, Run};
use abbe_spectra::Error;
use js_sys::{Array, Function, Uint8Array};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;

/// A renderer of one worker. The names of the methods are those of [`PageEngine`].
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Engine(PageEngine);

/// An answer for the page, with the number, the width and the height of its picture, if it has
/// values of pixels.
#[wasm_bindgen(getter_with_clone)]
#[derive(Debug)]
pub struct Answer {
    pub kind: String,
    pub plane: Vec<u32>,
    pub bytes: Uint8Array,
}

fn thrown(error: &Error) -> JsValue {
    JsValue::from_str(&error.to_string())
}

/// Takes the passes of a run as an array of byte arrays, each of which can move to another worker.
fn taken(run: &mut Run) -> Array {
    let pieces = Array::new();
    run.take_passes(&mut |piece| {
        pieces.push(&Uint8Array::from(piece));
    });
    pieces
}

#[wasm_bindgen]
impl Engine {
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    pub fn load(&mut self, text: &str, changes: Vec<String>, forbidden: Vec<String>) -> Result<(), JsValue> {
        self.0.load(text, &changes, &forbidden).map_err(|error| thrown(&error))
    }

    #[wasm_bindgen(js_name = showSketch)]
    pub fn show_sketch(&mut self) -> Result<(), JsValue> {
        self.0.show_sketch().map_err(|error| thrown(&error))
    }

    #[wasm_bindgen(js_name = showCoarse)]
    pub fn show_coarse(&mut self, bytes: &[u8]) -> Result<(), JsValue> {
        self.0.show_coarse_bytes(bytes).map_err(|error| thrown(&error))
    }

    pub fn passes(&self) -> Result<u32, JsValue> {
        self.0.passes().map(|passes| passes as u32).map_err(|error| thrown(&error))
    }

    /// Renders the passes of part `index` of `of` after the first `done` ones. Calls `after_pass`
    /// with their number. It returns false to end the render, or a function that receives the
    /// pieces of the passes so far. Calls `show_coarse` with the bytes of coarse pictures. Returns
    /// the pieces of the other passes.
    pub fn render(
        &self,
        index: u32,
        of: u32,
        passes: u32,
        done: u32,
        after_pass: &Function,
        show_coarse: Option<Function>,
    ) -> Result<Array, JsValue> {
        let part = PassPart::new(index, of).map_err(|error| thrown(&error))?;
        let mut report = |run: &mut Run| {
            let wanted = after_pass.call1(&JsValue::NULL, &JsValue::from_f64(run.passes() as f64));
            // The page wants the passes, or only goes on, or ends the render.
            match wanted {
                Ok(answer) if answer.is_function() => {
                    Function::from(answer).call1(&JsValue::NULL, &taken(run)).is_ok_and(|answer| !answer.is_falsy())
                }
                Ok(answer) => !answer.is_falsy(),
                Err(_) => false,
            }
        };
        let mut show = show_coarse.map(|show| {
            move |bytes: Vec<u8>| {
                // The page ignores a picture that it cannot receive; the passes replace it.
                let _ = show.call1(&JsValue::NULL, &Uint8Array::from(bytes.as_slice()));
            }
        });
        let show = show.as_mut().map(|show| show as &mut dyn FnMut(Vec<u8>));
        let run = self.0.render(part, passes.into(), done.into(), show, &mut report);
        run.map(|mut run| taken(&mut run)).map_err(|error| thrown(&error))
    }

    /// Adds pieces of passes.
    pub fn add(&mut self, pieces: &Array) -> Result<(), JsValue> {
        self.0.add(pieces.iter().map(|piece| Uint8Array::from(piece).to_vec())).map_err(|error| thrown(&error))
    }

    /// Returns the number of added passes of part `index` of `of`.
    pub fn done(&self, index: u32, of: u32) -> Result<u32, JsValue> {
        PassPart::new(index, of).map(|part| self.0.done(part) as u32).map_err(|error| thrown(&error))
    }

    pub fn show(&mut self, wanted: u32, elapsed_s: f64) -> Result<(), JsValue> {
        self.0.show(wanted.into(), elapsed_s).map_err(|error| thrown(&error))
    }

    #[wasm_bindgen(js_name = hashOfSums)]
    pub fn hash_of_sums(&self) -> Result<String, JsValue> {
        self.0.hash_of_sums().map_err(|error| thrown(&error))
    }

    #[wasm_bindgen(js_name = keepAsReference)]
    pub fn keep_as_reference(&mut self) {
        self.0.keep_as_reference();
    }

    /// Returns the state of the page as JSON text.
    pub fn state(&self, version: u32) -> String {
        self.0.state(version.into()).to_string()
    }

    #[wasm_bindgen(js_name = sceneText)]
    pub fn scene_text(&self) -> Option<String> {
        self.0.scene_text().map(str::to_string)
    }

    /// Answers a request. Throws the word of a refusal.
    pub fn answer(&self, path: &str, query: &str) -> Result<Answer, JsValue> {
        let refused = |refusal: Refusal| JsValue::from_str(&format!("{refusal:?}"));
        let answer = self.0.answer(path, query).map_err(refused)?;
        let plane = answer.plane.map_or_else(Vec::new, |plane| plane.map(|number| number as u32).to_vec());
        Ok(Answer { kind: answer.kind.to_string(), plane, bytes: Uint8Array::from(answer.body.as_slice()) })
    }
}
