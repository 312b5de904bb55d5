// The comparison of the shown picture A with a reference B.

/// The reference: what the state says about it, and its XYZ values.
let reference = null, imageB = document.createElement("canvas"), isFetchingB = false, flicker = null, showsB = false, figuresOf = "";
const REFERENCE_COLOUR = "#e8590c", SATURATED_DIFFERENCE = 0.5, WHITE_DELTA_E = 10;
const keyOf = of => of ? of.name + " " + of.number : "";
const fits = () => reference && picture && reference.width === picture.width && reference.height === picture.height;
const comparison = () => fits() ? $("compare").value : "off";
const isSplit = () => comparison() === "wipe";
const described = of => of.name + (of.without.length ? " without " + of.without.join(", ") : "") + (of.passes ? `, ${of.passes} ${of.passes === 1 ? "pass" : "passes"}` : "");

/// Fetches the reference if the state names another one.
async function showReference(next) {
  if (keyOf(next) !== keyOf(reference) && !isFetchingB) {
    isFetchingB = true;
    const first = !reference, found = next && await floats("reference").catch(() => null);
    reference = found && { ...next, xyz: found.values };
    isFetchingB = false;
    if (first && reference && !scene?.live) { showTab("compare"); setComparison("wipe"); }
    draw();
  }
  [...$("compare").options].forEach(option => { option.disabled = option.value !== "off" && !fits(); });
  const a = state.picture ? described(state.picture) : "none yet";
  $("compare-a").textContent = a;
  $("compare-b").textContent = !reference ? "none" : described(reference) + (picture && !fits() ? " (another size)" : "");
  showFigures();
}

function setComparison(mode) {
  $("compare").value = mode;
  clearInterval(flicker);
  showsB = mode === "b";
  const calm = matchMedia("(prefers-reduced-motion: reduce)").matches;
  flicker = mode === "flicker" && !calm ? setInterval(() => { showsB = !showsB; paint(); }, 500) : null;
  draw();
  if (area) probeCursor();
}
/// Shows the other picture.
function flip() {
  if (!fits()) return;
  const mode = comparison();
  if (mode === "flicker") { showsB = !showsB; paint(); } else setComparison(mode === "b" ? "a" : "b");
}

/// Writes the comparison of the picture with the reference to `pixels`. Returns the legend.
async function compare(current, pixels, how) {
  const mode = comparison(), b = reference, { width, height } = current;
  if (mode === "delta_e") {
    const values = await plane("delta_e?" + encodeURIComponent(keyOf(b)));
    if (!values) return "ΔE2000 is not known";
    for (let i = 0, j = 0; i < values.length; i++, j += 4) ramp(values[i] / WHITE_DELTA_E, pixels.data, j);
    return "colour difference ΔE2000: dark violet 0, yellow 10 or more";
  }
  if (mode === "difference") {
    let mean = 0;
    for (let i = 1; i < b.xyz.length; i += 3) mean += b.xyz[i] / (b.xyz.length / 3);
    for (let i = 1, j = 0; i < b.xyz.length; i += 3, j += 4) {
      const unit = Math.hypot(b.xyz[i], 0.1 * mean) * SATURATED_DIFFERENCE, share = (current.xyz[i] - b.xyz[i]) / unit;
      const faded = 255 * (1 - Math.min(1, Math.abs(share) || 0));
      pixels.data.set(share > 0 ? [255, faded, faded, 255] : [faded, faded, 255, 255], j);
    }
    return "difference of Y, relative to B: red if A is brighter, blue if A is darker; full colour at 50 %";
  }
  const factor = b.exposure * 2 ** ev(), other = new ImageData(width, height);
  const alike = { ...how, factor, reaches: b.reaches };
  develop(current.xyz, pixels.data, alike);
  develop(b.xyz, other.data, alike);
  imageB.width = width; imageB.height = height;
  imageB.getContext("2d", { colorSpace: space().name }).putImageData(new ImageData(other.data, width, height, { colorSpace: space().name }), 0, 0);
  return { wipe: "left: A, right: B", a: "A", b: "B", flicker: "A and B in turn" }[mode];
}

/// Paints the reference over the picture, as far as the comparison shows it.
function paintReference(place) {
  const mode = comparison();
  if (mode === "wipe") {
    const x = Number($("wipe").value) / 100 * canvas.width;
    context.save();
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.beginPath();
    context.rect(x, 0, canvas.width, canvas.height);
    context.clip();
    place();
    context.drawImage(imageB, 0, 0, picture.width, picture.height);
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = "#000"; context.fillRect(x - 2, 0, 4, canvas.height);
    context.fillStyle = "#fff"; context.fillRect(x, 0, 2, canvas.height);
    context.restore();
  } else if ((mode === "b" || mode === "flicker") && showsB) context.drawImage(imageB, 0, 0, picture.width, picture.height);
}
const isNearWipe = x => isSplit() && Math.abs(x - Number($("wipe").value) / 100 * stage.clientWidth) < 14;
function setWipe(share) {
  $("wipe").value = Math.min(100, Math.max(0, share));
  $("wipe-value").textContent = Math.round($("wipe").value) + " %";
  paint();
}

/// Shows the figures of `abbe compare`, if the panel is visible.
async function showFigures() {
  const now = keyOf(reference) + keyOf(picture);
  if ($("panel-compare").hidden || now === figuresOf) return;
  figuresOf = now;
  const found = fits() ? await json("comparison").catch(() => null) : null;
  const number = value => value == null ? "–" : short(value, 4), share = part => part ? (100 * part.share).toFixed(1) + " %" : "–";
  const rows = [["relative mean square error", number(found?.relative_mse)],
    ["… without the worst 2 % of the pixels", number(found?.relative_mse_trimmed)],
    ["RMSE of Y in cd/m²", number(found?.rmse)], ["mean Y of A / mean Y of B", number(found?.mean_ratio)],
    ["ΔE2000, mean", number(found?.delta_e_2000.mean)], ["ΔE2000, 95th percentile", number(found?.delta_e_2000.p95)],
    ["pixels with |z| < 1.96", share(found?.z)], ["probability of the largest difference", number(found?.z?.p)],
    ["95 % interval of A contains B", share(found?.covered)], ["pixels", found?.pixels ?? "–"]];
  $("figures").replaceChildren(...rows.map(([name, value]) => {
    const row = element("tr", "");
    row.append(element("th", name, { scope: "row" }), element("td", String(value), { className: "number" }));
    return row;
  }));
}

$("compare").onchange = () => setComparison($("compare").value);
$("wipe").oninput = () => setWipe(Number($("wipe").value));
$("keep").onclick = () => order({ keep: true });
$("flip").onclick = flip;
