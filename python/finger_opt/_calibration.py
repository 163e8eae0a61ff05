"""Measurements from the bench, and what follows from them."""

from __future__ import annotations

import html
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ._call import called, checked, given, without
from ._result import REST, Found, Result
from ._words import Numbers, StrPath

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, repr=False)
class Line(Result):
    """A line of a measurement file: a finger, its ``values`` by key, and what was measured of it, mm and N."""

    line: int
    task: str
    values: dict[str, float] = field(metadata=REST)
    negative_mm: float | None
    positive_mm: float | None
    range_mm: float | None
    failure_negative: int | None
    failure_positive: int | None
    repeats: int
    peak_force_n: float | None
    date: str | None
    note: str | None


class Measurements:
    """A file of measurements from the bench, or ``"published"``: those of the publication.

    >>> import finger_opt as fo
    >>> len(fo.Measurements("published").check())
    44
    """

    @checked
    def __init__(self, file: StrPath = "measurements.csv", *, tasks: Iterable[StrPath] = ()) -> None:
        """``tasks`` are files of one's own tasks that its lines name without a comment line."""
        self.file: str = os.fspath(file)
        self._tasks: list[StrPath] = [os.fspath(task) for task in tasks]

    def check(self) -> tuple[Line, ...]:
        """The lines, once nothing looks wrong: units, windows without the start, lines given twice, unknown tasks.

        Raises:
            InputError: What is wrong, with its line.
        """
        found = called("measure check", {"file": self.file, "task": self._tasks, "rows": True}, Found)
        return tuple(sorted((Line.from_json(line) for line in found["rows"]), key=lambda line: line.line))

    def to_dataframe(self) -> DataFrame:
        """A row for each line, checked, with the columns of the file."""
        from ._frame import pandas

        frame: DataFrame = pandas().DataFrame([line.to_dict() for line in self.check()])
        return frame

    @checked
    def add(
        self,
        task: StrPath,
        *,
        density: float | None = None,
        direction: float | None = None,
        negative_mm: float | None = None,
        positive_mm: float | None = None,
        range_mm: float | None = None,
        not_measurable: bool = False,
        failure_negative: int | None = None,
        failure_positive: int | None = None,
        repeats: int | None = None,
        peak_force_n: float | None = None,
        date: str | None = None,
        note: str | None = None,
        set: Numbers | None = None,
    ) -> int:
        """Adds a line, as ``optimize measure add`` does; the file need not exist. Gives how many it has then.

        Args:
            task: A shipped name, or the path of a task file.
            density: Infill density, percent.
            direction: Infill direction, degrees.
            negative_mm: Most negative start that inserted, mm.
            positive_mm: Most positive start that inserted, mm.
            range_mm: Width of the window, mm.
            not_measurable: The finger was tried, but no range could be measured.
            failure_negative: Failure class below the window, 1 to 4.
            failure_positive: Failure class above the window, 1 to 4.
            repeats: Measurements that the values are the mean of.
            peak_force_n: Largest contact force, N.
            date: Day, YYYY-MM-DD.
            note: Anything.
            set: Further design parameters.

        Raises:
            InputError: A line that looks wrong; nothing is added.
        """
        if not_measurable:
            without("not_measurable", "there is no range", range_mm=range_mm, negative_mm=negative_mm, positive_mm=positive_mm)
        return int(called("measure add", {"file": self.file, **given(locals())}, Found)["lines"])

    def __fspath__(self) -> str:
        return self.file

    def __repr__(self) -> str:
        return f"<Measurements {self.file}>"


@dataclass(frozen=True, repr=False)
class LeftOut(Result):
    """A measured finger, predicted without it: 80 % of such ranges lie between low and high."""

    values: dict[str, float] = field(metadata=REST)
    measured_mm: float
    range_mm: float
    low_mm: float
    high_mm: float


@dataclass(frozen=True, repr=False)
class Prediction(Result):
    """What a finger is expected to do on the bench: 80 % of such ranges lie between low and high."""

    values: dict[str, float] = field(metadata=REST)
    range_mm: float
    low_mm: float
    high_mm: float
    probability_best: float
    #: By simulation alone.
    simulated_mm: float | None
    failure_negative: int | None
    failure_positive: int | None


@dataclass(frozen=True, repr=False)
class Calibrated(Result):
    """The predictions for a task, and how far they are to be trusted: fingers left out of the fit."""

    task: str
    designs: int
    loo_mean_deviation_percent: float | None
    loo_spearman: float | None
    loo_coverage_80_percent: float | None
    simulations: int
    fresh_simulations: int
    emulator_error_mm: float
    warnings: tuple[str, ...]
    leave_one_out: tuple[LeftOut, ...] = field(repr=False)
    predictions: tuple[Prediction, ...] = field(repr=False)


@dataclass(frozen=True, repr=False)
class Parameter(Result):
    """What nobody measured: 10, 50 and 90 % points before and after; ``moved``: the measurements say something."""

    name: str
    task: str | None
    prior_low: float
    prior_median: float
    prior_high: float
    posterior_low: float
    posterior_median: float
    posterior_high: float
    moved: bool


@dataclass(frozen=True, repr=False)
class Together(Result):
    """Two parameters that the measurements do not tell apart."""

    parameters: tuple[str, str]
    correlation: float


@dataclass(frozen=True, repr=False)
class Calibration(Result):
    """What every finger does on the bench, from simulation and measurements."""

    tasks: tuple[Calibrated, ...]
    parameters: tuple[Parameter, ...]
    not_told_apart: tuple[Together, ...]

    def to_dataframe(self) -> DataFrame:
        """A row for each finger and task, as ``predictions`` has it."""
        from ._frame import pandas

        rows = [{"task": one.task, **each.to_dict()} for one in self.tasks for each in one.predictions]
        frame: DataFrame = pandas().DataFrame(rows)
        return frame

    def _repr_html_(self) -> str:
        return _tables(self)


def _tables(found: Calibration) -> str:
    """A table of the fingers that are expected to be best, for each task."""
    pieces: list[str] = []
    for task in found.tasks:
        best = sorted(task.predictions, key=lambda one: -one.range_mm)[:5]
        rows = "".join(
            f"<tr><td>{html.escape(', '.join(f'{key} {value:g}' for key, value in one.values.items()))}</td>"
            f"<td>{one.range_mm:.1f} mm</td><td>{one.low_mm:.1f} to {one.high_mm:.1f}</td>"
            f"<td>{one.probability_best:.0%}</td></tr>" for one in best
        )
        error = task.loo_mean_deviation_percent
        trust = "" if error is None else f": {error:.0f} % off on average for fingers left out"
        warnings = "".join(f"<p>{html.escape(text)}</p>" for text in task.warnings)
        pieces.append(
            f"<b>{html.escape(task.task)}</b>{trust}<table><tr><th>finger</th><th>range</th><th>80 %</th>"
            f"<th>best</th></tr>{rows}</table>{warnings}"
        )
    return "".join(pieces)


@dataclass(frozen=True, repr=False)
class Print(Result):
    """A finger to print next: 80 % of such ranges lie between low and high."""

    values: dict[str, float] = field(metadata=REST)
    expected_mm: float
    low_mm: float
    high_mm: float
    expected_gain_mm: float
    needs_print: bool
    reason: str


@dataclass(frozen=True, repr=False)
class Choice(Result):
    """The finger with the largest expected range, to be used if nothing more is printed."""

    values: dict[str, float] = field(metadata=REST)
    expected_mm: float
    measured: bool


@dataclass(frozen=True, repr=False)
class Advice(Result):
    """Which fingers to print next; ``stop``: none is worth its print."""

    task: str
    measured: int
    #: Fingers that were printed and insert from no start: not proposed again.
    not_measurable: tuple[dict[str, float], ...]
    measurements_missing: bool
    best_known_mm: float | None
    next: tuple[Print, ...]
    choice: Choice | None
    stop: bool
