"""Studies: seeded runs of one optimizer on one task and space, in a folder."""

from __future__ import annotations

import functools
import html
import io
import json
import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._answer import Answer, Recommended
from ._asked import Asked
from ._call import called, checked, keywords, wrong
from ._drawn import BLUE, COLOURS
from ._plot import axes as axes_of, text
from ._result import PICTURE, Found, Result
from ._run import run_open
from ._words import StrPath

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing
    from pandas import DataFrame


class Study(Asked):
    """A study in a folder. Make one with :meth:`create`, open one with :func:`finger_opt.load_study`.

    >>> import finger_opt as fo
    >>> study = fo.Study.create("rj45", budget=8, out="rj45-study", no_levers=True, no_map=True)
    >>> len(study.run(progress=False))
    8
    >>> study.answer.verdict in ("any", "print", "measured_before")
    True
    """

    def __init__(self, asked: _native.StudyRequest) -> None:
        #: The folder.
        self.path: str = os.path.abspath(asked.create())
        self._asked = asked

    @classmethod
    def asked(cls, words: Mapping[str, Any]) -> Study:
        """The study of these words, in its folder; a batch that is not given follows from the workers of :meth:`run`."""
        return cls(_native.StudyRequest(keywords(words)))

    @classmethod
    def resumed(cls, folder: StrPath, words: Mapping[str, Any] | None = None) -> Study:
        """The study in a folder; :meth:`run` continues it by these words."""
        if not os.path.isfile(os.path.join(folder, "study.toml")):
            raise wrong("folder", f"{os.fspath(folder)} is not a study: it has no study.toml")
        _native.Recorded(os.fspath(folder))
        return cls(_native.StudyRequest.resumed(os.fspath(folder), keywords(words or {})))

    @checked
    def run(
        self,
        executor: Executor | Any | None = None,
        progress: bool = True,
        *,
        workers: int | None = None,
        retries: int = 10,
        callbacks: Iterable[Callable[[Study, int], object]] = (),
    ) -> Study:
        """Runs the study until its budget is spent, and writes its report.

        Ctrl-C stops it; what was measured is safe, and ``run`` again goes on.

        Args:
            executor: Any ``concurrent.futures.Executor``, or what has its ``submit``: designs are measured there,
                and the journal is the same as with any other, or none, for the same batch. Without, they are
                measured on the threads of this process.
            progress: Show a line on standard error; the bar of ``tqdm`` if it is installed.
            workers: Measurements at a time; as many as the executor has unless given.
            retries: How often a measurement that a worker lost, or whose result is refused, is done again.
            callbacks: Called with the study and the number of its evaluations whenever there are more.

        Raises:
            StudyError: The executor fails, or the folder cannot be written.
            Interrupted: Ctrl-C.
        """
        told = [functools.partial(callback, self) for callback in callbacks]
        _, unusable = run_open(self._open, executor, progress, workers, retries, told)
        if unusable is not None:
            raise _native.StudyError(unusable)
        return self

    def report(self) -> str:
        """Writes tables and plots again, as ``optimize report`` does; gives the path of the page."""
        return str(called("report", {"dir": self.path}, Found)["page"])

    def _open(self, workers: int | None) -> _native.AskTellStudy:
        return self._asked.open(workers)

    def _begun(self) -> bool:
        return os.path.exists(os.path.join(self.path, "journal.jsonl"))

    def _read(self) -> _native.Recorded:
        return _native.Recorded(self.path)

    @property
    def config(self) -> dict[str, Any]:
        """What was asked for, as ``study.toml`` keeps it."""
        config: dict[str, Any] = json.loads(self._read().config())
        return config

    @property
    def best(self) -> Recommended | None:
        """The recommended design, as ``recommended`` of ``--json``; ``None`` while there is none."""
        found = json.loads(self._read().best()) if self._begun() else None
        return None if found is None else Recommended.from_json(found)

    @property
    def best_params(self) -> dict[str, float]:
        """Values of the recommended design by key; an error while there is none, as in Optuna."""
        return dict(self._recommended().values)

    @property
    def best_value(self) -> float:
        """The first objective of the recommended design, on the bench if there are measurements."""
        best = self._recommended()
        if best.bench is not None:
            return best.bench.range_mm
        if best.objectives:
            return next(iter(best.objectives.values()))
        objective = _objective(self)
        if objective is None or best.evaluation is None:
            raise ValueError("the study has no value yet")
        return float(self.to_dataframe()[objective[0]][best.evaluation])

    def _recommended(self) -> Recommended:
        best = self.best
        if best is None:
            raise ValueError("no design is recommended yet")
        return best

    @property
    def answer(self) -> Answer | None:
        """What to do, as ``answer`` of ``--json``; ``None`` before it has begun."""
        if not self._begun():
            return None
        read = self._read()
        return Answer.from_json({**json.loads(read.answer()), "card": read.card()})

    @property
    def settled(self) -> bool:
        """Whether the search has ended because no design is expected to gain ``indifference_mm``."""
        return self._begun() and self._read().settled()

    def to_dataframe(self) -> DataFrame:
        """A row for each evaluation; the columns of ``evaluations.csv``, with their units."""
        from ._frame import pandas

        table = self._read().table()
        frame: DataFrame = pandas().read_csv(io.StringIO(table)) if table.strip() else pandas().DataFrame()
        return frame

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the objective over the evaluations, and the best so far; gives the axes."""
        return _convergence(self, ax)

    def plot_surface(self, ax: Drawing | None = None) -> Drawing:
        """Draws the designs of an infill with their ranges; gives the axes."""
        return _surface(self, ax)

    def __len__(self) -> int:
        """Evaluations in the journal."""
        return self._read().length() if self._begun() else 0

    def __bool__(self) -> bool:
        return True

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return Study.resumed, (self.path,)

    def _repr_html_(self) -> str:
        if not self._begun():
            return f"<p>a study not begun yet: {html.escape(self.path)}</p>"
        return self._read().card()

    def __fspath__(self) -> str:
        return self.path

    def __repr__(self) -> str:
        return f"<Study {self.path}>"


def _named(study: Study) -> str:
    """The study's folder, without those that it is in."""
    return text(os.path.basename(study.path))


def _objective(study: Study) -> tuple[str, str, bool] | None:
    """Column of the first objective, what it is in words with its unit, and whether less is better."""
    columns = [str(column) for column in study.to_dataframe().columns]
    column = next((column for column in columns if column.startswith("objective")), None)
    if column is None:
        return None
    name = str(study.config["objective"]).split(",")[0].strip()
    words = "tolerable range" if name == "range" else name.replace("-", " ")
    unit = column.rpartition("_")[2] if column.count("_") > column.startswith("objective_1") else ""
    return column, f"{words}, {unit}" if unit in ("mm", "n") else words, name in ("peak-force", "slip")


def _convergence(study: Study, ax: Drawing | None) -> Drawing:
    """Each evaluation, and the best so far."""
    axes = axes_of(ax)
    objective = _objective(study)
    if objective is not None:
        column, label, least = objective
        values = study.to_dataframe()[column].to_numpy(dtype=float)
        best = np.fmin.accumulate(values) if least else np.fmax.accumulate(values)
        axes.plot(np.arange(1, len(values) + 1), values, ".", color="0.6", label="evaluation")
        axes.step(np.arange(1, len(values) + 1), best, where="post", color=BLUE, label="best so far")
        axes.set_ylabel(label)
        axes.legend(loc="lower right")
    axes.set(xlabel="evaluation", title=_named(study))
    return axes


def _surface(study: Study, ax: Drawing | None) -> Drawing:
    """The designs, coloured by their objective, and the recommended one."""
    axes = axes_of(ax, height=4.2)
    keys = ("infill_density_percent", "infill_direction_deg")
    objective, frame = _objective(study), study.to_dataframe()
    if objective is not None:
        column, label, _ = objective
        dots = axes.scatter(frame[keys[0]], frame[keys[1]], c=frame[column], cmap="viridis", s=28)
        axes.figure.colorbar(dots, ax=axes, label=label)
    best = study.best
    if best is not None and all(key in best.values for key in keys):
        axes.plot(*(best.values[key] for key in keys), "o", markersize=13, markerfacecolor="none", color=COLOURS[3],
                  label="recommended")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False)
    axes.set(xlabel="infill density, percent", ylabel="infill direction, degrees")
    axes.set_title(_named(study), loc="left")
    return axes


@dataclass(frozen=True, repr=False)
class Quartiles(Result):
    """Quartiles over seeds; none where too few got there."""

    q25: float | None
    median: float | None
    q75: float | None


@dataclass(frozen=True, repr=False)
class Compared(Result):
    """An optimizer: how many evaluations it needs to come near the best known."""

    optimizer: str
    batch: int
    studies: int
    reached: int
    evaluations_to_target: Quartiles
    best_so_far_mm: tuple[Quartiles, ...] = field(repr=False)


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """Optimizers over studies of the same task and objective."""

    task: str
    objective: str
    best_known_mm: float
    target_mm: float
    optimizers: tuple[Compared, ...]
    svg: str = field(default="", repr=False, metadata=PICTURE)

    def _repr_html_(self) -> str:
        return self.svg


@dataclass(frozen=True, repr=False)
class Factor(Result):
    """An input from ``low`` to ``high``: its share of the variance by itself (``first``) and with others."""

    name: str
    low: float
    high: float
    first: float
    first_low: float
    first_high: float
    total: float
    total_low: float
    total_high: float


@dataclass(frozen=True, repr=False)
class Sensitivity(Result):
    """Which input matters, most first."""

    task: str
    objective: str
    evaluations: int
    diverged: int
    nominal_start_fails: int
    factors: tuple[Factor, ...]
    svg: str = field(default="", repr=False, metadata=PICTURE)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the share of the variance of each factor, alone and with others; gives the axes."""
        return _importances(self, ax)

    def _repr_html_(self) -> str:
        return self.svg


def _importances(found: Sensitivity, ax: Drawing | None) -> Drawing:
    """First-order and total Sobol indices with their intervals, the most important factor on top."""
    axes = axes_of(ax, height=1.2 + 0.4 * len(found.factors))
    rows = list(reversed(found.factors))
    bars = [
        ("with others", "#9cc3e6", 0.2, [(of.total, of.total_low, of.total_high) for of in rows]),
        ("alone", BLUE, -0.2, [(of.first, of.first_low, of.first_high) for of in rows]),
    ]
    for label, fill, place, values in bars:
        share = [middle for middle, _, _ in values]
        errors = [[max(middle - low, 0.0) for middle, low, _ in values],
                  [max(high - middle, 0.0) for middle, _, high in values]]
        places = [row + place for row in range(len(rows))]
        axes.barh(places, share, height=0.4, xerr=errors, color=fill, label=label, ecolor="0.4")
    axes.set_yticks(range(len(rows)), [text(of.name) for of in rows], fontsize=8)
    axes.set(xlabel=f"share of the variance of {found.objective}", title=text(found.task))
    axes.legend(loc="lower right")
    return axes
