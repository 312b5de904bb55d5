// Plots and a table as texts, which contain only numbers and fixed words, and lines over a picture.

const PIN_COLOURS = ["#1c7ed6", "#e8590c", "#2b9a3e", "#ae3ec9", "#c92a2a", "#0c8599"];
const raised = power => String(power).replace(/./g, digit => digit === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[digit]);
const short = (value, digits = 3) => value === 0 ? "0" : Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3
  ? value.toExponential(digits - 1).replace(/e(.*)/, (_, power) => "·10" + raised(Number(power))) : String(Number(value.toPrecision(digits)));

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
  for (const { values, errors, colour, dash } of curves) {
    if (errors) {
      const high = steps(values.map((value, i) => value + 2 * errors[i]));
      const low = steps(values.map((value, i) => Math.max(0, value - 2 * errors[i]))).reverse();
      svg += `<path class="band" fill="${colour}" d="M${line(high)}L${line(low)}Z"/>`;
    }
    if (values.length) svg += `<path fill="none" stroke="${colour}" stroke-width="1.8" stroke-dasharray="${dash ?? "none"}" d="M${line(steps(values))}"/>`;
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
  for (const { xy, colour } of curves) {
    if (xy) svg += `<circle cx="${x(xy[0])}" cy="${y(xy[1])}" r="6" fill="${colour}" stroke="#fff" stroke-width="1.5"/>`;
  }
  const name = { srgb: "sRGB", "display-p3": "Display P3" }[space.name];
  return svg + `<text x="${x(0.42)}" y="512" text-anchor="middle">x (dashed: gamut of ${name}, ring: its white)</text><text x="14" y="${y(0.43)}">y</text></svg>`;
}

/// The values of the areas in `curves`, one column for each.
function valueTable(curves) {
  const cell = value => value == null ? "unknown" : short(value);
  const range = (from, to) => from === to ? `${from}` : `${from}–${to}`;
  const row = (name, of) => `<tr><th scope="row">${name}</th>${curves.map(curve => `<td>${of(curve)}</td>`).join("")}</tr>`;
  return "<table>" + row("pixels", c => `<span class="key" style="background:${c.colour}"></span>` + (c.name ?? "") +
      `${range(c.area[0], c.area[2])}, ${range(c.area[1], c.area[3])}`) +
    row("Y in cd/m²", c => cell(c.xyz[1])) + row("X, Z", c => `${cell(c.xyz[0])}, ${cell(c.xyz[2])}`) +
    row("x, y", c => c.xy ? c.xy.map(value => value.toFixed(4)).join(", ") : "–") +
    row("noise of Y in cd/m²", c => cell(c.noise)) + row("bias of Y in cd/m²", c => cell(c.bias)) +
    row("95 % interval of Y", c => c.interval_95 ? c.interval_95.map(value => short(value)).join(" … ") : "unknown") + "</table>";
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
