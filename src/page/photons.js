// Photon paths as coloured lines over the picture.

/// The lines that the server found, and the pixel that the paths must reach.
let photons = null, showsPhotons = false, photonPixel = null, isTracing = false, traceAgain = false;

/// Asks for the paths that the controls describe. While a request is on its way, only the newest waits.
async function tracePhotons() {
  if (!showsPhotons || !scene?.live) { photons = null; paint(); sayPhotons(); return; }
  if (isTracing) { traceAgain = true; return; }
  isTracing = true;
  const light = $("photon-light").value, reach = $("photon-reach").checked;
  const pixel = reach && photonPixel && `&x=${photonPixel[0]}&y=${photonPixel[1]}`;
  const path = `photons?count=${$("photon-count").value}${light && "&light=" + light}${pixel || ""}`;
  if (reach && !pixel) photons = null;
  else {
    photons = await json(path).catch(() => null);
    if (photons) colourPhotons();
  }
  isTracing = false;
  sayPhotons();
  paint();
  if (traceAgain) { traceAgain = false; tracePhotons(); }
}

/// Converts the XYZ of the lines to codes of the selected colour space. The brightness of all lines is the same.
function colourPhotons() {
  const code = value => CODES[value * 65535 + 0.5 | 0];
  photons.byColour = new Map();
  for (const [ax, ay, bx, by, x, y, z] of photons.lines) {
    const rgb = apply(space().own_matrix, x, y, z), most = Math.max(...rgb);
    if (most > 0) for (let c = 0; c < 3; c++) rgb[c] /= most;
    GAMUTS.desaturate(rgb, space());
    const style = `rgb(${rgb.map(code).join(" ")})`;
    if (!photons.byColour.has(style)) photons.byColour.set(style, []);
    photons.byColour.get(style).push(ax, ay, bx, by);
  }
  photons.strokes = new Map([...photons.byColour].map(([style, numbers]) => [style, linePath(numbers)]));
}

const hasPhotons = () => photons?.strokes && photons.scene === scene.number;

function sayPhotons() {
  const count = value => value.toLocaleString("en"), reach = $("photon-reach").checked;
  const at = photons?.point?.map(value => short(value)).join(", ");
  $("photon-text").textContent = !showsPhotons ? "Off"
    : reach && !photonPixel ? "Click a point of the picture, or press Enter on it"
    : !photons ? "The scene has no photon paths"
    : !photons.pixel ? `${count(photons.paths)} photon paths`
    : !photons.point ? "There is no surface at this pixel"
    : `${count(photons.paths)} paths reach (${at}) m, found among ${count(photons.traced)} photons`;
}

function showLights() {
  const before = $("photon-light").value, names = scene.lights ?? [];
  $("photon-light").replaceChildren(new Option("all lights", ""), ...names.map((name, number) => new Option(name, number)));
  $("photon-light").value = names[before] === undefined ? "" : before;
  tracePhotons();
}

function togglePhotons() {
  showsPhotons = !showsPhotons;
  press_("photon-show", showsPhotons);
  tracePhotons();
}
$("photon-show").onclick = togglePhotons;
["photon-light", "photon-reach", "photon-count"].forEach(id => { $(id).onchange = tracePhotons; });
$("photon-count").oninput = () => { $("photon-number").textContent = $("photon-count").value; };
