# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts the layers of Abbe's EXR files to the passes of Blender."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .exr import Picture

#: The depth of pixels in which no surface is visible, as in Blender.
_FAR = 1e10
_PATHS = ("emission", "direct", "caustic", "indirect", "volume")


@dataclass(frozen=True)
class Pass:
    """A pass of Blender: its name, channels and kind of socket, and its channels in the EXR."""

    name: str
    letters: str
    kind: str
    channels: tuple[str, ...]
    #: True if the numbers are divided by the luminous efficacy.
    is_light: bool = False


COMBINED = Pass("Combined", "RGBA", "COLOR", ("R", "G", "B"), True)
_DENOISED = ("denoised.R", "denoised.G", "denoised.B")


def passes(scene: Any, layer: Any) -> list[Pass]:
    """Returns the passes of a view layer."""
    own = layer.abbe
    is_denoised = scene.abbe.combined == "DENOISED"
    found = [Pass("Combined", "RGBA", "COLOR", _DENOISED, True) if is_denoised else COMBINED]
    if layer.use_pass_z:
        found.append(Pass("Depth", "Z", "VALUE", ("depth.Z",)))
    if layer.use_pass_normal:
        found.append(Pass("Normal", "XYZ", "VECTOR", ("normal.X", "normal.Y", "normal.Z")))
    if own.use_pass_noise:
        found.append(Pass("Noise", "X", "VALUE", ("denoised.noise" if is_denoised else "error.noise",), True))
    if own.use_pass_bias:
        found.append(Pass("Bias", "X", "VALUE", ("denoised.bias" if is_denoised else "error.bias",), True))
    if own.use_pass_denoised:
        found.append(Pass("Denoised", "RGBA", "COLOR", _DENOISED, True))
    if own.use_pass_albedo:
        found.append(Pass("Albedo", "RGB", "COLOR", ("albedo.R", "albedo.G", "albedo.B")))
    if own.use_pass_paths:
        for name in _PATHS:
            channels = tuple(f"path.{name}.{letter}" for letter in "RGB")
            found.append(Pass(f"{name.capitalize()} Light", "RGB", "COLOR", channels, True))
    for kind, is_used in (
        ("Object", layer.use_pass_cryptomatte_object),
        ("Material", layer.use_pass_cryptomatte_material),
    ):
        if is_used:
            for level in range((layer.pass_cryptomatte_depth + 1) // 2):
                channels = tuple(f"Crypto{kind}{level:02}.{letter}" for letter in "RGBA")
                found.append(Pass(f"Crypto{kind}{level:02}", "RGBA", "COLOR", channels))
    return found


def region(scene: Any, picture: Picture, size: tuple[int, int]) -> tuple[slice, slice]:
    """Returns the rows from the bottom, and the columns, of the region that Blender renders.

    `size` is the width and the height of the region, which Blender computes with 32 bits.
    """
    render, corner = scene.render, (0, 0)
    if render.use_border:
        low = (render.border_min_x, render.border_min_y)
        corner = tuple(int(np.float32(edge) * np.float32(length)) for edge, length in zip(low, picture.size))
    (x, y), (width, height) = corner, size
    if x + width > picture.size[0] or y + height > picture.size[1]:
        raise ValueError(f"the picture has {picture.size} pixels, but Blender expects {size} from {corner}")
    return slice(y, y + height), slice(x, x + width)


def pixels(wanted: Pass, picture: Picture, efficacy: float, part: tuple[slice, slice]) -> Any:
    """Returns the numbers of a pass, row by row from the bottom, or None if they are unknown."""
    layers = [picture.channels.get(name) for name in wanted.channels]
    if any(layer is None for layer in layers):
        if not wanted.name.startswith("Crypto"):
            return None
        # Abbe writes as many levels of a Cryptomatte as some pixel needs; the others are empty.
        layers = [np.zeros((picture.size[1], picture.size[0]), np.float32)] * 4
    if wanted.is_light:
        # A negative error is a mark for an unknown error, and no number.
        marks = wanted.letters == "X"
        layers = [np.where(layer < 0.0, layer, layer / efficacy) if marks else layer / efficacy for layer in layers]
    if wanted.name == "Depth":
        layers = [np.where(np.isfinite(layer), layer, _FAR) for layer in layers]
    if wanted.letters == "RGBA" and len(layers) == 3:
        layers.append(np.ones_like(layers[0]))
    return np.ascontiguousarray(np.stack(layers, axis=-1)[::-1][part], np.float32).ravel()


def cryptomatte_fields(picture: Picture, layer_name: str) -> dict[str, str]:
    """Returns the attributes of the Cryptomatte specification, with Blender's names of layers."""
    fields = {name: picture.text(name) for name in picture.header if name.startswith("cryptomatte/")}
    return {name: f"{layer_name}.{text}" if name.endswith("/name") else text for name, text in fields.items()}
