// Conversion of XYZ to display codes, as `abbe render` converts them for its PNG file.

const KNEE = 0.6, DESATURATION = 0.03;

const apply = (m, a, b, c) => [m[0][0] * a + m[0][1] * b + m[0][2] * c, m[1][0] * a + m[1][1] * b + m[1][2] * c,
  m[2][0] * a + m[2][1] * b + m[2][2] * c];
const product = (p, q) => p.map(row => [0, 1, 2].map(j => row[0] * q[0][j] + row[1] * q[1][j] + row[2] * q[2][j]));
const inverse = m => {
  const [[a, b, c], [d, e, f], [g, h, i]] = m;
  const det = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
  return [[e * i - f * h, c * h - b * i, b * f - c * e], [f * g - d * i, a * i - c * g, c * d - a * f],
    [d * h - e * g, b * g - a * h, a * e - b * d]].map(row => row.map(value => value / det));
};
const AGX_IN = [[0.856627153315983, 0.0951212405381588, 0.0482516061458583],
  [0.137318972929847, 0.761241990602591, 0.101439036467562], [0.11189821299995, 0.0767994186031903, 0.811302368396859]];
const AGX_OUT = [[1.1271005818144368, -0.11060664309660323, -0.016493938717834573],
  [-0.1413297634984383, 1.157823702216272, -0.016493938717834257], [-0.14132976349843826, -0.11060664309660294, 1.2519364065950405]];
const AGX_CONTRAST = [-0.00232, 0.1191, 0.4298, -6.868, 31.96, -40.14, 15.5];
const agxCurve = value => {
  const ev = Math.min(4.026069, Math.max(-12.47393, Math.log2(Math.max(value, 1e-10))));
  const x = (ev + 12.47393) / 16.499999;
  return AGX_CONTRAST.reduceRight((sum, coefficient) => sum * x + coefficient, 0);
};

const compress = (rgb, peak, start, strength) => {
  const range = 1 - start, low = 1 - range * range / (peak + range - start);
  const saturation = 1 / (strength * (peak - low) + 1);
  for (let c = 0; c < 3; c++) rgb[c] = low * (saturation * rgb[c] / peak + 1 - saturation);
};
const TONES = {
  clip() {},
  roll_off(rgb) {
    const [r, g, b] = rgb, top = Math.max(r, g, b);
    if (!(top > 0)) return;
    const second = Math.max(Math.min(r, g), Math.min(Math.max(r, g), b), 0), least = Math.max(Math.min(r, g, b), 0);
    const peak = top * (1 + Math.pow(second / top, 8) * (1 - least / top) / 15);
    if (peak > KNEE) compress(rgb, peak, KNEE, DESATURATION);
  },
  pbr_neutral(rgb) {
    const least = Math.min(rgb[0], rgb[1], rgb[2]);
    const offset = least < 0.08 ? least - least * least / 0.16 : 0.04;
    for (let c = 0; c < 3; c++) rgb[c] -= offset;
    const peak = Math.max(rgb[0], rgb[1], rgb[2]);
    if (peak >= 0.76) compress(rgb, peak, 0.76, 0.15);
  },
  agx(rgb, space) {
    const into = space.agxIn, back = space.agxBack;
    let [r, g, b] = apply(into, rgb[0], rgb[1], rgb[2]).map(agxCurve);
    [r, g, b] = apply(AGX_OUT, r, g, b).map(value => Math.pow(Math.max(value, 0), 2.2));
    [rgb[0], rgb[1], rgb[2]] = apply(back, r, g, b);
  },
};

/// Prepares a colour space from the server for the conversion.
const prepareSpace = space => {
  const toXyz = inverse(space.own_matrix);
  return { ...space, toSrgb: product(space.srgb_matrix, toXyz), fromSrgb: product(space.own_matrix, inverse(space.srgb_matrix)),
    agxIn: product(AGX_IN, product(space.rec2020_matrix, toXyz)), agxBack: product(space.own_matrix, inverse(space.rec2020_matrix)) };
};

const unit = value => value > 0 ? Math.min(value, 1) : 0;
const clip = rgb => { for (let c = 0; c < 3; c++) rgb[c] = unit(rgb[c]); };
const isInside = rgb => rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0 && rgb[0] <= 1 && rgb[1] <= 1 && rgb[2] <= 1;
const OKLAB_CONES = [[0.4122214708, 0.5363325363, 0.0514459929], [0.2119034982, 0.6806995451, 0.1073969566],
  [0.0883024619, 0.2817188376, 0.6299787005]];
const OKLAB = [[0.2104542553, 0.793617785, -0.0040720468], [1.9779984951, -2.428592205, 0.4505937099],
  [0.0259040371, 0.7827717662, -0.808675766]];
const OKLAB_CONES_INVERSE = inverse(OKLAB_CONES), OKLAB_INVERSE = inverse(OKLAB);

/// Returns the place of a hue in the tables of a colour space, from 0 to 4.
const huePlace = (a, b) => b >= 0 ? (a >= 0 ? b / (a + b) : 1 + a / (a - b)) : (a < 0 ? 2 + b / (a + b) : 3 + a / (a - b));

/// Returns the function that compresses the chroma of linear components, or null if no colour of
/// the picture is outside the gamut. A saturation is the Oklab chroma divided by the lightness.
function chromaCompression(space, reach) {
  if (!(reach > 0)) return null;
  const { edge, rounded, locus } = space.hue_limits, hues = edge.length, knees = [], bends = [];
  for (let i = 0; i < hues; i++) {
    const farthest = edge[i] + reach * (locus[i] - edge[i]), shown = edge[i] - reach * (edge[i] - rounded[i]);
    knees[i] = 0.7 * shown;
    bends[i] = (farthest - shown) / ((shown - knees[i]) * (farthest - knees[i]));
  }
  const w = space.luminance_weights, luminance = rgb => w[0] * rgb[0] + w[1] * rgb[1] + w[2] * rgb[2];
  return rgb => {
    const y = luminance(rgb), [l, a, b] = apply(OKLAB, ...apply(OKLAB_CONES, ...apply(space.toSrgb, ...rgb)).map(Math.cbrt));
    const saturation = Math.hypot(a, b) / l;
    if (!(l > 0 && saturation > 0 && isFinite(saturation) && y > 0)) return;
    const place = huePlace(a, b) * hues / 4, node = Math.floor(place), fraction = place - node;
    const at = table => table[node % hues] + fraction * (table[(node + 1) % hues] - table[node % hues]);
    const excess = saturation - at(knees);
    if (excess <= 0) return;
    const share = Math.min(saturation - excess + excess / (1 + at(bends) * excess), at(edge)) / saturation;
    const mapped = apply(space.fromSrgb, ...apply(OKLAB_CONES_INVERSE,
      ...apply(OKLAB_INVERSE, l, share * a, share * b).map(root => root * root * root)));
    const scale = y / luminance(mapped);
    for (let c = 0; c < 3; c++) rgb[c] = scale * mapped[c];
  };
}

const GAMUTS = {
  clip,
  oklab(rgb, space) {
    if (isInside(rgb)) return;
    const [l, a, b] = apply(OKLAB, ...apply(OKLAB_CONES, ...apply(space.toSrgb, ...rgb)).map(Math.cbrt));
    const at = (light, share) => apply(space.fromSrgb, ...apply(OKLAB_CONES_INVERSE,
      ...apply(OKLAB_INVERSE, light, share * a, share * b).map(root => root * root * root)));
    let inside = 0, outside = 1;
    if (l > 0 && l < 1) {
      for (let i = 0; i < 20; i++) {
        const middle = 0.5 * (inside + outside);
        if (isInside(at(l, middle))) inside = middle; else outside = middle;
      }
    }
    at(unit(l), inside).forEach((value, c) => { rgb[c] = unit(value); });
  },
  compress: (rgb, space) => GAMUTS.desaturate(rgb, space),
  desaturate(rgb, space) {
    if (isInside(rgb)) return;
    const w = space.luminance_weights, y = w[0] * rgb[0] + w[1] * rgb[1] + w[2] * rgb[2], grey = unit(y);
    if (grey !== y) { rgb[0] = rgb[1] = rgb[2] = grey; return; }
    let share = 1;
    for (let c = 0; c < 3; c++) {
      if (rgb[c] < 0) share = Math.min(share, grey / (grey - rgb[c]));
      else if (rgb[c] > 1) share = Math.min(share, (1 - grey) / (rgb[c] - grey));
    }
    for (let c = 0; c < 3; c++) rgb[c] = unit(grey + share * (rgb[c] - grey));
  },
};

// sRGB codes of 65536 equal steps of a linear component. Display P3 has the same curve.
const CODES = Uint8Array.from({ length: 65536 }, (_, i) => {
  const v = i / 65535;
  return Math.round(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * Math.pow(v, 1 / 2.4) - 0.055));
});

/// Converts XYZ to the codes of an image. `factor` multiplies the luminance, in 1/(cd/m²).
/// `reaches` holds the reach of the chroma compression for each colour space.
function develop(xyz, codes, { space, tone, gamut, factor, reaches }) {
  const compress = gamut === "compress" ? chromaCompression(space, reaches[space.name]) : null;
  const m = space.matrix.map(row => row.map(value => value * factor));
  const [[a, b, c], [d, e, f], [g, h, k]] = m, rgb = new Float64Array(3), curve = TONES[tone], map = GAMUTS[gamut];
  for (let i = 0, j = 0; i < xyz.length; i += 3, j += 4) {
    const x = xyz[i], y = xyz[i + 1], z = xyz[i + 2];
    rgb[0] = a * x + b * y + c * z; rgb[1] = d * x + e * y + f * z; rgb[2] = g * x + h * y + k * z;
    if (compress) compress(rgb);
    curve(rgb, space); map(rgb, space);
    codes[j] = CODES[rgb[0] * 65535 + 0.5 | 0]; codes[j + 1] = CODES[rgb[1] * 65535 + 0.5 | 0];
    codes[j + 2] = CODES[rgb[2] * 65535 + 0.5 | 0]; codes[j + 3] = 255;
  }
}

/// Writes one value per pixel in one colour. `rgb` is linear.
function tint(values, codes, rgb, factor) {
  for (let i = 0, j = 0; i < values.length; i++, j += 4) {
    for (let c = 0; c < 3; c++) codes[j + c] = CODES[unit(values[i] * factor * rgb[c]) * 65535 + 0.5 | 0];
    codes[j + 3] = 255;
  }
}

// Viridis at nine equal steps.
const HEAT = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];

/// Writes the colour at a place on the scale, from 0 to 1.
function ramp(place, codes, j) {
  const t = 8 * unit(place), n = Math.min(7, t | 0), s = t - n;
  for (let c = 0; c < 3; c++) codes[j + c] = HEAT[n][c] + s * (HEAT[n + 1][c] - HEAT[n][c]);
  codes[j + 3] = 255;
}

/// Writes one value per pixel on a logarithmic colour scale. Unknown values are grey.
function heat(values, codes, low, high) {
  const start = Math.log(low), span = Math.log(high) - start;
  for (let i = 0, j = 0; i < values.length; i++, j += 4) {
    if (values[i] >= 0) ramp((Math.log(Math.max(values[i], 1e-30)) - start) / span, codes, j);
    else codes.fill(96, j, j + 3), codes[j + 3] = 255;
  }
}
