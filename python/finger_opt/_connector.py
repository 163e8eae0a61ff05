"""One's own connector: a task made, checked and tuned."""

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
    """What is wrong at a key of a task file, and what would be right."""

    key: str
    problem: str
    remedy: str


@dataclass(frozen=True, repr=False)
class Nominal(Result):
    """How the insertion from the nominal start ends with a finger of medium stiffness."""

    outcome: Outcome
    failure: int | None
    depth_mm: float
    tilt_deg: float
    peak_force_n: float
    slip_mm: float
    compliance_n_per_mm: float
    assembly_n_per_mm: float
    explanation: str


@dataclass(frozen=True, repr=False)
class Step(Result):
    """A strategy that was tried: the ranges with a soft, a medium and a stiff finger, mm."""

    stage: str
    what: str
    least_range_mm: float | None
    range_mm: tuple[float | None, ...]
    turned_least_range_mm: float | None = None


@dataclass(frozen=True, repr=False)
class TaskCheck(Result):
    """What is wrong with a task, and how its nominal start ends; a notebook draws plug, socket and search path."""

    valid: bool
    problems: tuple[Problem, ...]
    nominal: Nominal | None
    #: By what a task that does not insert would, if by anything.
    mended_by: Step | None = None
    svg: str = field(default="", repr=False, metadata=PICTURE)

    @property
    def inserts(self) -> bool:
        """Whether nothing is wrong and the plug goes in."""
        return self.valid and self.nominal is not None and self.nominal.outcome == "inserted"

    def _repr_html_(self) -> str:
        return self.svg + super()._repr_html_()


@dataclass(frozen=True, repr=False)
class NewTask(Result):
    """A task file that was written, and its check."""

    out: str
    check: TaskCheck
    #: The strategy that was found for it, if it needed one.
    tuned: Step | None = None

    @property
    def task(self) -> Task:
        """The task of the file."""
        return Task.from_toml(self.out)


@dataclass(frozen=True, repr=False)
class TunedFinger(Result):
    """The window with one of three fingers, mm from the start."""

    compliance_n_per_mm: float
    assembly_n_per_mm: float
    nominal: Outcome
    window_mm: tuple[float, float]
    range_mm: float


@dataclass(frozen=True, repr=False)
class Strategy(Result):
    """Start and tilt of a search, and the windows with a soft, a medium and a stiff finger."""

    start_mm: tuple[float, float, float]
    tilt_deg: float
    push_speed_mm_per_s: float
    largest_force_n: float
    fingers: tuple[TunedFinger, ...]


@dataclass(frozen=True, repr=False)
class TuneLimits(Result):
    """What a search keeps to, or None: force between plug and socket and speed of a phase."""

    force_n: float | None
    speed_mm_per_s: float | None


@dataclass(frozen=True, repr=False)
class By(Result):
    """What made the strategy."""

    stage: Literal["as-it-is", "start", "families", "search"]
    what: str


@dataclass(frozen=True, repr=False)
class Kept(Result):
    """The least range that is kept under a change of the cell, mm."""

    change: str
    least_range_mm: float


@dataclass(frozen=True, repr=False)
class Nearest(Result):
    """The trial that came nearest, where none inserted."""

    outcome: str
    phase: str
    depth_mm: float
    tilt_deg: float
    plug_and_socket_part: tuple[str, str] | None = None


@dataclass(frozen=True, repr=False)
class Tuned(Result):
    """A start and a strategy by which a connector inserts, or what was tried in vain."""

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
        """Draws the strategies that were tried; gives the axes."""
        return _strategies(self, ax)


def _strategies(found: Tuned, ax: Drawing | None) -> Drawing:
    """The strategies that were tried; a cross fails once the socket is turned, a ring is what was taken."""
    axes = axes_of(ax, width=9.0)
    names = {"as-it-is": "as it is", "start": "start taught", "families": "like a shipped task", "search": "searched"}
    colours = dict(zip(names, ("black", *(COLOURS[number] for number in (2, 4, -1))), strict=True))
    taken = next(at for at, step in enumerate(found.steps, 1) if (step.stage, step.what) == (found.by.stage, found.by.what))
    for at, step in enumerate(found.steps, 1):
        axes.plot(at, step.least_range_mm or 0.0, "x" if step.turned_least_range_mm == 0.0 else "o", color=colours[step.stage])
    axes.plot(taken, found.steps[taken - 1].least_range_mm or 0.0, "o", markersize=13, markerfacecolor="none",
              color=COLOURS[3], label="taken")
    for stage in dict.fromkeys(step.stage for step in found.steps):
        axes.plot([], [], "o", color=colours[stage], label=names[stage])
    if any(step.turned_least_range_mm == 0.0 for step in found.steps):
        axes.plot([], [], "x", color=colours["search"], label="fails with the socket\nturned by 1°")
    axes.set(xlabel="strategy tried", ylabel="narrowest window of three fingers, mm", title=text(f"{found.task}: {found.by.what}"))
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return axes
