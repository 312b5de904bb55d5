// A worker of the page: one engine, which follows one message after another. This script follows
// the bindings of the module, which define `wasm_bindgen`.

let engine = null;
/// The newest sums of each part of the passes, for the worker that shows pictures.
let sums = [];

/// What the page can ask for. Each function returns the result, and the buffers that move with it.
const TASKS = {
  start({ module }) {
    wasm_bindgen.initSync({ module });
    engine = new wasm_bindgen.Engine();
  },
  load({ text, changes, forbidden }) {
    sums = [];
    engine.load(text, changes, forbidden);
  },
  sketch: () => engine.showSketch(),
  coarse: ({ bytes }) => engine.showCoarse(new Uint8Array(bytes)),
  passes: () => engine.passes(),
  /// Shows the passes so far. `news` contains the parts that have changed.
  show({ news, wanted, elapsed }) {
    news.forEach((bytes, index) => { sums[index] = bytes; });
    engine.show(sums.filter(Boolean).map(bytes => new Uint8Array(bytes)), wanted, elapsed);
  },
  part: ({ index }) => ({ bytes: sums[index]?.slice(0) }),
  keep: () => engine.keepAsReference(),
  state: ({ version }) => engine.state(version),
  text: () => engine.sceneText(),
  answer({ path }) {
    const [name, query] = path.split("?"), answer = engine.answer(name, query ?? "");
    return { kind: answer.kind, plane: [...answer.plane], bytes: answer.bytes.buffer };
  },
  /// Renders a part of the passes. The first part also sends coarse pictures before its first pass.
  /// Sends the sums after the first pass, then at most once in
  /// `pause` milliseconds, and at the end.
  render({ index, of, passes, earlier, pause }) {
    let sent = -Infinity;
    const show = bytes => postMessage({ coarse: bytes.buffer }, [bytes.buffer]);
    const send = bytes => { postMessage({ index, bytes: bytes.buffer }, [bytes.buffer]); sent = performance.now(); return true; };
    const last = engine.render(index, of, passes, earlier && new Uint8Array(earlier), () => performance.now() - sent < pause || send,
      index ? undefined : show);
    send(last);
  },
};

onmessage = ({ data: { id, task, ...values } }) => {
  try {
    const result = TASKS[task](values);
    postMessage({ id, result }, result?.bytes ? [result.bytes] : []);
  } catch (error) {
    postMessage({ id, error: String(error?.message ?? error) });
  }
};
