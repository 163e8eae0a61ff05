"""Simulated robot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np

from ._attempts import Attempt
from ._call import checked, shown, wrong
from ._commands import trial
from ._rehearsal import Rehearsal
from ._task import Given
from ._words import StrPath

#: Engines of a simulated robot: those of a trial, and MuJoCo with its own controller.
RobotEngine = Literal["direct", "rapier", "fake", "mujoco"]


class SimulatedRobot:
    """Simulated robot for rehearsals, notebooks and tests.

    Task, density (percent), direction (degrees) and ``engine`` are those of :func:`finger_opt.trial`. ``cell``
    contains the true parameters: keywords of that function and numbers
    (``{"robot": "ur5e", "task.friction.plug_socket": 0.3}``), the name or path of a robot file, or the path of a
    ``cell.toml``. ``noise`` is the width, mm, over which the probability to insert falls from 90 to 10 % at an end:
    each start has a logistic error, which the logs do not contain. The forces in the logs have white noise of
    standard deviation ``force_noise_n`` and a drift up to ``force_drift_n`` at the end of the log, N. ``seed``
    determines all random numbers. ``taught_mm`` shifts the taught start along y.

    With ``engine="mujoco"`` (extra ``finger-opt[mujoco]``) the robot shares neither contact code nor controller with
    the simulation. Without ``cell``, friction, preload, stiffnesses and more are drawn from the shipped priors. Effects
    that the simulation does not model are drawn as well: backlash and drift of the robot, errors of the start, dry
    friction in the fingers, compliance of the socket's mount, noise and bias of the sensor. Robots with the same task
    and seed have the same cell, whatever their finger; ``hidden`` contains the drawn values by name.

    Raises :class:`InputError` for invalid values.
    """

    #: Longest time of an attempt, s: a loaded machine simulates slowly.
    timeout_s: float = 3600.0

    @checked
    def __init__(
        self,
        task: Given,
        density: float,
        direction: float,
        engine: RobotEngine = "direct",
        cell: Mapping[str, Any] | StrPath | None = None,
        noise: float = 0.0,
        seed: int = 0,
        *,
        force_noise_n: float = 0.0,
        force_drift_n: float = 0.0,
        taught_mm: float = 0.0,
    ) -> None:
        for name, value, unit in (("noise", noise, "a width in mm"), ("force_noise_n", force_noise_n, "a force in N"),
                                  ("force_drift_n", force_drift_n, "a force in N")):
            if not 0.0 <= value <= 100.0:
                raise wrong(name, f"is {value}; must be {unit}, 0 to 100")
        if seed < 0:
            raise wrong("seed", f"is {shown(seed)}; must be a whole number, 0 or above")
        if not -100.0 <= taught_mm <= 100.0:
            raise wrong("taught_mm", f"is {taught_mm}; must be a length in mm, -100 to 100")
        self._taught_mm = taught_mm
        self._finger: dict[str, Any] = {"task": task, "density": density, "direction": direction}
        self._settings: dict[str, Any] = {"engine": engine, **_trial_keywords(cell)}
        self._mujoco: Rehearsal | None = None
        #: Drawn true parameters by name; empty unless the engine is ``mujoco``.
        self.hidden: dict[str, float] = {}
        if engine == "mujoco":
            self._mujoco = Rehearsal(task, density, direction, None if cell is None else _trial_keywords(cell), seed)
            self.hidden = self._mujoco.hidden
        self._error_scale_mm, self._start_errors = noise / (2.0 * math.log(9.0)), np.random.default_rng(seed)
        # A separate stream, so that logging does not change the attempts.
        self._sensor = np.random.default_rng([seed, 1])
        self._noise_n, self._drift_n = force_noise_n, force_drift_n

    def insert(self, offset_mm: float, log: Path | None = None) -> Attempt:
        """Simulates an insertion, and records it in ``log``, except with the engine ``fake``."""
        error_mm = self._error_scale_mm * float(self._start_errors.logistic())
        if self._mujoco is not None:
            ended = self._mujoco.insert(offset_mm + self._taught_mm + error_mm, log)
            if log is not None:
                self._add_sensor_errors(log, error_mm)
            return Attempt(ended.inserted, ended.failure, ended.depth_mm, ended.peak_force_n, log)
        if self._settings["engine"] == "fake":
            log = None
        found = trial(**self._finger, offset_mm=offset_mm + self._taught_mm + error_mm, log=log, **self._settings)
        if log is not None:
            self._add_sensor_errors(log, error_mm)
        return Attempt(found.outcome == "inserted", found.failure, found.depth_mm, found.peak_force_n, log)

    def probe(self, log: Path) -> None:
        """Simulates slow slides along y on a flat face, and records them in ``log``."""
        if self._mujoco is not None:
            self._mujoco.probe(log)
        else:
            trial(**self._finger, probe=True, log=log, **self._settings)
        self._add_sensor_errors(log, 0.0)

    def _add_sensor_errors(self, log: Path, error_mm: float) -> None:
        """Rewrites a log with sensor noise and drift, and without the start error, which a robot would not measure."""
        with log.open(encoding="utf-8") as file:
            header = file.readline().strip()
            rows = np.loadtxt(file, delimiter=",", ndmin=2)
        names = header.split(",")
        for name in ("y_mm", "target_y_mm"):
            rows[:, names.index(name)] -= error_mm
        time = rows[:, names.index("t_s")]
        share = (time - time[0]) / max(time[-1] - time[0], 1e-9)
        for name in ("fx_n", "fy_n", "fz_n"):
            drift = self._drift_n * self._sensor.choice((-1.0, 1.0)) * share
            rows[:, names.index(name)] += drift + self._noise_n * self._sensor.standard_normal(len(rows))
        np.savetxt(log, rows, fmt="%.7g", delimiter=",", header=header, comments="")


def _trial_keywords(cell: Mapping[str, Any] | StrPath | None) -> dict[str, Any]:
    """Returns a cell as keywords of a trial."""
    if cell is None or isinstance(cell, Mapping):
        keywords = {str(name): value for name, value in (cell or {}).items() if "." not in str(name)}
        numbers = {str(name): value for name, value in (cell or {}).items() if "." in str(name)}
        return {**keywords, "set": {**keywords.get("set", {}), **numbers}}
    path = Path(cell)
    # A cell file has [[parameter]] tables, a robot file has not.
    is_cell = path.suffix == ".toml" and path.is_file() and "[[parameter]]" in path.read_text("utf-8", "replace")
    return {"cell" if is_cell else "robot": cell}
