"""Finds the 3D-printed compliant finger that makes a connector insertion most robust.

>>> import finger_opt as fo
>>> fo.evaluate("usb", density=20, direction=10).range_mm      # doctest: +SKIP
7.2

Every call takes the words of the command line ``optimize`` as keywords, with underscores for
hyphens (``stiffness_data="mine.csv"``, ``walk=True``), and gives the numbers that ``--json``
prints, under the same keys; each key carries its unit (``range_mm``). Wrong arguments and files
raise :class:`InputError` (a ``ValueError``), what fails while it runs :class:`RunError` (a
``RuntimeError``), both with the text of the command line; unknown keywords are a ``TypeError``.
"""

from typing import Any

from ._measure import (
    CaptureMap, Evaluation, Levers, Trial, capture_map, evaluate, identify, levers, stiffness, trial,
)
from ._native import InputError, RunError, __version__
from ._optimizer import Optimizer, Point
from ._parts import Imported, import_parts
from ._run import perform
from ._study import Study, load_study
from ._task import Task

__all__ = [
    "CaptureMap",
    "Evaluation",
    "Imported",
    "InputError",
    "Levers",
    "Optimizer",
    "Point",
    "RunError",
    "Study",
    "Task",
    "Trial",
    "__version__",
    "capture_map",
    "evaluate",
    "import_parts",
    "identify",
    "levers",
    "load_study",
    "perform",
    "stiffness",
    "trial",
]


def __getattr__(name: str) -> Any:
    # The one needs gymnasium, which most do without; the other, a robot.
    if name in ("gym", "robot"):
        import importlib

        return importlib.import_module(f".{name}", __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
