"""Lists of shipped tasks, spaces, uncertainties and robots."""

from __future__ import annotations

from dataclasses import dataclass

from ._result import Result


@dataclass(frozen=True, repr=False)
class Named(Result):
    """Name and description of a shipped file."""

    name: str
    description: str


@dataclass(frozen=True, repr=False)
class TaskListed(Named):
    """A task, with the clearance at the seat of the plug."""

    clearance_x_mm: float
    clearance_y_mm: float


@dataclass(frozen=True, repr=False)
class Tasks(Result):
    """Shipped tasks, search spaces and uncertainties (distributions of errors)."""

    tasks: tuple[TaskListed, ...]
    spaces: tuple[Named, ...]
    uncertainties: tuple[Named, ...]


@dataclass(frozen=True, repr=False)
class RobotModel(Result):
    """A robot model, and the cell that it represents."""

    cell: str
    name: str
    description: str
    #: Stiffness at the TCP along x, y, z; None for a rigid robot.
    stiffness_n_per_mm: tuple[float, float, float]
    lag_s: float
    stop_force_n: float
    source: str


@dataclass(frozen=True, repr=False)
class Robots(Result):
    """Shipped robots, and an example of a robot file (``own_file``)."""

    robots: tuple[RobotModel, ...]
    own_file: str
