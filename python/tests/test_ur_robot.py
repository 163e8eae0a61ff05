"""The example of a UR: what it prints, and its calls against the signatures of ur_rtde."""

from __future__ import annotations

import ast
import importlib.util
import re
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "ur_robot.py"


@pytest.fixture
def example():
    spec = importlib.util.spec_from_file_location("ur_robot", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    # Dataclasses look their module up.
    sys.modules["ur_robot"] = module
    spec.loader.exec_module(module)
    return module


def calls():
    """Calls on the robot's two interfaces: interface, method, count of positional arguments, keywords."""
    for node in ast.walk(ast.parse(EXAMPLE.read_text())):
        called = getattr(node, "func", None)
        on = getattr(called, "value", None)
        if isinstance(node, ast.Call) and isinstance(called, ast.Attribute) and isinstance(on, ast.Attribute):
            if on.attr in ("control", "receive"):
                yield on.attr, called.attr, len(node.args), {word.arg for word in node.keywords}
        if isinstance(node, ast.Call) and isinstance(called, ast.Attribute) and called.attr.endswith("Interface"):
            interface = "control" if "Control" in called.attr else "receive"
            yield interface, "__init__", len(node.args), {word.arg for word in node.keywords}


def signatures(method):
    """Parameters of each overload, without self: names, and how many have no default."""
    for line in re.findall(r"\w+\(self: .*\) -> ", method.__doc__):
        inner = re.sub(r"\[[^]]*\]", "", re.sub(r"\[[^]]*\]", "", line[line.index("(") + 1 : line.rindex(")")]))
        parameters = [one.strip() for one in inner.split(",")][1:]
        parameters = [one for one in parameters if ":" in one]
        yield [one.split(":")[0] for one in parameters], sum("=" not in one for one in parameters)


def test_its_calls_fit_the_installed_ur_rtde():
    control = pytest.importorskip("rtde_control").RTDEControlInterface
    receive = pytest.importorskip("rtde_receive").RTDEReceiveInterface
    found = list(calls())
    assert len(found) >= 12
    for interface, name, count, keywords in found:
        method = getattr({"control": control, "receive": receive}[interface], name)
        fits = [
            needed <= count + len(keywords) and count <= len(names) and keywords <= set(names[count:])
            for names, needed in signatures(method)
        ]
        assert any(fits), (interface, name, count, keywords, method.__doc__)


def test_a_dry_run_prints_the_program_and_reports_no_attempt(example, capsys, tmp_path):
    import finger_opt as fo
    from finger_opt.robot import measure_window

    robot = example.URRobot("nowhere", fo.Task.from_toml("usb"), (0.4, -0.2, 0.3, 0, 3.14, 0), surface_m=-0.01)
    with pytest.raises(example.DryRun):
        robot.insert(-0.5)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["start", "approach", "touch", "back", "front", "side", "assembly"]
    assert "-0.2005" in lines[0] and "0.020 m/s, until 5 N" in lines[2]
    with pytest.raises(fo.StudyError, match="nothing moved"):
        measure_window(robot, task="usb", density=20, direction=10, out=tmp_path / "bench.csv")
    assert not (tmp_path / "bench.csv").exists()


def test_an_attempt_ends_at_the_limit_of_the_connector_or_of_the_robot(example):
    import finger_opt as fo

    def robot(force_n=None, **forces):
        limits = "" if force_n is None else f"\n[limits]\nforce_n = {force_n}\n"
        task = fo.Task.from_toml(fo.Task.from_toml("usb").to_toml() + limits)
        return example.URRobot("nowhere", task, (0.4, -0.2, 0.3, 0, 3.14, 0), surface_m=-0.01,
                               face=(0.43, -0.2, 0.3, 0, 3.14, 0), **forces)

    def largest_n(robot):
        return max(move.force_n for move in robot.program(0.0) + robot.probe_program())

    assert largest_n(robot()) == 150
    assert largest_n(robot(robot_stop_n=120)) == 120
    assert largest_n(robot(force_n=90.0)) == 90
    assert largest_n(robot(force_n=90.0, force_limit_n=60)) == 60
    assert largest_n(robot(force_n=12.0)) == 12
    assert largest_n(robot(force_n=4.0, touch_n=3.0)) == 4
    with pytest.raises(ValueError, match="force_limit_n: is 100 N; .* at most 90 N"):
        robot(force_n=90.0, force_limit_n=100)
    with pytest.raises(ValueError, match="above touch_n, 5 N"):
        robot(force_limit_n=5)


class Wire:
    """Both interfaces of a robot that is at once where it is sent, over a socket that ends 8 mm deep."""

    def __init__(self, pose):
        self.pose, self.moves, self.poses, self.recorded = list(pose), [], [], []

    def isPoseWithinSafetyLimits(self, pose):
        return True

    def zeroFtSensor(self):
        return True

    def moveL(self, pose, speed, acceleration, asynchronous):
        assert asynchronous
        self.pose = list(pose)
        self.moves.append((speed, acceleration))
        self.poses.append(list(pose))

    def getAsyncOperationProgress(self):
        return -1

    def getActualTCPPose(self):
        return self.pose

    def startFileRecording(self, name, variables):
        self.recorded.append((name, variables))

    def stopFileRecording(self):
        self.recorded.append("stopped")


def test_an_attempt_moves_asks_records_and_comes_back(example, tmp_path):
    import finger_opt as fo

    taught = (0.4, -0.2, 0.3, 0.0, 3.14, 0.0)
    wire = Wire(taught)
    robot = example.URRobot("nowhere", fo.Task.from_toml("usb"), taught, surface_m=-0.0118, dry_run=False,
                            ask=lambda _: "3", control=wire, receive=wire)
    done = robot.insert(1.0, tmp_path / "001.csv")
    # The phases go 31.8 mm down, 11.8 of them to the socket's top.
    assert (done.inserted, done.failure, done.depth_mm) == (False, 3, pytest.approx(20.0))
    assert wire.recorded == [(str(tmp_path / "001.csv"), example.RECORDED), "stopped"]
    assert len(wire.moves) == 8 and wire.pose[2] == pytest.approx(0.3)


class Face(Wire):
    """The same above a face that is met 4 mm below: a move there is stopped by the force."""

    def getAsyncOperationProgress(self):
        return 1 if self.pose[2] < 0.296 else -1

    def isProtectiveStopped(self):
        return False

    isEmergencyStopped = isProtectiveStopped

    def getActualTCPForce(self):
        return [0.0, 1.0, 6.0, 0.0, 0.0, 0.0]

    def stopL(self, deceleration):
        self.pose[2] = 0.296


def test_a_probe_slides_where_it_met_the_face(example, capsys, tmp_path):
    import finger_opt as fo
    from finger_opt.robot import measure_window

    taught, face = (0.4, -0.2, 0.3, 0.0, 3.14, 0.0), (0.43, -0.2, 0.3, 0.0, 3.14, 0.0)
    task = fo.Task.from_toml("usb")
    with pytest.raises(ValueError, match="face: teach a pose"):
        example.URRobot("nowhere", task, taught, surface_m=-0.01).probe(tmp_path / "probe.csv")
    dry = example.URRobot("nowhere", task, taught, surface_m=-0.01, face=face)
    with pytest.raises(fo.StudyError, match="nothing moved"):
        measure_window(dry, task="usb", density=20, direction=10, out=tmp_path / "bench.csv", probe=True)
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["above", "down", *["slide"] * 4, "up"]
    wire = Face(face)
    at = {"surface_m": -0.01, "face": face, "dry_run": False}
    robot = example.URRobot("nowhere", task, taught, **at, control=wire, receive=wire)
    robot.probe(tmp_path / "probe.csv")
    assert wire.recorded == [(str(tmp_path / "probe.csv"), example.RECORDED), "stopped"]
    assert len(wire.moves) == 7 and wire.pose[2] == pytest.approx(0.3)
    heights = [pose[2] for pose in wire.poses[2:6]]
    assert heights == pytest.approx([0.296] * 4)
    nothing = Wire(face)
    robot = example.URRobot("nowhere", task, taught, **at, control=nothing, receive=nothing)
    with pytest.raises(RuntimeError, match="no face within 10 mm"):
        robot.probe(tmp_path / "probe.csv")
    assert nothing.recorded[-1] == "stopped"
