// A ruler on the picture: the distance between two points of surfaces, and the angle at the second
// of three.

let isMeasuring = false, marks = [];

/// Adds the point under a pixel. A fourth point begins again.
async function markAt(pixel) {
  const found = await json(`pick?x=${pixel[0]}&y=${pixel[1]}`).catch(() => null);
  if (!found) { sayRuler("There is no surface"); return; }
  if (marks.length === 3) marks = [];
  marks.push({ pixel, point: found.point_m });
  sayRuler();
  paint();
}
function lengthText(metres) {
  const unit = scene.scene?.unit ?? "m", value = metres / (UNITS[unit] ?? 1);
  return `${Number(value.toPrecision(4))} ${unit}`;
}
/// The angle in degrees between two directions.
const angleOf = (a, b) => Math.acos(Math.min(1, Math.max(-1, dot(unitVector(a), unitVector(b))))) * 180 / Math.PI;
function sayRuler(text) {
  const [a, b, c] = marks.map(mark => mark.point), between = (p, q) => vector.length(vector.sub(p, q));
  const said = text ?? (c ? `${lengthText(between(a, b))}, ${lengthText(between(b, c))}; angle ${angleOf(vector.sub(a, b), vector.sub(c, b)).toFixed(2)}°, deviation ${angleOf(vector.sub(b, a), vector.sub(c, b)).toFixed(2)}°`
    : b ? `${lengthText(between(a, b))}; choose a third point for the angle` : a ? "Choose a second point" : "Choose points in the picture");
  $("legend").textContent = said;
  $("legend").hidden = !isMeasuring;
}
function paintRuler(scale) {
  if (!isMeasuring || !marks.length) return;
  const at = marks.map(({ pixel }) => pixel.map(v => (v + 0.5) * scale));
  for (const [width, style] of [[5, "#000a"], [2.5, "#ffd75e"]]) {
    context.lineWidth = width; context.strokeStyle = style;
    context.beginPath();
    at.forEach(([x, y], i) => i ? context.lineTo(x, y) : context.moveTo(x, y));
    at.forEach(([x, y]) => { context.moveTo(x + 5, y); context.arc(x, y, 5, 0, 2 * Math.PI); });
    context.stroke();
  }
}
function toggleRuler() {
  isMeasuring = !isMeasuring;
  if (isMeasuring && isMoving) toggleMoving();
  if (isMeasuring && isOrbiting) toggleOrbit();
  press_("ruler", isMeasuring);
  sayRuler();
  paint();
}
