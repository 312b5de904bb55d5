// A worker of the page: one engine, which follows one message after another. This script follows
// the bindings of the module, which define `wasm_bindgen`.

let engine = null;

/// What the page can ask for. Each function returns the result, and the buffers that move with it.
const TASKS = {
  start({ module }) {
    wasm_bindgen.initSync({ module });
    engine = new wasm_bindgen.Engine();
  },
  load({ text, changes, forbidden }) {
    engine.load(text, changes, forbidden);
  },
  sketch: () => engine.showSketch(),
  coarse: ({ bytes }) => engine.showCoarse(new Uint8Array(bytes)),
  passes: () => engine.passes(),
  /// Adds passes of a renderer, and frees their memory, which a browser would collect late.
  add({ pieces }) {
    engine.add(pieces.map(piece => new Uint8Array(piece)));
    pieces.forEach(piece => piece.transfer?.(0));
  },
  /// Shows the passes so far.
  show: ({ wanted, elapsed }) => engine.show(wanted, elapsed),
  done: ({ index, of }) => engine.done(index, of),
  keep: () => engine.keepAsReference(),
  state: ({ version }) => engine.state(version),
  text: () => engine.sceneText(),
  answer({ path }) {
    const [name, query] = path.split("?"), answer = engine.answer(name, query ?? "");
    return { kind: answer.kind, plane: [...answer.plane], bytes: answer.bytes.buffer };
  },
  /// Renders a part of the passes after its first `done` ones. The first part also sends coarse
  /// pictures before its first pass. Sends the passes after the first one, then at most once in
  /// `pause` milliseconds, less and less often, and at the end. They move, so the next message has
  /// only later ones. A browser frees the memory of messages late, so there should be few of them.
  render({ index, of, passes, done, pause }) {
    const GROWTH = 1.5, begun = performance.now();
    let sent = -Infinity;
    const isEarly = () => performance.now() - sent < Math.max(pause, GROWTH * (sent - begun));
    const show = bytes => postMessage({ coarse: bytes.buffer }, [bytes.buffer]);
    const send = arrays => {
      const pieces = arrays.map(bytes => bytes.buffer);
      postMessage({ pieces }, pieces);
      sent = performance.now();
      return true;
    };
    send(engine.render(index, of, passes, done, () => isEarly() || send, index ? undefined : show));
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
