"""Scenes as arguments: a path, or the JSON structure of a scene file."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any, Optional, Union

import numpy as np

from ._errors import InputError

#: A scene: the path of a scene file, or the content of a scene file as a dictionary.
Scene = Union[str, "os.PathLike[str]", Mapping[str, Any]]


def to_json(value: Any) -> str:
    """Returns JSON text. Spectra, numpy values and paths become their JSON forms."""
    try:
        return json.dumps(value, default=_json_form, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise InputError(f"the value cannot be written as JSON: {error}") from None


def _json_form(value: Any) -> Any:
    form = getattr(value, "scene", None)
    if form is not None:
        return form
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"{type(value).__name__} has no JSON form")


def scene_arguments(
    scene: Scene,
    changes: Optional[Mapping[str, Any]],
    folder: Optional[Union[str, os.PathLike[str]]],
    allow_outside: bool,
) -> dict[str, Any]:
    """Returns the scene in the form of the native module."""
    if isinstance(scene, Mapping):
        text: Optional[str] = to_json(scene)
        path = os.path.join(os.fspath(folder), "scene") if folder is not None else "scene"
    elif isinstance(scene, (str, os.PathLike)):
        if folder is not None:
            raise InputError("a folder for a scene file; expected a folder only for a scene given as a dictionary")
        text, path = None, os.fspath(scene)
    else:
        raise TypeError(f"a scene is a path or a dictionary, not {type(scene).__name__}")
    sets = [f"{key}={to_json(value)}" for key, value in (changes or {}).items()]
    return {"text": text, "path": path, "changes": sets, "allow_outside": allow_outside}
