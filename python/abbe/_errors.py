"""The exceptions of the package."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

if TYPE_CHECKING:
    from ._picture import Picture


class Error(Exception):
    """An error of Abbe. The text is the text that the command line prints.

    `file`, `line`, `column` and `path` give the location of the fault. `path` is the JSON path in
    the scene, such as ``objects[3].shape.sphere.radius``. `suggestion` is a similar name that
    exists. Each of them is None if it is unknown.
    """

    def __init__(
        self,
        message: str,
        *,
        file: Optional[str] = None,
        line: Optional[int] = None,
        column: Optional[int] = None,
        path: Optional[str] = None,
        suggestion: Optional[str] = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.column = column
        self.path = path
        self.suggestion = suggestion


class InputError(Error, ValueError):
    """The input is wrong, for example the scene or an option."""


class MachineError(Error, RuntimeError):
    """The machine failed, for example because the disk is full."""


class Interrupted(KeyboardInterrupt):
    """Ctrl-C stopped a render. `picture` contains the passes that were done, at least one."""

    def __init__(self, picture: Picture) -> None:
        super().__init__(f"interrupted after {picture.passes} passes")
        self.picture = picture
