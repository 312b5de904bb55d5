//! The server of the page. It runs on its own thread, and serves only what this file lists.

use super::access::Access;
use super::channel::ViewChannel;
use super::listener::LimitedListener;
use super::photons::{self, PhotonQuery};
use super::probe::{self, ProbeArea};
use super::snapshot::{Snapshot, float_bytes};
use abbe_session::output::compare::{compare, delta_e_map};
use abbe_session::output::exr::encode as encode_exr;
use abbe_session::output::png::encode as encode_png;
use abbe_session::output::selection::Selection;
use abbe_transport::sensor::exposure;
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::io;
use std::sync::Arc;
use std::time::Duration;

/// The largest body of a request in bytes.
const MAX_BODY_BYTES: usize = 32 * 1024;

/// The largest number of changes of the scene.
const MAX_CHANGES: usize = 256;

/// A request for the state waits at most this time for a new version.
const LONGEST_WAIT: Duration = Duration::from_secs(20);

/// The body of a request must arrive within this time.
const BODY_TIME: Duration = Duration::from_secs(5);

/// The page may use only what it contains, and may connect only to this server.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data: blob:; \
                      connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const PAGE: [&str; 11] = [
    include_str!("page_head.html"),
    include_str!("page.css"),
    include_str!("page_body.html"),
    include_str!("colour.js"),
    include_str!("plots.js"),
    include_str!("page.js"),
    include_str!("compare.js"),
    include_str!("photons.js"),
    include_str!("plan.js"),
    include_str!("controls.js"),
    "</script></body></html>\n",
];

struct ViewServer {
    access: Access,
    channel: Arc<ViewChannel>,
    /// Held while photon paths are traced, so that one page cannot take all processors.
    tracing: tokio::sync::Mutex<()>,
}

/// Starts the thread of the server, or returns an error if it or its event loop cannot be started.
pub(super) fn start(listener: std::net::TcpListener, access: Access, channel: Arc<ViewChannel>) -> io::Result<()> {
    listener.set_nonblocking(true)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_io().enable_time().build()?;
    let app = Router::new().fallback(answer).with_state(Arc::new(ViewServer {
        access,
        channel,
        tracing: tokio::sync::Mutex::default(),
    }));
    let listener = runtime.block_on(async { tokio::net::TcpListener::from_std(listener) })?;
    let serve = move || {
        // The server ends with the process: `LimitedListener` survives all errors.
        let _ = runtime.block_on(async { axum::serve(LimitedListener::new(listener), app).await });
    };
    std::thread::Builder::new().name("abbe-server".to_string()).spawn(serve).map(drop)
}

async fn answer(State(server): State<Arc<ViewServer>>, request: Request) -> Response {
    let mut response = match checked_answer(&server, request).await {
        Ok(response) => response,
        Err(status) => status.into_response(),
    };
    let headers = response.headers_mut();
    for (name, value) in [
        (header::CONTENT_SECURITY_POLICY, POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
        (header::CACHE_CONTROL, "no-store"),
    ] {
        headers.insert(name, header::HeaderValue::from_static(value));
    }
    response
}

/// The requests that [`pictured`] answers.
const OF_PICTURE: [&str; 10] =
    ["picture", "denoised", "errors", "samples", "classes", "band", "probe", "bloomed", "save.exr", "save.png"];

/// Checks a request, and answers it. Returns the status of a refusal otherwise.
async fn checked_answer(server: &ViewServer, request: Request) -> Result<Response, StatusCode> {
    let (parts, body) = request.into_parts();
    let text = |name: header::HeaderName| value_of(&parts.headers, name);
    if !server.access.allows(text(header::HOST), text(header::ORIGIN)) {
        return Err(StatusCode::FORBIDDEN);
    }
    let path = server.access.after_token(parts.uri.path()).ok_or(StatusCode::NOT_FOUND)?;
    let query = parts.uri.query().unwrap_or_default();
    let channel = &server.channel;
    match (&parts.method, path) {
        (&Method::GET, "") => Ok(typed("text/html; charset=utf-8", PAGE.concat())),
        (&Method::GET, "state") => Ok(state(channel, query).await),
        (&Method::GET, "scene") => json(channel.scene().ok_or(StatusCode::NOT_FOUND)?.text.clone()),
        (&Method::GET, path) if OF_PICTURE.contains(&path) => pictured(channel, path, query).await,
        (&Method::GET, "reference" | "reference_probe" | "delta_e" | "comparison") => {
            compared(channel, path, query).await
        }
        (&Method::GET, "photons") => traced(server, numbers(query)?).await,
        (&Method::POST, "orders") => {
            let body = body_of(&parts.headers, body).await?;
            follow(channel, serde_json::from_slice(&body).map_err(|_| StatusCode::BAD_REQUEST)?)
        }
        (_, "" | "state" | "scene" | "orders" | "photons") => Err(StatusCode::METHOD_NOT_ALLOWED),
        (_, path) if OF_PICTURE.contains(&path) => Err(StatusCode::METHOD_NOT_ALLOWED),
        (_, "reference" | "reference_probe" | "delta_e" | "comparison") => Err(StatusCode::METHOD_NOT_ALLOWED),
        (_, _) => Err(StatusCode::NOT_FOUND),
    }
}

fn value_of(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

fn typed(kind: &'static str, body: impl Into<Body>) -> Response {
    ([(header::CONTENT_TYPE, kind)], body.into()).into_response()
}

fn json(text: String) -> Result<Response, StatusCode> {
    Ok(typed("application/json", text))
}

async fn body_of(headers: &HeaderMap, body: Body) -> Result<axum::body::Bytes, StatusCode> {
    let declared = value_of(headers, header::CONTENT_LENGTH).and_then(|length| length.parse::<usize>().ok());
    if declared.is_some_and(|length| length > MAX_BODY_BYTES) {
        return Err(StatusCode::PAYLOAD_TOO_LARGE);
    }
    let read = tokio::time::timeout(BODY_TIME, to_bytes(body, MAX_BODY_BYTES)).await;
    read.map_err(|_| StatusCode::REQUEST_TIMEOUT)?.map_err(|_| StatusCode::PAYLOAD_TOO_LARGE)
}

/// Parses the query of a request: `name=number` pairs.
fn numbers<T: DeserializeOwned>(query: &str) -> Result<T, StatusCode> {
    let pairs = query.split('&').filter(|pair| !pair.is_empty()).map(|pair| {
        let (name, value) = pair.split_once('=')?;
        Some((name.to_string(), serde_json::Value::from(value.parse::<u64>().ok()?)))
    });
    let pairs: Option<serde_json::Map<String, serde_json::Value>> = pairs.collect();
    let object = serde_json::Value::Object(pairs.ok_or(StatusCode::BAD_REQUEST)?);
    serde_json::from_value(object).map_err(|_| StatusCode::BAD_REQUEST)
}

/// Returns the state when it is newer than the version in the query.
async fn state(channel: &ViewChannel, query: &str) -> Response {
    let after = query.strip_prefix("after=").and_then(|after| after.parse::<u64>().ok()).unwrap_or(0);
    let mut versions = channel.versions();
    // After the time, the page receives the old state and asks again.
    let _ = tokio::time::timeout(LONGEST_WAIT, versions.wait_for(|version| *version > after)).await;
    typed("application/json", channel.to_json().to_string())
}

/// Asks for the bloom of the picture or of the denoised one.
#[derive(Debug, Deserialize)]
struct BloomQuery {
    denoised: bool,
}

#[derive(Debug, Deserialize)]
struct BandQuery {
    band: usize,
}

/// Returns values of all pixels, with the number and the size of the picture in the header.
fn plane(snapshot: &Snapshot, body: impl Into<Body>) -> Response {
    let [number, width, height] =
        [snapshot.number, snapshot.picture.width as u64, snapshot.picture.height as u64].map(|n| n.to_string());
    let names = ["x-abbe-picture", "x-abbe-width", "x-abbe-height"];
    let headers = [(names[0], number), (names[1], width), (names[2], height)];
    (headers, typed("application/octet-stream", body)).into_response()
}

fn probed(snapshot: &Snapshot, query: &str) -> Result<Response, StatusCode> {
    let area: ProbeArea = numbers(query)?;
    let report = probe::report(snapshot, area).ok_or(StatusCode::BAD_REQUEST)?;
    json(serde_json::to_string(&report).map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?)
}

/// Answers a request about the reference, or about its difference from the published picture.
async fn compared(channel: &ViewChannel, path: &str, query: &str) -> Result<Response, StatusCode> {
    let reference = channel.reference().ok_or(StatusCode::NOT_FOUND)?;
    match path {
        "reference" => return Ok(plane(&reference, reference.xyz())),
        "reference_probe" => return probed(&reference, query),
        _ => {}
    }
    let snapshot = channel.snapshot().ok_or(StatusCode::NOT_FOUND)?;
    let (a, b) = (&snapshot.picture, &reference.picture);
    if (a.width, a.height) != (b.width, b.height) {
        return Err(StatusCode::CONFLICT);
    }
    let is_map = path == "delta_e";
    let work = tokio::task::spawn_blocking(move || {
        let (a, b) = (&snapshot.picture, &reference.picture);
        if is_map {
            let values = delta_e_map(a, b, exposure::automatic(b));
            return Ok(plane(&snapshot, float_bytes(values.into_iter().map(|value| value as f32))));
        }
        let comparison = compare(a, b, &Selection::default()).map_err(|_| StatusCode::CONFLICT)?;
        json(serde_json::to_string(&comparison).map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?)
    });
    work.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?
}

async fn traced(server: &ViewServer, query: PhotonQuery) -> Result<Response, StatusCode> {
    let _turn = server.tracing.lock().await;
    let (loaded, scene) = server.channel.loaded().ok_or(StatusCode::NOT_FOUND)?;
    let found = tokio::task::spawn_blocking(move || photons::paths(&loaded, scene, query)).await;
    let found = found.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?.ok_or(StatusCode::BAD_REQUEST)?;
    json(found.to_string())
}

/// Answers a request about the published picture.
async fn pictured(channel: &ViewChannel, path: &str, query: &str) -> Result<Response, StatusCode> {
    let snapshot = channel.snapshot().ok_or(StatusCode::NOT_FOUND)?;
    match path {
        "picture" => Ok(plane(&snapshot, snapshot.xyz())),
        "denoised" => Ok(plane(&snapshot, snapshot.denoised().ok_or(StatusCode::NOT_FOUND)?)),
        "errors" => Ok(plane(&snapshot, snapshot.errors())),
        "samples" => Ok(plane(&snapshot, snapshot.samples().ok_or(StatusCode::NOT_FOUND)?)),
        "classes" => Ok(plane(&snapshot, snapshot.classes().ok_or(StatusCode::NOT_FOUND)?)),
        "band" => {
            let BandQuery { band } = numbers(query)?;
            Ok(plane(&snapshot, snapshot.band(band).ok_or(StatusCode::NOT_FOUND)?))
        }
        "probe" => probed(&snapshot, query),
        "bloomed" => {
            let BloomQuery { denoised } = numbers(query)?;
            let bloomed = move || snapshot.bloomed(denoised).map(|bytes| plane(&snapshot, bytes));
            let work = tokio::task::spawn_blocking(bloomed);
            work.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?.ok_or(StatusCode::NOT_FOUND)
        }
        _ => {
            let is_exr = path == "save.exr";
            let file = tokio::task::spawn_blocking(move || {
                let metadata = snapshot.metadata.as_ref()?;
                if is_exr {
                    encode_exr(&snapshot.picture, metadata).ok()
                } else {
                    let screen = snapshot.scene.display.screen_at(&snapshot.picture, snapshot.exposure);
                    encode_png(&screen).ok()
                }
            });
            let bytes = file.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?.ok_or(StatusCode::NOT_FOUND)?;
            Ok(typed(if is_exr { "image/x-exr" } else { "image/png" }, bytes))
        }
    }
}

/// The changes that the page asks for. Absent fields do not change.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PageOrders {
    paused: Option<bool>,
    /// True to render twice as many passes, after all passes are done.
    #[serde(default)]
    extend: bool,
    /// All changes of the scene, in the form `PATH=JSON`.
    changes: Option<Vec<String>>,
    forbidden: Option<Vec<String>>,
    /// True while the reader moves a slider or the camera.
    #[serde(default)]
    draft: bool,
    /// True to keep the published picture as the reference of comparisons.
    #[serde(default)]
    keep: bool,
}

fn follow(channel: &ViewChannel, wanted: PageOrders) -> Result<Response, StatusCode> {
    let count = |list: &Option<Vec<String>>| list.as_ref().map_or(0, Vec::len);
    if count(&wanted.changes).max(count(&wanted.forbidden)) > MAX_CHANGES {
        return Err(StatusCode::PAYLOAD_TOO_LARGE);
    }
    if wanted.keep {
        channel.keep_as_reference();
    }
    channel.order(|orders| {
        orders.paused = wanted.paused.unwrap_or(orders.paused);
        orders.extensions += u64::from(wanted.extend);
        let before = (orders.changes.clone(), orders.forbidden.clone());
        orders.changes = wanted.changes.unwrap_or_else(|| before.0.clone());
        orders.forbidden = wanted.forbidden.unwrap_or_else(|| before.1.clone());
        if (&orders.changes, &orders.forbidden) != (&before.0, &before.1) {
            orders.revision += 1;
            orders.is_draft = wanted.draft;
        }
    });
    json("{}".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_are_pairs_of_names_and_numbers() {
        let area: ProbeArea = numbers("x0=1&y0=2&x1=3&y1=4").unwrap();
        assert_eq!([area.x0, area.y0, area.x1, area.y1], [1, 2, 3, 4]);
        for wrong in ["", "x0=1", "x0=-1&y0=2&x1=3&y1=4", "x0=1&y0=2&x1=3&y1=4&z=5", "x0&y0=2&x1=3&y1=4"] {
            assert!(numbers::<ProbeArea>(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn the_page_asks_for_nothing_else() {
        let page = PAGE.concat();
        assert!(page.starts_with("<!DOCTYPE html>"));
        assert!(!["src=", "href=", "@import", "url(", "http:", "https:"].iter().any(|word| page.contains(word)));
    }
}
