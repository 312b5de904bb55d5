// The link of the page with workers that render in the browser. One worker shows the pictures and
// answers; the others each render a part of the passes, and their exact sums move to the first.

/// The number of rendering workers.
const RENDERERS = Math.max(1, Math.min(8, navigator.hardwareConcurrency ?? 2));
/// Each renderer sends its sums at most once in this time in milliseconds per renderer, and later
/// less often.
const SUMS_PAUSE = 200;
/// The time from one picture to the next, divided by the time that a picture takes.
const SHOW_PAUSE = 5;
/// The page fetches a coarse picture within this time in milliseconds, unless it has it already.
const FETCH_TIME = 200;
/// A whole render begins when no slider has moved for this time in milliseconds.
const DRAFT_END = 250;

/// Returns the text of an element, and removes it, because the page needs it only once.
function embedded(id) {
  const holder = document.getElementById(id), text = holder.textContent;
  holder.remove();
  return text;
}
const module_ = (async () => {
  const letters = atob(embedded("abbe-module")), packed = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i++) packed[i] = letters.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
})();
const script = URL.createObjectURL(new Blob([embedded("abbe-worker")], { type: "text/javascript" }));

/// Starts a worker. `ask` sends it a task and the buffers that move to it, and `onnews` receives
/// what its render sends: passes, or a coarse picture.
function startWorker(onnews = () => {}) {
  const worker = new Worker(script), waiting = new Map();
  let next = 0;
  worker.onmessage = ({ data: { id, result, error, ...news } }) => {
    if (id === undefined) { onnews(news); return; }
    const { done, failed } = waiting.get(id);
    waiting.delete(id);
    if (error === undefined) done(result); else failed(new Error(error));
  };
  const ask = (task, values = {}, moved = []) => new Promise((done, failed) => {
    waiting.set(++next, { done, failed });
    worker.postMessage({ id: next, task, ...values }, moved);
  });
  // A message on its way from an ended worker is lost, so that a new one can render its passes.
  const end = () => { worker.onmessage = null; worker.terminate(); };
  return { ask, started: module_.then(module => ask("start", { module })), end };
}

/// The scene and what the reader wants of it.
const wish = { text: "", changes: [], forbidden: [], draft: false, paused: false, extensions: 0 };
/// The task of loading the scene that the reader wants.
const wantedScene = () => ({ text: wish.text, changes: wish.changes, forbidden: wish.forbidden });
const leader = startWorker();
/// The number of parts into which the passes of the scene are divided, or 0 before the first render.
let parts = 0;
let renderers = [], revision = 0, stateVersion = 1, listeners = [], spent = 0, begun = null;
let isLoading = false, isShowing = false, hasNews = false, draftEnd = 0;
let pictureFetched = () => {};

function changed() {
  stateVersion++;
  listeners.splice(0).forEach(done => done());
}

function endRenderers() {
  renderers.forEach(renderer => renderer.end());
  renderers = [];
  if (begun !== null) spent += performance.now() - begun;
  begun = null;
}

/// Loads the newest scene, shows its coarse picture, and renders it.
async function restart() {
  revision++;
  endRenderers();
  clearTimeout(draftEnd);
  if (isLoading) return;
  isLoading = true;
  let now;
  do {
    now = revision;
    parts = 0;
    hasNews = false;
    spent = 0;
    try {
      await leader.started;
      await leader.ask("load", wantedScene());
      await leader.ask("sketch");
    } catch (error) {
      // The state of the leader contains the message.
    }
    const fetched = new Promise(done => { pictureFetched = done; setTimeout(done, FETCH_TIME); });
    changed();
    // The page fetches the picture before the leader begins the next one.
    await fetched;
  } while (now !== revision);
  isLoading = false;
  if (wish.draft) draftEnd = setTimeout(endDraft, DRAFT_END); else startRenderers();
}

/// Begins the whole render when the reader rests.
function endDraft() {
  clearTimeout(draftEnd);
  wish.draft = false;
  changed();
  startRenderers();
}

const wantedPasses = async () => await leader.ask("passes") * 2 ** wish.extensions;

async function startRenderers() {
  const now = revision;
  const passes = await wantedPasses().catch(() => 0);
  if (!passes || now !== revision || wish.paused) return;
  const of = parts ||= Math.min(RENDERERS, passes);
  begun = performance.now();
  for (let index = 0; index < of; index++) {
    const renderer = startWorker(({ coarse, pieces }) => {
      if (now !== revision) return;
      if (coarse) { leader.ask("coarse", { bytes: coarse }).then(changed); return; }
      leader.ask("add", { pieces }, pieces).then(() => showSums(passes)).catch(error => console.error(error));
    });
    renderers.push(renderer);
    renderer.started
      .then(() => renderer.ask("load", wantedScene()))
      .then(() => leader.ask("done", { index, of }))
      .then(done => renderer.ask("render", { index, of, passes, done, pause: SUMS_PAUSE * of }))
      .catch(error => console.error(error))
      .finally(() => renderer.end());
  }
}

/// Shows the newest sums, one picture after another.
async function showSums(wanted) {
  hasNews = true;
  if (isShowing) return;
  isShowing = true;
  while (hasNews) {
    hasNews = false;
    const begin = performance.now(), elapsed = (spent + (begun === null ? 0 : performance.now() - begun)) / 1000, now = revision;
    await leader.ask("show", { wanted, elapsed }).catch(() => {});
    if (now !== revision) continue;
    changed();
    // The leader should be free most of the time, for drags and for spectra.
    const cost = performance.now() - begin;
    while (now === revision && performance.now() - begin < SHOW_PAUSE * cost) await new Promise(done => setTimeout(done, 50));
  }
  isShowing = false;
}

/// Asks for an answer: `plane` is the number, width and height of its picture, if it has values of
/// pixels.
async function get(path) {
  const asked = path.match(/^state\?after=(\d+)$/);
  if (!asked) {
    const answer = leader.ask("answer", { path });
    if (path === "picture") answer.finally(() => pictureFetched()).catch(() => {});
    return answer;
  }
  if (stateVersion <= Number(asked[1])) await new Promise(done => listeners.push(done));
  await leader.started;
  const state = JSON.parse(await leader.ask("state", { version: stateVersion }));
  const { paused, draft, changes, forbidden } = wish;
  const bytes = new TextEncoder().encode(JSON.stringify({ ...state, paused, draft, changes, forbidden })).buffer;
  return { kind: "application/json", plane: [], bytes };
}

/// Follows orders: changes of the scene, a pause, more passes.
async function post({ paused, extend, changes, forbidden, draft, keep }) {
  if (keep) await leader.ask("keep");
  if (paused !== undefined && paused !== wish.paused) {
    wish.paused = paused;
    if (paused) { endRenderers(); } else startRenderers();
  }
  if (extend) {
    wish.extensions++;
    endRenderers();
    startRenderers();
  }
  const wanted = JSON.stringify([changes ?? wish.changes, forbidden ?? wish.forbidden]);
  const wasDraft = wish.draft;
  const isNew = wanted !== JSON.stringify([wish.changes, wish.forbidden]);
  wish.draft = Boolean(draft) && (isNew || wasDraft);
  if (isNew) {
    [wish.changes, wish.forbidden] = JSON.parse(wanted);
    restart();
  } else if (wasDraft && !wish.draft && !isLoading) endDraft();
  changed();
}

/// Opens a scene.
function openScene(text) {
  Object.assign(wish, { text, changes: [], forbidden: [], draft: false, extensions: 0 });
  restart();
}
