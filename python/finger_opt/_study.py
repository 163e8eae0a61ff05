"""Studies: seeded runs of one optimizer on one task and space, in a folder."""

from __future__ import annotations

import html
import io
import json
import os
from collections.abc import Iterable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from . import _native
from ._answer import Answer, Recommended
from ._call import checked, given, wrong
from ._drawn import COLOURS
from ._plot import axes as axes_of, text
from ._result import DRAWN, Result, save
from ._run import run_open
from ._task import Given, sources
from ._words import (
    Aggregate, Engine, FingerModel, Objective, OptimizerName, RobotName, SpaceName, Start, StrPath,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing
    from pandas import DataFrame


class Study:
    """A study in a folder. Make one with :meth:`create`, open one with :func:`load_study`.

    >>> import finger_opt as fo
    >>> study = fo.Study.create("rj45", budget=8, out="rj45-study", no_levers=True, no_map=True)
    >>> len(study.run(progress=False))
    8
    >>> study.answer.verdict in ("any", "print", "measured_before")
    True
    """

    def __init__(self, asked: _native.Asked) -> None:
        #: The folder.
        self.path: str = os.path.abspath(asked.folder())
        self._asked = asked

    @classmethod
    @checked
    def create(
        cls,
        task: Given | Iterable[Given],
        *,
        budget: int | None = None,
        seed: int = 0,
        out: StrPath | None = None,
        space: SpaceName | StrPath = "infill",
        optimizer: OptimizerName = "gp",
        objective: Objective | Sequence[Objective] = "range",
        constraint: str | Sequence[str] = (),
        uncertainty: StrPath | None = None,
        measurements: StrPath | None = None,
        priors: StrPath | None = None,
        aggregate: Aggregate | None = None,
        weights: Sequence[float] = (),
        indifference_mm: float = 0.3,
        polish: int = 0,
        batch: int | None = None,
        async_: bool = False,
        robot: RobotName | StrPath | None = None,
        cell: StrPath | None = None,
        stiffness_data: StrPath | None = None,
        engine: Engine = "direct",
        finger_model: FingerModel | None = None,
        finger: StrPath = "finray9",
        start: Start | None = None,
        threads: int | None = None,
        cache: StrPath | None = None,
        no_cache: bool = False,
        no_confirm: bool = False,
        no_levers: bool = False,
        no_map: bool = False,
        accept_changed: bool = False,
        simulations: int | None = None,
        samples: int | None = None,
    ) -> Study:
        """A study of this task (or several), which :meth:`run` begins or continues.

        All is checked here; the folder is made by :meth:`run`, which knows the number of workers.

        Args:
            task: A shipped name, the path of a task file, or a :class:`Task`; or several.
            budget: Evaluations. Without, it ends once no design is expected to gain 0.3 mm, after 500 at most
                (other optimizers than ``gp`` and other objectives than ranges: after 200).
            seed: The same seed gives the same study.
            out: Folder; ``results/<task>-<optimizer>-seed<seed>`` unless given.
            space: Search space: a name or a file.
            optimizer: Search method.
            objective: What is optimized; two or three give a front.
            constraint: What a design must keep to: ``"peak-force<=30"``; one or several.
            uncertainty: Errors for success rate and robust range: ``"typical"``, or a file.
            measurements: What was measured on the bench: the study then ends with the finger best there.
            priors: What nobody measured, for ``measurements``.
            aggregate: What is made of the values of several tasks.
            weights: Weight of each task.
            indifference_mm: Difference of ranges that a bench cannot tell, mm.
            polish: Then so many evaluations more, by Nelder-Mead from the best design.
            batch: Designs proposed at a time; the number of workers unless given, 4 without executor.
            async_: Tell each result as it comes; the journal then depends on who was fast.
            threads: Threads, which change no result.
            cache: Folder of evaluations that studies share; ``results/.cache`` unless given.
            no_cache: Measure every design anew, and keep nothing.
            no_confirm: Leave out what confirms the recommendation.
            no_levers: Leave out what would help the finger more than its infill.
            no_map: Leave out the capture maps.
            accept_changed: Go on with a study that another version measured.
            simulations: Simulations per task of a prediction for the bench.
            samples: Samples of its posterior.

        Robot, cell, stiffness data, engine, finger model and start are as for :func:`evaluate`.

        Raises:
            InputError: A value or a file that cannot be used; :class:`TaskError` if it is a task.
        """
        return cls(_native.study(sources(task), **given(locals(), "task")))

    @checked
    def run(
        self,
        executor: Executor | Any | None = None,
        progress: bool = True,
        *,
        workers: int | None = None,
        retries: int = 10,
    ) -> Study:
        """Runs the study until its budget is spent, and writes its report.

        Ctrl-C stops it; what was measured is safe, and ``run`` again goes on.

        Args:
            executor: Any ``concurrent.futures.Executor``, or what has its ``submit``: designs are measured there,
                and the journal is the same as with any other, or none, for the same batch. Without, they are
                measured on the threads of this process.
            progress: Show a line on standard error.
            workers: Measurements at a time; as many as the executor has unless given.
            retries: How often a measurement that a worker lost, or whose result is refused, is done again.

        Raises:
            StudyError: The executor fails, or the folder cannot be written.
            Interrupted: Ctrl-C.
        """
        _, unusable = run_open(self._open, executor, progress, workers, retries)
        if unusable is not None:
            raise _native.StudyError(unusable)
        return self

    def report(self) -> str:
        """Writes tables and plots again, as ``optimize report`` does; gives the path of the page."""
        written: dict[str, str] = json.loads(_native.report(self.path))
        return written["page"]

    def _open(self, workers: int | None) -> _native.Guided:
        return self._asked.open(workers)

    def _begun(self) -> bool:
        return os.path.exists(os.path.join(self.path, "study.toml"))

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
        if not self._begun():
            raise TypeError(f"{self!r} has not begun: run it before it is pickled")
        return load_study, (os.path.abspath(self.path),)

    def _repr_html_(self) -> str:
        if not self._begun():
            return f"<p>a study not begun yet: {html.escape(self.path)}</p>"
        return self._read().card()

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
        axes.step(np.arange(1, len(values) + 1), best, where="post", color=COLOURS[0], label="best so far")
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


@checked
def load_study(
    folder: StrPath,
    *,
    threads: int | None = None,
    cache: StrPath | None = None,
    no_cache: bool = False,
    no_confirm: bool = False,
    no_levers: bool = False,
    no_map: bool = False,
    accept_changed: bool = False,
    simulations: int | None = None,
    samples: int | None = None,
) -> Study:
    """The study in a folder; its :meth:`~Study.run` continues it. The words are those of :meth:`Study.create`.

    Raises:
        InputError: What is no study.
    """
    if not os.path.isfile(os.path.join(folder, "study.toml")):
        raise wrong("folder", f"{os.fspath(folder)} is not a study: it has no study.toml")
    _native.Recorded(os.fspath(folder))
    return Study(_native.resume(os.fspath(folder), **given(locals(), "folder")))


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
    svg: str = field(default="", repr=False, metadata=DRAWN)

    def _repr_html_(self) -> str:
        return self.svg


@checked
def compare(
    studies: Iterable[Study | StrPath], *, svg: StrPath | None = None, html: StrPath | None = None
) -> Comparison:
    """Compares optimizers over studies of the same task and objective, as ``optimize compare`` does.

    Args:
        studies: Studies, or their folders; several seeds of an optimizer give its quartiles.
        svg: Write a picture of the best so far.
        html: Write table and picture as a page.

    Raises:
        InputError: Studies that cannot be compared, or what is no study.
    """
    folders: list[StrPath] = [study.path if isinstance(study, Study) else os.fspath(study) for study in studies]
    text, picture = _native.compare(folders, **given({"html": html}))
    save(picture, svg)
    return Comparison.from_json({**json.loads(text), "svg": picture})


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
    svg: str = field(default="", repr=False, metadata=DRAWN)

    def _repr_html_(self) -> str:
        return self.svg


@checked
def sensitivity(
    task: Given,
    *,
    objective: Literal["range", "centred-range"] = "range",
    uncertainty: StrPath = "typical",
    samples: int = 64,
    seed: int = 0,
    svg: StrPath | None = None,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
) -> Sensitivity:
    """Finds out which input matters: of the design, the task and the cell, as ``optimize sensitivity`` does.

    Args:
        objective: What is varied.
        uncertainty: Errors of the cell that are varied, too: ``"typical"``, ``"none"``, or a file.
        samples: Rows of the sample: evaluations are this times (inputs + 2). Takes minutes.
        seed: Seed of the sample.
        svg: Write the chart.

    The rest, and what is raised, is as for :func:`evaluate`.
    """
    text, picture = _native.sensitivity(sources(task), **given(locals(), "task", "svg"))
    save(picture, svg)
    return Sensitivity.from_json({**json.loads(text), "svg": picture})
