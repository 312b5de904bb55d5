"""Reports: read-only records with the figures that the command line prints with `--json`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any, Callable, Optional

from . import _native


class Report(Mapping[str, Any]):
    """A record whose entries are attributes and items.

    >>> report = Report({"name": "N-BK7", "cauchy": {"a": 1.5046}})
    >>> report.cauchy.a == report["cauchy"]["a"]
    True
    >>> sorted(report)
    ['cauchy', 'name']
    """

    __slots__ = ("_entries",)

    def __init__(self, entries: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_entries", {name: _wrapped(value) for name, value in entries.items()})

    def __getitem__(self, name: str) -> Any:
        return self._entries[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._entries[name]
        except KeyError:
            raise AttributeError(f"the report has no entry {name!r}; it has {', '.join(self)}") from None

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError("a report cannot be changed")

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._entries]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({_plain(self)!r})"

    def __reduce__(self) -> tuple[Any, ...]:
        return (type(self), (_plain(self),))

    def to_dict(self) -> dict[str, Any]:
        """Returns the entries as plain dictionaries and lists."""
        plain: dict[str, Any] = _plain(self)
        return plain

    def to_json(self) -> str:
        """Returns the entries as JSON text."""
        return json.dumps(self.to_dict(), indent=2)


def _wrapped(value: Any) -> Any:
    if isinstance(value, Mapping):
        return Report(value)
    if isinstance(value, list):
        return [_wrapped(item) for item in value]
    return value


def _plain(value: Any) -> Any:
    if isinstance(value, Report):
        return {name: _plain(item) for name, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value


def finished_report(task: _native.ReportTask, progress: Optional[Callable[[str], object]] = None) -> str:
    """Waits for the report of a task. `progress` receives the name of each step."""
    try:
        while True:
            ended, text = task.next_event()
            if ended and text is not None:
                return text
            if ended:
                raise KeyboardInterrupt
            if progress is not None and text is not None:
                progress(text)
    except BaseException:
        task.stop()
        raise
