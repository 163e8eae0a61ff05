"""Results of creating, checking and tuning a task of your own connector."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from ._drawn import COLOURS
from ._plot import axes as axes_of, text
from ._result import PICTURE, Result
from ._task import Task
from ._words import Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing


@dataclass(frozen=True, repr=False)
class Problem(Result):
    """Problem at a key of a task file, and its remedy."""

    key: str
    problem: str
    remedy: str


@dataclass(frozen=True, repr=False)
class Nominal(Result):
    """Outcome of the insertion from the nominal start with a finger of medium stiffness."""

    outcome: Outcome
    failure: int | None
    robot_stopped: bool
    depth_mm: float
    tilt_deg: float
    peak_force_n: float
    slip_mm: float
    compliance_n_per_mm: float
    assembly_n_per_mm: float
    explanation: str


@dataclass(frozen=True, repr=False)
class Step(Result):
    """Strategy that was tried, with its ranges for a soft, a medium and a stiff finger, mm."""

    stage: str
    what: str
    least_range_mm: float | None
    range_mm: tuple[float | None, ...]
    #: Smallest range of further fingers with the socket turned in either direction, mm, if it was checked.
    turned_least_range_mm: float | None = None


@dataclass(frozen=True, repr=False)
class TaskCheck(Result):
    """Problems of a task, and outcome of its nominal start; a notebook draws plug, socket and search path."""

    valid: bool
    problems: tuple[Problem, ...]
    nominal: Nominal | None
    #: A weak grip, and a robot stop although the plug is seated.
    warnings: tuple[str, ...]
    #: Strategy with which a task that does not insert would insert, if one was found.
    mended_by: Step | None = None
    svg: str = field(default="", repr=False, metadata=PICTURE)

    @property
    def inserts(self) -> bool:
        """Whether the task has no problems and its nominal start inserts."""
        return self.valid and self.nominal is not None and self.nominal.outcome == "inserted"

    def _repr_html_(self) -> str:
        return self.svg + super()._repr_html_()


@dataclass(frozen=True, repr=False)
class NewTask(Result):
    """Written task file, and its check; accepted wherever a task is, as the path of its file."""

    out: str
    check: TaskCheck
    #: Strategy that was found, if the nominal start did not insert.
    tuned: Step | None = None

    @property
    def task(self) -> Task:
        """Task read from the written file."""
        return Task.from_toml(self.out)

    def __fspath__(self) -> str:
        return self.out


@dataclass(frozen=True, repr=False)
class TunedFinger(Result):
    """Window with one of three fingers, mm from the start."""

    compliance_n_per_mm: float
    assembly_n_per_mm: float
    nominal: Outcome
    window_mm: tuple[float, float]
    range_mm: float


@dataclass(frozen=True, repr=False)
class Strategy(Result):
    """Start, tilt, push speed and peak force of a strategy; windows with a soft, a medium and a stiff finger."""

    start_mm: tuple[float, float, float]
    tilt_deg: float
    push_speed_mm_per_s: float
    largest_force_n: float
    fingers: tuple[TunedFinger, ...]


@dataclass(frozen=True, repr=False)
class TuneLimits(Result):
    """Limits of a search, None if unlimited: force between plug and socket, and speed of a phase."""

    force_n: float | None
    speed_mm_per_s: float | None


@dataclass(frozen=True, repr=False)
class By(Result):
    """Origin of the recommended strategy: the stage that found it, and a description."""

    stage: Literal["as-it-is", "start", "families", "search"]
    what: str


@dataclass(frozen=True, repr=False)
class Kept(Result):
    """Smallest range of the fingers after a change of the cell, mm."""

    change: str
    least_range_mm: float


@dataclass(frozen=True, repr=False)
class Nearest(Result):
    """Trial that came closest to an insertion, if none inserted."""

    outcome: str
    robot_stopped: bool
    phase: str
    depth_mm: float
    tilt_deg: float
    plug_and_socket_part: tuple[str, str] | None = None


@dataclass(frozen=True, repr=False)
class Tuned(Result):
    """Start and strategy that insert a connector, and all strategies that were tried."""

    schema_version: int
    task: str
    inserts: bool
    limits: TuneLimits
    windows: int
    before: Strategy
    after: Strategy | None
    by: By
    steps: tuple[Step, ...]
    kept: tuple[Kept, ...]
    nearest: Nearest | None
    out: str | None

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the strategies that were tried; returns the axes."""
        return _strategies(self, ax)


def _strategies(tuned: Tuned, ax: Drawing | None) -> Drawing:
    """Draws the least range of each strategy; a cross fails with the socket turned, a ring marks the chosen one."""
    axes = axes_of(ax, width=9.0)
    names = {"as-it-is": "as it is", "start": "start taught", "families": "like a shipped task", "search": "searched"}
    colours = dict(zip(names, ("black", *(COLOURS[number] for number in (2, 4, -1))), strict=True))
    chosen = next(at for at, step in enumerate(tuned.steps, 1)
                  if (step.stage, step.what) == (tuned.by.stage, tuned.by.what))
    for at, step in enumerate(tuned.steps, 1):
        marker = "x" if step.turned_least_range_mm == 0.0 else "o"
        axes.plot(at, step.least_range_mm or 0.0, marker, color=colours[step.stage])
    axes.plot(chosen, tuned.steps[chosen - 1].least_range_mm or 0.0, "o", markersize=13, markerfacecolor="none",
              color=COLOURS[3], label="taken")
    for stage in dict.fromkeys(step.stage for step in tuned.steps):
        axes.plot([], [], "o", color=colours[stage], label=names[stage])
    if any(step.turned_least_range_mm == 0.0 for step in tuned.steps):
        axes.plot([], [], "x", color=colours["search"], label="fails with the socket\nturned by 1°")
    axes.set(xlabel="strategy tried", ylabel="narrowest window of three fingers, mm",
             title=text(f"{tuned.task}: {tuned.by.what}"))
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return axes
