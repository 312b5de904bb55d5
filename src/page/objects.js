// Objects: choose one in the picture or in the list, and move, turn and scale it, or change its
// glass, its lamp and its sizes.

/// The chosen object: its index, its name, the pixel of its handles, and the width of a pixel there
/// in the unit of the scene.
let chosen = null, isMoving = false, dragging = null;
/// For each moved object: its transform before, its origin, and how it was moved since.
const moves = new Map();
const UNITS = { m: 1, cm: 0.01, mm: 0.001, um: 1e-6 };
/// The radius of the ring of the handles in CSS pixels, and half the width of what a pointer hits.
const RING = 52, REACH = 14;

const dot = (a, b) => a.reduce((sum, v, i) => sum + v * b[i], 0);
const unitVector = a => vector.times(a, 1 / (vector.length(a) || 1));
/// Returns the objects in the order of the renderer, each with its path in the scene. Groups
/// contain objects.
function objectsIn(list, path) {
  return list.flatMap((object, i) => object.group ? objectsIn(object.group, `${path}[${i}].group`) : [{ object, path: `${path}[${i}]` }]);
}
const placed = () => objectsIn(scene?.scene?.objects ?? [], "objects");
const objects = () => placed().map(({ object }) => object);
const pathOf = index => placed()[index].path;
const rounded = value => Array.isArray(value) ? value.map(rounded) : Number(value.toPrecision(7));

/// Returns a point after the steps of a transform.
function transformed(steps, point) {
  return steps.reduce((p, step) => {
    if (step.translate) return vector.add(p, step.translate);
    if (step.scale) return p.map((v, i) => v * (step.scale[i] ?? step.scale));
    if (step.matrix) return step.matrix.slice(0, 3).map(row => row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
    const axis = unitVector(step.rotate.axis), angle = step.rotate.degrees * Math.PI / 180;
    return vector.add(vector.add(vector.times(p, Math.cos(angle)), vector.times(vector.cross(axis, p), Math.sin(angle))),
      vector.times(axis, dot(axis, p) * (1 - Math.cos(angle))));
  }, point);
}

function moveOf(index) {
  if (!moves.has(index)) {
    const { transform: base = [], shape } = objects()[index], centre = Object.values(shape ?? {})[0]?.center;
    moves.set(index, { base, origin: transformed(base, centre ?? [0, 0, 0]), shift: [0, 0, 0], turn: 0, size: 1 });
  }
  return moves.get(index);
}

/// Sends the transform of a moved object.
function sendMove(index, draft) {
  const { base, origin, shift, turn, size } = moves.get(index), steps = [...base];
  if (turn || size !== 1) {
    steps.push({ translate: vector.times(origin, -1) });
    if (size !== 1) steps.push({ scale: size });
    if (turn) steps.push({ rotate: { axis: camera()?.up ?? [0, 1, 0], degrees: turn } });
    steps.push({ translate: vector.add(origin, shift) });
  } else if (shift.some(Boolean)) steps.push({ translate: shift });
  changeScene(`${pathOf(index)}.transform`, steps.map(step => step.rotate
    ? { rotate: { axis: step.rotate.axis, degrees: rounded(step.rotate.degrees) } }
    : Object.fromEntries(Object.entries(step).map(([key, value]) => [key, rounded(value)]))), draft);
  showChosenValues();
}

/// Chooses the object under a pixel, or none.
async function chooseAt(pixel) {
  const found = await json(`pick?x=${pixel[0]}&y=${pixel[1]}`).catch(() => null);
  const known = found && objects()[found.object];
  const isOwn = known && (known.name === undefined || known.name === found.name);
  choose(isOwn ? { index: found.object, name: found.name, pixel, width: found.pixel_width_m / (UNITS[scene.scene.unit ?? "m"] ?? 1) } : null);
  return chosen;
}
function choose(next) {
  chosen = next;
  showChosen();
  paint();
}

/// Moves the chosen object by picture pixels: parallel to the ground, or up and down.
function dragBy(dx, dy, how) {
  const eye = camera();
  if (!chosen || !eye) return;
  const move = moveOf(chosen.index), { ahead, side } = axes(eye), up = unitVector(eye.up);
  if (how === "turn") move.turn = ((move.turn + 0.6 * dx + 540) % 360) - 180;
  else {
    const rise = dot(unitVector(ahead), up), level = unitVector(vector.sub(ahead, vector.times(up, dot(ahead, up))));
    const along = how === "lift" ? vector.times(up, -dy * chosen.width / Math.max(0.3, Math.sqrt(1 - rise * rise)))
      : vector.add(vector.times(side, dx * chosen.width), vector.times(level, -dy * chosen.width / Math.max(0.25, Math.abs(rise))));
    move.shift = vector.add(move.shift, along);
    chosen.pixel = [chosen.pixel[0] + (how === "lift" ? 0 : dx), chosen.pixel[1] + dy];
  }
  sendMove(chosen.index, true);
}

/// Paints the handles over the picture: a dot to move, a ring to turn, an arrow to lift.
function paintHandles(scale) {
  if (!chosen?.pixel || !isMoving) return;
  const [x, y] = chosen.pixel.map(v => (v + 0.5) * scale);
  for (const [width, style] of [[5, "#000a"], [2.5, "#fff"]]) {
    context.lineWidth = width; context.strokeStyle = style;
    context.beginPath();
    context.arc(x, y, RING, 0, 2 * Math.PI);
    context.moveTo(x, y - RING - 6); context.lineTo(x, y - RING - 34);
    context.moveTo(x - 7, y - RING - 26); context.lineTo(x, y - RING - 34); context.lineTo(x + 7, y - RING - 26);
    context.moveTo(x + 5, y); context.arc(x, y, 5, 0, 2 * Math.PI);
    context.stroke();
  }
}
/// Returns what a press on the stage would drag: `turn`, `lift`, or `null` for another object.
function handleAt([x, y]) {
  if (!chosen?.pixel) return null;
  const { scale, left, top } = placement(), dx = x - left - (chosen.pixel[0] + 0.5) * scale, dy = y - top - (chosen.pixel[1] + 0.5) * scale;
  const far = Math.hypot(dx, dy);
  if (Math.abs(dx) < REACH && dy < -RING - 4 && dy > -RING - 42) return "lift";
  if (Math.abs(far - RING) < REACH) return "turn";
  return far < RING - REACH ? "move" : null;
}

function pressObject(at, pixel, isShift) {
  const handle = handleAt(at);
  dragging = { how: handle ?? (isShift ? "lift" : "move"), owed: [0, 0], ready: handle !== null };
  if (handle === null) {
    const now = dragging;
    chooseAt(pixel).then(found => { if (found) { now.ready = true; dragObject(0, 0); } });
  }
}
function dragObject(dx, dy) {
  if (!dragging) return;
  const { scale } = placement();
  dragging.owed = [dragging.owed[0] + dx / scale, dragging.owed[1] + dy / scale];
  if (!dragging.ready || !dragging.owed.some(Boolean)) return;
  dragBy(...dragging.owed, dragging.how);
  dragging.owed = [0, 0];
  dragging.moved = true;
  paint();
}
function releaseObject() {
  if (dragging?.moved && chosen) sendMove(chosen.index, false);
  dragging = null;
}

/// Follows a key while objects move. Returns false for a key without a meaning.
function moveKey(event) {
  if (!chosen) return false;
  const step = event.shiftKey ? 10 : 1, arrow = ARROWS[event.key], move = moveOf(chosen.index);
  if (arrow) dragBy(step * arrow[0], step * arrow[1], "move");
  else if (event.key === "PageUp" || event.key === "PageDown") dragBy(0, event.key === "PageUp" ? -step : step, "lift");
  else if ("qeQE".includes(event.key)) { move.turn += event.key.toLowerCase() === "q" ? step : -step; sendMove(chosen.index, true); }
  else if (event.key === "+" || event.key === "-") { move.size *= event.key === "+" ? 1.05 : 1 / 1.05; sendMove(chosen.index, true); }
  else if (event.key === "Escape") choose(null);
  else return false;
  return true;
}

// Changes, which can be undone.

const history_ = [];
let lastChange = { path: null, at: -Infinity };
/// Changes a value of the scene. Changes of the same value in quick succession are undone together.
function changeScene(path, value, draft) {
  const now = performance.now();
  if (path !== lastChange.path || now - lastChange.at > 1000) history_.push([[...changes], [...moves].map(([index, move]) => [index, { ...move }])]);
  lastChange = { path, at: now };
  changes.set(path, value);
  $("undo").disabled = false;
  sendChanges(draft);
}
function undo() {
  const before = history_.pop();
  if (!before) return;
  changes.clear(); before[0].forEach(([path, value]) => changes.set(path, value));
  moves.clear(); before[1].forEach(([index, move]) => moves.set(index, move));
  lastChange = { path: null, at: -Infinity };
  $("undo").disabled = !history_.length;
  sendChanges(false);
  showChosenValues();
}

// The controls of the chosen object.

const numberRow = (name, unit, value, [least, most, by], set) => {
  const row = element("div", "", { className: "leaf" }), label = unit ? `${name} (${unit})` : name;
  const slider = element("input", "", { type: "range", min: least, max: most, step: by, value });
  const number = element("input", "", { type: "number", step: "any", value: rounded(value) });
  const follow = (from, to, draft) => {
    if (from.value === "" || !isFinite(Number(from.value))) return;
    to.value = from.value;
    set(Number(from.value), draft);
  };
  slider.oninput = () => follow(slider, number, true);
  slider.onchange = () => follow(slider, number, false);
  number.onchange = () => follow(number, slider, false);
  [slider, number].forEach(input => input.setAttribute("aria-label", label));
  const play = element("button", "▶", { type: "button", title: `Play ${label}` });
  play.setAttribute("aria-label", `Play ${label}`);
  play.onclick = () => playNumber(play, slider, number, set);
  row.append(element("span", label, { title: label }), slider, number, play);
  row.show = shown => { slider.value = shown; if (document.activeElement !== number) number.value = rounded(shown); };
  return row;
};
/// The time in which a played number goes through its range once, and the time of a step, in ms.
const PLAY = 8000, PLAY_STEP = 250;
let playing = null;
/// Plays a number from its present value to the end of its range and again from the beginning, or
/// ends what plays.
function playNumber(button, slider, number, set) {
  const was = playing;
  if (was) {
    clearInterval(was.timer);
    was.button.textContent = "▶";
    playing = null;
    was.set(Number(was.slider.value), false);
  }
  if (was?.button === button) return;
  const [least, most] = [Number(slider.min), Number(slider.max)];
  button.textContent = "■";
  const timer = setInterval(() => {
    const next = Number(slider.value) + (most - least) * PLAY_STEP / PLAY;
    slider.value = number.value = rounded(next > most ? least : next);
    set(Number(slider.value), true);
  }, PLAY_STEP);
  playing = { button, slider, set, timer };
}
const choiceRow = (name, value, list, set) => {
  const row = element("div", "", { className: "leaf choice" }), field = element("input", "", { value, autocomplete: "off" });
  field.setAttribute("list", list);
  field.setAttribute("aria-label", name);
  field.onchange = () => { if (field.value) set(field.value); };
  row.append(element("span", name), field);
  return row;
};
/// The keys whose text is chosen from a list.
const LISTS = { ior: "glass-names", spectrum: "spectrum-names", reflectance: "spectrum-names" };
const UNIT_OF = { apex: "°", degrees: "°", fov: "°", power: "W", temperature: "K", lines_per_mm: "1/mm", thickness_nm: "nm" };
const LENGTHS = ["side", "length", "radius", "width", "height", "size", "radius2", "thickness"];

/// Returns controls for the numbers and names in a part of the scene.
function controlsOf(value, path, title) {
  return Object.entries(value).flatMap(([key, below]) => {
    const at = step(path, Array.isArray(value) ? Number(key) : key), name = Array.isArray(value) ? `${title} ${"xyz"[key] ?? Number(key) + 1}` : key.replace(/_/g, " ");
    if (typeof below === "number") {
      const isAngle = UNIT_OF[key] === "°", reach = Math.abs(below) || 1;
      const most = Array.isArray(value) ? Math.max(...value.map(Math.abs)) || 1 : 0;
      const range = most ? [-3 * most, 3 * most, most / 100] : isAngle ? [1, 179, 0.5] : key === "reflectance" ? [0, 1, 0.005] : [below < 0 ? -3 * reach : 0, 3 * reach, reach / 100];
      const unit = UNIT_OF[key] ?? (LENGTHS.includes(key) || LENGTHS.includes(title) ? scene.scene.unit ?? "m" : "");
      return [numberRow(name, unit, below, range, (next, draft) => changeScene(at, next, draft))];
    }
    if (typeof below === "string" && LISTS[key]) return [choiceRow(key === "ior" ? "glass" : key, below, LISTS[key], next => changeScene(at, next, false))];
    return below && typeof below === "object" ? controlsOf(below, at, key) : [];
  });
}

let moveRows = [];
/// Shows the controls of the chosen object.
function showChosen() {
  const list = $("object"), named = objects().map((object, index) => object.name ?? `object ${index + 1}`);
  if (list.options.length !== named.length + 1 || named.some((name, i) => list.options[i + 1].text !== name)) {
    list.replaceChildren(new Option("none", ""), ...named.map((name, index) => new Option(name, index)));
  }
  list.value = chosen ? chosen.index : "";
  const object = chosen && objects()[chosen.index];
  if (!object) { $("chosen").replaceChildren(); moveRows = []; return; }
  const move = moveOf(chosen.index), unit = scene.scene.unit ?? "m", far = camera() ? axes(camera()).distance / 2 : 1;
  const change = (set, draft) => { set(); sendMove(chosen.index, draft); };
  moveRows = [0, 1, 2].map(axis => numberRow(`move ${"xyz"[axis]}`, unit, move.shift[axis], [-rounded(far), rounded(far), far / 500], (value, draft) => change(() => { move.shift[axis] = value; }, draft)));
  moveRows.push(numberRow("turn", "°", move.turn, [-180, 180, 0.5], (value, draft) => change(() => { move.turn = value; }, draft)));
  moveRows.push(numberRow("size", "×", move.size, [0.2, 3, 0.01], (value, draft) => { if (value > 0) change(() => { move.size = value; }, draft); }));
  const material = typeof object.material === "string" ? scene.scene.materials?.[object.material] : object.material;
  const at = typeof object.material === "string" ? step("materials", object.material) : `${pathOf(chosen.index)}.material`;
  const rows = [...moveRows, ...controlsOf(object.shape ?? {}, `${pathOf(chosen.index)}.shape`, "shape")];
  if (material && typeof material === "object") rows.push(...controlsOf(material, at, object.material));
  if (object.emission) rows.push(...controlsOf(object.emission, `${pathOf(chosen.index)}.emission`, "emission"));
  $("chosen").replaceChildren(...rows);
}
function showChosenValues() {
  const move = chosen && moves.get(chosen.index);
  if (!move) return;
  [...move.shift, move.turn, move.size].forEach((value, i) => moveRows[i]?.show(value));
}
/// Shows the lists of names of a new scene, and the lamps.
function showObjects() {
  for (const [id, names] of [["glass-names", scene.glasses], ["spectrum-names", [...Object.keys(scene.scene?.spectra ?? {}), ...scene.spectra ?? []]]]) {
    if ($(id).options.length !== names?.length) $(id).replaceChildren(...(names ?? []).map(name => new Option(name)));
  }
  if (chosen && chosen.index >= objects().length) chosen = null;
  if (!document.activeElement?.closest("#chosen, #lamps")) {
    showChosen();
    $("lamps").replaceChildren(...(scene.scene?.lights ?? []).flatMap((light, index) => {
      const kind = Object.keys(light)[0], rows = controlsOf(light[kind] ?? {}, `lights[${index}].${kind}`, kind);
      return rows.length ? [element("h3", light.name ?? `${kind} ${index + 1}`), ...rows] : [];
    }));
  }
}
/// What the reader can do with objects, before one is chosen.
const moveHint = () => isMoving && !chosen
  ? "Drag an object. The ring turns it, and the arrow lifts it." : "";
function toggleMoving() {
  isMoving = !isMoving && Boolean(camera());
  if (isMoving && isOrbiting) toggleOrbit();
  if (isMoving && isMeasuring) toggleRuler();
  press_("move", isMoving);
  stage.style.cursor = isMoving ? "move" : "crosshair";
  draw();
}
