//! Answers the page's requests about its pictures, however they arrive.

use super::cells;
use super::export;
use super::loaded_scene::LoadedScene;
use super::photons::paths;
use super::pick::pick;
use super::probe::{self, ProbeArea};
use super::snapshot::{Snapshot, float_bytes};
use super::state::PageState;
use abbe_session::output::compare::{compare, delta_e_map};
use abbe_session::output::exr::encode as encode_exr;
use abbe_session::output::png::encode as encode_png;
use abbe_session::output::selection::Selection;
use abbe_transport::sensor::exposure;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// The requests that [`answer`] answers. Each is a path with a query.
#[cfg(feature = "view")]
pub(crate) const ANSWERED: [&str; 18] = [
    "picture",
    "denoised",
    "errors",
    "samples",
    "classes",
    "stokes",
    "degree",
    "band",
    "probe",
    "cells",
    "export",
    "bloomed",
    "save.exr",
    "save.png",
    "reference",
    "reference_probe",
    "delta_e",
    "comparison",
];

/// An answer for the page.
#[derive(Debug)]
pub struct Answer {
    /// The media type of the body.
    pub kind: &'static str,
    /// The number, the width and the height of the picture, if the body has values of its pixels.
    /// The body is empty if the picture does not have these values.
    pub plane: Option<[u64; 3]>,
    pub body: Vec<u8>,
}

/// Why there is no answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refusal {
    /// The picture does not exist.
    Absent,
    /// The query is wrong.
    Wrong,
    /// The pictures cannot be compared.
    Unlike,
    Failed,
}

type Answered = Result<Answer, Refusal>;

/// Asks for the bloom of the picture or of the denoised one.
#[derive(Debug, Deserialize)]
struct BloomQuery {
    denoised: bool,
}

#[derive(Debug, Deserialize)]
struct BandQuery {
    band: usize,
}

/// Answers a request of [`ANSWERED`]. `query` is the text after the question mark.
pub(crate) fn answer(state: &PageState, path: &str, query: &str) -> Answered {
    let reference = || state.reference.as_deref().ok_or(Refusal::Absent);
    match path {
        "reference" => return Ok(plane(reference()?, reference()?.xyz())),
        "reference_probe" => return probed(reference()?, query),
        _ => {}
    }
    let snapshot = state.snapshot.as_deref().ok_or(Refusal::Absent)?;
    // A plane that the picture lacks is empty, because a page asks for it before it knows the
    // picture.
    let found = |values: Option<Vec<u8>>| Ok(plane(snapshot, values.unwrap_or_default()));
    match path {
        "picture" => found(Some(snapshot.xyz())),
        "denoised" => found(snapshot.denoised()),
        "errors" => found(Some(snapshot.errors())),
        "samples" => found(snapshot.samples()),
        "classes" => found(snapshot.classes()),
        "stokes" => found(snapshot.stokes()),
        "degree" => found(snapshot.degree()),
        "band" => found(snapshot.band(numbers::<BandQuery>(query)?.band)),
        "bloomed" => found(snapshot.bloomed(numbers::<BloomQuery>(query)?.denoised)),
        "probe" => probed(snapshot, query),
        "cells" => {
            let values = cells::values(snapshot, numbers(query)?);
            Ok(plane(snapshot, values.ok_or(Refusal::Wrong)?))
        }
        "export" => file("text/html; charset=utf-8", Some(export::template().into_bytes())),
        "save.exr" => {
            let metadata = snapshot.metadata.as_ref().ok_or(Refusal::Absent)?;
            file("image/x-exr", encode_exr(&snapshot.picture, metadata).ok())
        }
        "save.png" => {
            let screen = snapshot.scene.display.screen_at(&snapshot.picture, snapshot.exposure);
            file("image/png", snapshot.metadata.as_ref().and_then(|_| encode_png(&screen).ok()))
        }
        "delta_e" | "comparison" => compared(snapshot, reference()?, path == "delta_e"),
        _ => Err(Refusal::Absent),
    }
}

/// Answers a request about the difference between the reference and the published picture.
fn compared(snapshot: &Snapshot, reference: &Snapshot, is_map: bool) -> Answered {
    let (a, b) = (&snapshot.picture, &reference.picture);
    if (a.width, a.height) != (b.width, b.height) {
        return Err(Refusal::Unlike);
    }
    if is_map {
        let values = delta_e_map(a, b, exposure::automatic(b));
        return Ok(plane(snapshot, float_bytes(values.into_iter().map(|value| value as f32))));
    }
    json(&compare(a, b, &Selection::default()).map_err(|_| Refusal::Unlike)?)
}

fn probed(snapshot: &Snapshot, query: &str) -> Answered {
    let area: ProbeArea = numbers(query)?;
    json(&probe::report(snapshot, area).ok_or(Refusal::Wrong)?)
}

fn plane(snapshot: &Snapshot, body: Vec<u8>) -> Answer {
    let (width, height) = (snapshot.picture.width as u64, snapshot.picture.height as u64);
    Answer { kind: "application/octet-stream", plane: Some([snapshot.number, width, height]), body }
}

fn file(kind: &'static str, body: Option<Vec<u8>>) -> Answered {
    Ok(Answer { kind, plane: None, body: body.ok_or(Refusal::Absent)? })
}

fn json(value: &impl Serialize) -> Answered {
    let body = serde_json::to_vec(value).map_err(|_| Refusal::Failed)?;
    Ok(Answer { kind: "application/json", plane: None, body })
}

/// The requests that [`answer_of_scene`] answers.
pub(crate) const ANSWERED_OF_SCENE: [&str; 2] = ["photons", "pick"];

/// Answers a request of [`ANSWERED_OF_SCENE`] about the scene `number`.
pub(crate) fn answer_of_scene(loaded: &LoadedScene, number: u64, path: &str, query: &str) -> Answered {
    let found = match path {
        "photons" => paths(loaded, number, numbers(query)?),
        "pick" => pick(loaded, numbers(query)?),
        _ => return Err(Refusal::Absent),
    };
    json(&found.ok_or(Refusal::Wrong)?)
}

/// Parses the query of a request: `name=number` pairs.
fn numbers<T: DeserializeOwned>(query: &str) -> Result<T, Refusal> {
    let pairs = query.split('&').filter(|pair| !pair.is_empty()).map(|pair| {
        let (name, value) = pair.split_once('=')?;
        let value = match value {
            "true" | "false" => serde_json::Value::from(value == "true"),
            _ => serde_json::Value::from(value.parse::<u64>().ok()?),
        };
        Some((name.to_string(), value))
    });
    let pairs: Option<serde_json::Map<String, serde_json::Value>> = pairs.collect();
    let object = serde_json::Value::Object(pairs.ok_or(Refusal::Wrong)?);
    serde_json::from_value(object).map_err(|_| Refusal::Wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_are_pairs_of_names_and_numbers() {
        let area: ProbeArea = numbers("x0=1&y0=2&x1=3&y1=4").unwrap();
        assert_eq!([area.x0, area.y0, area.x1, area.y1], [1, 2, 3, 4]);
        assert!(numbers::<BloomQuery>("denoised=true").unwrap().denoised);
        for wrong in ["", "x0=1", "x0=-1&y0=2&x1=3&y1=4", "x0=1&y0=2&x1=3&y1=4&z=5", "x0&y0=2&x1=3&y1=4"] {
            assert!(numbers::<ProbeArea>(wrong).is_err(), "{wrong}");
        }
    }
}
