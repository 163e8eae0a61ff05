"""Robot simulated in MuJoCo, with contact model and controller independent of this package's simulation."""

from __future__ import annotations

import json
import tempfile
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._commands import export_mjcf
from ._native import InputError
from ._task import Given, Task

#: Physics step and controller period, s. A quarter of this step gives the same windows, twice this step does not.
STEP_S = 5e-5
TICK_S = 1e-3
#: Time constant of the force sensor's low-pass filter, s.
FORCE_FILTER_S = 5e-3
#: Durations of the grasp, of carrying, and of the rest after a move, s.
GRASP_S, CARRY_S, REST_S = 0.3, 0.2, 0.05
#: Default force that ends a touch phase, N, and longest time without contact before a finger has let go, s.
CONTACT_N, NO_CONTACT_S = 1.0, 0.02
#: Depth from which a plug that is not seated counts as jammed (class 3), not as beside the opening (class 2), mm.
ENTERED_MM = 0.5
#: Normal force, stroke and speed of the friction probe, N, mm, mm/s.
PROBE_N, PROBE_MM, PROBE_MM_PER_S = 5.0, 8.0, 5.0
#: Columns of a log.
LOG_COLUMNS = ("t_s", "x_mm", "y_mm", "z_mm", "tilt_deg", "fx_n", "fy_n", "fz_n",
               "target_x_mm", "target_y_mm", "target_z_mm")

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class UnmodelledEffects:
    """Effects of a real cell that this package's simulation does not model; drawn once per cell.

    The ranges are assumptions for a good table-top robot and printed fingers.
    """

    #: Backlash of each axis, mm.
    backlash_mm: float
    #: Standard deviation of the tool's random walk per attempt and axis, mm.
    drift_mm: float
    #: Standard deviation of the start position along x and y, mm.
    start_error_mm: float
    #: Dry friction in each finger along the closing direction, N: half the width of the hysteresis loop.
    hysteresis_n: float
    #: Stiffness of the socket's mount along each axis, N/mm.
    mount_n_per_mm: float
    #: Standard deviations of the force sensor per axis, N: white noise, bias, and drift over the log.
    force_noise_n: float
    force_bias_n: float
    force_drift_n: float

    RANGES = {"backlash_mm": (0.01, 0.06), "drift_mm": (0.0, 0.01), "start_error_mm": (0.01, 0.06),
              "hysteresis_n": (0.05, 0.4), "mount_n_per_mm": (50.0, 400.0), "force_noise_n": (0.1, 0.5),
              "force_bias_n": (0.2, 1.5), "force_drift_n": (0.1, 1.0)}

    @classmethod
    def draw(cls, random: np.random.Generator) -> UnmodelledEffects:
        """Returns effects drawn uniformly from their ranges."""
        return cls(**{field.name: float(random.uniform(*cls.RANGES[field.name])) for field in fields(cls)})


@dataclass
class AttemptResult:
    """Result of an attempt; ``failure`` is the class, 1 to 4, or None if the plug was inserted."""

    inserted: bool
    failure: int | None
    depth_mm: float
    peak_force_n: float


class GripLost(Exception):
    """Loss of the plug: both fingers have let go, or it has slipped beyond the limit."""


class Rehearsal:
    """MuJoCo model of a task's cell, with hidden parameters, and one finger.

    ``density`` is in percent, ``direction`` in degrees. ``cell`` contains keyword arguments of
    :func:`finger_opt.export_mjcf`; if it is ``None``, the parameters are drawn from the shipped priors with ``seed``.
    The cell depends on the seed only; the random errors of attempts also depend on the finger.
    """

    def __init__(self, task: Given, density: float, direction: float, cell: Mapping[str, Any] | None,
                 seed: int) -> None:
        self._mujoco = _mujoco()
        rows: list[dict[str, Any]] = []
        with tempfile.TemporaryDirectory() as folder:
            if cell is None:
                text, parameters = _native.drawn_cell(seed)
                rows = json.loads(parameters)
                Path(folder, "cell.toml").write_text(text, encoding="utf-8")
                cell = {"cell": Path(folder, "cell.toml")}
            scene = Path(folder, "scene.xml")
            export_mjcf(task, density, direction, out=scene, **cell)
            self._scene = ET.parse(scene).getroot()
        self.task = _with_hidden_moves(task if isinstance(task, Task) else Task.from_toml(task), rows)
        self.unmodelled = UnmodelledEffects.draw(np.random.default_rng([seed, 2]))
        self.hidden = {**{row["name"]: row["value"] for row in rows}, **vars(self.unmodelled)}
        self._random = np.random.default_rng([seed, 3, round(density * 10), round(direction * 10)])
        self._drift_mm = np.zeros(3)
        self._model = self._build(plate=False)
        self._plate: Any = None
        #: State after the approach, which is the same for every start.
        self._approached: _Attempt | None = None

    def insert(self, offset_mm: float, log: Path | None, exact: bool = False) -> AttemptResult:
        """Attempts an insertion, the start shifted by ``offset_mm`` along y; ``exact`` omits drift and start error."""
        error_mm = np.zeros(3)
        if not exact:
            self._drift_mm += self.unmodelled.drift_mm * self._random.standard_normal(3)
            error_mm = self._drift_mm + self.unmodelled.start_error_mm * self._random.standard_normal(3) * [1, 1, 0]
        if self._approached is None:
            self._approached = _Attempt(self._mujoco, copy(self._model), self.task, self.unmodelled)
            self._approached.approach()
        run = self._approached.shifted(np.array([0.0, offset_mm, 0.0]) * 1e-3, error_mm * 1e-3)
        result = run.insert(log is not None)
        if log is not None:
            self._write(log, run.rows)
        return result

    def probe(self, log: Path) -> None:
        """Slides the plug back and forth along y on a flat plate of the socket's material; writes the log."""
        if self._plate is None:
            self._plate = self._build(plate=True)
        run = _Attempt(self._mujoco, copy(self._plate), self.task, self.unmodelled)
        run.probe()
        self._write(log, run.rows)

    def _build(self, plate: bool) -> Any:
        """Returns the MuJoCo model with the unmodelled effects; with ``plate`` in place of the socket's parts."""
        root = ET.fromstring(ET.tostring(self._scene))
        root.find("option").set("timestep", str(STEP_S))  # type: ignore[union-attr]
        for joint in root.iter("joint"):
            if joint.get("name", "").startswith("springs") and joint.get("name", "").endswith(" y"):
                joint.set("frictionloss", str(self.unmodelled.hysteresis_n))
        socket = next(body for body in root.iter("body") if body.get("name") == "socket")
        del socket.attrib["mocap"]
        socket.set("gravcomp", "1")
        stiffness = 1e3 * self.unmodelled.mount_n_per_mm
        for axis, along in (("x", "1 0 0"), ("y", "0 1 0"), ("z", "0 0 1")):
            # Damping ratio 0.7 for the mass of 0.5 kg.
            ET.SubElement(socket, "joint", name=f"mount {axis}", type="slide", axis=along, stiffness=str(stiffness),
                          damping=str(1.4 * (0.5 * stiffness) ** 0.5))
        ET.SubElement(socket, "inertial", pos="0 0 0", mass="0.5", diaginertia="1e-3 1e-3 1e-3")
        if plate:
            _replace_by_plate(root, socket)
        return self._mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))

    def _write(self, log: Path, rows: list[list[float]]) -> None:
        """Writes a log as CSV, with the errors of the force sensor."""
        table = np.array(rows)
        share = np.linspace(0.0, 1.0, len(table))[:, None]
        effects, random = self.unmodelled, self._random
        table[:, 5:8] += (effects.force_bias_n * random.standard_normal(3)
                          + effects.force_drift_n * random.standard_normal(3) * share
                          + effects.force_noise_n * random.standard_normal((len(table), 3)))
        np.savetxt(log, table, fmt="%.7g", delimiter=",", header=",".join(LOG_COLUMNS), comments="")


def _mujoco() -> Any:
    try:
        import mujoco
    except ImportError as error:
        raise InputError("engine: mujoco is not installed; install it with pip install 'finger-opt[mujoco]'") from error
    return mujoco


def _with_hidden_moves(task: Task, rows: list[dict[str, Any]]) -> Task:
    """Returns the task with the hidden changes of its phases, which the exported scene does not contain."""
    if not any(row["sets"].startswith("task.strategy.phase.") for row in rows):
        return task
    task = Task(task.file, task.to_toml())
    for row in rows:
        keys = row["sets"].split(".")
        if keys[:3] != ["task", "strategy", "phase"]:
            continue
        try:
            phase = task.strategy.phase[keys[3]]
        except (KeyError, IndexError, InputError):
            continue
        if len(keys) == 6:
            move = list(phase[keys[4]])
            axis = "xyz".index(keys[5])
            move[axis] = _changed(row, move[axis])
            phase[keys[4]] = move
        elif keys[4] in list(phase):
            phase[keys[4]] = _changed(row, phase[keys[4]])
    return task


def _changed(row: Mapping[str, Any], number: float) -> float:
    """Returns a number after the change of a drawn parameter."""
    value = float(row["value"])
    return {"factor": number * value, "shift": number + value, "value": value}[row["as"]]


def _replace_by_plate(root: Any, socket: Any) -> None:
    """Replaces the socket's parts by a flat plate with its top at z = 0."""
    for geom in socket.findall("geom"):
        socket.remove(geom)
    ET.SubElement(socket, "geom", name="socket: plate", type="box", size="0.1 0.1 0.05", pos="0 0 -0.05")
    contact = root.find("contact")
    paired: set[str] = set()
    for pair in contact.findall("pair"):
        names = [pair.get("geom1", ""), pair.get("geom2", "")]
        if not any(name.startswith("socket: ") for name in names):
            continue
        other = next(name for name in names if not name.startswith("socket: "))
        if other in paired:
            contact.remove(pair)
            continue
        paired.add(other)
        pair.set("geom1", other)
        pair.set("geom2", "socket: plate")


class _Attempt:
    """One simulated attempt, beginning with the grasp."""

    def __init__(self, mujoco: Any, model: Any, task: Task, effects: UnmodelledEffects) -> None:
        self.mujoco, self.model, self.task, self.effects = mujoco, model, task, effects
        #: Shift of the start from the taught start, m, as known to the controller.
        self.start: Vector = np.zeros(3)
        #: Failure class of a lost plug: 1 in the approach, 4 later; 0 while it is held.
        self.lost_class = 0
        self.data = mujoco.MjData(model)

        def id_of(kind: str, name: str) -> int:
            return int(mujoco.mj_name2id(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind}"), name))

        self.plug, self.flange, self.socket = (id_of("BODY", name) for name in ("plug", "flange", "socket"))
        self.fingers = [id_of("BODY", f"finger {side}") for side in ("-y", "+y")]
        drive = [f"drive command {axis}" for axis in ("x", "y", "z", "rx")]
        self.drive = [id_of("ACTUATOR", name) for name in drive]
        gain, damping, mass = (model.actuator_gainprm[self.drive[0], 0], -model.actuator_biasprm[self.drive[0], 2],
                               model.body_mass[id_of("BODY", "command")])
        #: Feedforward of the drive's command per speed, s, and per acceleration, s^2.
        self.lead_s, self.lead_s2 = damping / gain, mass / gain
        slides = [f"slide {side} y" for side in ("-y", "+y")]
        self.jaws = [id_of("ACTUATOR", name) for name in slides]
        self.jaw_qpos = [model.jnt_qposadr[id_of("JOINT", name)] for name in slides]
        mujoco.mj_forward(model, self.data)
        self.home: Vector = self.data.xpos[id_of("BODY", "command")].copy()
        #: Commanded pose, without and with backlash: position, m, and tilt, rad.
        self.target: Vector = np.array([*self.home, 0.0], dtype=np.float64)
        self.followed: Vector = np.array(self.target, dtype=np.float64)
        self.speed: Vector = np.zeros(4)
        self.force: Vector = np.zeros(3)
        self.peak_n = 0.0
        #: Time without contact of each finger, s.
        self.no_contact_s: Vector = np.zeros(2)
        #: Grip point in the frame of each finger after the grasp, m.
        self.grasped: Vector = np.zeros((2, 3))
        self.monitoring = self.logging = False
        self.rows: list[list[float]] = []

    def approach(self) -> None:
        """Grasps the plug and carries it to the taught start."""
        strategy = self.task.strategy
        try:
            self.grasp()
            start = np.array([*strategy.start_mm, 0.0]) * 1e-3
            start[3] = np.deg2rad(strategy.tilt_deg)
            self.move(start, CARRY_S)
            for phase in strategy.phase:
                if phase.stage == "approach":
                    self.run_phase(phase)
        except GripLost:
            self.lost_class = 1

    def shifted(self, start: Vector, error: Vector) -> _Attempt:
        """Returns a copy with its start shifted, m, plus an error, m, that is unknown to the controller."""
        run = copy(self)
        run.model, run.data, run.rows = copy(self.model), copy(self.data), []
        run.start = start
        # While the plug is in the air, moving the socket in the opposite direction is equivalent.
        run.model.body_pos[self.socket] -= start + error
        return run

    def insert(self, log: bool) -> AttemptResult:
        """Runs the phases after the approach; with ``log``, records rows."""
        if self.lost_class:
            return self.result()
        try:
            self.logging = log
            self.rest(0.2 if log else 0.0)
            for phase in self.task.strategy.phase:
                if phase.stage == "approach":
                    continue
                if phase.stage == "assembly" and self.task.grip.hold == "assembly":
                    self.lock_jaws()
                self.run_phase(phase)
            self.rest(REST_S)
        except GripLost:
            self.lost_class = 4
        return self.result()

    def probe(self) -> None:
        """Records rows while sliding the plug back and forth along y at constant normal force."""
        self.grasp()
        above = 2e-3
        tip = self.task.grip.tcp_z_mm * 1e-3
        self.move(np.array([0.0, -0.5e-3 * PROBE_MM, tip + above, 0.0]), CARRY_S)
        self.rest(REST_S)
        self.logging = True
        self.rest(0.2)
        speed = PROBE_MM_PER_S * 1e-3
        for _ in range(round(20e-3 / speed / TICK_S)):
            if self.force[2] >= PROBE_N:
                break
            self.tick(self.target + np.array([0.0, 0.0, -speed, 0.0]) * TICK_S)
        for along in (speed, -speed, speed, -speed):
            for _ in range(round(1e-3 * PROBE_MM / speed / TICK_S)):
                retreat = 2e-4 * (self.force[2] - PROBE_N)
                self.tick(self.target + np.array([0.0, along, retreat, 0.0]) * TICK_S)
        self.move(self.target + np.array([0.0, 0.0, 2.0 * above, 0.0]), 2.0 * above / 0.02)
        self.rest(0.2)

    def grasp(self) -> None:
        """Closes the jaws with the grip force and removes the stand under the plug."""
        for i in range(round(GRASP_S / TICK_S)):
            stroke = min(0.1 * i * TICK_S, 0.02)
            self.data.ctrl[self.jaws] = [stroke, -stroke]
            self.tick(self.target)
        if self.task.grip.hold == "always":
            self.lock_jaws()
        self.grasped = self.grip_points()
        # The stand is the only mocap body left.
        self.data.mocap_pos[:] = [0.0, 0.0, -1.0]
        self.monitoring = True

    def lock_jaws(self) -> None:
        """Locks the jaws in their positions, like a self-locking gripper."""
        for jaw, q in zip(self.jaws, self.jaw_qpos):
            gain, damping = 1e7, 1.4e3
            self.model.actuator_gainprm[jaw, 0] = gain
            self.model.actuator_biasprm[jaw, 1:3] = [-gain, -damping]
            self.model.actuator_forcerange[jaw] = [-1e6, 1e6]
            self.data.ctrl[jaw] = self.data.qpos[q]

    def run_phase(self, phase: Any) -> None:
        """Executes a phase of the strategy; a touch phase ends at its contact force, followed by the preload."""
        by: Vector = np.append(np.array(phase.move_mm), 0.0) * 1e-3
        duration_s = float(np.linalg.norm(by)) * 1e3 / float(phase.speed_mm_per_s)
        if phase.motion != "touch":
            self.move(self.target + by, duration_s)
            self.rest(phase.settle_s if "settle_s" in list(phase) else REST_S)
            return
        start = np.array(self.target, dtype=np.float64)
        contact_n = phase.touch_force_n if "touch_force_n" in list(phase) else CONTACT_N
        for share in self.minimum_jerk(duration_s):
            self.tick(start + share * by)
            if np.linalg.norm(self.force) > contact_n:
                break
        along: Vector = by[:3] / np.linalg.norm(by[:3])
        reached = float(along @ (self.tcp() - start[:3]))
        end = start + np.array([*along, 0.0], dtype=np.float64) * (reached + phase.preload_mm * 1e-3)
        self.move(end, float(np.linalg.norm(end - self.target)) * 1e3 / float(phase.speed_mm_per_s))
        self.rest(REST_S)

    @staticmethod
    def minimum_jerk(duration_s: float) -> Vector:
        """Returns the fractions of a minimum-jerk move at the controller periods; it lasts at least 20 periods."""
        t: Vector = np.arange(1, max(round(duration_s / TICK_S), 20) + 1, dtype=np.float64)
        t /= t[-1]
        share: Vector = t**3 * (10.0 - 15.0 * t + 6.0 * t**2)
        return share

    def move(self, to: Vector, duration_s: float) -> None:
        """Moves to a pose (m, rad) with minimum jerk."""
        start = np.array(self.target, dtype=np.float64)
        for share in self.minimum_jerk(float(duration_s)):
            self.tick(start + share * (to - start))

    def rest(self, duration_s: float) -> None:
        """Holds the commanded pose."""
        for _ in range(round(duration_s / TICK_S)):
            self.tick(self.target)

    def tick(self, target: Vector) -> None:
        """Runs one controller period: commands a pose (m, rad), steps the physics, reads forces, checks the grip."""
        self.target = np.array(target, dtype=np.float64)
        half = 0.5e-3 * self.effects.backlash_mm
        followed = np.array(self.followed, dtype=np.float64)
        followed[:3] = np.clip(self.followed[:3], self.target[:3] - half, self.target[:3] + half)
        followed[3] = self.target[3]
        data = self.data
        # The drive is force-controlled: setting its position would ignore the inertia of the flange.
        speed = (followed - self.followed) / TICK_S
        ahead = self.lead_s * speed + self.lead_s2 * (speed - self.speed) / TICK_S
        data.ctrl[self.drive] = followed - np.append(self.home, 0.0) + ahead
        self.mujoco.mj_step(self.model, data, round(TICK_S / STEP_S))
        self.followed, self.speed = followed, speed
        finger_n = self.read_forces()
        if self.logging:
            place, force = self.tcp() + self.start, self.force
            tilt = np.arctan2(data.xmat[self.flange][7], data.xmat[self.flange][8])
            target_mm = (target[:3] + self.start) * 1e3
            self.rows.append([len(self.rows) * TICK_S, *(place * 1e3), np.rad2deg(tilt), *force, *target_mm])
        if self.monitoring:
            self.no_contact_s = np.where(finger_n < 0.01, self.no_contact_s + TICK_S, 0.0)
            if (self.no_contact_s > NO_CONTACT_S).all() or self.slip() > self.task.grip.slip_limit_mm * 1e-3:
                raise GripLost

    def read_forces(self) -> Vector:
        """Updates the filtered force of the socket on the plug, N; returns the normal force of each finger, N."""
        net, finger_n = np.zeros(3), np.zeros(2)
        wrench = np.zeros(6)
        bodies = self.model.geom_bodyid
        for i in range(self.data.ncon):
            contact = self.data.contact[i]
            first, second = bodies[contact.geom1], bodies[contact.geom2]
            self.mujoco.mj_contactForce(self.model, self.data, i, wrench)
            if self.socket in (first, second):
                # Force of the first body on the second.
                force = contact.frame.reshape(3, 3).T @ wrench[:3]
                net += force if first == self.socket else -force
            for side, finger in enumerate(self.fingers):
                if finger in (first, second):
                    finger_n[side] += wrench[0]
        self.force = self.force + (net - self.force) * (TICK_S / FORCE_FILTER_S)
        self.peak_n = max(self.peak_n, float(np.linalg.norm(self.force)))
        return finger_n

    def tcp(self) -> Vector:
        """Returns the position of the TCP, m."""
        place: Vector = self.data.xpos[self.flange].copy()
        return place

    def grip_points(self) -> Vector:
        """Returns the grip point of the plug in the frame of each finger, m, shape (2, 3)."""
        data, plug = self.data, self.plug
        point = data.xpos[plug] + data.xmat[plug].reshape(3, 3)[:, 2] * self.task.grip.tcp_z_mm * 1e-3
        return np.array([data.xmat[one].reshape(3, 3).T @ (point - data.xpos[one]) for one in self.fingers])

    def slip(self) -> float:
        """Returns the slip in the pads since the grasp, m: the smaller of the two fingers."""
        moved = self.grip_points() - self.grasped
        return float(np.hypot(moved[:, 0], moved[:, 2]).min())

    def result(self) -> AttemptResult:
        """Returns the result by the success criteria of the task."""
        data, success = self.data, self.task.success
        tip = (data.xpos[self.plug] - data.xpos[self.socket]) * 1e3
        tilt = np.rad2deg(np.arccos(np.clip(data.xmat[self.plug][8], -1.0, 1.0)))
        opening = self.task.socket.opening_x_mm, self.task.socket.opening_y_mm
        inside = all(low - 0.1 <= at <= high + 0.1 for at, (low, high) in zip(tip, opening))
        if "mated" in list(success):
            # A plug that is deep, but laterally off the mated pose, is not inserted.
            lateral = [float(at) - float(place) for at, place in zip(tip[:2], success.mated.tip_mm)]
            inside = float(np.linalg.norm(lateral)) <= float(success.mated.lateral_mm)
        depth = -float(tip[2])
        seated = inside and depth >= success.depth_mm and tilt <= success.tilt_deg
        gripped = not (self.no_contact_s > NO_CONTACT_S).any()
        lost = self.lost_class
        if seated and gripped and not lost:
            failure = None
        elif lost or seated:
            failure = lost or 4
        else:
            failure = 3 if depth > ENTERED_MM and inside else 2
        return AttemptResult(failure is None, failure, depth, self.peak_n)
