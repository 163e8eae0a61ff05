"""Evaluations, trials and stiffness."""

from __future__ import annotations

import html
import json
import os
from typing import Any

import numpy as np

from . import _native
from ._task import Given, sources


class Record(dict[str, Any]):
    """Measured values by key, as ``--json`` prints them; keys are attributes, too."""

    def __getattr__(self, key: str) -> Any:
        try:
            return self[key]
        except KeyError:
            raise AttributeError(f"no value is called `{key}`; there are {', '.join(self)}") from None

    def __dir__(self) -> list[str]:
        return [*self, *super().__dir__()]

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th style='text-align:left'>{html.escape(key)}</th>"
            f"<td style='text-align:left'>{html.escape(_cell(value))}</td></tr>"
            for key, value in self.items()
        )
        return f"<table>{rows}</table>"


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_cell(one)}" for key, one in value.items())
    if isinstance(value, list):
        return ", ".join(_cell(one) if not isinstance(one, dict) else one.get("name", "") for one in value)
    return "none" if value is None else str(value)


class Evaluation(Record):
    """The tolerance window of one finger on one task: ``range_mm``, ``negative_mm``,
    ``positive_mm`` (the shifts of the start that insert), ``failure_negative`` and
    ``failure_positive`` (class 1 to 4 of what ends it), ``peak_force_n``, ``slip_mm``."""


class Levers(Record):
    """What moves the range of one finger on one task: ``sentence``, ``base`` (its ``range_mm`` from a
    taught start), ``infill_range_mm``, and ``levers``, most first: ``name``, ``value``, ``low`` and
    ``high`` in ``unit``, their ``source``, and ``range_mm`` at both (``None``: nothing inserts)."""


class Trial(Record):
    """One simulated insertion: ``outcome``, ``failure``, ``depth_mm``, ``tilt_deg``,
    ``peak_force_n``, ``slip_mm``, ``phases``, and its course from the start of the search on.

    ``series`` holds ``n`` samples as NumPy arrays of float64, in the task frame (origin at the
    middle of the socket's opening, z out of it): ``time_s`` (n), ``phase`` (n, place among
    ``phases``), ``tcp_mm`` (n, 3), ``tip_mm`` (n, 3), ``tilt_deg`` (n), ``force_n`` (n, 3: of
    the socket on the plug) and ``slip_mm`` (n).
    """

    series: dict[str, np.ndarray]

    def __init__(self, fields: dict[str, Any], series: dict[str, np.ndarray]) -> None:
        super().__init__(fields)
        self.__dict__["series"] = series


class CaptureMap(Record):
    """How insertions of one finger end over two errors of the start: ``axes`` (each with ``name``,
    ``unit``, ``low``, ``high``, ``step``), ``area`` in ``area_unit``, ``trials``; a notebook draws it.

    ``outcomes`` and ``simulated`` are NumPy arrays as attributes: a row for each value of the second
    axis, in it a number for each shift along y. An outcome is 0 if inserted, 1 to 4 for the failure
    class, -1 if the simulation diverged; what was not simulated is taken over from its neighbours.
    """

    svg: str

    def __init__(self, fields: dict[str, Any], svg: str) -> None:
        super().__init__(fields)
        self.__dict__["svg"] = svg

    @property
    def outcomes(self) -> np.ndarray:
        return np.array(self["outcomes"], dtype=np.int64)

    @property
    def simulated(self) -> np.ndarray:
        return np.array(self["simulated"], dtype=bool)

    def _repr_html_(self) -> str:
        return self.svg


def evaluate(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    **settings: Any,
) -> Evaluation:
    """Measures the tolerance window of one finger, as ``optimize evaluate`` does.

    ``task`` is a shipped name, the path of a task file or a :class:`Task`; ``density`` is the
    infill density in percent, ``direction`` its direction in degrees. ``settings`` are the
    words of ``optimize evaluate`` (``walk=True``, ``robot="ur5e"``, ``uncertainty="typical"``,
    ``stiffness_compliance=2.2, stiffness_assembly=55`` in N/mm in place of the infill), and
    numbers of task and finger by their keys: ``**{"task.strategy.tilt_deg": 8}``.

    Takes about a second, without the interpreter's lock; Ctrl-C ends it.
    """
    found = _native.evaluate(sources(task), density=density, direction=direction, **settings)
    return Evaluation(json.loads(found))


def identify(
    task: Given,
    runs: str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    *,
    frame: str | os.PathLike[str] | None = None,
    report: str | os.PathLike[str] | None = None,
    **settings: Any,
) -> Record:
    """Tells from a robot's logs what its cell is like, as ``optimize identify`` does, and writes it to ``out``.

    ``runs`` is the table of the logs that :func:`finger_opt.robot.measure_window` writes, ``frame`` the task's
    frame in the robot's base, of logs that are not in the task's frame; ``report`` a page to write. ``unknowns``
    of the result are the numbers of the cell, ``value`` and ``sd`` as identified. The rest is as for
    :func:`evaluate`.
    """
    found = _native.identify(sources(task), runs=runs, out=out, frame=frame, report=report, **settings)
    return Record(json.loads(found))


def levers(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    **settings: Any,
) -> Levers:
    """What would help a finger more than its infill, as ``optimize levers`` finds it: tilt, strokes,
    preload, speed, grip, friction, clearance, chamfer, robot, one at a time.

    At most 20 windows, each from a start taught for it. Words and numbers are as for :func:`evaluate`.
    """
    found = _native.levers(sources(task), density=density, direction=direction, **settings)
    return Levers(json.loads(found))


def trial(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    offset_mm: float = 0.0,
    *,
    every_s: float = 0.001,
    **settings: Any,
) -> Trial:
    """Simulates one insertion, as ``optimize trial`` does, and samples its course.

    ``offset_mm`` shifts the start along y; ``every_s`` is the simulated time between two
    samples, s. The rest is as for :func:`evaluate`.
    """
    settings = {"density": density, "direction": direction, "offset_mm": offset_mm, **settings}
    fields, columns = _native.trial(sources(task), every_s=every_s, **settings)
    series = {name: np.frombuffer(column, dtype="<f8") for name, column in columns.items()}
    for name in ("tcp_mm", "tip_mm", "force_n"):
        series[name] = series[name].reshape(-1, 3)
    series["phase"] = series["phase"].astype(np.int64)
    return Trial(json.loads(fields), series)


def capture_map(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    **settings: Any,
) -> CaptureMap:
    """Traces the capture map of one finger, as ``optimize map`` does, with at most 300 trials.

    ``axes`` is ``"y,x"``, ``"y,yaw"`` or ``"y,tilt"``. The rest is as for :func:`evaluate`.
    """
    settings = {"density": density, "direction": direction, **settings}
    fields, svg = _native.capture_map(sources(task), **settings)
    return CaptureMap(json.loads(fields), svg)


def stiffness(
    density: float | None = None,
    direction: float | None = None,
    *,
    stiffness_data: str | os.PathLike[str] | None = None,
) -> Record:
    """The stiffness predicted for an infill, or, without one, how well the model fits.

    ``density`` in percent, ``direction`` in degrees; the result has ``compliance_n_per_mm``
    and ``assembly_n_per_mm`` with their standard deviations ``.._sd_n_per_mm``,
    ``inside_hull`` and ``hull_distance``. Without an infill: the leave-one-out errors that
    ``optimize stiffness --json`` prints. ``stiffness_data`` is the path of a CSV file with your
    own measurements in place of the shipped ones.
    """
    if density is None and direction is None:
        found = _native.stiffness(stiffness_data=stiffness_data)
    elif density is None or direction is None:
        raise _native.InputError("give density and direction, or neither")
    else:
        found = _native.predict(density, direction, stiffness_data=stiffness_data)
    return Record(json.loads(found))
