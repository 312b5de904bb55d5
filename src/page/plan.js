// The plan: its effects, what each of them contributes, and where time and light go.

/// The effect whose difference is shown, and the scene for which effects were measured.
let withoutEffect = null, measuredScene = "", planBefore = null;
/// The shares of the time and of the light that an effect contributes, by its name.
const measured = new Map();
const CLASSES = ["emission", "direct", "caustic", "indirect", "volume"];
const CLASS_RGB = [[255, 212, 59], [77, 148, 255], [240, 62, 140], [64, 192, 87], [255, 146, 43]];
const share = (part, whole) => whole > 0 && isFinite(part) ? short(100 * part / whole, 2) + " %" : "–";
/// The scene without the forbidden effects, as a text.
const sceneText = () => JSON.stringify({ ...scene.scene, render: { ...scene.scene?.render, forbid: 0 } });

function showPlan() {
  if (measuredScene !== sceneText()) { measured.clear(); measuredScene = sceneText(); }
  const head = element("tr", "");
  ["", "effect", "events", "time", "light", ""].forEach(name => head.append(element("th", name)));
  const rows = scene.plan.effects.flatMap(effect => {
    const row = element("tr", ""), below = element("tr", "", { className: "reason" });
    const box = element("input", "", { type: "checkbox", checked: !forbidden.includes(effect.name), disabled: effect.state === "off",
      onchange() { forbid(effect.name, !this.checked); } });
    box.setAttribute("aria-label", "allow " + effect.name);
    const button = element("button", "Difference", { disabled: effect.state === "off", onclick() { showDifference(effect.name); } });
    button.dataset.state = effect.state;
    button.setAttribute("aria-label", "show the difference that " + effect.name + " makes");
    button.setAttribute("aria-pressed", String(withoutEffect === effect.name));
    const cells = ["", `${effect.name} (${effect.state})`, "", "", "", ""].map(text => element("td", text));
    cells[0].append(box); cells[5].append(button);
    cells.slice(2, 5).forEach((cell, i) => { cell.className = "number"; cell.dataset.effect = effect.name; cell.dataset.column = ["events", "time", "light"][i]; });
    row.append(...cells);
    below.append(element("td", ""), element("td", effect.because, { colSpan: 5 }));
    return [row, below];
  });
  // The keyboard stays where it is.
  const focused = document.activeElement?.closest("#plan") ? document.activeElement.getAttribute("aria-label") : null;
  $("plan").replaceChildren(head, ...rows);
  if (focused) document.querySelector(`#plan [aria-label="${focused}"]`)?.focus({ preventScroll: true });
  const now = new Map(scene.plan.effects.map(effect => [effect.name, effect.state]));
  if (planBefore) {
    const changed = [...now].filter(([name, word]) => planBefore.get(name) !== word).map(([name, word]) => `${name}: ${planBefore.get(name)} → ${word}`);
    if (changed.length) $("plan-change").textContent = "Last change of the plan: " + changed.join("; ");
  }
  planBefore = now;
  const layers = sceneLayers();
  for (const [id, [name]] of Object.entries(BUTTON_LAYERS)) {
    press_(id, layers.includes(name));
    $(id).disabled = (changes.has("film.layers") ? ownLayers : layers).includes(name);
  }
  showEvents();
}

function forbid(name, isForbidden) {
  forbidden = forbidden.filter(other => other !== name).concat(isForbidden ? [name] : []);
  withoutEffect = null;
  sendChanges(false);
}

/// Renders without an effect, and shows the difference from the picture with all effects. A second call ends this.
function showDifference(name) {
  const ends = withoutEffect === name, keep = !ends && !forbidden.length;
  withoutEffect = ends ? null : name;
  forbidden = ends ? [] : [name];
  if (keep) order({ keep });
  setComparison(ends ? "off" : "difference");
  sendChanges(false);
  showPlan();
}

/// Notes what the shown picture lacks in comparison with the reference.
function measureEffect() {
  const a = state.picture, b = state.reference;
  if (!a?.passes || !b || a.without.length !== b.without.length + 1 || measuredScene !== sceneText() || a.scene !== scene.number) return;
  const name = a.without.find(effect => !b.without.includes(effect));
  if (withoutEffect === name) measured.set(name, { time: b.pass_seconds - a.pass_seconds, seconds: b.pass_seconds, light: b.mean_y - a.mean_y, y: b.mean_y });
}

function showEvents() {
  const { events = {}, passes = 0, seconds, ledger_w: ledger, classes = [], samples, stokes } = state.picture ?? {};
  for (const option of $("mode").options) {
    if (option.value === "classes") option.disabled = !classes.length;
    if (option.value === "samples") option.disabled = !samples;
    if (option.value === "degree" || option.value === "analyser") option.disabled = !stokes;
  }
  $("analyser").disabled = !stokes;
  if (!scene?.live) return;
  measureEffect();
  document.querySelectorAll("#plan [data-effect]").forEach(cell => {
    const { effect, column } = cell.dataset, known = measured.get(effect);
    cell.textContent = column === "events" ? events[effect]?.toLocaleString("en") ?? ""
      : !known ? "–" : column === "time" ? share(known.time, known.seconds) : share(known.light, known.y);
  });
  // The first difference needs a picture with all effects.
  document.querySelectorAll("#plan button").forEach(button => { button.disabled = button.dataset.state === "off" || !(passes || withoutEffect); });
  const table = (id, rows) => $(id).replaceChildren(...rows.map(([name, value, colour]) => {
    const row = element("tr", ""), title = element("th", name, { scope: "row" });
    if (colour) title.prepend(element("span", "", { className: "key", style: `background: rgb(${colour})` }));
    row.append(title, element("td", value, { className: "number" }));
    return row;
  }));
  const stages = [["pilot", "pilot"], ["moving objects", "pose"], ["photons", "emit"], ["maps", "map"], ["camera paths", "gather"]];
  const spent = stages.reduce((sum, [, key]) => sum + (seconds?.[key] ?? 0), 0);
  table("stages", stages.map(([name, key]) => [name, share(seconds?.[key], spent)]));
  const y = classes.reduce((sum, value) => sum + value, 0);
  table("class-shares", CLASSES.map((name, i) => [name, share(classes[i], y), CLASS_RGB[i]]));
  const gone = ledger ? [["absorbed inside bodies", ledger.absorbed - Object.values(ledger.by_material).reduce((sum, w) => sum + w, 0)],
    ...Object.entries(ledger.by_material).map(([name, w]) => ["absorbed by " + name, w]), ["leaves the scene", ledger.escaped]] : [];
  table("ledger", [["emitted by the lights", ledger ? short(ledger.emitted) + " W" : "–"],
    ...gone.filter(([, w]) => w > 1e-9 * ledger.emitted).map(([name, w]) => [name, share(w, ledger.emitted)])]);
}

/// Writes the colours of the path classes, mixed in proportion to their light. Returns the legend.
async function drawClasses(current, codes) {
  const values = await plane("classes"), count = current.width * current.height;
  if (!values) return "The picture does not separate path classes";
  for (let i = 0, j = 0; i < count; i++, j += 4) {
    let sum = 0;
    const mix = [0, 0, 0];
    for (let k = 0; k < CLASSES.length; k++) {
      const y = Math.max(0, values[k * count + i]);
      sum += y;
      for (let c = 0; c < 3; c++) mix[c] += y * CLASS_RGB[k][c];
    }
    for (let c = 0; c < 3; c++) codes[j + c] = sum > 0 ? mix[c] / sum : 0;
    codes[j + 3] = 255;
  }
  return "path classes: yellow emission, blue direct, pink caustic, green indirect, orange volume";
}

/// The layers that a button adds to those of the scene, by its id. The first one is the button's
/// own.
const BUTTON_LAYERS = { separate: ["paths", "samples"], record: ["stokes"] };
/// The layers of the scene without those of the buttons, while `changes` holds layers.
let ownLayers = [];
const sceneLayers = () => {
  const { layers = [], stokes } = scene.scene?.film ?? {};
  return stokes && !layers.includes("stokes") ? [...layers, "stokes"] : layers;
};

for (const [id, names] of Object.entries(BUTTON_LAYERS)) $(id).onclick = () => {
  const layers = sceneLayers();
  if (!changes.has("film.layers")) ownLayers = layers;
  const others = layers.filter(layer => !names.includes(layer) || ownLayers.includes(layer));
  const wanted = layers.includes(names[0]) ? others : [...new Set([...layers, ...names])];
  if (wanted.length === ownLayers.length) changes.delete("film.layers");
  else changes.set("film.layers", wanted);
  sendChanges(false);
};
