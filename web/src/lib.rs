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

    /// Renders the passes of part `index` of `of`. Calls `after_pass` with the number of passes and
    /// a function that returns the bytes of the run; it returns false to end the render.
    /// Calls `show_coarse` with the bytes of coarse pictures.
    pub fn render(
        &self,
        index: u32,
        of: u32,
        passes: u32,
        earlier: Option<Vec<u8>>,
        after_pass: &Function,
        show_coarse: Option<Function>,
    ) -> Result<Uint8Array, JsValue> {
        let part = PassPart::new(index, of).map_err(|error| thrown(&error))?;
        let mut report = |run: &Run| {
            let bytes = || Uint8Array::from(run.to_bytes().as_slice());
            let wanted = after_pass.call1(&JsValue::NULL, &JsValue::from_f64(run.passes() as f64));
            // The page wants the bytes, or only goes on, or ends the render.
            match wanted {
                Ok(answer) if answer.is_function() => {
                    Function::from(answer).call1(&JsValue::NULL, &bytes()).is_ok_and(|answer| !answer.is_falsy())
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
        let bytes = self.0.render(part, passes.into(), earlier.as_deref(), show, &mut report);
        bytes.map(|bytes| Uint8Array::from(bytes.as_slice())).map_err(|error| thrown(&error))
    }

    /// `parts` contains the bytes of runs.
    pub fn show(&mut self, parts: &Array, wanted: u32, elapsed_s: f64) -> Result<(), JsValue> {
        let parts: Vec<Vec<u8>> = parts.iter().map(|bytes| Uint8Array::from(bytes).to_vec()).collect();
        self.0.show(&parts, wanted.into(), elapsed_s).map_err(|error| thrown(&error))
    }

    /// Returns the hash of the exact sums of runs.
    #[wasm_bindgen(js_name = hashOfSums)]
    pub fn hash_of_sums(&self, parts: &Array) -> Result<String, JsValue> {
        let parts: Vec<Vec<u8>> = parts.iter().map(|bytes| Uint8Array::from(bytes).to_vec()).collect();
        self.0.hash_of_sums(&parts).map_err(|error| thrown(&error))
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
