"""Files for the printer and for MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ._result import Result


@dataclass(frozen=True, repr=False)
class Files(Result):
    """Written files: ``out``, and the files that belong to it in the same folder."""

    out: str
    beside: tuple[str, ...] = ()
    title: str | None = None
    task: str | None = None

    @property
    def paths(self) -> tuple[Path, ...]:
        """Paths of all written files."""
        return tuple(Path(file) for file in (self.out, *self.beside))
