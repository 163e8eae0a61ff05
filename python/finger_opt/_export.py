"""Files for the printer and for MuJoCo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ._result import Result


@dataclass(frozen=True, repr=False)
class Files(Result):
    """Written file."""

    out: str
    title: str | None = None
    task: str | None = None

    @property
    def paths(self) -> tuple[Path, ...]:
        """Path of the written file."""
        return (Path(self.out),)
