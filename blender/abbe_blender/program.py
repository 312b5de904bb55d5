# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the program `abbe` in a process of its own. This module does not need Blender."""

from __future__ import annotations

import functools
import queue
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

_PROGRESS = re.compile(r"^(\d+)(?:/(\d+))? passes(.*)$")
#: The flag CREATE_NO_WINDOW of Windows.
_FLAGS = 0x08000000 if sys.platform == "win32" else 0


class ProgramError(Exception):
    """The program is missing or is not Abbe, or it refused a scene."""


def find(program: str) -> str:
    """Returns the path of the program. Raises ProgramError if there is no Abbe."""
    found = shutil.which(program)
    if found is None:
        raise ProgramError(f"the program '{program}' does not exist; set its path in the preferences of the add-on")
    if not version(found).startswith("abbe "):
        raise ProgramError(f"'{found}' is not Abbe; set the path of abbe in the preferences of the add-on")
    return found


@functools.cache
def version(program: str) -> str:
    """Returns the name and the version that a program prints."""
    return output(program, "--version").strip()


def output(program: str, *arguments: str) -> str:
    """Returns what a command prints. Raises ProgramError with the message of a failure."""
    try:
        done = subprocess.run(
            [program, *arguments],
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            check=False,
            creationflags=_FLAGS,
        )
    except OSError as error:
        raise ProgramError(f"'{program}' cannot be run: {error}") from error
    if done.returncode != 0:
        raise ProgramError(done.stderr.strip() or f"'{program}' ended with the status {done.returncode}")
    return done.stdout


@functools.cache
def names(program: str, command: str) -> tuple[tuple[str, str], ...]:
    """Returns the names and the descriptions that `abbe COMMAND --list` prints."""
    lines = output(program, command, "--list").splitlines()
    pairs = (re.split(r"\s{2,}", line.strip(), maxsplit=1) for line in lines if line.strip())
    return tuple((pair[0], pair[1] if len(pair) > 1 else "") for pair in pairs)


class Progress:
    """What a running render prints: finished passes, all passes if known, and the rest."""

    def __init__(self, done: int, total: int | None, rest: str) -> None:
        self.done, self.total, self.rest = done, total, rest


class Render:
    """A running `abbe render`. Iterate over `steps`; then read `notes`, `errors`, `status`."""

    def __init__(self, program: str, scene: Path, picture: Path, options: list[str]) -> None:
        self.picture = picture
        self.notes: list[str] = []
        self.errors: list[str] = []
        self.status: int | None = None
        command = [program, "render", str(scene), "-o", str(picture), *options]
        try:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                encoding="utf-8", errors="replace", creationflags=_FLAGS,
            )  # fmt: skip
        except OSError as error:
            raise ProgramError(f"'{program}' cannot be run: {error}") from error
        self._lines: queue.Queue[str | None] = queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self._lines.put(line.rstrip())
        self._lines.put(None)

    def stop(self) -> None:
        """Ends the program, which saves the finished passes. Does nothing if it has ended."""
        if self._process.poll() is None:
            self._process.terminate()

    def steps(self, seconds: float, is_cancelled: Callable[[], bool]) -> Iterator[Progress | None]:
        """Yields each progress, and None at least every `seconds` seconds, until the program ends.

        If `is_cancelled` returns true, the program saves the finished passes and ends.
        """
        stopped = False
        while True:
            try:
                line = self._lines.get(timeout=seconds)
            except queue.Empty:
                line = ""
            if not stopped and is_cancelled():
                stopped = True
                self.stop()
            if line is None:
                self.status = self._process.wait()
                return
            found = _PROGRESS.match(line)
            if found:
                yield Progress(int(found[1]), int(found[2]) if found[2] else None, found[3].strip(" ,"))
                continue
            if line.startswith("error: "):
                self.errors.append(line.removeprefix("error: "))
            elif line.startswith(("note: ", "warning: ")):
                self.notes.append(line)
            yield None
