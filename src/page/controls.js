// The panels of the scene, and the controls.

const changes = new Map();
let forbidden = [], isOrbiting = false, player = null;
const sendChanges = draft => order({ changes: [...changes].map(([path, value]) => path + "=" + JSON.stringify(value)), forbidden, draft });

async function showScene() {
  scene = await json("scene");
  spaces = scene.spaces.map(prepareSpace);
  $("title").textContent = $("title").title = scene.scene?.title ?? scene.file ?? "Abbe live view";
  document.title = "Abbe: " + scene.file;
  if (!$("tone").options.length) {
    const fill = (select, names, chosen) => {
      names.forEach(name => select.add(new Option(name.replace("_", " "), name)));
      select.value = names.includes(chosen) ? chosen : names[0];
    };
    fill($("tone"), scene.tones, scene.tone);
    fill($("space"), spaces.map(space => space.name), scene.space);
    const { from_nm, to_nm, values } = scene.light;
    $("band").max = values.length - 1;
    $("band").value = Math.floor((555 - from_nm) / (to_nm - from_nm) * values.length);
  }
  ["pause", "extend", "orbit", "move", "undo", "ruler", "save-scene", "tab-plan", "tab-scene", "tab-photons"].forEach(id => { $(id).hidden = !scene.live; });
  $("keep").disabled = !scene.live;
  $("band").max = scene.light.values.length - 1;
  showBand();
  if (!scene.live) { showProbes(); return; }
  showCamera();
  // While a slider moves, the panels would change too often.
  hasOldPanels = state.draft;
  if (!hasOldPanels) {
    showPlan();
    showLights();
    if (!document.activeElement?.closest("#tree")) showTree();
    showObjects();
  }
  showProbes();
}

const element = (name, text, properties = {}) => Object.assign(document.createElement(name), { textContent: text }, properties);

// The numbers of the scene.

const step = (path, key) => typeof key === "number" ? `${path}[${key}]` : /^[^\s.[\]"=\\]+$/.test(key) ? (path ? path + "." : "") + key : `${path}[${JSON.stringify(key)}]`;
const LEFT_OUT = ["$schema", "film", "render", "camera"];

function showTree() {
  const branch = (value, path) => Object.entries(value).flatMap(([key, below]) => {
    if (!path && LEFT_OUT.includes(key)) return [];
    const at = step(path, Array.isArray(value) ? Number(key) : key);
    if (typeof below === "number") return [leaf(key, below, at)];
    if (below === null || typeof below !== "object") return [];
    const inner = branch(below, at);
    if (!inner.length) return [];
    const details = element("details", "", { open: !path && key === "objects" });
    details.append(element("summary", below.name ?? (Array.isArray(value) ? `${key}: ${Object.keys(below)[0]}` : key)), ...inner);
    return [details];
  });
  $("tree").replaceChildren(...branch(scene.scene ?? {}, ""));
}

function leaf(name, value, path) {
  const row = element("div", "", { className: "leaf" }), reach = Math.abs(value) || 1;
  const number = element("input", "", { type: "number", step: "any", value });
  const slider = element("input", "", { type: "range", min: -2 * reach, max: 2 * reach, step: reach / 200, value });
  const change = (from, to, draft) => {
    if (from.value === "" || !isFinite(Number(from.value))) return;
    to.value = from.value;
    changeScene(path, Number(from.value), draft);
  };
  slider.oninput = () => change(slider, number, true);
  number.onchange = () => change(number, slider, false);
  [slider, number].forEach(input => input.setAttribute("aria-label", path));
  row.append(element("span", name, { title: path }), slider, number);
  return row;
}

// The camera.

const vector = { sub: (a, b) => a.map((v, i) => v - b[i]), add: (a, b) => a.map((v, i) => v + b[i]), times: (a, s) => a.map(v => v * s),
  cross: (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]], length: a => Math.hypot(...a) };
const isVector = value => Array.isArray(value) && value.length === 3 && value.every(v => typeof v === "number");

function camera() {
  const found = scene?.scene?.camera;
  if (!found || !isVector(found.from) || !isVector(found.at)) return null;
  return { from: changes.get("camera.from") ?? found.from, at: changes.get("camera.at") ?? found.at, up: isVector(found.up) ? found.up : [0, 1, 0] };
}
function showCamera() {
  const found = scene.scene?.camera ?? {}, moved = camera();
  $("camera").value = JSON.stringify(moved ? { ...found, from: moved.from, at: moved.at } : found, null, 1).replace(/\n\s+(?=[-\d\]])/g, " ");
  $("orbit").disabled = !moved;
}
function moveCamera(next, draft = true) {
  const round = a => a.map(value => Number(value.toPrecision(7)));
  changes.set("camera.from", round(next.from)); changes.set("camera.at", round(next.at));
  showCamera();
  sendChanges(draft);
}
function axes({ from, at, up }) {
  const ahead = vector.sub(at, from), right = vector.cross(ahead, up);
  const side = vector.times(right, 1 / vector.length(right)), above = vector.cross(side, ahead);
  return { ahead, side, above: vector.times(above, 1 / vector.length(above)), distance: vector.length(ahead) };
}
/// Turns the camera around the point at which it looks, by angles in radians.
function orbit(across, down) {
  const now = camera();
  if (!now) return;
  const { ahead, side, above, distance } = axes(now), up = vector.times(now.up, 1 / vector.length(now.up));
  const turn = (a, axis, angle) => vector.add(vector.add(vector.times(a, Math.cos(angle)), vector.times(vector.cross(axis, a), Math.sin(angle))),
    vector.times(axis, axis.reduce((sum, v, i) => sum + v * a[i], 0) * (1 - Math.cos(angle))));
  const back = turn(turn(vector.times(ahead, -1), side, -down), up, -across);
  const steep = Math.abs(back.reduce((sum, v, i) => sum + v * up[i], 0)) / distance;
  if (steep < 0.995 && above) moveCamera({ from: vector.add(now.at, back), at: now.at });
}
function panCamera(across, down) {
  const now = camera();
  if (!now) return;
  const { side, above, distance } = axes(now), shift = vector.add(vector.times(side, -across * distance), vector.times(above, down * distance));
  moveCamera({ from: vector.add(now.from, shift), at: vector.add(now.at, shift) });
}
function dolly(factor) {
  const now = camera();
  if (now) moveCamera({ from: vector.add(now.at, vector.times(vector.sub(now.from, now.at), factor)), at: now.at });
}

// Pointers and keys.

const pointers = new Map();
let press = null;
const local = event => { const box = stage.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
const spread = () => { const [a, b] = [...pointers.values()]; return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0; };
stage.addEventListener("pointerdown", event => {
  if (!picture) return;
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, local(event));
  if (isMoving && pointers.size === 1) pressObject(local(event), pixelAt(...local(event)), event.shiftKey);
  press = { at: local(event), pixel: pixelAt(...local(event)), last: local(event), spread: spread(), zoom: placement().scale, moved: false, wipe: pointers.size === 1 && isNearWipe(local(event)[0]) };
});
stage.addEventListener("pointermove", event => {
  if (!picture) return;
  const at = local(event);
  if (!pointers.has(event.pointerId)) { if (!isOrbiting) select(areaOf(pixelAt(...at))); return; }
  pointers.set(event.pointerId, at);
  const [dx, dy] = [at[0] - press.last[0], at[1] - press.last[1]], size = stage.clientHeight;
  press.moved ||= Math.hypot(at[0] - press.at[0], at[1] - press.at[1]) > 4;
  if (!press.moved) return;
  press.last = at;
  if (dragging && pointers.size === 1) { dragObject(dx, dy); return; }
  if (press.wipe) { setWipe(100 * at[0] / stage.clientWidth); return; }
  if (pointers.size > 1) {
    const ratio = spread() / press.spread;
    if (isOrbiting) { if (Math.abs(ratio - 1) > 0.05) { dolly(1 / ratio); press.spread = spread(); } else panCamera(dx / size, dy / size); }
    else setZoom(press.zoom * ratio, at);
  } else if (isOrbiting) {
    if (event.shiftKey) panCamera(dx / size, dy / size); else orbit(3 * dx / size, 3 * dy / size);
  } else if (event.shiftKey) select(areaOf(press.pixel, pixelAt(...at)));
  else {
    if (!zoom) setZoom(placement().scale);
    offset = [offset[0] + dx, offset[1] + dy];
    paint();
  }
});
stage.addEventListener("pointerup", async event => {
  pointers.delete(event.pointerId);
  if (dragging) { releaseObject(); return; }
  if (press && !press.moved && isMeasuring) markAt(press.pixel);
  else if (press && !press.moved && !isOrbiting) {
    area = areaOf(press.pixel);
    while (isProbing) await new Promise(done => setTimeout(done, 5));
    await probeCursor();
    pinArea();
  }
});
stage.addEventListener("pointercancel", event => { pointers.delete(event.pointerId); releaseObject(); });
stage.addEventListener("wheel", event => {
  event.preventDefault();
  const factor = Math.exp(-event.deltaY * 0.0015);
  if (isOrbiting) dolly(1 / factor); else if (picture) setZoom(placement().scale * factor, local(event));
}, { passive: false });

function moveProbe(dx, dy) {
  if (!picture) return;
  const { x0, y0 } = area ?? { x0: picture.width >> 1, y0: picture.height >> 1 };
  select(areaOf([Math.min(picture.width - 1, Math.max(0, x0 + dx)), Math.min(picture.height - 1, Math.max(0, y0 + dy))]));
}
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
stage.addEventListener("keydown", event => {
  const arrow = ARROWS[event.key];
  const keys = { Enter: pinArea, Delete: () => { pins.pop(); paint(); showProbes(); }, "0": fit, "1": () => setZoom(1), b: flip, c: toggleOrbit, o: toggleMoving, r: toggleRuler, f: toggleFull, p: togglePhotons, " ": togglePause,
    "+": () => isOrbiting ? dolly(0.9) : setZoom(placement().scale * 1.25), "-": () => isOrbiting ? dolly(1 / 0.9) : setZoom(placement().scale / 1.25),
    "[": () => nudge("ev", -1), "]": () => nudge("ev", 1), ",": () => nudge("band", -1), ".": () => nudge("band", 1) };
  if (isMoving && moveKey(event)) { event.preventDefault(); return; }
  if (arrow) {
    if (!isOrbiting) moveProbe(...arrow.map(step => step * (event.shiftKey ? 10 : 1)));
    else if (event.shiftKey) panCamera(-0.05 * arrow[0], -0.05 * arrow[1]); else orbit(0.1 * arrow[0], 0.1 * arrow[1]);
  } else if (keys[event.key]) keys[event.key]();
  else return;
  event.preventDefault();
});
function nudge(id, by) {
  $(id).value = Number($(id).value) + by * Number($(id).step);
  $(id).dispatchEvent(new Event("input"));
}

// Controls.

const fit = () => { zoom = 0; offset = [0, 0]; paint(); };
const press_ = (id, on) => $(id).setAttribute("aria-pressed", String(on));
function toggleOrbit() {
  isOrbiting = !isOrbiting && Boolean(camera());
  if (isOrbiting && isMoving) toggleMoving();
  if (isOrbiting && isMeasuring) toggleRuler();
  press_("orbit", isOrbiting);
  stage.style.cursor = isOrbiting ? "grab" : "crosshair";
}
const togglePause = () => order({ paused: !state.paused });
function showBand() {
  const { from_nm, to_nm, values } = scene.light;
  $("band-value").textContent = Math.round(from_nm + (Number($("band").value) + 0.5) * (to_nm - from_nm) / values.length) + " nm";
}
function play() {
  const isPlaying = player !== null;
  if (isPlaying) { clearInterval(player); player = null; }
  else {
    $("mode").value = "band";
    player = setInterval(() => {
      const band = $("band");
      band.value = Number(band.value) >= Number(band.max) ? 2 : Number(band.value) + 1;
      showBand();
      draw();
    }, 200);
  }
  press_("play", !isPlaying);
}
function download(name, kind, content) {
  const link = element("a", "", { href: URL.createObjectURL(new Blob([content], { type: kind })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
const toggleFull = () => document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen();
async function save(name) {
  const answer = await get(name).catch(() => null);
  if (!answer) { $("legend").textContent = "The first pass is not done yet"; $("legend").hidden = false; return; }
  download((scene.file ?? "picture").replace(/\.[^.]*$/, "") + name.slice(4), answer.kind, answer.bytes);
}
const PANELS = ["spectrum", "photons", "plan", "scene", "compare"];
function showTab(name) {
  for (const panel of PANELS) {
    $("panel-" + panel).hidden = panel !== name;
    $("tab-" + panel).setAttribute("aria-selected", String(panel === name));
  }
  if (name === "compare") showFigures();
}
$("examples").onclick = () => location.assign("./");
$("pause").onclick = togglePause;
$("extend").onclick = () => order({ extend: true });
$("save-exr").onclick = () => save("save.exr");
$("save-png").onclick = () => save("save.png");
$("fit").onclick = fit;
$("pixels").onclick = () => setZoom(1);
$("orbit").onclick = toggleOrbit;
$("move").onclick = toggleMoving;
$("undo").onclick = undo;
$("ruler").onclick = toggleRuler;
$("full").onclick = toggleFull;
$("large").onclick = () => press_("large", document.documentElement.classList.toggle("large"));
$("save-scene").onclick = () => download("scene.json", "application/json", JSON.stringify(scene.scene, null, 2));
$("object").onchange = () => choose($("object").value === "" ? null : { index: Number($("object").value), name: $("object").selectedOptions[0].text });
addEventListener("keydown", event => { if (event.key === "z" && (event.ctrlKey || event.metaKey) && !/INPUT|TEXTAREA/.test(event.target.tagName)) { undo(); event.preventDefault(); } });
$("play").onclick = play;
$("pin").onclick = pinArea;
$("unpin").onclick = () => { pins = []; paint(); showProbes(); };
$("denoise").onchange = () => draw();
["tone", "space"].forEach(id => { $(id).onchange = () => { if (photons) colourPhotons(); draw(); showProbes(); }; });
$("mode").onchange = () => { if (comparison() === "off") draw(); else setComparison("off"); };
$("ev").oninput = () => { $("ev-value").textContent = (ev() < 0 ? "−" : "+") + Math.abs(ev()).toFixed(1) + " EV"; draw(); };
$("band").oninput = () => { showBand(); $("mode").value = "band"; draw(); };
$("analyser").oninput = () => { $("analyser-value").textContent = $("analyser").value + "°"; $("mode").value = "analyser"; draw(); };
$("copy").onclick = async () => {
  $("camera").select();
  await navigator.clipboard?.writeText($("camera").value).catch(() => {});
};
$("reset").onclick = () => { changes.clear(); moves.clear(); history_.length = 0; $("undo").disabled = true; forbidden = []; withoutEffect = null; sendChanges(false); };
PANELS.forEach(name => { $("tab-" + name).onclick = () => showTab(name); });
new ResizeObserver(resize).observe(stage);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", showProbes);
resize();
follow();
