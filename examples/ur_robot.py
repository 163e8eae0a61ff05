"""A UR robot for `finger_opt.robot.measure_window`, controlled with ur_rtde (pip install ur_rtde).

NOT TESTED ON HARDWARE. Only the signatures of its calls were checked, against ur_rtde 1.6.5. Read the code,
adapt it to your cell, review the moves that it prints (`dry_run=True`), and then run it slowly, with a person
next to the robot and a hand on the stop button. Set the safety limits of the robot first, and pass their force as
``robot_stop_n``: simulated insertions exceed 140 N. The gripper stays closed; this program does not move it.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import finger_opt as fo
from finger_opt.robot import Attempt

#: Columns recorded by the RTDE client, in SI units.
RECORDED = ["timestamp", "actual_TCP_pose", "actual_TCP_force", "target_TCP_pose"]
ACCELERATION_M_S2 = 0.5
RETREAT_M_S = 0.02
#: Probe: contact force, sliding distance along y, speed, and maximum distance of the face below the start.
PROBE_N, PROBE_M, PROBE_M_S, PROBE_DEPTH_M = 5.0, 0.008, 0.005, 0.01


class DryRun(RuntimeError):
    """Raised after printing the moves of a dry run, in which the robot does not move."""


@dataclass(frozen=True)
class Move:
    """Straight move of the TCP to a pose (x, y, z, rx, ry, rz; m, rad) in the base frame, or until a force."""

    name: str
    pose: list[float]
    speed_m_s: float
    force_n: float


@dataclass
class URRobot:
    """Attempts insertions with the strategy of a task file; each phase is a guarded straight move.

    ``taught`` is the TCP pose (x, y, z, rx, ry, rz; m, rad) at the start that inserts; ``surface_m`` is the
    height of the TCP relative to it, along ``out_of_socket``, at which the tip touches the top of the socket
    (below 0). ``jaws`` and ``out_of_socket`` are the task's y and z in the base frame. ``touch_n`` is the force
    that counts as contact. ``face`` is the TCP pose at which the plug is upright, a few mm above a flat face beside
    the opening, where :meth:`probe` measures the friction.

    ``force_limit_n`` is the force that ends an attempt. It may not exceed, and by default is, the smaller of the
    task's ``limits.force_n`` and ``robot_stop_n``, the force at which the robot stops by itself. Braking takes time:
    choose less for a connector that must not see more.
    """

    host: str
    task: fo.Task
    taught: Sequence[float]
    surface_m: float
    jaws: Sequence[float] = (0.0, 1.0, 0.0)
    out_of_socket: Sequence[float] = (0.0, 0.0, 1.0)
    face: Sequence[float] | None = None
    robot_stop_n: float = 150.0
    force_limit_n: float | None = None
    touch_n: float = 5.0
    dry_run: bool = True
    ask: Callable[[str], str] = input
    #: Time for the operator's answer, much longer than the moves.
    timeout_s: float = 600.0
    control: Any = field(default=None, repr=False)
    receive: Any = field(default=None, repr=False)

    def __post_init__(self) -> None:
        y, z = np.array(self.jaws, float), np.array(self.out_of_socket, float)
        if not (np.isclose(np.linalg.norm(y), 1) and np.isclose(np.linalg.norm(z), 1) and abs(y @ z) < 1e-6):
            raise ValueError("jaws and out_of_socket must be perpendicular unit vectors")
        self.axes = np.column_stack([np.cross(y, z), y, z])
        connector_n = getattr(getattr(self.task, "limits", None), "force_n", self.robot_stop_n)
        most_n = min(connector_n, self.robot_stop_n)
        self.stop_n = most_n if self.force_limit_n is None else self.force_limit_n
        if not self.touch_n < self.stop_n <= most_n:
            raise ValueError(
                f"force_limit_n: is {self.stop_n:g} N; it must be above touch_n, {self.touch_n:g} N, and at most "
                f"{most_n:g} N, the smaller of the task's limits.force_n and robot_stop_n"
            )
        if not self.dry_run and self.control is None:
            import rtde_control  # pyright: ignore[reportMissingImports]
            import rtde_receive  # pyright: ignore[reportMissingImports]

            self.control = rtde_control.RTDEControlInterface(self.host)
            self.receive = rtde_receive.RTDEReceiveInterface(self.host)

    def pose(self, shift_mm: ArrayLike, taught: Sequence[float] | None = None) -> list[float]:
        """Returns the taught pose, shifted by a vector in the task frame."""
        taught = self.taught if taught is None else taught
        place = np.array(taught[:3], float) + self.axes @ np.asarray(shift_mm, float) / 1000.0
        return [*place.tolist(), *taught[3:]]

    def program(self, offset_mm: float) -> list[Move]:
        """Returns the moves of an attempt: to the shifted start, then the phases of the task's strategy."""
        at = np.array([0.0, offset_mm, 0.0])
        moves = [Move("start", self.pose(at), RETREAT_M_S, self.touch_n)]
        for phase in self.task.strategy.phase:
            touching = phase.motion == "touch"
            at = at + np.array(list(phase.move_mm))
            limit = self.touch_n if touching else self.stop_n
            moves.append(Move(phase.name, self.pose(at), phase.speed_mm_per_s / 1000.0, limit))
        return moves

    def probe_program(self, height_m: float = -PROBE_DEPTH_M) -> list[Move]:
        """Returns the moves of the probe; it slides at the height of the contact relative to ``face``."""
        if self.face is None:
            raise ValueError("face: teach a pose above the flat face beside the opening")
        half_mm, height_mm = 500.0 * PROBE_M, 1000.0 * height_m
        pressing_n, catching_n = min(PROBE_N, self.stop_n), min(4.0 * PROBE_N, self.stop_n)
        above, down = [0.0, -half_mm, 0.0], [0.0, -half_mm, -1000.0 * PROBE_DEPTH_M]
        moves = [Move("above", self.pose(above, self.face), RETREAT_M_S, self.touch_n),
                 Move("down", self.pose(down, self.face), PROBE_M_S, pressing_n)]
        # At constant height the normal force varies; the log contains the normal and the tangential force.
        for y_mm in (half_mm, -half_mm, half_mm, -half_mm):
            moves.append(Move("slide", self.pose([0.0, y_mm, height_mm], self.face), PROBE_M_S, catching_n))
        return [*moves, Move("up", self.pose(above, self.face), RETREAT_M_S, self.stop_n)]

    def probe(self, log: Path) -> None:
        """Slides on the flat face beside the opening; with ``dry_run``, prints the moves and raises :class:`DryRun`."""
        above, down, *_ = moves = self.probe_program()
        assert self.face is not None
        self.check(moves)
        if self.guarded(above) >= above.force_n:
            raise RuntimeError("obstacle on the way to the face")
        self.control.zeroFtSensor()
        time.sleep(0.2)
        self.receive.startFileRecording(str(log), RECORDED)
        try:
            # The log starts and ends in the air, to record the sensor without contact.
            time.sleep(0.2)
            if self.guarded(down) < down.force_n:
                raise RuntimeError(f"no face within {1000.0 * PROBE_DEPTH_M:g} mm below the start")
            contact = np.array(self.receive.getActualTCPPose()[:3]) - np.array(self.face[:3], float)
            *slides, up = self.probe_program(float(self.axes[:, 2] @ contact))[2:]
            caught = any(self.guarded(slide) >= slide.force_n for slide in slides)
            self.guarded(up)
            time.sleep(0.2)
        finally:
            self.receive.stopFileRecording()
        if caught:
            raise RuntimeError("the plug catches on the face; teach another position")

    def insert(self, offset_mm: float, log: Path | None = None) -> Attempt:
        """Makes one attempt; with ``dry_run``, prints the moves and raises :class:`DryRun`."""
        start, *phases = moves = self.program(offset_mm)
        self.check(moves)
        if self.guarded(start) >= start.force_n:
            raise RuntimeError("obstacle on the way to the start")
        self.control.zeroFtSensor()
        time.sleep(0.2)
        if log is not None:
            self.receive.startFileRecording(str(log), RECORDED)
        try:
            peak = 0.0
            for move in phases:
                peak = max(peak, self.guarded(move))
                if peak >= self.stop_n:
                    break
            depth_mm = self.depth_mm()
            inserted, failure = self.judged(depth_mm)
        finally:
            if log is not None:
                self.receive.stopFileRecording()
        self.retreat()
        return Attempt(inserted, failure, depth_mm, peak, log)

    def check(self, moves: list[Move]) -> None:
        """Checks that the moves are within the safety limits; with ``dry_run``, prints them and raises."""
        if self.dry_run:
            for move in moves:
                where = ", ".join(f"{number:+.4f}" for number in move.pose)
                print(f"{move.name:<12} to [{where}] at {move.speed_m_s:.3f} m/s, until {move.force_n:g} N")
            raise DryRun("dry run, nothing moved; pass dry_run=False once these moves are correct")
        for move in moves:
            if not self.control.isPoseWithinSafetyLimits(move.pose):
                raise RuntimeError(f"{move.name}: {move.pose} is outside the safety limits")

    def guarded(self, move: Move) -> float:
        """Moves until the pose or the force is reached; returns the largest force, N."""
        self.control.moveL(move.pose, move.speed_m_s, ACCELERATION_M_S2, True)
        peak = 0.0
        time.sleep(0.02)
        while self.control.getAsyncOperationProgress() >= 0:
            if self.receive.isProtectiveStopped() or self.receive.isEmergencyStopped():
                raise RuntimeError(f"{move.name}: the robot has stopped; inspect it before you continue")
            force = float(np.linalg.norm(self.receive.getActualTCPForce()[:3]))
            peak = max(peak, force)
            if force >= move.force_n:
                self.control.stopL(10.0)
                break
            time.sleep(0.004)
        return peak

    def depth_mm(self) -> float:
        """Returns the depth of the tip below the socket's top, from the TCP pose."""
        below = np.array(self.receive.getActualTCPPose()[:3]) - np.array(self.taught[:3], float)
        return 1000.0 * (self.surface_m - float(self.axes[:, 2] @ below))

    def judged(self, depth_mm: float) -> tuple[bool, int | None]:
        """Asks the operator for the outcome: depth alone does not prove that the plug is inserted and still held."""
        answer = self.ask(f"depth {depth_mm:.1f} mm. Inserted: +, else the failure class 1 to 4: ").strip()
        return answer == "+", int(answer) if answer in ("1", "2", "3", "4") else None

    def retreat(self) -> None:
        """Pulls the plug out to the height of the start, along the axis of the socket."""
        pose = self.receive.getActualTCPPose()
        up = self.axes[:, 2] * float(self.axes[:, 2] @ (np.array(self.taught[:3], float) - np.array(pose[:3])))
        out = [*(np.array(pose[:3]) + up).tolist(), *pose[3:]]
        if self.guarded(Move("retreat", out, RETREAT_M_S, self.stop_n)) >= self.stop_n:
            raise RuntimeError("the plug is stuck; free it by hand")


if __name__ == "__main__":
    robot = URRobot("192.168.0.10", fo.Task.from_toml("usb"), (0.4, -0.2, 0.3, 0.0, 3.1416, 0.0), surface_m=-0.0104,
                    face=(0.43, -0.2, 0.3, 0.0, 3.1416, 0.0))
    # With dry_run=False: finger_opt.robot.measure_window(robot, task=robot.task, density=20, direction=10, probe=True)
    for moves in (lambda: robot.probe(Path("probe.csv")), lambda: robot.insert(-0.5)):
        try:
            moves()
        except DryRun as reason:
            print(reason)
