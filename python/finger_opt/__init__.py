"""Finds the 3D-printed compliant gripper finger with which a connector insertion tolerates the largest start error.

>>> import finger_opt as fo
>>> fo.evaluate("usb", density=20, direction=10).range_mm
7.2

Simulation of a finger
    evaluate        tolerance window of a finger: largest shifts of the start that still insert
    sweep           windows of many fingers, as a table
    trial           one insertion with its time series; .replay() plays it
    capture_map     outcomes over two errors of the start
    levers          effect of other changes, compared with the infill
    sensitivity     share of each input in the variance
Optimization
    Study.create    seeded study in a folder; .run() starts or continues it
    load_study      study in a folder; .answer recommends the finger to print
    compare         comparison of optimizers over studies
Your own connector
    import_parts    task from meshes or STEP files
    new_task        task from a few dimensions
    check_task      problems of a task
    tune_task       start and strategy that insert the connector
    Task            task file as an object
Finger and bench
    stiffness       model fitted to measured fingers
    finger          mechanics of a printed finger
    export_finger   files for the printer
    export_mjcf     scene for MuJoCo
    Measurements    file of measurements; measuring_sheet writes a sheet for them
    calibrate       predicted range of every finger on the bench
    next_print      finger to print next
    identify        parameters of a cell from the robot's logs
    robot           measure_window, with a real or simulated robot
Other
    Optimizer       the optimizers, for any problem
    gym             insertion as a Gymnasium environment, for learning a search
    tasks, robots   shipped tasks and robots
    config          settings of finger-opt.toml; functions ignore this file
    perform         unit of work of a study, for custom executors

Each function takes the options of the command line ``optimize`` as keywords; help(fo.evaluate) lists them. Results are
frozen dataclasses with the keys of ``--json``, which contain the units; most have .plot() and a display for notebooks.

Errors: InputError (a ValueError) for an invalid value or file, TaskError for an invalid task file, StudyError (a
RuntimeError) for failures at run time, Interrupted (a KeyboardInterrupt) for Ctrl-C; all have .file, .key and .line.
Unknown keywords and values of a wrong type raise TypeError.
"""

from typing import TYPE_CHECKING

# `X as X` marks a name as public for type checkers.
from ._answer import Answer as Answer
from ._calibration import Advice as Advice, Calibration as Calibration, Measurements as Measurements
from ._commands import *
from ._commands import _FURTHER
from ._connector import NewTask as NewTask, TaskCheck as TaskCheck, Tuned as Tuned
from ._evaluation import Evaluation as Evaluation, Springs as Springs
from ._identify import Cell as Cell
from ._map import CaptureMap as CaptureMap, Levers as Levers
from ._native import __version__ as __version__
from ._optimizer import Optimizer as Optimizer, Point as Point
from ._parts import Imported as Imported, import_parts as import_parts
from ._run import perform as perform
from ._springs import Finger as Finger, StiffnessModel as StiffnessModel, stiffness as stiffness
from ._study import Comparison as Comparison, Sensitivity as Sensitivity, Study as Study
from ._sweep import sweep as sweep
from ._task import Task as Task
from ._trial import Film as Film, Series as Series, Trial as Trial
from .errors import (
    InputError as InputError, Interrupted as Interrupted, StudyError as StudyError, TaskError as TaskError,
)

# Commands that the text above does not list.
__doc__ = (__doc__ or "") + _FURTHER

if TYPE_CHECKING:
    from . import gym as gym
    from . import robot as robot


def __getattr__(name: str) -> object:
    # Imported on first use: `gym` needs the optional package gymnasium.
    if name in ("gym", "robot"):
        import importlib

        return importlib.import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    from importlib.util import find_spec

    # help() imports every name: it would fail on `gym` without gymnasium.
    lazy = {"robot"} if find_spec("gymnasium") is None else {"gym", "robot"}
    return sorted(name for name in {*globals(), *lazy} if not name.startswith("_") and name != "TYPE_CHECKING")
