"""Spectra."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal, Optional, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._report import Report
from ._scene import to_json

if TYPE_CHECKING:
    import colour

Role = Literal["light", "reflectance"]


class ColourReport(Report):
    """A colour. Its attributes are those of `abbe spectrum --json`."""

    __slots__ = ()

    name: str
    observer: str
    #: X, Y and Z. A light and the perfect diffuser have Y = 100.
    xyz: list[float]
    xy: list[float]
    linear_srgb: list[float]
    srgb_hex: str
    dominant_nm: Optional[float]
    cct_k: Optional[float]
    duv: Optional[float]
    #: The general colour rendering index.
    ra: Optional[float]
    #: The colour rendition of TM-30: `rf`, `rg`, `rf_bins`, `chroma_shift_percent` and `hue_shift`.
    tm30: Optional[Report]
    #: The melanopic daylight efficacy ratio (CIE S 026).
    melanopic_ratio: Optional[float]
    efficacy_lm_per_w: Optional[float]


class Spectrum:
    """A light, or a reflectance, as a function of wavelength.

    `value` is a name of the library (see `spectra`), a file, a colour such as ``"#ff8800"``, a
    number, or the form of a spectrum in a scene file. A `Spectrum` may stand in the dictionary of a
    scene wherever the scene file allows a spectrum.

    >>> import abbe
    >>> round(abbe.Spectrum("D65").colour().cct_k)
    6503
    >>> sodium = abbe.Spectrum.from_lines({589.0: 2, 589.6: 1})
    >>> sodium.scene
    {'lines': [{'nm': 589.0, 'power': 2.0}, {'nm': 589.6, 'power': 1.0}]}
    """

    def __init__(
        self, value: Union[str, float, os.PathLike[str], Mapping[str, Any], Spectrum], role: Role = "light"
    ) -> None:
        form: Any = value.scene if isinstance(value, Spectrum) else value
        if isinstance(form, os.PathLike):
            form = os.fspath(form)
        text = form if isinstance(form, str) else to_json(form)
        self._native = _native.Spectrum(text, role)
        self._role: Role = role
        if self._native.origin == "read from this file":
            form = {"file": os.path.abspath(form)}
        self._form = json.loads(to_json(form))

    @classmethod
    def from_table(cls, nm: ArrayLike, values: ArrayLike, role: Role = "light") -> Spectrum:
        """Returns the spectrum that interpolates between values at rising wavelengths in nm."""
        table = {"nm": np.asarray(nm, dtype=float).tolist(), "values": np.asarray(values, dtype=float).tolist()}
        return cls({"table": table}, role)

    @classmethod
    def from_lines(cls, powers: Mapping[float, float]) -> Spectrum:
        """Returns the light with these spectral lines: the power of each wavelength in nm."""
        return cls({"lines": [{"nm": float(nm), "power": float(power)} for nm, power in powers.items()]})

    @classmethod
    def blackbody(cls, temperature: float) -> Spectrum:
        """Returns the light of a black body; `temperature` is in K."""
        return cls({"blackbody": {"temperature": float(temperature)}})

    @classmethod
    def from_colour(cls, distribution: colour.SpectralDistribution, role: Role = "light") -> Spectrum:
        """Returns the spectrum of a `SpectralDistribution` of colour-science."""
        return cls.from_table(distribution.wavelengths, distribution.values, role)

    def to_colour(self, nm: Optional[ArrayLike] = None) -> colour.SpectralDistribution:
        """Returns a `SpectralDistribution` of colour-science, by default at 360, 361, … 830 nm.

        A spectral line becomes one value: its power divided by the interval of 1 nm. Use `lines`
        for the exact powers.
        """
        import colour

        if nm is None:
            wavelengths = np.arange(360.0, 831.0)
            values = self.means(np.arange(359.5, 831.0))
        else:
            wavelengths = np.asarray(nm, dtype=float)
            values = np.asarray(self(wavelengths))
        return colour.SpectralDistribution(values, wavelengths, name=self.name)

    @property
    def name(self) -> str:
        """The name in the library, or a description."""
        return self._native.name

    @property
    def origin(self) -> str:
        """The description and the source of the data."""
        return self._native.origin

    @property
    def role(self) -> Role:
        """``"light"`` or ``"reflectance"``."""
        return self._role

    @property
    def scene(self) -> Any:
        """The form of the spectrum in a scene file."""
        return self._form

    @property
    def lines(self) -> dict[float, float]:
        """The spectral lines: the power of each wavelength in nm."""
        return dict(self._native.lines())

    @overload
    def __call__(self, nm: float) -> float: ...
    @overload
    def __call__(self, nm: ArrayLike) -> Union[float, NDArray[np.float64]]: ...
    def __call__(self, nm: ArrayLike) -> Union[float, NDArray[np.float64]]:
        """Returns the values at one or more wavelengths in nm."""
        wavelengths = np.asarray(nm, dtype=np.float64)
        values = self._native.at(wavelengths.ravel().tolist()).reshape(wavelengths.shape)
        return float(values) if values.ndim == 0 else values

    def means(self, edges: ArrayLike) -> NDArray[np.float64]:
        """Returns the mean values between successive wavelengths in nm. Lines keep their powers."""
        limits = np.asarray(edges, dtype=np.float64)
        return self._native.means(limits.tolist())

    def integral(self) -> float:
        """Returns the integral over 360–830 nm."""
        return self._native.integral()

    def xyz(self, observer: str = "cie1931") -> NDArray[np.float64]:
        """Returns the integrals of the spectrum and the colour-matching functions, without scale."""
        return np.array(self._native.xyz(observer))

    def colour(self, observer: str = "cie1931", under: Union[str, Spectrum, None] = None) -> ColourReport:
        """Returns the colour of a light, or of a reflectance under a light.

        >>> import abbe
        >>> abbe.Spectrum("#ff8800", role="reflectance").colour(under="D65").srgb_hex
        '#ff8800'
        """
        if under is None and self._role == "reflectance":
            under = "D65"
        light = None if under is None else (under if isinstance(under, Spectrum) else Spectrum(under))._native
        return ColourReport(json.loads(self._native.report_json(observer, light)))

    def __reduce__(self) -> tuple[Any, ...]:
        return (Spectrum, (self._form, self._role))

    def __repr__(self) -> str:
        return f"abbe.Spectrum({self.name!r}, role={self._role!r})"


def spectra(kind: Optional[str] = None) -> list[str]:
    """Returns the names of the spectra in the library, of one kind (such as ``"light"``) or all."""
    return [name for name, of_kind, _ in _native.spectrum_names() if kind in (None, of_kind)]


def spectra_from_colour(
    distributions: Union[colour.MultiSpectralDistributions, Iterable[colour.SpectralDistribution]],
    role: Role = "light",
) -> dict[str, Spectrum]:
    """Returns the spectra of `MultiSpectralDistributions` of colour-science by their names."""
    to_list = getattr(distributions, "to_sds", None)
    single = to_list() if to_list is not None else distributions
    return {str(one.name): Spectrum.from_colour(one, role) for one in single}
