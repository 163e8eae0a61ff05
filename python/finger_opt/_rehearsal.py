"""A robot in MuJoCo that shares no contact code and no controller with the simulation of this package."""

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

#: Physics step and period of the controller, s. A quarter of this step gives the same windows; twice it does not.
STEP_S = 5e-5
TICK_S = 1e-3
#: Time constant of the force sensor, s.
SENSOR_S = 5e-3
#: Grasp, carry, and rest after a move, s.
GRASP_S, CARRY_S, REST_S = 0.3, 0.2, 0.05
#: Force at which a touch is felt, N, and how long a grip may be off, s.
TOUCH_N, LOOSE_S = 1.0, 0.02
#: Depth from which a plug that did not go home is jammed and has not missed, mm.
ENTERED_MM = 0.5
#: Force, stroke and speed of the probe, N, mm, mm/s.
PROBE_N, PROBE_MM, PROBE_MM_PER_S = 5.0, 8.0, 5.0
LOGGED = ("t_s", "x_mm", "y_mm", "z_mm", "tilt_deg", "fx_n", "fy_n", "fz_n",
          "target_x_mm", "target_y_mm", "target_z_mm")

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Unmodelled:
    """What a real cell has and the simulation of this package has not; each number is drawn once for a cell.

    The ranges are assumed: those of a good table-top robot and of printed fingers.
    """

    #: Play of each axis when it reverses, mm.
    backlash_mm: float
    #: Standard deviation of the step of the tool's place from one attempt to the next, mm.
    drift_mm: float
    #: Standard deviation of the place of a start along x and y, mm.
    start_error_mm: float
    #: Dry friction within each finger along the closing direction, N: half the width of its hysteresis.
    hysteresis_n: float
    #: Stiffness of the socket's mount along each axis, N/mm.
    mount_n_per_mm: float
    #: White noise of a force sample, bias and drift until the log ends, per axis, N (standard deviations).
    force_noise_n: float
    force_bias_n: float
    force_drift_n: float

    RANGES = {"backlash_mm": (0.01, 0.06), "drift_mm": (0.0, 0.01), "start_error_mm": (0.01, 0.06),
              "hysteresis_n": (0.05, 0.4), "mount_n_per_mm": (50.0, 400.0), "force_noise_n": (0.1, 0.5),
              "force_bias_n": (0.2, 1.5), "force_drift_n": (0.1, 1.0)}

    @classmethod
    def drawn(cls, random: np.random.Generator) -> Unmodelled:
        return cls(**{one.name: float(random.uniform(*cls.RANGES[one.name])) for one in fields(cls)})


@dataclass
class Seen:
    """Ends of an attempt as a lab would note them."""

    inserted: bool
    failure: int | None
    depth_mm: float
    peak_force_n: float


class Lost(Exception):
    """Both fingers have let go of the plug, or it has slipped out of the pads."""


class Rehearsal:
    """The hidden cell of a task and one finger in it.

    ``cell`` are settings of :func:`finger_opt.export_mjcf`; if ``None``, numbers drawn from the shipped priors with
    ``seed``. The cell depends on the seed only, its errors on seed and finger.
    """

    def __init__(self, task: Given, density: float, direction: float, cell: Mapping[str, Any] | None,
                 seed: int) -> None:
        self._mujoco = _mujoco()
        rows: list[dict[str, Any]] = []
        with tempfile.TemporaryDirectory() as folder:
            if cell is None:
                text, found = _native.drawn_cell(seed)
                rows = json.loads(found)
                Path(folder, "cell.toml").write_text(text, encoding="utf-8")
                cell = {"cell": Path(folder, "cell.toml")}
            scene = Path(folder, "scene.xml")
            export_mjcf(task, density, direction, out=scene, **cell)
            self._scene = ET.parse(scene).getroot()
        self.task = _moved(task if isinstance(task, Task) else Task.from_toml(task), rows)
        self.unmodelled = Unmodelled.drawn(np.random.default_rng([seed, 2]))
        self.hidden = {**{row["name"]: row["value"] for row in rows}, **vars(self.unmodelled)}
        self._errors = np.random.default_rng([seed, 3, round(density * 10), round(direction * 10)])
        self._place_mm = np.zeros(3)
        self._model = self._built(plate=False)
        self._plate: Any = None
        #: Right before the search, which is the same for every start.
        self._approached: _Attempt | None = None

    def insert(self, offset_mm: float, log: Path | None, exact: bool = False) -> Seen:
        """Tries an insertion; ``exact`` without drift and start error."""
        error_mm = np.zeros(3)
        if not exact:
            self._place_mm += self.unmodelled.drift_mm * self._errors.standard_normal(3)
            error_mm = self._place_mm + self.unmodelled.start_error_mm * self._errors.standard_normal(3) * [1, 1, 0]
        if self._approached is None:
            self._approached = _Attempt(self._mujoco, copy(self._model), self.task, self.unmodelled)
            self._approached.approach()
        run = self._approached.shifted(np.array([0.0, offset_mm, 0.0]) * 1e-3, error_mm * 1e-3)
        seen = run.insert(log is not None)
        if log is not None:
            self._write(log, run.rows)
        return seen

    def probe(self, log: Path) -> None:
        """Slides the plug slowly along y on a flat face of the socket's material."""
        if self._plate is None:
            self._plate = self._built(plate=True)
        run = _Attempt(self._mujoco, copy(self._plate), self.task, self.unmodelled)
        run.probe()
        self._write(log, run.rows)

    def _built(self, plate: bool) -> Any:
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
            # Of 0.5 kg, near critical damping.
            ET.SubElement(socket, "joint", name=f"mount {axis}", type="slide", axis=along, stiffness=str(stiffness),
                          damping=str(1.4 * (0.5 * stiffness) ** 0.5))
        ET.SubElement(socket, "inertial", pos="0 0 0", mass="0.5", diaginertia="1e-3 1e-3 1e-3")
        if plate:
            _replace_by_plate(root, socket)
        return self._mujoco.MjModel.from_xml_string(ET.tostring(root, encoding="unicode"))

    def _write(self, log: Path, rows: list[list[float]]) -> None:
        table = np.array(rows)
        share = np.linspace(0.0, 1.0, len(table))[:, None]
        have, random = self.unmodelled, self._errors
        table[:, 5:8] += (have.force_bias_n * random.standard_normal(3)
                          + have.force_drift_n * random.standard_normal(3) * share
                          + have.force_noise_n * random.standard_normal((len(table), 3)))
        np.savetxt(log, table, fmt="%.7g", delimiter=",", header=",".join(LOGGED), comments="")


def _mujoco() -> Any:
    try:
        import mujoco
    except ImportError as error:
        raise InputError("engine: mujoco is not installed; install it with pip install 'finger-opt[mujoco]'") from error
    return mujoco


def _moved(task: Task, rows: list[dict[str, Any]]) -> Task:
    """The task with the hidden moves of the robot, which no scene has."""
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
    value = float(row["value"])
    return {"factor": number * value, "shift": number + value, "value": value}[row["as"]]


def _replace_by_plate(root: Any, socket: Any) -> None:
    """Puts a flat plate, its top at z = 0, in the place of the socket's parts."""
    for geom in socket.findall("geom"):
        socket.remove(geom)
    ET.SubElement(socket, "geom", name="socket: plate", type="box", size="0.1 0.1 0.05", pos="0 0 -0.05")
    contact = root.find("contact")
    seen: set[str] = set()
    for pair in contact.findall("pair"):
        names = [pair.get("geom1", ""), pair.get("geom2", "")]
        beside = [name for name in names if name.startswith("socket: ")]
        if not beside:
            continue
        other = next(name for name in names if not name.startswith("socket: "))
        if other in seen:
            contact.remove(pair)
            continue
        seen.add(other)
        pair.set("geom1", other)
        pair.set("geom2", "socket: plate")


class _Attempt:
    """One run of a model from the pick-up on."""

    def __init__(self, mujoco: Any, model: Any, task: Task, have: Unmodelled) -> None:
        self.mujoco, self.model, self.task, self.have = mujoco, model, task, have
        #: Place of the start, m, from the taught one, as the controller knows it.
        self.start: Vector = np.zeros(3)
        self.lost = 0
        self.data = mujoco.MjData(model)

        def number(kind: str, name: str) -> int:
            return int(mujoco.mj_name2id(model, getattr(mujoco.mjtObj, f"mjOBJ_{kind}"), name))

        self.plug, self.flange, self.socket = (number("BODY", name) for name in ("plug", "flange", "socket"))
        self.fingers = [number("BODY", f"finger {side}") for side in ("-y", "+y")]
        drive = [f"drive command {axis}" for axis in ("x", "y", "z", "rx")]
        self.drive = [number("ACTUATOR", name) for name in drive]
        gain, damping, moved = (model.actuator_gainprm[self.drive[0], 0], -model.actuator_biasprm[self.drive[0], 2],
                                model.body_mass[number("BODY", "command")])
        #: What a drive of this gain, damping and mass is ahead of a place to be there, per speed and acceleration.
        self.lead_s, self.lead_s2 = damping / gain, moved / gain
        slides = [f"slide {side} y" for side in ("-y", "+y")]
        self.jaws = [number("ACTUATOR", name) for name in slides]
        self.jaw_q = [model.jnt_qposadr[number("JOINT", name)] for name in slides]
        mujoco.mj_forward(model, self.data)
        self.home: Vector = self.data.xpos[number("BODY", "command")].copy()
        #: Commanded and played pose: place, m, and tilt, rad.
        self.target: Vector = np.array([*self.home, 0.0], dtype=np.float64)
        self.played: Vector = np.array(self.target, dtype=np.float64)
        self.speed: Vector = np.zeros(4)
        self.force: Vector = np.zeros(3)
        self.peak_n = 0.0
        self.loose_s: Vector = np.zeros(2)
        self.held: Vector = np.zeros((2, 3))
        self.watching = self.logging = False
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
                    self.phase(phase)
        except Lost:
            self.lost = 1

    def shifted(self, start: Vector, error: Vector) -> _Attempt:
        """A copy whose start is shifted, and off by an error that the controller does not know."""
        run = copy(self)
        run.model, run.data, run.rows = copy(self.model), copy(self.data), []
        run.start = start
        # In the air it is the same to move the socket the other way.
        run.model.body_pos[self.socket] -= start + error
        return run

    def insert(self, log: bool) -> Seen:
        """Searches, and pushes the plug in."""
        if self.lost:
            return self.seen()
        try:
            self.logging = log
            self.rest(0.2 if log else 0.0)
            for phase in self.task.strategy.phase:
                if phase.stage == "approach":
                    continue
                if phase.stage == "assembly" and self.task.grip.hold == "assembly":
                    self.hold()
                self.phase(phase)
            self.rest(REST_S)
        except Lost:
            self.lost = 4
        return self.seen()

    def probe(self) -> None:
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
                yields = 2e-4 * (self.force[2] - PROBE_N)
                self.tick(self.target + np.array([0.0, along, yields, 0.0]) * TICK_S)
        self.move(self.target + np.array([0.0, 0.0, 2.0 * above, 0.0]), 2.0 * above / 0.02)
        self.rest(0.2)

    def grasp(self) -> None:
        """Closes the jaws with the force of the gripper, and takes the stand away."""
        for i in range(round(GRASP_S / TICK_S)):
            stroke = min(0.1 * i * TICK_S, 0.02)
            self.data.ctrl[self.jaws] = [stroke, -stroke]
            self.tick(self.target)
        if self.task.grip.hold == "always":
            self.hold()
        self.held = self.grip_points()
        # The only other body that no force moves.
        self.data.mocap_pos[:] = [0.0, 0.0, -1.0]
        self.watching = True

    def hold(self) -> None:
        """Keeps the jaws where they are, as a gripper that blocks."""
        for jaw, q in zip(self.jaws, self.jaw_q):
            gain, damping = 1e7, 1.4e3
            self.model.actuator_gainprm[jaw, 0] = gain
            self.model.actuator_biasprm[jaw, 1:3] = [-gain, -damping]
            self.model.actuator_forcerange[jaw] = [-1e6, 1e6]
            self.data.ctrl[jaw] = self.data.qpos[q]

    def phase(self, phase: Any) -> None:
        by: Vector = np.append(np.array(phase.move_mm), 0.0) * 1e-3
        length_s = float(np.linalg.norm(by)) * 1e3 / float(phase.speed_mm_per_s)
        if phase.motion != "touch":
            self.move(self.target + by, length_s)
            self.rest(phase.settle_s if "settle_s" in list(phase) else REST_S)
            return
        start = np.array(self.target, dtype=np.float64)
        felt_n = phase.touch_force_n if "touch_force_n" in list(phase) else TOUCH_N
        for share in self.shares(length_s):
            self.tick(start + share * by)
            if np.linalg.norm(self.force) > felt_n:
                break
        along: Vector = by[:3] / np.linalg.norm(by[:3])
        reached = float(along @ (self.tcp() - start[:3]))
        end = start + np.array([*along, 0.0], dtype=np.float64) * (reached + phase.preload_mm * 1e-3)
        self.move(end, float(np.linalg.norm(end - self.target)) * 1e3 / float(phase.speed_mm_per_s))
        self.rest(REST_S)

    @staticmethod
    def shares(length_s: float) -> Vector:
        """Shares of a move of least jerk at the ticks of the controller."""
        t: Vector = np.arange(1, max(round(length_s / TICK_S), 20) + 1, dtype=np.float64)
        t /= t[-1]
        share: Vector = t**3 * (10.0 - 15.0 * t + 6.0 * t**2)
        return share

    def move(self, to: Vector, length_s: float) -> None:
        start = np.array(self.target, dtype=np.float64)
        for share in self.shares(float(length_s)):
            self.tick(start + share * (to - start))

    def rest(self, length_s: float) -> None:
        for _ in range(round(length_s / TICK_S)):
            self.tick(self.target)

    def tick(self, target: Vector) -> None:
        """One period of the controller: the arm follows within its play, sensors and grip are read."""
        self.target = np.array(target, dtype=np.float64)
        half = 0.5e-3 * self.have.backlash_mm
        played = np.array(self.played, dtype=np.float64)
        played[:3] = np.clip(self.played[:3], self.target[:3] - half, self.target[:3] + half)
        played[3] = self.target[3]
        data = self.data
        # Steered by forces: a drive whose place were set would not pull the flange's mass along.
        speed = (played - self.played) / TICK_S
        ahead = self.lead_s * speed + self.lead_s2 * (speed - self.speed) / TICK_S
        data.ctrl[self.drive] = played - np.append(self.home, 0.0) + ahead
        self.mujoco.mj_step(self.model, data, round(TICK_S / STEP_S))
        self.played, self.speed = played, speed
        pressed = self.read()
        if self.logging:
            place, force = self.tcp() + self.start, self.force
            tilt = np.arctan2(data.xmat[self.flange][7], data.xmat[self.flange][8])
            self.rows.append([len(self.rows) * TICK_S, *(place * 1e3), np.rad2deg(tilt), *force, *((target[:3] + self.start) * 1e3)])
        if self.watching:
            self.loose_s = np.where(pressed < 0.01, self.loose_s + TICK_S, 0.0)
            if (self.loose_s > LOOSE_S).all() or self.slip() > self.task.grip.slip_limit_mm * 1e-3:
                raise Lost

    def read(self) -> Vector:
        """Reads the force of the socket on the plug into the sensor; returns the force of each finger, N."""
        net, pressed = np.zeros(3), np.zeros(2)
        wrench = np.zeros(6)
        bodies = self.model.geom_bodyid
        for i in range(self.data.ncon):
            contact = self.data.contact[i]
            first, second = bodies[contact.geom1], bodies[contact.geom2]
            self.mujoco.mj_contactForce(self.model, self.data, i, wrench)
            if self.socket in (first, second):
                # Of the first on the second.
                force = contact.frame.reshape(3, 3).T @ wrench[:3]
                net += force if first == self.socket else -force
            for side, finger in enumerate(self.fingers):
                if finger in (first, second):
                    pressed[side] += wrench[0]
        self.force = self.force + (net - self.force) * (TICK_S / SENSOR_S)
        self.peak_n = max(self.peak_n, float(np.linalg.norm(self.force)))
        return pressed

    def tcp(self) -> Vector:
        place: Vector = self.data.xpos[self.flange].copy()
        return place

    def grip_points(self) -> Vector:
        data, plug = self.data, self.plug
        point = data.xpos[plug] + data.xmat[plug].reshape(3, 3)[:, 2] * self.task.grip.tcp_z_mm * 1e-3
        return np.array([data.xmat[one].reshape(3, 3).T @ (point - data.xpos[one]) for one in self.fingers])

    def slip(self) -> float:
        moved = self.grip_points() - self.held
        return float(np.hypot(moved[:, 0], moved[:, 2]).min())

    def seen(self) -> Seen:
        data, success = self.data, self.task.success
        tip = (data.xpos[self.plug] - data.xpos[self.socket]) * 1e3
        tilt = np.rad2deg(np.arccos(np.clip(data.xmat[self.plug][8], -1.0, 1.0)))
        opening = self.task.socket.opening_x_mm, self.task.socket.opening_y_mm
        inside = all(low - 0.1 <= at <= high + 0.1 for at, (low, high) in zip(tip, opening))
        if "mated" in list(success):
            # Deep beside the mated pose is not inserted.
            beside = [float(at) - float(place) for at, place in zip(tip[:2], success.mated.tip_mm)]
            inside = float(np.linalg.norm(beside)) <= float(success.mated.lateral_mm)
        depth = -float(tip[2])
        seated = inside and depth >= success.depth_mm and tilt <= success.tilt_deg
        gripped = not (self.loose_s > LOOSE_S).any()
        lost = self.lost
        if seated and gripped and not lost:
            failure = None
        elif lost or seated:
            failure = lost or 4
        else:
            failure = 3 if depth > ENTERED_MM and inside else 2
        return Seen(failure is None, failure, depth, self.peak_n)
