"""What a measurement records: the probe, the logs, and the file that names them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from test_robot import FINGER, Steps, log_of

import finger_opt as fo
from finger_opt.robot import Attempt, SimulatedRobot, measure_window

HEADER = "t_s,x_mm,y_mm,z_mm,tilt_deg,target_x_mm,target_y_mm,target_z_mm,fx_n,fy_n,fz_n"


class Recording(Steps):
    """Records a line for each attempt, and probes."""

    probes = 0

    def probe(self, log):
        self.probes += 1
        log.write_text(HEADER + "\n")

    def insert(self, offset_mm, log=None):
        done = super().insert(offset_mm, log)
        log.write_text(f"{HEADER}\n{offset_mm}\n")
        return Attempt(done.inserted, done.failure, done.depth_mm, done.peak_force_n, log)


@pytest.fixture
def out(tmp_path):
    return tmp_path / "bench.csv"


def runs_of(out):
    lines = [line.split(",") for line in out.with_name("runs.csv").read_text().splitlines()]
    assert lines[0] == ["log", "infill_density_percent", "infill_direction_deg", "offset_mm", "outcome"]
    # No log twice.
    assert len({line[0] for line in lines[1:]}) == len(lines) - 1
    return lines[1:]


def test_it_begins_with_the_probe_and_names_every_log(out):
    robot = Recording()
    found = measure_window(robot, out=out, probe=True, **FINGER)
    first, *rest = runs_of(out)
    folder = found.log.stem
    assert first == [f"{folder}/probe.csv", "20", "10", "", "probe"] and robot.probes == 1
    assert [float(line[3]) for line in rest] == robot.offsets
    assert rest[0] == [f"{folder}/001.csv", "20", "10", "0", "inserted"]
    assert {line[4] for line in rest} == {"inserted", "3"}
    for log, *_, offset, _ in rest:
        assert float((out.parent / log).read_text().split()[1]) == float(offset)
    # Measured today, it is neither measured nor probed again.
    assert measure_window(robot, out=out, probe=True, **FINGER) == found and robot.probes == 1
    # All fingers of the folder stand in one file.
    measure_window(Recording(), out=out, probe=True, **{**FINGER, "density": 30})
    both = runs_of(out)
    assert both[: 1 + len(rest)] == [first, *rest] and {line[1] for line in both} == {"20", "30"}


def test_from_another_folder_the_logs_are_named_from_where_the_file_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "usb").mkdir()
    measure_window(Recording(), out="usb/bench.csv", **FINGER)
    assert all((tmp_path / "usb" / line[0]).is_file() for line in runs_of(tmp_path / "usb" / "bench.csv"))


def test_what_is_not_known_is_left_out(out):
    def answer(count, done):
        # No class; a lie.
        changes = {8: {"failure": None}, 3: {"depth_mm": 0.0}}.get(count, {})
        return Attempt(**{**vars(done), **changes})

    robot = Recording(answer=answer)
    measure_window(robot, out=out, **FINGER)
    attempts = log_of(out)
    wanted = [one["log"] for one in attempts if one["doubt"] is None and (one["inserted"] or one["failure"])]
    assert [str(out.parent / line[0]) for line in runs_of(out)] == wanted and len(wanted) == len(attempts) - 2


def test_a_robot_that_records_nothing_leaves_no_file(out):
    measure_window(Steps(), out=out, **FINGER)
    assert not out.with_name("runs.csv").exists()


def test_a_log_that_is_not_there_is_said(out):
    class Forgetful(Recording):
        def insert(self, offset_mm, log=None):
            done = super().insert(offset_mm, log)
            if len(self.offsets) == 4:
                log.unlink()
            return done

    with pytest.warns(UserWarning, match="004.csv: the robot returned this log, but the file does not exist"):
        found = measure_window(Forgetful(), out=out, **FINGER)
    assert len(runs_of(out)) == found.attempts - 1


def test_a_probe_that_cannot_be_is_refused_before_the_robot_moves(out):
    robot = Steps()
    with pytest.raises(fo.InputError, match=r"Steps has no method probe\(log\)"):
        measure_window(robot, out=out, probe=True, **FINGER)
    out.with_name("runs.csv").write_text("file,what\n")
    with pytest.raises(fo.InputError, match="runs.csv: line 1: the columns are file,what, not log,infill"):
        measure_window(robot, out=out, **FINGER)
    out.with_name("runs.csv").write_text(
        "log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n"
        "bench-ket8-20-10-2026-01-02/001.csv,20,10,0,inserted\n"
    )
    with pytest.raises(fo.InputError, match="which is not a log of usb; use a separate folder for each task"):
        measure_window(robot, out=out, **FINGER)
    assert robot.offsets == []


def test_a_probe_that_fails_stops_it_and_is_made_again(out):
    robot = Recording()
    robot.probe = lambda log: None
    with pytest.raises(fo.StudyError, match="^probe: the robot recorded nothing"):
        measure_window(robot, out=out, probe=True, **FINGER)
    assert [list(line) for line in log_of(out)] == [["stopped"]]
    del robot.probe
    measure_window(robot, out=out, probe=True, **FINGER)
    assert robot.probes == 1 and runs_of(out)[0][4] == "probe"


KILLED = """
import sys, time
sys.path.insert(0, sys.argv[2])
from test_runs import FINGER, Recording, measure_window

class Slow(Recording):
    def insert(self, offset_mm, log=None):
        time.sleep(0.1)
        return super().insert(offset_mm, log)

measure_window(Slow(), out=sys.argv[1], probe=True, **FINGER)
"""


def test_a_killed_measurement_has_no_line_twice(out):
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(out), os.path.dirname(__file__)])
    runs, deadline = out.with_name("runs.csv"), time.monotonic() + 60
    while time.monotonic() < deadline and not (runs.exists() and runs.read_bytes().count(b"\n") > 8):
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    # As if it had been killed earlier, after the attempt was on the disk and while its line was written.
    lines = runs.read_bytes().splitlines(keepends=True)
    runs.write_bytes(b"".join(lines[:-2]) + lines[-2][:20])
    robot = Recording()
    found = measure_window(robot, out=out, probe=True, **FINGER)
    assert robot.probes == 0 and len(robot.offsets) < found.attempts
    assert len(runs_of(out)) == 1 + found.attempts


def columns(log):
    names = log.read_text().splitlines()[0].split(",")
    assert sorted(names) == sorted(HEADER.split(","))
    return dict(zip(names, np.loadtxt(log, delimiter=",", skiprows=1).T, strict=True))


def test_a_simulated_robot_records_what_its_sensor_shows(tmp_path):
    plain, noisy = tmp_path / "plain.csv", tmp_path / "noisy.csv"
    SimulatedRobot("usb", 20, 10).insert(0.5, plain)
    robot = SimulatedRobot("usb", 20, 10, force_noise_n=0.5, force_drift_n=1.0, seed=3)
    assert robot.insert(0.5, noisy).log == noisy
    before, after = columns(plain), columns(noisy)
    np.testing.assert_allclose(np.diff(before["t_s"]), 0.002, atol=1e-6)
    assert all(np.array_equal(before[name], after[name]) for name in HEADER.split(",")[:8])
    for name in ("fx_n", "fy_n", "fz_n"):
        added = after[name] - before[name]
        time = before["t_s"] - before["t_s"][0]
        slope, level = np.polyfit(time, added, 1)
        assert abs(abs(slope * time[-1]) - 1.0) < 0.15 and abs(level) < 0.1
        assert np.std(added - level - slope * time) == pytest.approx(0.5, rel=0.1)
    # The same seed, the same log.
    again = tmp_path / "again.csv"
    SimulatedRobot("usb", 20, 10, force_noise_n=0.5, force_drift_n=1.0, seed=3).insert(0.5, again)
    assert again.read_bytes() == noisy.read_bytes()


def test_a_log_does_not_show_by_how_much_the_start_is_off(tmp_path):
    SimulatedRobot("usb", 20, 10).insert(0.5, tmp_path / "plain.csv")
    SimulatedRobot("usb", 20, 10, noise=1.0, seed=1).insert(0.5, tmp_path / "off.csv")
    plain, off = columns(tmp_path / "plain.csv"), columns(tmp_path / "off.csv")
    np.testing.assert_allclose(off["target_y_mm"][0], plain["target_y_mm"][0], atol=1e-3)
    assert not np.array_equal(off["fy_n"][-1], plain["fy_n"][-1])


def test_a_simulated_probe_slides_and_tells_the_friction(tmp_path):
    log = tmp_path / "probe.csv"
    SimulatedRobot("usb", 20, 10, cell={"task.friction.plug_socket": 0.3}).probe(log)
    probe = columns(log)
    # It slides by millimetres, back and forth, under some newtons.
    assert np.ptp(probe["y_mm"]) > 3.0 and 2.0 < probe["fz_n"].max() < 30.0
    pressed = probe["fz_n"] > 0.5 * probe["fz_n"].max()
    assert 0.1 < np.abs(probe["fy_n"][pressed] / probe["fz_n"][pressed]).max() < 0.4


def test_the_sensor_and_the_cell_are_checked(tmp_path, fake):
    with pytest.raises(fo.InputError, match="force_noise_n: is nan; must be a force in N, 0 to 100"):
        SimulatedRobot("usb", 20, 10, force_noise_n=float("nan"))
    # A closed formula has no course.
    assert SimulatedRobot("usb", 20, 10, **fake).insert(0.0, tmp_path / "log.csv").log is None


def test_a_cell_file_is_what_the_robot_hides(tmp_path):
    robot = (Path(__file__).parents[2] / "robots" / "servo.toml").read_text()
    row = {"name": "friction", "sets": "task.friction.plug_socket", "as": "factor", "scale": "log", "source": "hidden"}
    numbers = {"value": 1.5, "sd": 0.1, "low": 0.5, "high": 2.0}
    lines = [f'{key} = "{value}"' for key, value in row.items()]
    lines += [f"{key} = {value}" for key, value in numbers.items()]
    cell = tmp_path / "cell.toml"
    cell.write_text("\n".join(['name = "cell"', 'description = ""', 'task = "usb"', "[robot]", robot, "[[parameter]]",
                               *lines, "shared = false\n"]))
    peak_n = SimulatedRobot("usb", 20, 10, cell=cell).insert(0.5).peak_force_n
    same = SimulatedRobot("usb", 20, 10, cell={"task.friction.plug_socket": 0.3}).insert(0.5).peak_force_n
    assert peak_n == pytest.approx(same, rel=1e-3)
    assert peak_n != pytest.approx(SimulatedRobot("usb", 20, 10).insert(0.5).peak_force_n, rel=2e-3)
