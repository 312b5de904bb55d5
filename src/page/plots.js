// Plots and tables as texts, which contain only numbers and fixed words, and lines over a picture.

const MOST_PINS = 6;
const raised = power => String(power).replace(/./g, digit => digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);
const short = (value, digits = 3) => value === 0 ? "0" : Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3
  ? value.toExponential(digits - 1).replace(/e(.*)/, (_, power) => "·10" + raised(Number(power))) : String(Number(value.toPrecision(digits)));

/// Returns the colour of light with these XYZ as the colour of a line in sRGB, light enough for
/// dark paper or dark enough for light paper.
function lineColour(xyz, { own_matrix, luminance_weights }, isDark) {
  const product = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
  const rgb = own_matrix.map(row => product(row, xyz)), most = Math.max(...rgb), y = product(luminance_weights, rgb) / most;
  let inside = most > 0 ? rgb.map(value => value / most) : [0, 0, 0];
  // Colours outside the gamut come nearer to grey.
  const part = Math.min(1, ...inside.filter(value => value < 0).map(value => y / (y - value)));
  inside = inside.map(value => Math.max(0, y + part * (value - y)) || 0);
  const light = product(luminance_weights, inside), limit = 0.2;
  if (isDark && light < limit) inside = inside.map(value => value + (1 - value) * (limit - light) / (1 - light));
  if (!isDark && light > limit) inside = inside.map(value => value * limit / light);
  return `rgb(${inside.map(v => Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055))).join(" ")})`;
}
const isDark = () => matchMedia("(prefers-color-scheme: dark)").matches;

/// The spectra of the areas in `curves`, over the spectrum of the lights.
function spectrumPlot(curves, light) {
  const [left, right, top, foot] = [62, 508, 12, 196], [from, to] = [light.from_nm, light.to_nm];
  const most = Math.max(0, ...curves.flatMap(curve => curve.values));
  const scale = most > 0 ? most * 1.08 : 1, power = most > 0 ? Math.floor(Math.log10(scale)) : 0;
  const x = nm => (left + (nm - from) / (to - from) * (right - left)).toFixed(1);
  const y = value => (foot - Math.min(Math.max(value / scale, -0.02), 1.1) * (foot - top)).toFixed(1);
  const edge = (i, count) => from + i * (to - from) / count;
  const steps = values => values.flatMap((value, i) => [[edge(i, values.length), value], [edge(i + 1, values.length), value]]);
  const line = points => points.map(([nm, value]) => `${x(nm)} ${y(value)}`).join("L");
  let svg = `<svg viewBox="0 0 520 236" role="img" aria-label="Spectral radiance by wavelength">`;
  const brightest = Math.max(...light.values, 0);
  if (brightest > 0) {
    const shown = light.values.map(value => value / brightest * scale * 0.92);
    svg += `<path class="light" d="M${x(from)} ${foot}L${line(steps(shown))}L${x(to)} ${foot}Z"/>`;
  }
  for (let nm = 400; nm <= 800; nm += 50) {
    svg += `<path class="rule" d="M${x(nm)} ${foot}v5"/><text x="${x(nm)}" y="${foot + 18}" text-anchor="middle">${nm}</text>`;
  }
  for (let i = 0; i <= 2; i++) {
    const value = scale * i / 2;
    svg += `<path class="rule" d="M${left} ${y(value)}H${right}"/>`;
    svg += `<text x="${left - 6}" y="${Number(y(value)) + 4}" text-anchor="end">${most > 0 ? short(value / 10 ** power, 2) : i ? "" : "0"}</text>`;
  }
  for (const { values, errors, colour, dash, label } of curves) {
    if (errors) {
      const high = steps(values.map((value, i) => value + 2 * errors[i]));
      const low = steps(values.map((value, i) => Math.max(0, value - 2 * errors[i]))).reverse();
      svg += `<path class="band" fill="${colour}" d="M${line(high)}L${line(low)}Z"/>`;
    }
    if (values.length) svg += `<path fill="none" stroke="${colour}" stroke-width="1.8" stroke-dasharray="${dash ?? "none"}" d="M${line(steps(values))}"/>`;
    if (values.length && label) {
      const top = values.indexOf(Math.max(...values)), place = (edge(top, values.length) + edge(top + 1, values.length)) / 2;
      svg += `<text x="${x(place)}" y="${Math.max(11, y(values[top]) - 4)}" text-anchor="middle" fill="${colour}">${label}</text>`;
    }
  }
  return svg + `<text x="285" y="232" text-anchor="middle">wavelength in nm</text>` +
    `<text x="12" y="104" text-anchor="middle" transform="rotate(-90 12 104)">radiance in ${power ? "10" + raised(power) + " " : ""}W/m²/sr/nm</text></svg>`;
}

/// The chromaticities of the areas in `curves`, with the spectral locus and the gamut of a space.
function chromaticityPlot(curves, locus, space) {
  const x = value => (50 + value * 560).toFixed(1), y = value => (470 - value * 520).toFixed(1);
  const line = points => points.map(([a, b]) => `${x(a)} ${y(b)}`).join("L");
  let svg = `<svg viewBox="0 0 520 520" role="img" aria-label="Chromaticity diagram">`;
  for (let i = 0; i <= 8; i += 2) {
    const v = i / 10;
    svg += `<path class="rule" d="M${x(v)} ${y(0)}V${y(0.86)}M${x(0)} ${y(v)}H${x(0.8)}"/>`;
    svg += `<text x="${x(v)}" y="490" text-anchor="middle">${v}</text><text x="42" y="${Number(y(v)) + 4}" text-anchor="end">${v}</text>`;
  }
  svg += `<path class="ink" d="M${line(locus.map(point => point[1]))}Z"/>`;
  for (const [nm, [a, b]] of locus) {
    if (nm % 20 || nm < 460 || nm > 620) continue;
    const anchor = nm < 510 ? "end" : "start", shift = nm < 510 ? -6 : 6;
    svg += `<circle cx="${x(a)}" cy="${y(b)}" r="2"/><text x="${Number(x(a)) + shift}" y="${Number(y(b)) + (nm < 510 ? 4 : -2)}" text-anchor="${anchor}">${nm}</text>`;
  }
  svg += `<path class="ink" stroke-dasharray="4 4" d="M${line(space.primaries_xy)}Z"/>`;
  svg += `<circle class="ink" cx="${x(space.white_xy[0])}" cy="${y(space.white_xy[1])}" r="3"/>`;
  for (const { xy, colour, label } of curves) {
    if (xy) svg += `<circle cx="${x(xy[0])}" cy="${y(xy[1])}" r="6" fill="${colour}" stroke="#fff" stroke-width="1.5"/>`;
    if (xy && label) svg += `<text x="${Number(x(xy[0])) + 9}" y="${Number(y(xy[1])) - 6}">${label}</text>`;
  }
  const name = { srgb: "sRGB", "display-p3": "Display P3" }[space.name];
  return svg + `<text x="${x(0.42)}" y="512" text-anchor="middle">x (dashed: gamut of ${name}, ring: its white)</text><text x="14" y="${y(0.43)}">y</text></svg>`;
}

const pixelText = ([x0, y0, x1, y1]) => [[x0, x1], [y0, y1]].map(([from, to]) => from === to ? `${from}` : `${from}–${to}`).join(", ");
const colourKey = curve => `<span class="key" style="background:${curve.colour}"></span>`;
const xyText = curve => curve.xy ? curve.xy.map(value => value.toFixed(4)).join(", ") : "–";
const intervalText = curve => curve.interval_95 ? curve.interval_95.map(value => short(value)).join(" … ") : "unknown";

/// The values of pinned areas, one row for each.
function pinTable(pins) {
  const names = ["pin", "pixels", "Y in cd/m²", "95 % interval", "x, y"].map(name => `<th scope="col">${name}</th>`).join("");
  const rows = pins.map(pin => `<tr><th scope="row">${colourKey(pin)}${pin.label}</th><td>${pixelText(pin.area)}</td><td>${short(pin.xyz[1])}</td>` +
    `<td>${intervalText(pin)}</td><td>${xyText(pin)}</td></tr>`);
  return pins.length ? `<table><thead><tr>${names}</tr></thead><tbody>${rows.join("")}</tbody></table>` : "";
}

/// Returns the curves of pins with these reports: a pin has the colour of its light and a number.
const pinCurves = (reports, srgb) => reports.map((report, i) => ({ ...report, colour: lineColour(report.xyz, srgb, isDark()), label: String(i + 1) }));

/// Paints frames around areas, and the numbers of pins. `scale` is the number of screen pixels per
/// picture pixel.
function paintFrames(context, frames, srgb, scale) {
  const grow = Math.max(0, 3 / scale - 1);
  for (const { area: [x0, y0, x1, y1], xyz, label } of frames) {
    const colour = label ? lineColour(xyz, srgb, true) : "#fff", size = 13 / scale;
    for (const [width, style] of [[4, "#000"], [2, colour]]) {
      context.lineWidth = width / scale; context.strokeStyle = style;
      context.strokeRect(x0 - grow, y0 - grow, x1 - x0 + 1 + 2 * grow, y1 - y0 + 1 + 2 * grow);
    }
    if (!label) continue;
    context.font = `600 ${size}px system-ui, sans-serif`;
    context.lineWidth = 3 / scale; context.strokeStyle = "#000"; context.fillStyle = colour;
    context.strokeText(label, x1 + 1 + grow + 4 / scale, y0 + size / 2);
    context.fillText(label, x1 + 1 + grow + 4 / scale, y0 + size / 2);
  }
}

/// The values of the areas in `curves`, one column for each.
function valueTable(curves) {
  const cell = value => value == null ? "unknown" : short(value);
  const row = (name, of) => `<tr><th scope="row">${name}</th>${curves.map(curve => `<td>${of(curve)}</td>`).join("")}</tr>`;
  return "<table>" + row("pixels", c => colourKey(c) + (c.name ?? "") + pixelText(c.area)) +
    row("Y in cd/m²", c => cell(c.xyz[1])) + row("X, Z", c => `${cell(c.xyz[0])}, ${cell(c.xyz[2])}`) +
    row("x, y", xyText) +
    row("noise of Y in cd/m²", c => cell(c.noise)) + row("bias of Y in cd/m²", c => cell(c.bias)) +
    row("95 % interval of Y", intervalText) + "</table>";
}

/// Returns a path of lines of four numbers each.
function linePath(numbers) {
  const path = new Path2D();
  for (let i = 0; i < numbers.length; i += 4) { path.moveTo(numbers[i], numbers[i + 1]); path.lineTo(numbers[i + 2], numbers[i + 3]); }
  return path;
}

/// Paints photon paths by colour over a picture. `scale` is the number of screen pixels per picture
/// pixel.
function paintPaths(context, paths, { width, height }, scale) {
  // The darker picture lets the lines stand out.
  context.fillStyle = "rgb(0 0 0 / 55%)";
  context.fillRect(0, 0, width, height);
  context.globalAlpha = 0.45;
  context.lineWidth = 1 / scale;
  context.globalCompositeOperation = "lighter";
  for (const [style, path] of paths) { context.strokeStyle = style; context.stroke(path); }
  context.globalAlpha = 1;
  context.globalCompositeOperation = "source-over";
}
