//! The server of the page. It runs on its own thread, and serves only what this file lists.

use super::access::Access;
use super::channel::ViewChannel;
use super::examples::Example;
use super::listener::LimitedListener;
use super::start_page;
use crate::page::{self, Answer, Refusal};
use axum::Router;
use axum::body::{Body, to_bytes};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
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

/// The script by which the page asks this server.
const LINK: &str = include_str!("link.js");

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
        (&Method::GET, "") if channel.has_examples() => Ok(html(start_page::text(channel.orders().example))),
        (&Method::GET, "") => Ok(html(page::text(LINK))),
        (&Method::GET, "view") if channel.has_examples() => Ok(html(page::text(LINK))),
        (&Method::GET, "state") => Ok(state(channel, query).await),
        (&Method::GET, "scene") => json(channel.scene().ok_or(StatusCode::NOT_FOUND)?.text.clone()),
        (&Method::GET, path) if page::ANSWERED.contains(&path) => pictured(channel, path, query).await,
        (&Method::GET, path) if page::ANSWERED_OF_SCENE.contains(&path) => of_scene(server, path, query).await,
        (&Method::POST, "orders") => {
            let body = body_of(&parts.headers, body).await?;
            follow(channel, serde_json::from_slice(&body).map_err(|_| StatusCode::BAD_REQUEST)?)
        }
        (_, "" | "state" | "scene" | "orders") => Err(StatusCode::METHOD_NOT_ALLOWED),
        (_, path) if page::ANSWERED.contains(&path) || page::ANSWERED_OF_SCENE.contains(&path) => {
            Err(StatusCode::METHOD_NOT_ALLOWED)
        }
        (_, _) => Err(StatusCode::NOT_FOUND),
    }
}

fn value_of(headers: &HeaderMap, name: header::HeaderName) -> Option<&str> {
    headers.get(name)?.to_str().ok()
}

fn typed(kind: &'static str, body: impl Into<Body>) -> Response {
    ([(header::CONTENT_TYPE, kind)], body.into()).into_response()
}

fn html(text: String) -> Response {
    typed("text/html; charset=utf-8", text)
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

/// Returns the state when it is newer than the version in the query.
async fn state(channel: &ViewChannel, query: &str) -> Response {
    let after = query.strip_prefix("after=").and_then(|after| after.parse::<u64>().ok()).unwrap_or(0);
    let mut versions = channel.versions();
    // After the time, the page receives the old state and asks again.
    let _ = tokio::time::timeout(LONGEST_WAIT, versions.wait_for(|version| *version > after)).await;
    typed("application/json", channel.to_json().to_string())
}

/// Answers a request about the scene, such as for photon paths.
async fn of_scene(server: &ViewServer, path: &str, query: &str) -> Result<Response, StatusCode> {
    let _turn = server.tracing.lock().await;
    let (loaded, scene) = server.channel.loaded().ok_or(StatusCode::NOT_FOUND)?;
    let (path, query) = (path.to_string(), query.to_string());
    let work = tokio::task::spawn_blocking(move || page::answer_of_scene(&loaded, scene, &path, &query));
    respond(work.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?)
}

/// Answers a request about the pictures on a thread of its own, because some answers take long.
async fn pictured(channel: &ViewChannel, path: &str, query: &str) -> Result<Response, StatusCode> {
    let (page, path, query) = (channel.page(), path.to_string(), query.to_string());
    let work = tokio::task::spawn_blocking(move || page::answer(&page, &path, &query));
    respond(work.await.map_err(|_| StatusCode::INTERNAL_SERVER_ERROR)?)
}

fn respond(answer: Result<Answer, Refusal>) -> Result<Response, StatusCode> {
    let Answer { kind, plane, body } = answer.map_err(status)?;
    let mut response = typed(kind, body);
    for (name, number) in
        ["x-abbe-picture", "x-abbe-width", "x-abbe-height"].into_iter().zip(plane.into_iter().flatten())
    {
        response.headers_mut().insert(name, number.into());
    }
    Ok(response)
}

fn status(refusal: Refusal) -> StatusCode {
    match refusal {
        Refusal::Absent => StatusCode::NOT_FOUND,
        Refusal::Wrong => StatusCode::BAD_REQUEST,
        Refusal::Unlike => StatusCode::CONFLICT,
        Refusal::Failed => StatusCode::INTERNAL_SERVER_ERROR,
    }
}

/// The changes that the page asks for. Absent fields do not change.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PageOrders {
    /// The name of an example to open.
    open: Option<String>,
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
    if let Some(name) = &wanted.open {
        let example = Example::named(name).filter(|_| channel.has_examples());
        channel.open(example.ok_or(StatusCode::NOT_FOUND)?);
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
        let is_new = (&orders.changes, &orders.forbidden) != (&before.0, &before.1);
        orders.revision += u64::from(is_new);
        orders.is_draft = wanted.draft && (is_new || orders.is_draft);
    });
    json("{}".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_asks_for_nothing_else() {
        let page = page::text(LINK);
        assert!(page.starts_with("<!DOCTYPE html>"));
        assert!(!["src=", "href=", "@import", "url(", "http:", "https:"].iter().any(|word| page.contains(word)));
    }
}
