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
from ._map import Levers
from ._plot import axes as axes_of, text
from ._result import PICTURE, Found, Result
from ._run import run_open
from ._words import StrPath

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing
    from pandas import DataFrame


class Study(Asked):
    """Study in a folder, created by :meth:`create` or opened by :func:`finger_opt.load_study`.

    >>> import finger_opt as fo
    >>> study = fo.Study.create("rj45", budget=8, out="rj45-study", no_levers=True, no_map=True)
    >>> len(study.run(progress=False))
    8
    >>> study.answer.verdict in ("any", "print", "measured_before")
    True
    """

    def __init__(self, request: _native.StudyRequest) -> None:
        #: Absolute path of the folder.
        self.path: str = os.path.abspath(request.create())
        self._request = request

    @classmethod
    def asked(cls, words: Mapping[str, Any]) -> Study:
        """Creates a study with these options; the default of ``batch`` depends on the workers of :meth:`run`."""
        return cls(_native.StudyRequest(keywords(words)))

    @classmethod
    def resumed(cls, folder: StrPath, words: Mapping[str, Any] | None = None) -> Study:
        """Opens the study in a folder; :meth:`run` continues it with these options.

        Raises :class:`InputError` if the folder is not a study.
        """
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

        Ctrl-C stops the study; finished evaluations are kept, and calling ``run`` again continues it.

        Args:
            executor: Any ``concurrent.futures.Executor``, or object with its ``submit``, on which designs are
                evaluated; without one, they are evaluated on threads of this process. The journal does not depend on
                the executor if the batch is the same.
            progress: Show a progress line on standard error, or the bar of ``tqdm`` if it is installed.
            workers: Number of simultaneous evaluations; default: the number of workers of the executor.
            retries: Number of retries of an evaluation that a worker lost, or whose result is rejected.
            callbacks: Functions called with the study and its number of evaluations whenever that number increases.

        Raises:
            StudyError: The executor fails, or the folder cannot be written.
            Interrupted: Ctrl-C.
        """
        bound = [functools.partial(callback, self) for callback in callbacks]
        _, unusable = run_open(self._open, executor, progress, workers, retries, bound)
        if unusable is not None:
            raise _native.StudyError(unusable)
        return self

    def report(self) -> str:
        """Writes tables and plots again, as ``optimize report`` does; returns the path of the page."""
        return str(called("report", {"dir": self.path}, Found)["page"])

    def _open(self, workers: int | None) -> _native.AskTellStudy:
        return self._request.open(workers)

    def _begun(self) -> bool:
        return os.path.exists(os.path.join(self.path, "journal.jsonl"))

    def _read(self) -> _native.Recorded:
        return _native.Recorded(self.path)

    @property
    def config(self) -> dict[str, Any]:
        """Configuration of the study, as in ``study.toml``."""
        config: dict[str, Any] = json.loads(self._read().config())
        return config

    @property
    def best(self) -> Recommended | None:
        """Recommended design, as ``recommended`` of ``--json``; ``None`` as long as there is none."""
        found = json.loads(self._read().best()) if self._begun() else None
        return None if found is None else Recommended.from_json(found)

    @property
    def best_params(self) -> dict[str, float]:
        """Values of the recommended design by key; raises ValueError without one, as Optuna does."""
        return dict(self._recommended().values)

    @property
    def best_value(self) -> float:
        """First objective of the recommended design, or its predicted range on the bench, mm, with measurements.

        Raises ValueError without a recommended design.
        """
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
        """Recommended action, as ``answer`` of ``--json``; ``None`` before the study has started."""
        if not self._begun():
            return None
        read = self._read()
        return Answer.from_json({**json.loads(read.answer()), "card": read.card()})

    @property
    def settled(self) -> bool:
        """Whether the search has ended because no design is expected to gain ``indifference_mm``."""
        return self._begun() and self._read().settled()

    def to_dataframe(self) -> DataFrame:
        """Returns the evaluations as rows, with the columns of ``evaluations.csv``, which contain the units."""
        from ._frame import pandas

        table = self._read().table()
        frame: DataFrame = pandas().read_csv(io.StringIO(table)) if table.strip() else pandas().DataFrame()
        return frame

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the objective over the evaluations, and the best so far; returns the axes."""
        return _convergence(self, ax)

    def plot_surface(self, ax: Drawing | None = None) -> Drawing:
        """Draws the infills, coloured by the objective; returns the axes."""
        return _surface(self, ax)

    def plot_importances(self, ax: Drawing | None = None) -> Drawing:
        """Draws the range of the recommended finger at both ends of each lever, the largest on top; returns the axes.

        Raises :class:`InputError` if the folder has no levers of this finger.
        """
        return self._levers().plot(ax)

    def _levers(self) -> Levers:
        """Reads the levers of the recommended finger; raises InputError if there are none."""
        try:
            with open(os.path.join(self.path, "levers.json"), encoding="utf-8") as file:
                stored: dict[str, Any] = json.load(file)
            if self.best is not None and stored["design"] == self.best_params:
                return Levers.from_json({**stored["found"], "sentence": _named(self)})
        except (OSError, ValueError, KeyError):
            pass
        run = "call run() of a study of one task and objective, opened without no_levers"
        raise wrong("study", f"{self.path} has no levers of its recommended finger; {run}, or "
                             "finger_opt.sensitivity(task).plot() for Sobol indices")

    def __len__(self) -> int:
        """Returns the number of evaluations in the journal."""
        return self._read().length() if self._begun() else 0

    def __bool__(self) -> bool:
        return True

    def __reduce__(self) -> tuple[Any, tuple[str]]:
        return Study.resumed, (self.path,)

    def _repr_html_(self) -> str:
        if not self._begun():
            return f"<p>study not started: {html.escape(self.path)}</p>"
        return self._read().card()

    def __fspath__(self) -> str:
        return self.path

    def __repr__(self) -> str:
        return f"<Study {self.path}>"


def _named(study: Study) -> str:
    """Returns the name of the study's folder."""
    return text(os.path.basename(study.path))


def _objective(study: Study) -> tuple[str, str, bool] | None:
    """Returns column and label (with unit) of the first objective, and whether it is minimized; None without data."""
    columns = [str(column) for column in study.to_dataframe().columns]
    column = next((column for column in columns if column.startswith("objective")), None)
    if column is None:
        return None
    name = str(study.config["objective"]).split(",")[0].strip()
    label = "tolerable range" if name == "range" else name.replace("-", " ")
    unit = column.rpartition("_")[2] if column.count("_") > column.startswith("objective_1") else ""
    return column, f"{label}, {unit}" if unit in ("mm", "n") else label, name in ("peak-force", "slip")


def _convergence(study: Study, ax: Drawing | None) -> Drawing:
    """Draws the objective of each evaluation, and the best so far; returns the axes."""
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
    """Draws the infills, coloured by the objective, and the recommended design; returns the axes."""
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
    """Quartiles over studies; ``None`` where too few of them reached the target or have a value."""

    q25: float | None
    median: float | None
    q75: float | None


@dataclass(frozen=True, repr=False)
class Compared(Result):
    """Evaluations that an optimizer needs to reach the target; ``reached`` of its ``studies`` did."""

    optimizer: str
    batch: int
    studies: int
    reached: int
    evaluations_to_target: Quartiles
    best_so_far_mm: tuple[Quartiles, ...] = field(repr=False)


@dataclass(frozen=True, repr=False)
class Comparison(Result):
    """Comparison of optimizers over studies of the same task and objective.

    The target, ``target_mm``, is slightly below the best known value.
    """

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
    """Sobol indices of an input from ``low`` to ``high``: first-order and total, each with its interval.

    They are the shares of the variance due to the input alone (``first``) and including interactions (``total``).
    """

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
    """Sensitivity of the range to its inputs, the most important one first.

    ``diverged`` and ``nominal_start_fails`` are numbers of evaluations.
    """

    task: str
    evaluations: int
    diverged: int
    nominal_start_fails: int
    factors: tuple[Factor, ...]
    svg: str = field(default="", repr=False, metadata=PICTURE)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the share of each input in the variance, alone and with others; returns the axes."""
        return _importances(self, ax)

    def _repr_html_(self) -> str:
        return self.svg


def _importances(found: Sensitivity, ax: Drawing | None) -> Drawing:
    """Draws first-order and total Sobol indices with their intervals, the largest on top; returns the axes."""
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
    axes.set(xlabel="share of the variance of the range", title=text(found.task))
    axes.legend(loc="lower right")
    return axes
