"""One simulated insertion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._drawn import BLUE, WORDS, framed
from ._evaluation import Subject
from ._native import InputError
from ._plot import axes as axes_of, text
from ._result import DRAWN, Result, equal
from ._words import Outcome, StrPath

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing

Floats = NDArray[np.float64]


@dataclass(frozen=True, repr=False)
class PhaseEnd(Result):
    """The end of a phase of the search: the plug's tip in the task frame, mm."""

    name: str
    time_s: float
    tip_mm: tuple[float, float, float]
    tilt_deg: float
    slip_mm: float
    peak_force_n: float


@dataclass(frozen=True, eq=False)
class Series:
    """The course of a trial from the start of the search on, in the task frame: its origin is the middle of the
    socket's opening, z points out of it. ``n`` samples."""

    #: (n), s.
    time_s: Floats
    #: (n), place among the trial's ``phases``.
    phase: NDArray[np.int64]
    #: (n, 3), mm.
    tcp_mm: Floats
    #: (n, 3), of the plug's tip, mm.
    tip_mm: Floats
    #: (n), between the plug's axis and z, degrees.
    tilt_deg: Floats
    #: (n, 3), of the socket on the plug, N.
    force_n: Floats
    #: (n), in the grasp, mm.
    slip_mm: Floats

    def __eq__(self, other: object) -> bool:
        return equal(self, other)

    @classmethod
    def of(cls, columns: Mapping[str, Any]) -> Series:
        """Of lists of numbers."""
        found = {name: np.asarray(column, dtype=np.float64) for name, column in columns.items()}
        shaped = {name: found[name].reshape(-1, 3) for name in ("tcp_mm", "tip_mm", "force_n")}
        rest = {name: found[name] for name in ("time_s", "tilt_deg", "slip_mm")}
        return cls(phase=found["phase"].astype(np.int64), **rest, **shaped)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Trial(Subject):
    """One simulated insertion: how it ended, how its phases ended, and its course as ``series``."""

    #: Shift of the start along y, mm.
    offset_mm: float
    outcome: Outcome
    #: The class, 1 to 4, of what failed.
    failure: int | None = None
    depth_mm: float
    tilt_deg: float
    peak_force_n: float
    slip_mm: float
    simulated_s: float
    retried_at_half_step: bool
    phases: tuple[PhaseEnd, ...]
    taught_start_mm: float | None = None
    #: With ``repeat``: how many ended so.
    repeats: dict[str, int] | None = None
    series: Series = field(repr=False, metadata=DRAWN)
    #: The film as HTML, if it was asked for.
    film: str | None = field(default=None, repr=False, metadata=DRAWN)

    @classmethod
    def from_json(cls, fields: Mapping[str, Any], picture: str | None = None) -> Trial:
        return super().from_json({**fields, "series": Series.of(fields["series"])}, picture)

    def __eq__(self, other: object) -> bool:
        return equal(self, other)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the contact force over time, with the phases; gives the axes."""
        return _force(self, ax)

    def replay(self) -> Film:
        """The film of the trial, which a notebook plays; of a trial made with ``film=True``."""
        if self.film is None:
            raise InputError("replay: needs a trial that was made with film=True")
        return Film(self.film)

    def _repr_html_(self) -> str:
        return super()._repr_html_() if self.film is None else self.replay()._repr_html_()


def _force(trial: Trial, ax: Drawing | None) -> Drawing:
    """The contact force over time; a stroke where a phase ends."""
    axes = axes_of(ax)
    series = trial.series
    line = axes.plot(series.time_s, np.linalg.norm(series.force_n, axis=1), color=BLUE, linewidth=1.0)[0]
    # Room above for the names of the phases, none below.
    line.sticky_edges.y.append(0.0)
    axes.margins(y=0.2)
    begin = float(series.time_s[0]) if len(series.time_s) else 0.0
    for phase in trial.phases:
        if phase.time_s > begin:
            axes.axvline(phase.time_s, color="0.7", linewidth=0.6)
            axes.text(phase.time_s, 0.98, phase.name, transform=axes.get_xaxis_transform(), rotation=90, ha="right", va="top",
                      fontsize=7, color="0.35")
    outcome = trial.outcome if trial.failure is None else WORDS[trial.failure]
    axes.set(xlabel="time, s", ylabel="force of the socket on the plug, N",
             title=f"{text(trial.task)}, start {trial.offset_mm:+g} mm: {outcome}")
    return axes


@dataclass(frozen=True)
class Film:
    """A page that plays a trial."""

    html: str = field(repr=False)

    def save(self, file: StrPath) -> None:
        """Writes the page."""
        with open(file, "w", encoding="utf-8") as page:
            page.write(self.html)

    def _repr_html_(self) -> str:
        return framed(self.html)
