// A page that the reader takes along: one HTML file with the picture as it is shown, its spectra
// and the photon paths.

/// The largest numbers of cells with a spectrum, and of pixels of the picture. They bound the file.
const MOST_CELLS = 2 ** 14, MOST_PIXELS = 2 ** 20;

/// Returns the width of square cells in pixels of a picture.
function cellSize({ width, height }) {
  let size = 1;
  while (Math.ceil(width / size) * Math.ceil(height / size) > MOST_CELLS) size++;
  return size;
}

/// Returns the bytes of all cells: seven 32-bit numbers of each (X, Y, Z, noise, bias and upper end
/// of the 95 % interval of Y, and the scale of the spectrum), then the square roots of all values
/// in units of the scale, then those of their errors, in 8 bits each.
function packedCells(values, cells) {
  const each = values.length / cells, bands = (each - 6) / 2;
  const numbers = new Float32Array(7 * cells), radiance = new Uint8Array(bands * cells), errors = new Uint8Array(bands * cells);
  for (let cell = 0; cell < cells; cell++) {
    const at = cell * each, known = value => value > 0 ? value : 0, root = value => 255 * Math.sqrt(known(value) / scale);
    const scale = values.subarray(at + 6, at + each).reduce((most, value) => Math.max(most, known(value)), 0);
    numbers.set(values.subarray(at, at + 6), 7 * cell);
    numbers[7 * cell + 6] = scale;
    for (let band = 0; band < bands && scale > 0; band++) {
      radiance[cell * bands + band] = Math.round(root(values[at + 6 + band]));
      errors[cell * bands + band] = Math.ceil(root(values[at + 6 + bands + band]));
    }
  }
  return { bytes: new Blob([numbers, radiance, errors]), bands, hasErrors: bands > 0 && !isNaN(values[6 + bands]) };
}

async function base64(blob) {
  const reader = new FileReader();
  await new Promise((done, failed) => { reader.onload = done; reader.onerror = failed; reader.readAsDataURL(blob); });
  return reader.result.split(",")[1];
}

/// Returns the cells of the shown picture. While passes arrive, it may take two tries.
async function shownCells(size) {
  for (let tries = 0; tries < 30; tries++) {
    const found = await floats("cells?size=" + size);
    await draw();
    if (found.number === picture.number) return found;
    await new Promise(done => setTimeout(done, 50));
  }
  throw new Error("the picture changes too quickly; pause the render first");
}

/// Returns the shown picture as a `data:` address of at most `MOST_PIXELS` pixels.
function pictureData() {
  const shrink = Math.min(1, Math.sqrt(MOST_PIXELS / (image.width * image.height)));
  const copy = Object.assign(document.createElement("canvas"), { width: Math.round(image.width * shrink), height: Math.round(image.height * shrink) });
  copy.getContext("2d", { colorSpace: space().name }).drawImage(image, 0, 0, copy.width, copy.height);
  return copy.toDataURL("image/png");
}

/// Returns the text of the page.
async function exportedPage() {
  const template = new TextDecoder().decode((await get("export")).bytes);
  const size = cellSize(picture), found = await shownCells(size);
  const { width, height, passes } = picture, columns = Math.ceil(width / size), rows = Math.ceil(height / size);
  const { bytes, bands, hasErrors } = packedCells(found.values, columns * rows), { name, primaries_xy, white_xy } = space();
  const content = {
    title: $("title").textContent, file: scene.file,
    legend: $("legend").hidden || moveHint() ? "" : $("legend").textContent,
    width, height, passes, error: state.typical_error, picture: pictureData(),
    size, columns, rows, bands, hasErrors, light: scene.light, locus: scene.locus, space: { name, primaries_xy, white_xy },
    pins: pins.map(pin => pin.report), srgb: { own_matrix: spaces[0].own_matrix, luminance_weights: spaces[0].luminance_weights },
    paths: hasPhotons() ? { text: $("photon-text").textContent, byColour: [...photons.byColour] } : null,
    scene: scene.live ? JSON.stringify(scene.scene, null, 2) : null,
  };
  const packed = await new Response(bytes.stream().pipeThrough(new CompressionStream("gzip"))).blob();
  content.cells = await base64(packed);
  const mark = 'id="data">';
  return template.replace(mark, () => mark + JSON.stringify(content).replace(/</g, "\\u003c"));
}

async function exportPage() {
  const tell = text => { $("legend").textContent = text; $("legend").hidden = false; };
  if (!picture?.passes) { tell("The first pass is not done yet"); return; }
  $("export").disabled = true;
  try {
    download((scene.file ?? "picture").replace(/\.[^.]*$/, "") + ".html", "text/html", await exportedPage());
  } catch (error) {
    tell("No page: " + error.message);
  }
  $("export").disabled = false;
}
$("export").onclick = exportPage;
