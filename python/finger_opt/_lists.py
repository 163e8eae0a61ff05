"""What is shipped."""

from __future__ import annotations

from dataclasses import dataclass

from ._result import Result


@dataclass(frozen=True, repr=False)
class Named(Result):
    """What has a name."""

    name: str
    description: str


@dataclass(frozen=True, repr=False)
class TaskListed(Named):
    """A task, with its clearance where the plug seats."""

    clearance_x_mm: float
    clearance_y_mm: float


@dataclass(frozen=True, repr=False)
class Tasks(Result):
    """Tasks, search spaces and sets of errors that are shipped."""

    tasks: tuple[TaskListed, ...]
    spaces: tuple[Named, ...]
    uncertainties: tuple[Named, ...]


@dataclass(frozen=True, repr=False)
class RobotModel(Result):
    """A robot, and the cell that it stands for."""

    cell: str
    name: str
    description: str
    #: At the TCP along x, y, z.
    stiffness_n_per_mm: tuple[float, float, float]
    lag_s: float
    stop_force_n: float
    source: str


@dataclass(frozen=True, repr=False)
class Robots(Result):
    """The robots that are shipped, and the text of a file for one's own."""

    robots: tuple[RobotModel, ...]
    own_file: str
