"""Ctrl-C during a render."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import abbe


@pytest.fixture(autouse=True)
def handled_interrupts() -> Iterator[None]:
    """Handles Ctrl-C as usual, also where the shell that started the tests ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def interrupt_after(seconds: float) -> threading.Timer:
    timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def test_ctrl_c_keeps_the_passes_and_saves_a_checkpoint(scene: dict[str, Any], tmp_path: Path) -> None:
    checkpoint = tmp_path / "run.exr"
    interrupt_after(0.5)
    with pytest.raises(abbe.Interrupted) as caught:
        abbe.render(scene, passes=10**9, time=60, checkpoint=checkpoint)
    picture = caught.value.picture
    assert isinstance(caught.value, KeyboardInterrupt)
    assert picture.interrupted and picture.passes > 0
    assert np.array_equal(picture.xyz, abbe.render(scene, passes=picture.passes).xyz)
    assert abbe.read(checkpoint).passes == picture.passes


def test_ctrl_c_during_the_iterator(scene: dict[str, Any]) -> None:
    interrupt_after(0.5)
    last = None
    with pytest.raises(KeyboardInterrupt):
        for last in abbe.passes(scene, passes=10**9, time=60):
            pass
    assert last is not None and last.passes > 0


@pytest.mark.parametrize("integrator", ["photon", "path"])
def test_ctrl_c_does_not_wait_for_a_pass(scene: dict[str, Any], tmp_path: Path, integrator: Any) -> None:
    """A pass of this picture takes more than ten seconds."""
    checkpoint = tmp_path / "run.exr"
    changes = {"film.width": 1920, "film.height": 1080, "render.photons": 10**6, "render.camera_samples": 256}
    assert_ends_soon(lambda: abbe.render(scene, set=changes, passes=1, integrator=integrator, checkpoint=checkpoint))
    # There is no whole pass to keep.
    assert not checkpoint.exists()


def test_ctrl_c_stops_a_measurement_within_a_pass(scene: dict[str, Any]) -> None:
    meters = [{"name": "desk", "quantity": "illuminance", "points": [[0, 0, 0]]}]
    assert_ends_soon(lambda: abbe.measure({**scene, "meters": meters}, photons=10**8, passes=64))


def assert_ends_soon(render: Callable[[], object]) -> None:
    """Interrupts a long call soon after its start, and checks that it ends within two seconds."""
    interrupt_after(0.25)
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt) as caught:
        render()
    assert not isinstance(caught.value, abbe.Interrupted)
    assert time.monotonic() - start < 2.25


def test_other_threads_run_during_a_render(scene: dict[str, Any]) -> None:
    ticks = 0
    done = threading.Event()

    def count() -> None:
        nonlocal ticks
        while not done.wait(0.005):
            ticks += 1

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    abbe.render(scene, time=0.5)
    elapsed = time.monotonic() - start
    done.set()
    thread.join()
    assert ticks > 0.2 * elapsed / 0.005, f"{ticks} ticks in {elapsed:.2f} s"


def test_renders_run_in_several_threads(scene: dict[str, Any]) -> None:
    pictures: list[abbe.Picture] = []
    work = [threading.Thread(target=lambda: pictures.append(abbe.render(scene, passes=3))) for _ in range(4)]
    for thread in work:
        thread.start()
    for thread in work:
        thread.join()
    assert len(pictures) == 4 and len({picture.xyz.tobytes() for picture in pictures}) == 1


def test_ctrl_c_stops_the_command_line(scene: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(scene))
    words = [sys.executable, "-m", "abbe", "render", str(path), "--passes", "1000000000", "-o", str(tmp_path / "a.exr")]
    process = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130 and "--resume" in errors
    assert (tmp_path / "a.checkpoint.exr").exists()
