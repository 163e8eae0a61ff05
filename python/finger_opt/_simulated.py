"""A robot that is simulated."""

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

#: Engines of a simulated robot: those of a trial, and MuJoCo with a controller of its own.
RobotEngine = Literal["direct", "rapier", "fake", "mujoco"]


class SimulatedRobot:
    """A robot that is simulated: for rehearsals, notebooks and tests.

    Task, density (percent), direction (degrees) and ``engine`` are those of :func:`finger_opt.trial`. ``cell``
    is what the robot hides: words of that function and numbers (``{"robot": "ur5e", "task.friction.plug_socket": 0.3}``),
    the name or path of a robot file, or the path of a ``cell.toml``. ``noise`` is the width, mm, over which the
    probability to insert goes from 90 to 10 % at an end: each start is off by a logistic error, which no log
    shows. The forces in the logs have white noise of standard deviation ``force_noise_n`` and a drift that
    rises to ``force_drift_n`` until the log ends, N. All is drawn with ``seed``. ``taught_mm`` moves the taught start
    along y.

    With ``engine="mujoco"`` (extra ``finger-opt[mujoco]``) the robot shares neither contact nor controller with the
    simulation. Without ``cell`` the seed draws friction, preload, stiffnesses and more from the shipped priors; it
    also draws what the simulation does not know: play and drift of the robot, errors of the start, dry friction in
    the fingers, a socket on a spring, noise and bias of the sensor. Robots with the same task and seed share the cell,
    whatever their finger; ``hidden`` is what was drawn, by name.
    """

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
                raise wrong(name, f"is {value}; it is {unit}, 0 to 100")
        if seed < 0:
            raise wrong("seed", f"is {shown(seed)}; it is a whole number, 0 or above")
        if not -100.0 <= taught_mm <= 100.0:
            raise wrong("taught_mm", f"is {taught_mm}; it is a length in mm, -100 to 100")
        self._taught_mm = taught_mm
        self._finger: dict[str, Any] = {"task": task, "density": density, "direction": direction}
        self._settings: dict[str, Any] = {"engine": engine, **_hidden(cell)}
        self._mujoco: Rehearsal | None = None
        #: Hidden numbers by name, of a robot in MuJoCo.
        self.hidden: dict[str, float] = {}
        if engine == "mujoco":
            self._mujoco = Rehearsal(task, density, direction, None if cell is None else _hidden(cell), seed)
            self.hidden = self._mujoco.hidden
        self._scale, self._drawn = noise / (2.0 * math.log(9.0)), np.random.default_rng(seed)
        # Of its own: the logs change no attempt.
        self._sensor = np.random.default_rng([seed, 1])
        self._noise_n, self._drift_n = force_noise_n, force_drift_n

    def insert(self, offset_mm: float, log: Path | None = None) -> Attempt:
        """Simulates the insertion, and records it in ``log``; the engine ``fake`` has nothing to record."""
        error_mm = self._scale * float(self._drawn.logistic())
        if self._mujoco is not None:
            seen = self._mujoco.insert(offset_mm + self._taught_mm + error_mm, log)
            if log is not None:
                self._sense(log, error_mm)
            return Attempt(seen.inserted, seen.failure, seen.depth_mm, seen.peak_force_n, log)
        if self._settings["engine"] == "fake":
            log = None
        ended = trial(**self._finger, offset_mm=offset_mm + self._taught_mm + error_mm, log=log, **self._settings)
        if log is not None:
            self._sense(log, error_mm)
        return Attempt(ended.outcome == "inserted", ended.failure, ended.depth_mm, ended.peak_force_n, log)

    def probe(self, log: Path) -> None:
        """Simulates slow slides along y on a flat face, and records them in ``log``."""
        if self._mujoco is not None:
            self._mujoco.probe(log)
        else:
            trial(**self._finger, probe=True, log=log, **self._settings)
        self._sense(log, 0.0)

    def _sense(self, log: Path, error_mm: float) -> None:
        """Writes the log as the robot would: it does not know by how much its start is off."""
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


def _hidden(cell: Mapping[str, Any] | StrPath | None) -> dict[str, Any]:
    """The settings of a trial that a cell is."""
    if cell is None or isinstance(cell, Mapping):
        words = {str(name): value for name, value in (cell or {}).items() if "." not in str(name)}
        numbers = {str(name): value for name, value in (cell or {}).items() if "." in str(name)}
        return {**words, "set": {**words.get("set", {}), **numbers}}
    path = Path(cell)
    # A robot file has no unknowns.
    unknowns = path.suffix == ".toml" and path.is_file() and "[[parameter]]" in path.read_text("utf-8", "replace")
    return {"cell" if unknowns else "robot": cell}
