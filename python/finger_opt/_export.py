"""Files for the printer and for MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ._result import Result


@dataclass(frozen=True, repr=False)
class Files(Result):
    """Files that were written: the one asked for, and what belongs beside it."""

    out: str
    beside: tuple[str, ...] = ()
    title: str | None = None
    task: str | None = None

    @property
    def paths(self) -> tuple[Path, ...]:
        """All of them."""
        return tuple(Path(file) for file in (self.out, *self.beside))
