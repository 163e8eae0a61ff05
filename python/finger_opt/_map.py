"""Capture maps, and levers: effects of other parameters on the window."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ._drawn import BLUE, COLOURS, WORDS, ending
from ._evaluation import Subject
from ._plot import axes as axes_of
from ._result import PICTURE, Result, equal

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing


@dataclass(frozen=True, repr=False)
class Axis(Result):
    """An axis of a map: from ``low`` to ``high`` by ``step``, in ``unit``."""

    name: str
    unit: str
    low: float
    high: float
    step: float


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CaptureMap(Subject):
    """Outcomes of insertions with one finger over two errors of the start.

    ``outcomes`` and ``simulated`` have a row for each value of the second axis and a column for each shift along y.
    An outcome is 0 if inserted, 1 to 4 for the failure class, -1 if the simulation diverged; outcomes that were not
    simulated are inferred from their neighbours.
    """

    design: dict[str, float]
    axes: tuple[Axis, Axis]
    outcomes: NDArray[np.int64] = field(repr=False)
    simulated: NDArray[np.bool_] = field(repr=False)
    trials: int
    #: Step along either axis at which the border of the inserting region was traced, in the unit of the axis.
    traced_step: float
    #: Area of the inserting region, in ``area_unit``.
    area: float
    area_unit: str
    taught_start_mm: float | None = None
    svg: str = field(repr=False, metadata=PICTURE)

    def __eq__(self, other: object) -> bool:
        return equal(self, other)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the outcomes; returns the axes."""
        return _outcomes(self, ax)

    def _repr_html_(self) -> str:
        return self.svg


def _outcomes(found: CaptureMap, ax: Drawing | None) -> Drawing:
    """Draws the outcomes over the two errors; returns the axes."""
    axes = axes_of(ax, height=4.2)
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    numbers = [-1, 0, 1, 2, 3, 4]
    colours = ListedColormap([COLOURS[number] for number in numbers])
    edges = [np.arange(axis.low - axis.step / 2, axis.high + axis.step, axis.step) for axis in found.axes]
    shape = found.outcomes.shape
    axes.pcolormesh(edges[0][: shape[1] + 1], edges[1][: shape[0] + 1], found.outcomes, cmap=colours,
                    norm=BoundaryNorm(np.arange(-1.5, 5.0), colours.N))
    met = [number for number in numbers if (found.outcomes == number).any()]
    handles = [Patch(color=COLOURS[number], label=ending(number) if number > 0 else WORDS[number]) for number in met]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    axes.plot(0, 0, "+", color="white", markersize=10)
    labels = [f"error of the start in {axis.name}, {axis.unit}" for axis in found.axes]
    axes.set(xlabel=labels[0], ylabel=labels[1],
             title=f"{found.task}: {found.area:.3g} {found.area_unit.replace('mm2', 'mm²')} insert")
    return axes


@dataclass(frozen=True, repr=False)
class Taught(Result):
    """Range of the finger without a change, mm, and shift of the taught start along y, mm."""

    range_mm: float | None
    taught_start_mm: float | None


@dataclass(frozen=True, repr=False)
class Lever(Result):
    """One parameter of task or cell, changed to ``low`` and to ``high`` (in ``unit``), with the range at both, mm
    (``None``: nothing inserts)."""

    name: str
    key: str
    unit: str
    #: Present value; the name if the parameter is the robot.
    value: float | str | None
    low: float | str | None
    high: float | str | None
    #: Source of ``low`` and ``high``.
    source: str
    range_mm: tuple[float | None, float | None]


@dataclass(frozen=True, repr=False)
class Levers(Result):
    """Levers: effects of parameters on the range of one finger, the largest first.

    ``infill_range_mm`` are the smallest and the largest range over infills, for comparison; ``base`` is the range
    without a change.
    """

    sentence: str
    #: Smallest ranges over parameters that a user does not set, in words; None if none of them narrows the window.
    uncertainty: str | None
    task: str
    design: dict[str, float]
    base: Taught
    infill_range_mm: tuple[float, float] | None
    levers: tuple[Lever, ...]
    #: Names of the levers that exceeded the limit on simulated windows.
    left_out: tuple[str, ...]
    #: Number of simulated windows.
    windows: int
    svg: str = field(default="", repr=False, metadata=PICTURE)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the ranges at both ends of each lever; returns the axes."""
        return _tornado(self, ax)

    def _repr_html_(self) -> str:
        return self.svg


def _tornado(found: Levers, ax: Drawing | None) -> Drawing:
    """Draws the ranges at both ends of each lever; returns the axes."""
    axes = axes_of(ax, width=7.4, height=4.2)
    base = found.base.range_mm or 0.0
    rows = list(reversed(found.levers))
    for y, lever in enumerate(rows):
        ends = zip(lever.range_mm, (lever.low, lever.high), (y + 0.2, y - 0.2), ("#9cc3e6", BLUE), strict=True)
        for end, value, place, fill in ends:
            reach = end or 0.0
            axes.barh(place, reach - base, left=base, height=0.4, color=fill)
            axes.annotate(f"{value:g}" if isinstance(value, float) else str(value), (reach, place),
                          (3 if reach >= base else -3, 0), textcoords="offset points", va="center",
                          ha="left" if reach >= base else "right", fontsize=7)
    labels = [f"{lever.name}{f', {lever.unit}' if lever.unit else ''}" for lever in rows]
    axes.set_yticks(range(len(rows)), labels, fontsize=8)
    axes.axvline(base, color="0.3", linewidth=0.8)
    axes.set(xlabel="tolerable range, mm", title=found.sentence)
    axes.margins(x=0.15)
    return axes
