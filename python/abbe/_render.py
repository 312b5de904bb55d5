"""Renders."""

from __future__ import annotations

import datetime
import os
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Callable, Literal, NoReturn, Optional, Union

from . import _native
from ._errors import Interrupted
from ._picture import Picture
from ._scene import Scene, scene_arguments

_Path = Union[str, "os.PathLike[str]"]


@dataclass(frozen=True)
class Progress:
    """The progress of a render after a pass.

    `passes_wanted` is None if the number of passes is not limited. `typical_error`, the error of a
    typical pixel, and `relative_error`, the root mean square error of the picture, are None if they
    are not known yet.
    """

    passes: int
    passes_wanted: Optional[int]
    seconds: float
    relative_error: Optional[float]
    photons_per_second: float
    typical_error: Optional[float] = None

    def __str__(self) -> str:
        passes = f"{self.passes}" if self.passes_wanted is None else f"{self.passes} of {self.passes_wanted}"
        error = "" if self.typical_error is None else f", error {100 * self.typical_error:.3g} %"
        return f"{passes} passes, {self.seconds:.1f} s{error}"


#: True prints the progress on standard error. A function receives the progress after each pass.
ProgressSink = Union[bool, Callable[[Progress], object], None]


def render(
    scene: Scene,
    *,
    passes: Optional[int] = None,
    target_error: Optional[float] = None,
    time: Union[float, datetime.timedelta, None] = None,
    set: Optional[Mapping[str, Any]] = None,
    size: Optional[tuple[int, int]] = None,
    photons: Optional[int] = None,
    seed: Optional[int] = None,
    threads: Optional[int] = None,
    spectral_bands: Optional[int] = None,
    integrator: Literal["photon", "path"] = "photon",
    folder: Optional[_Path] = None,
    allow_outside: bool = False,
    checkpoint: Optional[_Path] = None,
    resume: bool = False,
    progress: ProgressSink = None,
) -> Picture:
    """Renders a scene, and returns the picture.

    `scene` is the path of a scene file, or the content of a scene file as a dictionary. A
    dictionary may contain numpy values and `Spectrum` objects. `folder` is the folder of the files
    that a dictionary names; the default is the working directory.

    The render stops as soon as one of these limits is reached: a number of `passes`, a `time` in
    seconds, or a relative `target_error` (0.02 means 2 %). Without a limit, the scene determines
    the number of passes. `set` changes values of the scene, such as ``{"film.width": 64}``. With
    the same scene, passes and seed, the picture has the same bits as the picture of `abbe render`.

    Ctrl-C discards the current pass, stops the render and raises `Interrupted`, whose attribute
    `picture` contains the passes before. Before the end of the first pass, it raises a plain
    `KeyboardInterrupt`. With a `checkpoint` (an EXR file), the passes are also
    saved about once per minute and at an interruption, and `resume` continues from this file if it
    exists. A complete render removes the file.

    Raises `InputError` if the scene or an option is wrong.
    """
    arguments = scene_arguments(scene, set, folder, allow_outside)
    options = _options(
        passes, target_error, time, size, photons, seed, threads, spectral_bands, integrator, checkpoint, resume
    )
    task = _native.RenderTask(arguments, options, False)
    report = _sink(progress)
    try:
        while True:
            state, native = task.next_event()
            if native is not None:
                return Picture(native)
            if report is not None and state is not None:
                report(Progress(*state))
    except KeyboardInterrupt:
        _interrupt(task)
    except BaseException:
        task.stop()
        raise
    finally:
        if progress is True:
            print(file=sys.stderr)


def passes(
    scene: Scene,
    *,
    passes: Optional[int] = None,
    target_error: Optional[float] = None,
    time: Union[float, datetime.timedelta, None] = None,
    set: Optional[Mapping[str, Any]] = None,
    size: Optional[tuple[int, int]] = None,
    photons: Optional[int] = None,
    seed: Optional[int] = None,
    threads: Optional[int] = None,
    spectral_bands: Optional[int] = None,
    integrator: Literal["photon", "path"] = "photon",
    folder: Optional[_Path] = None,
    allow_outside: bool = False,
    checkpoint: Optional[_Path] = None,
    resume: bool = False,
) -> Iterator[Picture]:
    """Renders a scene, and yields the picture so far after each pass.

    The arguments are those of `render`. The last picture is the picture that `render` returns. The
    next pass runs while the caller works on a picture. If the caller leaves the loop, the render
    stops and discards the current pass.

    A live picture in a notebook::

        from IPython.display import clear_output, display

        for picture in abbe.passes("prism.json", passes=32):
            clear_output(wait=True)
            display(picture)
    """
    arguments = scene_arguments(scene, set, folder, allow_outside)
    options = _options(
        passes, target_error, time, size, photons, seed, threads, spectral_bands, integrator, checkpoint, resume
    )
    return _pictures(_native.RenderTask(arguments, options, True), checkpoint is not None)


def _pictures(task: _native.RenderTask, has_checkpoint: bool) -> Iterator[Picture]:
    ended = False
    try:
        while not ended:
            try:
                state, native = task.next_event()
            except KeyboardInterrupt:
                ended = True
                _interrupt(task)
            except BaseException:
                ended = True
                raise
            ended = state is None
            if native is not None:
                picture = Picture(native)
                picture.progress = None if state is None else Progress(*state)
                yield picture
    finally:
        task.stop()
        if has_checkpoint and not ended:
            _last_picture(task)


def check(
    scene: Scene,
    *,
    set: Optional[Mapping[str, Any]] = None,
    folder: Optional[_Path] = None,
    allow_outside: bool = False,
) -> list[str]:
    """Checks a scene without rendering it, and returns notes such as approximated materials.

    Raises `InputError` if the scene cannot be rendered.
    """
    return _native.check_scene(scene_arguments(scene, set, folder, allow_outside))


def explain(
    scene: Scene,
    *,
    set: Optional[Mapping[str, Any]] = None,
    folder: Optional[_Path] = None,
    allow_outside: bool = False,
) -> str:
    """Describes in words which effects the renderer simulates for a scene, and why."""
    return _native.explain_scene(scene_arguments(scene, set, folder, allow_outside))


def _options(
    passes: Optional[int],
    target_error: Optional[float],
    time: Union[float, datetime.timedelta, None],
    size: Optional[tuple[int, int]],
    photons: Optional[int],
    seed: Optional[int],
    threads: Optional[int],
    spectral_bands: Optional[int],
    integrator: str,
    checkpoint: Optional[_Path],
    resume: bool,
) -> dict[str, Any]:
    return {
        "passes": passes,
        "seconds": time.total_seconds() if isinstance(time, datetime.timedelta) else time,
        "target_error": target_error,
        "integrator": integrator,
        "photons": photons,
        "size": size,
        "seed": seed,
        "threads": threads,
        "spectral_bands": spectral_bands,
        "checkpoint": None if checkpoint is None else os.fspath(checkpoint),
        "resume": resume,
    }


def _sink(progress: ProgressSink) -> Optional[Callable[[Progress], object]]:
    if progress is True:
        return lambda state: print(f"\r{state}  ", end="", file=sys.stderr, flush=True)
    if progress is None or progress is False:
        return None
    return progress


def _last_picture(task: _native.RenderTask) -> Picture:
    """Waits for the end of a stopped render."""
    while True:
        state, native = task.next_event()
        if state is None and native is not None:
            return Picture(native)


def _interrupt(task: _native.RenderTask) -> NoReturn:
    """Stops a render, and discards its current pass. Another Ctrl-C does not wait for the end."""
    task.stop()
    picture = _last_picture(task)
    if picture.passes == 0:
        raise KeyboardInterrupt from None
    raise Interrupted(picture) from None
