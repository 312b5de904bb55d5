// The exported page: shows the spectrum of the cell under the cursor, from the data in the page.

const $ = id => document.getElementById(id);
const data = JSON.parse($("data").textContent), stage = $("stage"), canvas = $("canvas");
const context = canvas.getContext("2d", { colorSpace: data.space.name });
const { width, height, size, columns, rows, bands } = data;
const picture = new Image(), paths = data.paths?.byColour.map(([style, numbers]) => [style, linePath(numbers)]);
let cells = null, cell = null, pins = data.pins;

async function unpacked() {
  const bytes = Uint8Array.from(atob(data.cells), letter => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const buffer = await new Response(stream).arrayBuffer(), count = columns * rows;
  return { numbers: new Float32Array(buffer, 0, 7 * count), radiance: new Uint8Array(buffer, 28 * count, bands * count),
    errors: new Uint8Array(buffer, 28 * count + bands * count) };
}

/// Returns the values of a cell in the form of a probe.
function report([column, row]) {
  const at = row * columns + column, [x, y, z, noise, bias, high, scale] = cells.numbers.subarray(7 * at, 7 * at + 7);
  const known = value => isNaN(value) ? null : value, sum = x + y + z, spectrum = roots => Array.from(roots.subarray(at * bands, (at + 1) * bands), root => (root / 255) ** 2 * scale);
  return {
    area: [column * size, row * size, Math.min(width, (column + 1) * size) - 1, Math.min(height, (row + 1) * size) - 1],
    xyz: [x, y, z], xy: sum > 0 ? [x / sum, y / sum] : null, noise: known(noise), bias: known(bias), interval_95: isNaN(high) ? null : [Math.max(0, 2 * y - high), high],
    values: spectrum(cells.radiance),
    errors: data.hasErrors ? spectrum(cells.errors) : null,
  };
}

function show() {
  const ink = getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  const pinned = pinCurves(pins, data.srgb), probed = cell ? [{ ...report(cell), colour: ink }] : [], curves = [...pinned, ...probed];
  $("spectrum").innerHTML = spectrumPlot(curves, data.light);
  $("chromaticity").innerHTML = chromaticityPlot(curves, data.locus, data.space);
  $("pins").innerHTML = pinTable(pinned);
  $("values").innerHTML = cell ? valueTable(probed) : "";
  paint(curves);
}

function paint(curves) {
  const ratio = window.devicePixelRatio || 1, scale = stage.clientWidth / width;
  canvas.width = Math.round(stage.clientWidth * ratio);
  canvas.height = Math.round(stage.clientHeight * ratio);
  context.scale(ratio * scale, ratio * scale);
  context.imageSmoothingEnabled = scale < 1;
  context.drawImage(picture, 0, 0, width, height);
  if (paths && $("paths").checked) paintPaths(context, paths, data, scale);
  paintFrames(context, curves, data.srgb, scale);
}

function select(column, row) {
  cell = [Math.min(columns - 1, Math.max(0, column)), Math.min(rows - 1, Math.max(0, row))];
  show();
}
function pin() {
  if (!cell) return;
  pins = [...pins, report(cell)].slice(-MOST_PINS);
  show();
}
function point(event) {
  const box = stage.getBoundingClientRect(), scale = width / box.width;
  select(Math.floor((event.clientX - box.left) * scale / size), Math.floor((event.clientY - box.top) * scale / size));
}
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
stage.addEventListener("pointermove", point);
stage.addEventListener("pointerdown", point);
stage.addEventListener("click", event => { point(event); pin(); });
stage.addEventListener("keydown", event => {
  const arrow = ARROWS[event.key], by = event.shiftKey ? 10 : 1;
  if (arrow) {
    const [column, row] = cell ?? [columns >> 1, rows >> 1];
    select(column + by * arrow[0], row + by * arrow[1]);
  } else if (event.key === "Enter") pin();
  else if (event.key === "Delete") { pins = pins.slice(0, -1); show(); }
  else return;
  event.preventDefault();
});
$("unpin").onclick = () => { pins = []; show(); };
$("paths").onchange = show;

document.title = "Abbe: " + data.title;
$("title").textContent = data.title;
$("about").textContent = `Rendered with Abbe in ${data.passes} ${data.passes === 1 ? "pass" : "passes"}` +
  (data.error === null ? "" : `; the relative error of a typical pixel is ${(100 * data.error).toPrecision(2)} %`) + ". This page works without a network.";
$("legend").textContent = data.legend;
$("cells").textContent = (size > 1 ? `To keep this page small, spectra are means of ${size} × ${size} pixels. ` : "") +
  (data.hasErrors ? "The shaded band is ± 2 standard errors. " : "") + "The grey area is the power of all lights, in any unit.";
$("paths-row").hidden = !paths;
$("paths-text").textContent = data.paths?.text ?? "";
$("scene-row").hidden = data.scene === null;
$("scene").value = data.scene ?? "";
stage.style.aspectRatio = `${width} / ${height}`;
stage.style.maxWidth = `calc(82vh * ${width / height})`;
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", show);
(async () => {
  picture.src = data.picture;
  [cells] = await Promise.all([unpacked(), picture.decode()]);
  new ResizeObserver(show).observe(stage);
  show();
})();
