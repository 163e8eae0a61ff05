"""Finds the 3D-printed compliant finger that makes a connector insertion most robust.

>>> import finger_opt as fo
>>> fo.evaluate("usb", density=20, direction=10).range_mm
7.2

A finger on a task
    evaluate        the tolerance window of a finger: how far the start may be off
    sweep           the windows of many fingers, as a table
    trial           one insertion, with its course; .replay() plays it
    capture_map     how insertions end over two errors of the start
    levers          what would help more than the infill
    sensitivity     which input matters
A search
    Study.create    a seeded study in a folder; .run() begins or continues it
    load_study      the study in a folder; .answer says which finger to print
    compare         optimizers over studies
One's own connector
    import_parts    a task from meshes or STEP files
    new_task        a task from a few dimensions
    check_task      what cannot work in it
    tune_task       a start and a strategy by which it inserts
    Task            a task file as an object
Finger and bench
    stiffness       the model fitted to measured fingers
    finger          the mechanics of a printed finger
    export_finger   files for the printer
    export_mjcf     the scene for MuJoCo
    Measurements    a file of measurements; measuring_sheet prints a sheet for them
    calibrate       what every finger does on the bench
    next_print      which finger to print next
    identify        what a robot's logs say of its cell
    robot           measure_window with a robot, or with a simulated one
Else
    Optimizer       the optimizers, for any problem
    gym             an insertion as an environment, to learn a search
    tasks, robots   what is shipped
    config          the settings of finger-opt.toml, which is read only so
    perform         the unit of work of a study, for an executor of one's own

Each call takes the words of the command line ``optimize`` as keywords; help(fo.evaluate) lists them. Results are
frozen dataclasses with the keys of ``--json``, each with its unit; most have .plot(), and a notebook draws them.

Errors: InputError (a ValueError) for a wrong value or file, TaskError if it is a task file, StudyError (a
RuntimeError) for what fails while it runs, Interrupted (a KeyboardInterrupt) for Ctrl-C; with .file, .key, .line.
An unknown keyword and a value of a wrong type are a TypeError.
"""

from typing import TYPE_CHECKING

# Each by its own name: these, and nothing else, are what a user calls.
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

# What this page does not name.
__doc__ = (__doc__ or "") + _FURTHER

if TYPE_CHECKING:
    from . import gym as gym
    from . import robot as robot


def __getattr__(name: str) -> object:
    # The one needs gymnasium, which most do without; the other, a robot.
    if name in ("gym", "robot"):
        import importlib

        return importlib.import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    from importlib.util import find_spec

    # What cannot be imported would keep help() from its end.
    lazy = {"robot"} if find_spec("gymnasium") is None else {"gym", "robot"}
    return sorted(name for name in {*globals(), *lazy} if not name.startswith("_") and name != "TYPE_CHECKING")
