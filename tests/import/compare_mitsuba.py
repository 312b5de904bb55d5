"""Compares Abbe's pictures of Mitsuba scenes with Mitsuba's own pictures.

Renders each scene of tests/import/mitsuba with both programs, and prints the differences of the
luminance: of the whole picture, and the largest one of 6 x 4 regions, in percent of the region's
luminance in Mitsuba's picture. A region darker than 2 % of the picture's mean luminance is compared
with this luminance instead. "colour" is the largest difference of red, green or blue of the whole
picture, in percent of the luminance.

The scenes of tests/import/pbrt are translations of Mitsuba scenes with the same names. Abbe's picture
of such a scene is compared with Mitsuba's picture of the original.

Run it by hand, with Mitsuba 3 in a virtual environment:

    python3 -m venv /tmp/mitsuba && /tmp/mitsuba/bin/pip install mitsuba numpy
    cargo build --release
    /tmp/mitsuba/bin/python tests/import/compare_mitsuba.py target/release/abbe [scene ...]

Options: --samples N (samples per pixel of Mitsuba, default 1024), --passes N (passes of Abbe,
default 96), --keep FOLDER (keep the pictures), --sheet FILE.png (write a sheet of all pictures:
Mitsuba's on the left and Abbe's on the right of each pair).
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

import mitsuba
import numpy

SCENES = pathlib.Path(__file__).parent / "mitsuba"
PBRT_SCENES = pathlib.Path(__file__).parent / "pbrt"
REGIONS = (4, 6)
LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722])


def of_mitsuba(path, samples):
    """Returns Mitsuba's picture."""
    return numpy.array(mitsuba.render(mitsuba.load_file(str(path)), spp=samples))[..., :3]


def of_abbe(program, path, output, passes):
    """Returns Abbe's picture and the notes of the import."""
    command = [program, "render", str(path), "--passes", str(passes), "-o", str(output)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{path.name}: {done.stderr}")
    bitmap = mitsuba.Bitmap(str(output))
    names = [field.name for field in bitmap.struct_()]
    picture = numpy.array(bitmap).reshape(bitmap.height(), bitmap.width(), -1)
    colours = [picture[..., names.index(name)] for name in ("R", "G", "B")]
    return numpy.stack(colours, -1), [line for line in done.stderr.splitlines() if line.startswith("note:")]


def regions(picture):
    """Returns the mean luminance of each region."""
    rows, columns = REGIONS
    luminance = picture @ LUMINANCE
    parts = [numpy.array_split(row, columns, 1) for row in numpy.array_split(luminance, rows, 0)]
    return numpy.array([[part.mean() for part in row] for row in parts])


def write_sheet(path, pairs, columns=3):
    """Writes pairs of pictures side by side. Both pictures of a pair have the same exposure."""
    scale = 2

    def shown(pair):
        white = numpy.percentile(pair[0] @ LUMINANCE, 98)
        linear = numpy.clip(numpy.concatenate(pair, 1) / white, 0, 1)
        encoded = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
        return encoded.repeat(scale, 0).repeat(scale, 1)

    cells = [numpy.pad(shown(pair), ((4, 4), (4, 4), (0, 0)), constant_values=1) for pair in pairs]
    cells += [numpy.ones_like(cells[0])] * (-len(cells) % columns)
    rows = [numpy.concatenate(cells[i : i + columns], 1) for i in range(0, len(cells), columns)]
    picture = (255 * numpy.concatenate(rows, 0) + 0.5).astype(numpy.uint8)
    mitsuba.Bitmap(picture).write(str(path))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--passes", type=int, default=96)
    parser.add_argument("--keep", type=pathlib.Path)
    parser.add_argument("--sheet", type=pathlib.Path)
    options = parser.parse_args()
    mitsuba.set_variant("scalar_spectral")
    mitsuba.set_log_level(mitsuba.LogLevel.Error)
    found = sorted(path for path in SCENES.glob("*.xml") if "<scene" in path.read_text())
    found += sorted(PBRT_SCENES.glob("*.pbrt"))
    chosen = [path for path in found if not options.scenes or path.stem in options.scenes]
    expected_pictures, pairs = {}, []
    print(f"{'scene':18} {'luminance':>10} {'Abbe':>10} {'mean':>8} {'region':>8} {'colour':>8}   worst region (row, column)")
    with tempfile.TemporaryDirectory() as folder:
        folder = options.keep or pathlib.Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        for path in chosen:
            start = time.time()
            if path.stem not in expected_pictures:
                original = SCENES / f"{path.stem}.xml"
                expected_pictures[path.stem] = of_mitsuba(original, options.samples)
            expected = expected_pictures[path.stem]
            middle = time.time()
            picture, notes = of_abbe(options.program, path, folder / f"{path.stem}.exr", options.passes)
            mitsuba.Bitmap(expected.astype(numpy.float32)).write(str(folder / f"{path.stem}.mitsuba.exr"))
            pairs.append((expected, picture))
            a, b = regions(expected), regions(picture)
            mean = (expected @ LUMINANCE).mean()
            error = (b - a) / numpy.maximum(a, 0.02 * mean)
            worst = numpy.unravel_index(numpy.abs(error).argmax(), error.shape)
            colour = ((picture - expected).mean((0, 1)) / mean)
            colour = colour[numpy.abs(colour).argmax()]
            whole = (picture @ LUMINANCE).mean()
            print(
                f"{path.name:18} {mean:10.5f} {whole:10.5f} {100 * (whole / mean - 1):+7.2f}% {100 * error[worst]:+7.2f}% "
                f"{100 * colour:+7.2f}%   {int(worst[0])}, {int(worst[1])}   "
                f"({middle - start:.0f} s, {time.time() - middle:.0f} s)",
                flush=True,
            )
            for note in notes:
                print(f"    {note}", flush=True)
    if options.sheet:
        write_sheet(options.sheet, pairs)


if __name__ == "__main__":
    main()
