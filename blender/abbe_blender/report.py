# SPDX-License-Identifier: GPL-3.0-or-later
"""Collects by name what a conversion leaves out or changes. This module does not need Blender."""

from __future__ import annotations


class Report:
    """Sentences about the parts of a scene that Abbe's scene does not have, each of them once."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def missing(self, owner: str, what: str) -> None:
        """States that a setting of `owner`, such as "Light 'Key'", is not mapped."""
        self.add(f"{owner}: {what} is not mapped")

    def add(self, line: str) -> None:
        """Adds a sentence without its full stop."""
        if line not in self.lines:
            self.lines.append(line)

    def text(self) -> str:
        """Returns all sentences, one in each line."""
        return "".join(f"{line}\n" for line in self.lines)
