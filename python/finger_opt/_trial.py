"""One simulated insertion."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._call import checked, given, without, wrong
from ._drawn import COLOURS, WORDS, framed
from ._evaluation import Subject
from ._plot import axes as axes_of, text
from ._result import DRAWN, Result, equal, suffixed
from ._task import Given, sources
from ._words import Engine, FingerModel, Numbers, Outcome, RobotName, SpaceName, Start, StrPath

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
    def of(cls, columns: dict[str, bytes]) -> Series:
        """Of columns of little-endian float64."""
        found = {name: np.frombuffer(column, dtype="<f8") for name, column in columns.items()}
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

    def __eq__(self, other: object) -> bool:
        return equal(self, other)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the contact force over time, with the phases; gives the axes."""
        return _force(self, ax)

    def replay(self) -> Film:
        """The film of the trial, which a notebook plays; of a trial made with ``film=True``."""
        if self.film is None:
            raise _native.InputError("replay: needs a trial that was made with film=True")
        return Film(self.film)

    def _repr_html_(self) -> str:
        return super()._repr_html_() if self.film is None else self.replay()._repr_html_()


def _force(trial: Trial, ax: Drawing | None) -> Drawing:
    """The contact force over time; a stroke where a phase ends."""
    axes = axes_of(ax)
    series = trial.series
    line = axes.plot(series.time_s, np.linalg.norm(series.force_n, axis=1), color=COLOURS[0], linewidth=1.0)[0]
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


@checked
def trial(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    offset_mm: float = 0.0,
    *,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
    every_s: float = 0.001,
    repeat: int | None = None,
    repeat_seed: int | None = None,
    film: bool = False,
    record: StrPath | None = None,
    plot: StrPath | None = None,
    svg: StrPath | None = None,
    log: StrPath | None = None,
    probe: bool = False,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
) -> Trial:
    """Simulates one insertion, as ``optimize trial`` does, and samples its course.

    >>> import finger_opt as fo
    >>> found = fo.trial("usb", density=20, direction=10, offset_mm=0.5)
    >>> found.outcome, found.series.force_n.shape[1]
    ('inserted', 3)

    Args:
        offset_mm: Shift of the start along y, mm.
        every_s: Simulated time between two samples of the series, s.
        repeat: How often to repeat it, with friction, start and time step varied.
        repeat_seed: Seed of the repeats.
        film: Make the film for :meth:`Trial.replay`, too.
        record: Write the course: ``.csv``, or ``.html`` for the film.
        plot: Write a picture of the forces, ``.svg``.
        svg: Write a picture of the phases, ``.svg``.
        log: Write force and pose as a robot's log, ``.csv``.
        probe: In place of the insertion slide over a flat face, which tells the friction to :func:`identify`.

    The rest, and what is raised, is as for :func:`evaluate`.
    """
    if probe:
        if log is None:
            raise wrong("probe", "needs log, the file to write")
        without("probe", "it is no insertion", repeat=repeat, svg=svg, record=record, plot=plot, film=film)
    suffixed(plot, ".svg")
    suffixed(svg, ".svg")
    text, columns, drawn = _native.trial(sources(task), **given(locals(), "task"))
    return Trial.from_json({**json.loads(text), "series": Series.of(columns), "film": drawn})
