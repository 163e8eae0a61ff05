"""Measurements from the bench; results of the calibration and of the advice on the next print."""

from __future__ import annotations

import html
import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ._answer import BestMeasured
from ._call import called, checked, given, without
from ._result import REST, Found, Result
from ._words import Numbers, StrPath

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, repr=False)
class Line(Result):
    """Line of a measurement file: design parameters of a finger (``values``, by key) and its measured window."""

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
    """File of measurements from the bench, or ``"published"``: the measurements of the publication.

    >>> import finger_opt as fo
    >>> len(fo.Measurements("published").check())
    44
    """

    @checked
    def __init__(self, file: StrPath = "bench.csv", *, tasks: Iterable[StrPath] = ()) -> None:
        """Refers to a file; ``tasks`` are files of your own tasks that are not named in its comment lines."""
        self.file: str = os.fspath(file)
        self._tasks: list[StrPath] = [os.fspath(task) for task in tasks]

    def check(self) -> tuple[Line, ...]:
        """Checks the file, and returns its lines.

        Raises:
            InputError: A line has an implausible unit, a window without the start, a duplicate or an unknown task.
        """
        output = called("measure check", {"file": self.file, "task": self._tasks, "rows": True}, Found)
        return tuple(sorted((Line.from_json(line) for line in output["rows"]), key=lambda line: line.line))

    def to_dataframe(self) -> DataFrame:
        """Checks the file, and returns a row for each line, with the columns of the file."""
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
        failure_negative: int | str | None = None,
        failure_positive: int | str | None = None,
        repeats: int | None = None,
        peak_force_n: float | None = None,
        date: str | None = None,
        note: str | None = None,
        set: Numbers | None = None,
    ) -> int:
        """Adds a line, like ``optimize measure add``, to a file that need not exist; returns the number of its lines.

        Args:
            task: Name of a shipped task, or path of a task file.
            density: Infill density, percent.
            direction: Infill direction, degrees.
            negative_mm: Most negative start that inserted, mm.
            positive_mm: Most positive start that inserted, mm.
            range_mm: Width of the window, mm.
            not_measurable: Whether the finger was tried, but has no measurable range.
            failure_negative: Failure class below the window: 1 to 4, or its name.
            failure_positive: Failure class above the window: 1 to 4, or its name.
            repeats: Number of measurements that were averaged.
            peak_force_n: Largest contact force, N.
            date: Date of the measurement, YYYY-MM-DD.
            note: Free text.
            set: Further design parameters by key.

        Raises:
            InputError: The line is implausible; nothing is added.
        """
        if not_measurable:
            without("not_measurable", "there is no range",
                    range_mm=range_mm, negative_mm=negative_mm, positive_mm=positive_mm)
        return int(called("measure add", {"file": self.file, **given(locals())}, Found)["lines"])

    def __fspath__(self) -> str:
        return self.file

    def __repr__(self) -> str:
        return f"<Measurements {self.file}>"


@dataclass(frozen=True, repr=False)
class LeftOut(Result):
    """Leave-one-out prediction of a measured finger; ``low_mm`` to ``high_mm`` is the 80 % prediction interval."""

    values: dict[str, float] = field(metadata=REST)
    measured_mm: float
    range_mm: float
    low_mm: float
    high_mm: float


@dataclass(frozen=True, repr=False)
class Prediction(Result):
    """Predicted range of a finger on the bench; ``low_mm`` to ``high_mm`` is the 80 % prediction interval."""

    values: dict[str, float] = field(metadata=REST)
    range_mm: float
    low_mm: float
    high_mm: float
    probability_best: float
    #: Range of the calibrated simulation, mm, without the correction from measurements.
    simulated_mm: float | None
    failure_negative: int | None
    failure_positive: int | None


@dataclass(frozen=True, repr=False)
class Calibrated(Result):
    """Predictions for a task, and their leave-one-out accuracy."""

    task: str
    designs: int
    #: Whether the predictions can be trusted within their intervals.
    reliable: bool
    #: Advice on their use, with its reason.
    verdict: str
    loo_mean_deviation_percent: float | None
    #: Error of predicting each finger by the mean of the others.
    loo_mean_of_others_percent: float | None
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
    """Quantiles (10, 50, 90 %) of a parameter that was not measured; ``moved``: shifted or narrowed by the data."""

    name: str
    task: str | None
    #: Key that the value changes, and how: replaced, multiplied by it, or shifted by it.
    sets: str
    as_: str
    prior_low: float
    prior_median: float
    prior_high: float
    posterior_low: float
    posterior_median: float
    posterior_high: float
    moved: bool


@dataclass(frozen=True, repr=False)
class Together(Result):
    """Two parameters that the measurements cannot distinguish, with their posterior correlation."""

    parameters: tuple[str, str]
    correlation: float


@dataclass(frozen=True, repr=False)
class Calibration(Result):
    """Predictions for every finger on the bench, from simulation and measurements."""

    tasks: tuple[Calibrated, ...]
    parameters: tuple[Parameter, ...]
    not_told_apart: tuple[Together, ...]

    def to_dataframe(self) -> DataFrame:
        """Returns a row for each finger and task, with the fields of ``predictions``."""
        from ._frame import pandas

        rows = [{"task": task.task, **finger.to_dict()} for task in self.tasks for finger in task.predictions]
        frame: DataFrame = pandas().DataFrame(rows)
        return frame

    def _repr_html_(self) -> str:
        return _tables(self)


def _tables(calibration: Calibration) -> str:
    """Returns an HTML table of the best fingers, for each task."""
    pieces: list[str] = []
    for task in calibration.tasks:
        best = sorted(task.predictions, key=lambda finger: -finger.range_mm)[:5]
        rows = "".join(
            f"<tr><td>{html.escape(', '.join(f'{key} {value:g}' for key, value in finger.values.items()))}</td>"
            f"<td>{finger.range_mm:.1f} mm</td><td>{finger.low_mm:.1f} to {finger.high_mm:.1f}</td>"
            f"<td>{finger.probability_best:.0%}</td></tr>" for finger in best
        )
        warnings = "".join(f"<p>{html.escape(text)}</p>" for text in task.warnings)
        pieces.append(
            f"<b>{html.escape(task.task)}</b>: {html.escape(task.verdict)}<table><tr><th>finger</th><th>range</th>"
            f"<th>80 %</th><th>best</th></tr>{rows}</table>{warnings}"
        )
    return "".join(pieces)


@dataclass(frozen=True, repr=False)
class Print(Result):
    """Finger to print next; ``low_mm`` to ``high_mm`` is the 80 % prediction interval of its range."""

    values: dict[str, float] = field(metadata=REST)
    expected_mm: float
    low_mm: float
    high_mm: float
    #: Expected increase of the largest expected range of all fingers by measuring this one.
    expected_gain_mm: float
    #: The same of the printed fingers alone: what printing it gains for use.
    gain_in_use_mm: float
    #: Probability that its range is larger than that of the best measured finger, 0 to 1.
    probability_better: float | None
    needs_print: bool
    reason: str


@dataclass(frozen=True, repr=False)
class Choice(Result):
    """Finger with the largest expected range, the choice if no more fingers are printed."""

    values: dict[str, float] = field(metadata=REST)
    expected_mm: float
    low_mm: float
    high_mm: float
    measured: bool


@dataclass(frozen=True, repr=False)
class Advice(Result):
    """Fingers to print next; ``stop`` if no print is worth its expected gains."""

    task: str
    measured: int
    #: Number of fingers predicted without their own measurement, and of those that are in their 80 % interval.
    loo_designs: int
    loo_inside: int
    #: Whether the predictions can be trusted within their intervals, and advice with its reason.
    reliable: bool
    verdict: str
    #: Printed fingers that insert from no start; they are not recommended again.
    not_measurable: tuple[dict[str, float], ...]
    #: Number of simulations with a robot stop in most insertions, and of all simulations.
    stopped_simulations: int
    simulations: int
    measurements_missing: bool
    #: The best measured finger.
    use_now: BestMeasured | None
    best_known_mm: float | None
    next: tuple[Print, ...]
    choice: Choice | None
    stop: bool
