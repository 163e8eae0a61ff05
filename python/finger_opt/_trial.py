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
    """State at the end of a phase of the search: tip of the plug in the task frame, tilt, slip, and force so far."""

    name: str
    time_s: float
    tip_mm: tuple[float, float, float]
    tilt_deg: float
    slip_mm: float
    peak_force_n: float


@dataclass(frozen=True, eq=False)
class Series:
    """Time series of a trial from the start of the search, with ``n`` samples.

    Vectors are in the task frame: the origin is the middle of the socket's opening, and z points out of the socket.
    """

    #: Time, (n), s.
    time_s: Floats
    #: Index in the trial's ``phases``, (n).
    phase: NDArray[np.int64]
    #: Position of the tool centre point, (n, 3), mm.
    tcp_mm: Floats
    #: Position of the plug's tip, (n, 3), mm.
    tip_mm: Floats
    #: Angle between the plug's axis and z, (n), degrees.
    tilt_deg: Floats
    #: Force of the socket on the plug, (n, 3), N.
    force_n: Floats
    #: Slip in the grasp, (n), mm.
    slip_mm: Floats

    def __eq__(self, other: object) -> bool:
        return equal(self, other)

    @classmethod
    def of(cls, columns: Mapping[str, Any]) -> Series:
        """Creates the series from lists of numbers by field."""
        found = {name: np.asarray(column, dtype=np.float64) for name, column in columns.items()}
        shaped = {name: found[name].reshape(-1, 3) for name in ("tcp_mm", "tip_mm", "force_n")}
        rest = {name: found[name] for name in ("time_s", "tilt_deg", "slip_mm")}
        return cls(phase=found["phase"].astype(np.int64), **rest, **shaped)


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Trial(Subject):
    """One simulated insertion: outcome, ends of the phases, and time series as ``series``."""

    #: Shift of the start along y, mm.
    offset_mm: float
    outcome: Outcome
    #: Failure class, 1 to 4; ``None`` if it did not fail.
    failure: int | None = None
    #: Whether a protective stop of the robot ended the trial.
    robot_stopped: bool
    depth_mm: float
    tilt_deg: float
    peak_force_n: float
    slip_mm: float
    simulated_s: float
    retried_at_half_step: bool
    phases: tuple[PhaseEnd, ...]
    taught_start_mm: float | None = None
    #: Number of repeats by outcome; only with ``repeat``.
    repeats: dict[str, int] | None = None
    #: Number of draws of the cell's numbers that are impossible on this task, and left out; only with ``repeat``.
    impossible_draws: int | None = None
    series: Series = field(repr=False, metadata=DRAWN)
    #: Animation as an HTML page; only with ``film=True``.
    film: str | None = field(default=None, repr=False, metadata=DRAWN)

    @classmethod
    def from_json(cls, fields: Mapping[str, Any], picture: str | None = None) -> Trial:
        return super().from_json({**fields, "series": Series.of(fields["series"])}, picture)

    def __eq__(self, other: object) -> bool:
        return equal(self, other)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the contact force over time, with the phases; returns the axes."""
        return _force(self, ax)

    def replay(self) -> Film:
        """Returns the animation of the trial, which notebooks play; raises InputError without ``film=True``."""
        if self.film is None:
            raise InputError("replay: the trial has no film; simulate it with film=True")
        return Film(self.film)

    def _repr_html_(self) -> str:
        return super()._repr_html_() if self.film is None else self.replay()._repr_html_()


def _force(trial: Trial, ax: Drawing | None) -> Drawing:
    """Draws the contact force over time, with a line at the end of each phase; returns the axes."""
    axes = axes_of(ax)
    series = trial.series
    line = axes.plot(series.time_s, np.linalg.norm(series.force_n, axis=1), color=BLUE, linewidth=1.0)[0]
    # Margin above for the names of the phases, none below.
    line.sticky_edges.y.append(0.0)
    axes.margins(y=0.2)
    begin = float(series.time_s[0]) if len(series.time_s) else 0.0
    for phase in trial.phases:
        if phase.time_s > begin:
            axes.axvline(phase.time_s, color="0.7", linewidth=0.6)
            axes.text(phase.time_s, 0.98, phase.name, transform=axes.get_xaxis_transform(), rotation=90, ha="right",
                      va="top", fontsize=7, color="0.35")
    outcome = trial.outcome if trial.failure is None else WORDS[trial.failure]
    axes.set(xlabel="time, s", ylabel="force of the socket on the plug, N",
             title=f"{text(trial.task)}, start {trial.offset_mm:+g} mm: {outcome}")
    return axes


@dataclass(frozen=True)
class Film:
    """HTML page with the animation of a trial."""

    html: str = field(repr=False)

    def save(self, file: StrPath) -> None:
        """Writes the page to a file."""
        with open(file, "w", encoding="utf-8") as page:
            page.write(self.html)

    def _repr_html_(self) -> str:
        return framed(self.html)
