"""Pictures with error bars."""

from __future__ import annotations

import json
import math
import os
import tempfile
from functools import cached_property
from typing import TYPE_CHECKING, Any, Optional, TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._errors import InputError
from ._report import Report

if TYPE_CHECKING:
    import colour
    import xarray

    from ._render import Progress

_Array = TypeVar("_Array", bound=NDArray[Any])


def _read_only(array: _Array) -> _Array:
    array.flags.writeable = False
    return array


class Picture:
    """A picture in absolute units, with an error estimate for every pixel.

    `render`, `passes` and `read` return pictures. All arrays are read-only. Pixels whose error is
    unknown have the error NaN. `progress` is the progress after the last pass if `passes` returned
    the picture before the end of the render, and None otherwise.
    """

    progress: Optional[Progress] = None

    def __init__(self, native: _native.Picture) -> None:
        self._native = native

    @property
    def width(self) -> int:
        """The number of columns."""
        return self._native.width

    @property
    def height(self) -> int:
        """The number of rows."""
        return self._native.height

    @cached_property
    def xyz(self) -> NDArray[np.float64]:
        """The CIE tristimulus values X, Y and Z, with the shape (rows, columns, 3). Y is in cd/m²."""
        return _read_only(self._native.xyz())

    @property
    def luminance(self) -> NDArray[np.float64]:
        """The luminance Y in cd/m², with the shape (rows, columns)."""
        return self.xyz[:, :, 1]

    @cached_property
    def rgb(self) -> NDArray[np.float64]:
        """Linear sRGB with the shape (rows, columns, 3). White of 1 cd/m² is (1, 1, 1).

        Colours outside the gamut have negative components.
        """
        return _read_only(self._native.linear_rgb())

    @cached_property
    def srgb(self) -> NDArray[np.uint8]:
        """The picture for a display: 8-bit sRGB with the exposure and the tone curve of the scene."""
        return _read_only(self._native.srgb())

    @cached_property
    def noise(self) -> NDArray[np.float32]:
        """The standard error of the luminance in cd/m², with the shape (rows, columns)."""
        return _read_only(self._native.noise())

    @cached_property
    def bias(self) -> NDArray[np.float32]:
        """The magnitude of the estimated bias of the luminance in cd/m²."""
        return _read_only(self._native.bias())

    @cached_property
    def edge(self) -> NDArray[np.bool_]:
        """True near an edge of the illumination, where the bias may be larger than estimated."""
        return _read_only(self._native.edge() > 0)

    @cached_property
    def stokes(self) -> NDArray[np.float32]:
        """The Stokes vector of each pixel in cd/m², with the shape (rows, columns, 4).

        S1 is positive for horizontal light, S2 at +45° counter-clockwise, and S3 for right-circular
        light. Raises `InputError` if the render did not store it; see the scene key `film.stokes`.
        """
        return _read_only(np.stack([self._stokes_layer(f"stokes.S{part}") for part in range(4)], axis=-1))

    @property
    def stokes_noise(self) -> NDArray[np.float32]:
        """The standard errors of S1, S2 and S3 in cd/m², with the shape (rows, columns, 3)."""
        return np.stack([self._stokes_layer(f"stokes.noise.S{part}") for part in range(1, 4)], axis=-1)

    @property
    def dop(self) -> NDArray[np.float32]:
        """The degree of polarisation from 0 to 1, without what noise adds to it."""
        return self._stokes_layer("polarisation.degree")

    def analyse(self, angle: float) -> NDArray[np.float64]:
        """Returns the luminance in cd/m² through an ideal polariser.

        The polariser passes light at `angle` degrees, counter-clockwise from the horizontal.
        """
        double = math.radians(2.0 * angle)
        s0, s1, s2, _ = np.moveaxis(self.stokes.astype(np.float64), -1, 0)
        passed: NDArray[np.float64] = 0.5 * (s0 + math.cos(double) * s1 + math.sin(double) * s2)
        return np.maximum(passed, 0.0)

    def _stokes_layer(self, name: str) -> NDArray[np.float32]:
        values = self._native.layer(name)
        if values is None:
            raise InputError("the picture has no Stokes vectors; expected a scene with film.stokes set to true")
        return values

    @property
    def denoised(self) -> Optional[Picture]:
        """The denoised picture with its own noise and bias.

        None if the render did not denoise, or has fewer than four passes.
        """
        native = self._native.denoised
        return None if native is None else Picture(native)

    def interval(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Returns the lower and the upper limit of the 95 % interval of the luminance in cd/m².

        The interval contains noise and bias. Unknown limits are NaN.
        """
        half = self._native.half_interval()
        return self.luminance - half, self.luminance + half

    @property
    def wavelengths(self) -> NDArray[np.float64]:
        """The centres of the spectral bands in nm."""
        wavelengths = self._native.wavelengths()
        if wavelengths is None:
            raise _no_bands()
        return wavelengths

    @cached_property
    def spectrum(self) -> NDArray[np.float32]:
        """The spectral radiance in W/m²/sr/nm, with the shape (rows, columns, bands).

        Raises `InputError` if the render stored no bands; see the option `spectral_bands`.
        """
        values = self._native.spectrum()
        if values is None:
            raise _no_bands()
        return _read_only(values)

    @property
    def typical_error(self) -> Optional[float]:
        """The error of a typical pixel: the root mean square of the relative errors of all pixels
        except the worst 2 %. `target_error` refers to it."""
        return self._native.typical_error

    @property
    def relative_error(self) -> Optional[float]:
        """The root mean square error of the picture: √mean(noise² + bias²) / mean luminance."""
        return self._native.relative_error

    @cached_property
    def stats(self) -> Report:
        """The statistics of the render, as `abbe render --stats` writes them.

        A picture from a file, or of an unfinished render, has no statistics, and the report is
        empty.
        """
        text = self._native.stats_json()
        return Report({} if text is None else json.loads(text))

    @cached_property
    def header(self) -> dict[str, str]:
        """The header of the EXR file: version, scene, plan, seed, passes and more."""
        return dict(self._native.metadata())

    @property
    def passes(self) -> int:
        """The number of passes."""
        return int(self.header.get("abbe.passes", "0"))

    @property
    def interrupted(self) -> bool:
        """True if the render was stopped before it was complete."""
        return self._native.interrupted

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes an EXR file (all data), or a PNG file (for a display), by the ending of the name."""
        name = os.fspath(path)
        ending = os.path.splitext(name)[1].lower()
        if ending == ".exr":
            self._native.write_exr(name)
        elif ending == ".png":
            self._native.write_png(name)
        else:
            raise InputError(f"the picture {name} is neither an EXR nor a PNG file; expected a name with .exr or .png")

    def _repr_png_(self) -> bytes:
        return self._native.png()

    def __repr__(self) -> str:
        error = "unknown error" if self.typical_error is None else f"error {100 * self.typical_error:.3g} %"
        return f"<abbe.Picture {self.width} × {self.height}, {self.passes} passes, {error}>"

    def __reduce__(self) -> tuple[Any, ...]:
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.exr")
            self.save(path)
            with open(path, "rb") as file:
                return (_from_exr, (file.read(),))

    def to_xarray(self) -> xarray.Dataset:
        """Returns the picture as a dataset of xarray, with named dimensions and units."""
        import xarray

        pixel = ("y", "x")
        data: dict[str, Any] = {
            "xyz": ((*pixel, "component"), self.xyz, {"units": "cd/m²", "long_name": "CIE XYZ"}),
            "noise": (pixel, self.noise, {"units": "cd/m²", "long_name": "standard error of Y"}),
            "bias": (pixel, self.bias, {"units": "cd/m²", "long_name": "bias of Y"}),
        }
        coordinates: dict[str, Any] = {
            "x": np.arange(self.width),
            "y": np.arange(self.height),
            "component": ["X", "Y", "Z"],
        }
        if self._native.wavelengths() is not None:
            data["spectrum"] = (
                (*pixel, "wavelength"),
                self.spectrum,
                {"units": "W/m²/sr/nm", "long_name": "spectral radiance"},
            )
            coordinates["wavelength"] = ("wavelength", self.wavelengths, {"units": "nm"})
        return xarray.Dataset(data, coords=coordinates, attrs={"passes": self.passes})

    def to_colour(self, x: int, y: int) -> colour.SpectralDistribution:
        """Returns the spectrum of the pixel in column `x` and row `y` for colour-science."""
        import colour

        values = self.spectrum[y, x].astype(np.float64)
        return colour.SpectralDistribution(values, self.wavelengths, name=f"pixel {x}, {y}")


def _no_bands() -> InputError:
    return InputError("the picture has no spectral bands; expected a render with spectral_bands, such as 47")


def _from_exr(data: bytes) -> Picture:
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "picture.exr")
        with open(path, "wb") as file:
            file.write(data)
        return read(path)


def read(path: Union[str, os.PathLike[str]]) -> Picture:
    """Reads the picture of an EXR file."""
    return Picture(_native.Picture.read(os.fspath(path)))
