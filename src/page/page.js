// The page of the live view. It asks for the state, and shows what changed. A script before this
// one defines `get` and `post`, the link with the renderer.

const $ = id => document.getElementById(id);
const stage = $("stage"), canvas = $("canvas"), context = canvas.getContext("2d");
let version = 0, state = {}, scene = null, spaces = [];
/// The shown picture: number, width, height, xyz, and the other planes that were fetched for it.
let picture = null, image = document.createElement("canvas"), isFetching = false;
/// What recent states said about their pictures, by the number of the picture.
const summaries = new Map();
/// True if the panels were not refreshed while a slider moved.
let hasOldPanels = false;
/// Screen pixels per picture pixel, and the position of the picture's corner. `zoom` 0 fits the picture.
let zoom = 0, offset = [0, 0];
let area = null, pins = [], hovered = null, hoveredB = null, isProbing = false;

// Requests.

async function floats(path) {
  const { plane: [number, width, height], bytes } = await get(path);
  return { number, width, height, values: new Float32Array(bytes) };
}
const json = async path => JSON.parse(new TextDecoder().decode((await get(path)).bytes));
let sending = null, waiting = null;
/// Sends orders one after another. While one is on its way, only the newest waits.
function order(orders) {
  if (sending) { waiting = { ...waiting, ...orders }; return; }
  sending = post(orders).catch(() => {}).then(() => {
    sending = null;
    const next = waiting;
    waiting = null;
    if (next) order(next);
  });
}

async function follow() {
  for (;;) {
    try {
      const next = await json("state?after=" + version);
      version = next.version;
      await show(next);
    } catch (error) {
      $("session").textContent = "not connected";
      version = 0;
      await new Promise(done => setTimeout(done, 1000));
    }
  }
}

const time = s => s == null ? "–" : s < 90 ? s.toFixed(0) + " s" : s < 5400 ? (s / 60).toFixed(0) + " min" : (s / 3600).toFixed(1) + " h";
const percent = value => value == null ? "not known yet" : (100 * value).toPrecision(2) + " %";

async function show(next) {
  if (next.has_examples && !next.example) location.replace("./");
  $("examples").hidden = !next.has_examples;
  state = next;
  if (next.picture) summaries.set(next.picture.number, next.picture);
  if (next.scene !== null && (next.scene !== scene?.number || hasOldPanels && !next.draft)) await showScene();
  $("passes").textContent = next.passes + (next.passes_wanted ? " of " + next.passes_wanted : "");
  $("error").textContent = percent(next.typical_error);
  $("left").textContent = next.session === "rendering" ? time(next.left_s) : "–";
  $("rate").textContent = next.photons_per_second ? short(next.photons_per_second) : "–";
  $("session").textContent = next.paused && next.session === "rendering" ? "paused" : next.session;
  $("pause").textContent = next.paused ? "Continue" : "Pause";
  $("fault").hidden = !next.error;
  $("fault").textContent = next.error ?? "";
  showEvents();
  showReference(next.reference);
  if (next.picture && next.picture.number !== picture?.number) fetchPicture();
}

async function fetchPicture() {
  if (isFetching) return;
  isFetching = true;
  let fetched;
  try {
    const next = await floats("picture"), summary = summaries.get(next.number);
    // The state of a picture that has just been published may be on its way. It brings us here
    // again.
    fetched = next.number;
    if (summary) {
      const { exposure, reaches, passes, denoised, coarse } = summary;
      picture = { ...next, xyz: next.values, planes: new Map(),
        exposure, reaches, passes, denoised, coarse };
      for (const number of summaries.keys()) if (number < next.number) summaries.delete(number);
      await draw();
      refreshProbes();
      showReference(state.reference);
    }
  } finally {
    isFetching = false;
  }
  if (state.picture?.number > fetched) fetchPicture();
}

// The picture.

const space = () => spaces.find(space => space.name === $("space").value) ?? spaces[0];
const ev = () => Number($("ev").value);

/// Converts the picture to display codes, and paints it.
async function draw() {
  if (!picture || !scene) return;
  const current = picture, { width, height } = current, mode = $("mode").value;
  const pixels = new ImageData(width, height), factor = current.exposure * 2 ** ev();
  const how = { space: space(), tone: $("tone").value, gamut: scene.gamut, factor, reaches: current.reaches };
  const { coarse } = current, size = coarse?.size.join(" × ");
  let legend = coarse ? `coarse picture: ${size} pixels, ${coarse.photons} photons` : moveHint();
  if (comparison() !== "off") legend = await compare(current, pixels, how);
  else if (mode === "colour") develop((scene.bloom && await bloomedXyz()) || await shownXyz(current), pixels.data, how);
  else if (mode === "band") {
    const band = Number($("band").value), values = await plane("band?band=" + band);
    if (values) {
      // A surface that reflects the equal-energy spectrum is equally bright in each band.
      tint(values, pixels.data, bandColour(band), factor * 683 * 106.857);
      legend = $("band-value").textContent + ", radiance in W/m²/sr/nm";
    } else legend = "The coarse picture has no spectrum";
  } else if (mode === "classes") legend = await drawClasses(current, pixels.data);
  else if (mode === "analyser") {
    const xyz = await analysedXyz(current);
    develop(xyz ?? current.xyz, pixels.data, how);
    legend = xyz ? `through a polariser at ${$("analyser").value}°; all wavelengths have the polarisation of Y` : "The picture has no polarisation";
  } else if (mode === "degree") {
    const values = await plane("degree");
    for (let i = 0; values && i < values.length; i++) ramp(values[i], pixels.data, 4 * i);
    legend = values ? "degree of polarisation: dark violet 0, yellow 1" : "The picture has no polarisation";
  }
  else {
    const values = await valuesOf(mode, current);
    const known = Float32Array.from(values.filter(value => value > 0 && isFinite(value))).sort();
    const high = known.length ? known[Math.floor(0.995 * (known.length - 1))] * 2 ** -ev() : 1;
    const low = mode === "samples" ? (known[0] ?? 1) / 2 : high / (mode === "error" ? 100 : 1000), unitName = mode === "error" || mode === "samples" ? "" : " cd/m²";
    heat(values, pixels.data, low, high);
    const name = { luminance: "luminance", error: "relative error", noise: "noise of Y", bias: "bias of Y", samples: "camera samples per pixel" }[mode];
    legend = known.length ? `${name}: dark violet ${short(low)}${unitName}, yellow ${short(high)}${unitName}` : `${name}: not known yet`;
  }
  if (current !== picture) return;
  $("legend").textContent = legend;
  $("legend").hidden = !legend;
  image.width = width; image.height = height;
  image.getContext("2d", { colorSpace: space().name }).putImageData(new ImageData(pixels.data, width, height, { colorSpace: space().name }), 0, 0);
  paint();
}

/// Returns what [`shownXyz`] does with the bloom of the scene.
const bloomedXyz = () => plane("bloomed?denoised=" + showsDenoised());

/// Returns the denoised picture if the reader wants it and the render has one, and else the
/// picture.
const shownXyz = async current => (showsDenoised() ? await plane("denoised") : null) ?? current.xyz;
const showsDenoised = () => $("denoise").checked && picture.denoised;

/// Returns the picture as a polariser transmits it whose axis is at the angle of the dial from the
/// horizontal, or null without Stokes vectors.
async function analysedXyz(current) {
  const stokes = await plane("stokes"), xyz = await shownXyz(current);
  if (!stokes) return null;
  const angle = 2 * Number($("analyser").value) * Math.PI / 180, cos = Math.cos(angle), sin = Math.sin(angle);
  const passed = new Float32Array(xyz.length);
  for (let i = 0, j = 0; i < xyz.length; i += 3, j += 4) {
    const part = stokes[j] > 0 ? unit(0.5 * (1 + (cos * stokes[j + 1] + sin * stokes[j + 2]) / stokes[j])) : 0;
    for (let c = 0; c < 3; c++) passed[i + c] = part * xyz[i + c];
  }
  return passed;
}

/// Fetches a plane of the shown picture. Returns null if the picture has no such plane.
async function plane(path) {
  const current = picture;
  if (!current.planes.has(path)) {
    const found = await floats(path).catch(() => null);
    if (!found?.values.length || found.width !== current.width || found.height !== current.height) return null;
    current.planes.set(path, found.values);
  }
  return current.planes.get(path);
}

async function valuesOf(mode, { xyz }) {
  const y = Float32Array.from({ length: xyz.length / 3 }, (_, i) => xyz[3 * i + 1]);
  if (mode === "luminance") return y;
  if (mode === "samples") return await plane("samples") ?? y.fill(NaN);
  const errors = await plane("errors");
  if (!errors) return y.fill(NaN);
  return y.map((value, i) => mode === "noise" ? errors[2 * i] : mode === "bias" ? errors[2 * i + 1]
    : value > 0 ? Math.hypot(errors[2 * i], errors[2 * i + 1]) / value : NaN);
}

/// The linear colour of a band, with the largest component 1.
function bandColour(band) {
  const { from_nm, to_nm, values } = scene.light, nm = from_nm + (band + 0.5) * (to_nm - from_nm) / values.length;
  const near = scene.locus.reduce((best, point) => Math.abs(point[0] - nm) < Math.abs(best[0] - nm) ? point : best);
  const [x, y] = near[1], rgb = apply(space().own_matrix, x / y, 1, (1 - x - y) / y);
  const most = Math.max(...rgb), colour = rgb.map(value => value / most);
  GAMUTS.desaturate(colour, space());
  return colour;
}

function resize() {
  const ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(stage.clientWidth * ratio);
  canvas.height = Math.round(stage.clientHeight * ratio);
  paint();
}

/// The scale and the corner of the picture in CSS pixels of the stage.
function placement() {
  if (!picture) return { scale: 1, left: 0, top: 0 };
  const [w, h] = [stage.clientWidth, stage.clientHeight];
  const fit = Math.min(w / picture.width, h / picture.height), scale = zoom || fit;
  const centre = [(w - picture.width * scale) / 2, (h - picture.height * scale) / 2];
  return { scale, left: centre[0] + (zoom ? offset[0] : 0), top: centre[1] + (zoom ? offset[1] : 0) };
}

function paint() {
  const ratio = window.devicePixelRatio || 1, { scale, left, top } = placement();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, canvas.width, canvas.height);
  if (!picture || !image.width) return;
  const place = () => {
    context.setTransform(ratio * scale, 0, 0, ratio * scale, ratio * left, ratio * top);
    context.imageSmoothingEnabled = scale < 1;
  };
  place();
  context.drawImage(image, 0, 0, picture.width, picture.height);
  paintReference(place);
  if (hasPhotons()) paintPaths(context, photons.strokes, picture, scale);
  const corners = ({ x0, y0, x1, y1 }) => [x0, y0, x1, y1];
  const frames = pins.map((pin, i) => ({ area: corners(pin.area), xyz: pin.report.xyz, label: String(i + 1) }));
  paintFrames(context, area ? [...frames, { area: corners(area) }] : frames, spaces[0], scale);
  context.setTransform(ratio, 0, 0, ratio, ratio * left, ratio * top);
  paintHandles(scale);
  paintRuler(scale);
}

function setZoom(wanted, at = [stage.clientWidth / 2, stage.clientHeight / 2]) {
  const before = placement(), point = [(at[0] - before.left) / before.scale, (at[1] - before.top) / before.scale];
  zoom = Math.min(64, Math.max(0.1, wanted));
  offset = [0, 0];
  const after = placement();
  offset = [at[0] - point[0] * zoom - after.left, at[1] - point[1] * zoom - after.top];
  paint();
}

// Probes.

const pixelAt = (x, y) => {
  const { scale, left, top } = placement(), clamp = (value, most) => Math.min(most - 1, Math.max(0, Math.floor(value)));
  return [clamp((x - left) / scale, picture.width), clamp((y - top) / scale, picture.height)];
};
const areaOf = ([ax, ay], [bx, by] = [ax, ay]) => ({ x0: Math.min(ax, bx), y0: Math.min(ay, by), x1: Math.max(ax, bx), y1: Math.max(ay, by) });
const probePath = ({ x0, y0, x1, y1 }, of = "") => `${of}probe?x0=${x0}&y0=${y0}&x1=${x1}&y1=${y1}`;

function select(next) {
  area = next;
  paint();
  probeCursor();
}

/// Asks for the values under the cursor. While a request is on its way, only the newest area waits.
async function probeCursor() {
  if (isProbing || !area || !picture) return;
  isProbing = true;
  const asked = area, begin = performance.now();
  try {
    hovered = await json(probePath(asked));
    hovered.delay_ms = performance.now() - begin;
    hoveredB = comparison() === "off" ? null : await json(probePath(asked, "reference_")).catch(() => null);
  } catch { hovered = null; }
  isProbing = false;
  showProbes();
  if (area !== asked) probeCursor();
}

async function refreshProbes() {
  const inside = ({ x1, y1 }) => x1 < picture.width && y1 < picture.height;
  await Promise.all(pins.filter(pin => inside(pin.area)).map(async pin => {
    pin.report = await json(probePath(pin.area)).catch(() => pin.report);
  }));
  if (area && !inside(area)) area = null;
  if (area) probeCursor(); else showProbes();
}

function pinArea() {
  if (!area || !hovered) return;
  photonPixel = [area.x0, area.y0];
  if ($("photon-reach").checked) tracePhotons();
  pins.push({ area: { ...area }, report: hovered });
  if (pins.length > MOST_PINS) pins.shift();
  paint();
  showProbes();
}

function showProbes() {
  if (!scene) return;
  const ink = getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  const pinned = pinCurves(pins.map(pin => pin.report), spaces[0]), probed = [];
  if (hovered && area) probed.push({ ...hovered, colour: ink, name: hoveredB ? "A: " : "" });
  if (hoveredB && area) probed.push({ ...hoveredB, colour: REFERENCE_COLOUR, name: "B: ", dash: "6 3" });
  const curves = [...pinned, ...probed];
  $("spectrum").innerHTML = spectrumPlot(curves, scene.light);
  $("chromaticity").innerHTML = chromaticityPlot(curves, scene.locus, space());
  $("pins").innerHTML = pinTable(pinned);
  $("values").innerHTML = probed.length ? valueTable(probed)
    : `<p class="soft">Point at the picture, or use the arrow keys. Shift and drag selects a
rectangle. A click or Enter pins it. To drag an object, press <em>Move objects</em> first.</p>`;
}
