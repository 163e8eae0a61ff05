"""One's own connector: a task made, checked and tuned."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from . import _native
from ._call import checked, given, without, wrong
from ._drawn import COLOURS
from ._plot import axes as axes_of, text
from ._result import DRAWN, Result, save
from ._task import Given, Task, sources
from ._words import Engine, Outcome, RobotName, StrPath, TaskName

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
    svg: str = field(default="", repr=False, metadata=DRAWN)

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


@checked
def new_task(
    name: str,
    *,
    plug: tuple[float, float, float] | None = None,
    round: tuple[float, float] | None = None,
    clearance: float | None = None,
    body: tuple[float, float, float] | None = None,
    like: StrPath | None = None,
    out: StrPath | None = None,
    engine: Engine = "direct",
) -> NewTask:
    """Writes a commented task file from a few dimensions, as ``optimize task new`` does, and tries it.

    Args:
        name: Letters, digits, - and _.
        plug: What goes in: width (y, between the jaws), height (x), length, mm.
        round: What goes in, if it is a cylinder: diameter, length, mm.
        clearance: Opening less plug in x and y, mm: both sides together.
        body: What the fingers hold, above the plug: width, height, length, mm; the plug itself unless given.
        like: In place of all that another task, whose copy is written.
        out: File to write; ``NAME.toml`` unless given.
        engine: Contact engine that tries the nominal start.

    Raises:
        InputError: Dimensions that cannot be, or a file that is there already.
        Interrupted: Ctrl-C.
    """
    if plug is not None:
        without("plug", "one of them goes in", round=round)
    if plug is None and round is None:
        without("no plug", "they go with plug or round", clearance=clearance, body=body)
    elif clearance is None:
        raise wrong("clearance", "is missing: opening less plug in x and y, mm, both sides together")
    words = given(locals(), "name", "plug", "round", "body")
    sizes = {"plug": plug, "round": round, "body": body}
    words |= {key: "x".join(f"{length:.10g}" for length in size) for key, size in sizes.items() if size is not None}
    return NewTask.from_json(json.loads(_native.new_task(name, **words)))


@checked
def check_task(
    task: Given, *, svg: StrPath | None = None, robot: RobotName | StrPath = "servo", engine: Engine = "direct"
) -> TaskCheck:
    """Looks for what cannot work in a task, and tries its nominal start, as ``optimize task check`` does.

    >>> import finger_opt as fo
    >>> fo.check_task("usb").inserts
    True

    Args:
        task: A shipped name, the path of a task file, or a :class:`Task`.
        svg: Write the drawing.
        robot: Robot: a name or a file.
        engine: Contact engine.

    Raises:
        InputError: A file that cannot be read. What is wrong in it is a result, not an error.
        Interrupted: Ctrl-C.
    """
    text, picture = _native.check_task(sources(task)[0], **given(locals(), "task", "svg"))
    save(picture, svg)
    return TaskCheck.from_json({**json.loads(text), "svg": picture})


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
    fingers: tuple[TunedFinger, ...]


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
    colours = dict(zip(names, ("black", *(COLOURS[number] for number in (2, 4, 0))), strict=True))
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


@checked
def tune_task(
    task: TaskName | StrPath,
    *,
    robot: RobotName | StrPath = "servo",
    engine: Engine = "direct",
    seed: int = 0,
    out: StrPath | None = None,
    dry_run: bool = False,
    svg: StrPath | None = None,
) -> Tuned:
    """Finds a start and a strategy by which a connector inserts, as ``optimize task tune`` does, within a minute.

    Args:
        task: The path of a task file, which is written anew, or with ``out`` a shipped name, too.
        robot: Robot: a name or a file.
        engine: Contact engine.
        seed: Seed of the search.
        out: Write this new file in place of the task's own.
        dry_run: Write no task file.
        svg: Write a drawing of the search before and after.

    Raises:
        InputError: A task that cannot be used; :class:`TaskError` if its file is wrong.
        Interrupted: Ctrl-C.
    """
    return Tuned.from_json(json.loads(_native.tune_task(task, **given(locals(), "task"))))
