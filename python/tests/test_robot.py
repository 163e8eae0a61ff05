"""Windows that a robot measures, attempt by attempt."""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import subprocess
import sys
import time

import pytest

import finger_opt as fo
from finger_opt.robot import Attempt, Gap, SimulatedRobot, measure_window

FINGER = {"task": "usb", "density": 20, "direction": 10}


class Steps:
    """Inserts from `low` to `high`, mm, but not in `gap`; `answer` may say something else of an attempt."""

    def __init__(self, low=-2.34, high=3.17, gap=None, answer=None):
        self.low, self.high, self.gap, self.answer, self.offsets = low, high, gap, answer, []

    def insert(self, offset_mm, log=None):
        self.offsets.append(offset_mm)
        inside = self.low <= offset_mm <= self.high
        if self.gap and self.gap[0] <= offset_mm <= self.gap[1]:
            inside = False
        done = Attempt(inside, None if inside else 3, 12.5 if inside else 4.0, 20.0 + abs(offset_mm))
        return self.answer(len(self.offsets), done) if self.answer else done


@pytest.fixture
def out(tmp_path):
    return tmp_path / "bench.csv"


def log_of(out):
    (log,) = out.parent.glob("bench-usb-20-10-*.jsonl")
    return [json.loads(line) for line in log.read_text().splitlines()][1:]


def test_a_window_with_sharp_ends_and_its_line(out, command):
    robot = Steps()
    found = measure_window(robot, out=out, **FINGER)
    assert found.settled and found.attempts == len(robot.offsets) <= 40
    for end, interval, truth in ((found.negative_mm, found.negative_interval_mm, -2.34),
                                 (found.positive_mm, found.positive_interval_mm, 3.17)):
        assert abs(end - truth) < 0.1 and interval[0] <= truth <= interval[1]
    assert (found.failure_negative, found.failure_positive, found.gaps) == (3, 3, ())
    # Outward by steps, and never farther than two of them.
    assert robot.offsets[:7] == [0.0, -0.5, -1.0, -1.5, -2.0, -2.5, -3.0]
    assert max(map(abs, robot.offsets)) <= 4.0
    code, said, errors = command("measure", "check", str(out))
    assert code == 0 and "1 range," in said, errors
    assert [line["offset_mm"] for line in log_of(out)] == robot.offsets
    # Measured today, it is not measured again.
    assert measure_window(robot, out=out, **FINGER) == found
    assert len(robot.offsets) == found.attempts and len(out.read_text().splitlines()) == 2


def test_each_attempt_is_a_line_unless_it_is_to_be_silent(out, tmp_path, capsys):
    found = measure_window(Steps(), out=out, **FINGER)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == found.attempts
    assert lines[0] == "attempt 1: start +0 mm, inserted" and "attempt 7: start -3 mm, failed, class 3" in lines
    measure_window(Steps(), out=tmp_path / "silent.csv", progress=False, **FINGER)
    assert capsys.readouterr().err == ""


def test_a_gap_is_recorded_and_the_ends_lie_beyond(out):
    found = measure_window(Steps(gap=(0.9, 1.2)), out=out, **FINGER)
    (gap,) = found.gaps
    assert gap == Gap(failed_mm=(1.0, 1.0), within_mm=(0.5, 1.5), failure=3)
    assert abs(found.positive_mm - 3.17) < 0.1
    assert "gap at 1 to 1 mm within 0.5 to 1.5 (class 3)" in out.read_text()


def test_ends_that_are_not_met_are_bounds(out, command):
    found = measure_window(Steps(low=-50, high=50), out=out, limit_mm=3.0, **FINGER)
    assert (found.negative_mm, found.positive_mm, found.range_mm, found.settled) == (None, None, None, False)
    assert found.inserted_mm == (-3.0, 3.0)
    code, said, errors = command("measure", "check", str(out))
    assert code == 0 and "1 lower bound," in said, errors


def test_a_start_that_fails_more_often_than_it_inserts_has_to_be_taught_again(out):
    lucky = Steps(low=0.05, answer=lambda count, done: Attempt(True, None, 12.5, 20.0) if count == 1 else done)
    with pytest.raises(fo.StudyError, match=r"2 of 3 attempts from the taught start failed: teach another, near \+1\.[56]"):
        measure_window(lucky, out=out, **FINGER)
    assert not out.exists()
    # One failure by chance is none of the start.
    once = Steps(answer=lambda count, done: Attempt(False, 3, 4.0, 20.0) if count == 1 else done)
    assert measure_window(once, out=out.with_name("other.csv"), **FINGER).settled


def test_attempts_max_ends_it(out):
    found = measure_window(Steps(), out=out, attempts_max=20, **FINGER)
    assert found.attempts == 20 and not found.settled and "ended before" in out.read_text()


@pytest.mark.parametrize("error", [ValueError("no signal"), SystemExit("gone")])
def test_a_robot_that_raises_stops_it_and_what_was_measured_stays(out, error):
    def fails(count, done):
        if count == 8:
            raise error
        return done

    robot = Steps(answer=fails)
    with pytest.raises((fo.StudyError, SystemExit)):
        measure_window(robot, out=out, **FINGER)
    kept = [line for line in log_of(out) if "stopped" not in line]
    assert len(kept) == 7 and not out.exists()
    found = measure_window(robot, out=out, **FINGER)
    # The eighth once more, no other.
    assert len(robot.offsets) == found.attempts + 1
    assert robot.offsets[7] == robot.offsets[8] and out.exists()


def test_a_robot_that_hangs_stops_it(out):
    robot = Steps(answer=lambda count, done: done if count < 4 else time.sleep(60))
    robot.timeout_s = 0.2
    begun = time.monotonic()
    with pytest.raises(fo.StudyError, match="no answer within 0.2 s"):
        measure_window(robot, out=out, **FINGER)
    assert time.monotonic() - begun < 20
    *kept, last = log_of(out)
    assert len(kept) == 3 and "TimeoutError" in last["stopped"]


@pytest.mark.parametrize("lie, said", [
    ({"depth_mm": 0.0}, "inserted at a depth of 0 mm; the task counts from 12 mm on"),
    ({"depth_mm": float("nan")}, "depth_mm is nan; it must be a depth of at most 100 mm"),
    ({"failure": 7, "inserted": False}, "failure is 7; it must be a failure class from 1 to 4"),
    ({"failure": 2}, "inserted, and failed with class 2"),
    ({"inserted": "yes"}, "inserted is 'yes'; it must be True or False"),
])
def test_a_lie_is_marked_and_tried_again(out, lie, said):
    def once(count, done):
        return dataclasses.replace(done, **lie) if count == 3 else done

    robot = Steps(answer=once)
    found = measure_window(robot, out=out, **FINGER)
    assert found.doubtful == 1 and found.settled and "1 doubtful" in out.read_text()
    marked = log_of(out)[2]
    assert said in marked["doubt"] and marked["offset_mm"] == robot.offsets[3]


def test_a_robot_that_keeps_lying_is_stopped(out):
    robot = Steps(answer=lambda count, done: dataclasses.replace(done, depth_mm=0.0) if done.inserted else done)
    with pytest.raises(fo.StudyError, match="3 attempts in a row are implausible"):
        measure_window(robot, out=out, **FINGER)
    assert len(log_of(out)) == 4 and not out.exists()


def test_what_is_no_attempt_stops_it(out):
    with pytest.raises(fo.StudyError, match="returned True, which is not an Attempt"):
        measure_window(Steps(answer=lambda *_: True), out=out, **FINGER)


def test_a_start_that_does_not_insert_is_to_be_taught_anew(out):
    with pytest.raises(fo.StudyError, match="teach another"):
        measure_window(Steps(low=1.0), out=out, **FINGER)
    assert not out.exists()
    assert measure_window(Steps(), out=out, **FINGER).settled


def test_what_could_not_be_written_is_refused_before_the_robot_moves(out, tmp_path):
    robot = Steps()
    for wrong, said in [
        ({"density": 0.2}, "in fractions, multiply by 100: 20.00 %"),
        ({"direction": 95}, "0 .. 90"),
        ({"step_mm": float("nan")}, "lengths in mm"),
        ({"resolution_mm": 0.6}, "each at most the next"),
        ({"attempts_max": 0}, "1 to 10000"),
        ({"out": tmp_path / "no" / "bench.csv"}, "no folder"),
        ({"task": "usbb"}, "usb"),
    ]:
        with pytest.raises(fo.InputError, match=said):
            measure_window(robot, **{"out": out, **FINGER, **wrong})
    out.write_text("task,density\n")
    with pytest.raises(fo.InputError, match=f"{out.name}: line 1"):
        measure_window(robot, out=out, **FINGER)
    assert robot.offsets == [] and not list(tmp_path.glob("*.jsonl"))


def test_another_search_does_not_go_on_in_the_same_log(out):
    with pytest.raises(fo.StudyError):
        measure_window(Steps(answer=lambda count, done: done if count < 5 else None), out=out, **FINGER)
    with pytest.raises(fo.InputError, match="was started with step_mm 0.5, not 0.4"):
        measure_window(Steps(), out=out, step_mm=0.4, **FINGER)
    (log,) = out.parent.glob("*.jsonl")
    log.write_bytes(log.read_bytes() + b"{broken}\n")
    with pytest.raises(fo.InputError, match="line 7: is not an attempt"):
        measure_window(Steps(), out=out, **FINGER)


def test_what_was_measured_on_another_day_is_measured_anew(out):
    measure_window(Steps(), out=out, step_mm=0.4, **FINGER)
    (log,) = out.parent.glob("*.jsonl")
    before = log.with_name("bench-usb-20-10-2026-01-02.jsonl")
    before.write_text(log.read_text().replace(log.stem[-10:], "2026-01-02"))
    out.write_text(out.read_text().replace(log.stem[-10:], "2026-01-02"))
    log.unlink()
    robot = Steps()
    found = measure_window(robot, out=out, **FINGER)
    assert found.log == log and found.attempts == len(robot.offsets)
    assert len(out.read_text().splitlines()) == 3
    # One that was not finished then goes on, as of its day.
    out.unlink()
    log.unlink()
    assert measure_window(robot, out=out, step_mm=0.4, **FINGER).log == before
    assert "2026-01-02" in out.read_text()


KILLED = """
import sys, time
sys.path.insert(0, sys.argv[2])
from test_robot import FINGER, Steps, measure_window

class Slow(Steps):
    def insert(self, offset_mm, log=None):
        time.sleep(0.1)
        return super().insert(offset_mm, log)

measure_window(Slow(gap=(0.9, 1.2)), out=sys.argv[1], **FINGER)
"""


def test_a_killed_measurement_goes_on_where_it_was(out, command):
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(out), os.path.dirname(__file__)])
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        logs = list(out.parent.glob("*.jsonl"))
        if logs and logs[0].read_bytes().count(b"\n") > 12:
            break
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert process.returncode == -signal.SIGKILL and not out.exists()
    before = len(log_of(out))
    assert before >= 12
    # As if it had been cut off while it wrote.
    with logs[0].open("ab") as log:
        log.write(b'{"offset_mm": 1.0, "ins')
    robot = Steps(gap=(0.9, 1.2))
    found = measure_window(robot, out=out, **FINGER)
    assert len(robot.offsets) == found.attempts - before
    whole = out.with_name("whole")
    whole.mkdir()
    undisturbed = measure_window(Steps(gap=(0.9, 1.2)), out=whole / "bench.csv", **FINGER)
    assert dataclasses.replace(undisturbed, log=found.log) == found
    assert (whole / "bench.csv").read_text() == out.read_text()
    assert command("measure", "check", str(out))[0] == 0


def test_a_task_of_ones_own(out, command):
    task = fo.Task.from_toml("usb")
    task.name = "mine"
    measure_window(Steps(), out=out, task=task, density=20, direction=10)
    own = out.with_name("mine.toml")
    own.write_text(task.to_toml())
    assert command("measure", "check", str(out), "--task", str(own))[0] == 0
    assert command("measure", "check", str(out))[0] == 0


def test_a_simulated_robot_measures_what_evaluate_finds(out, fake):
    window = fo.evaluate("usb", 20, 10, set={"task.friction.plug_socket": 0.3}, **fake)
    cell = {"task.friction.plug_socket": 0.3}
    found = measure_window(SimulatedRobot("usb", 20, 10, cell=cell, **fake), out=out, **FINGER)
    assert abs(found.negative_mm - window.negative_mm) < 0.15
    assert abs(found.positive_mm - window.positive_mm) < 0.15
    # A robot file is a cell, too.
    assert SimulatedRobot("usb", 20, 10, cell="ur5e", **fake).insert(0.0).inserted


def test_noise_is_a_logistic_of_the_width_that_is_said(fake):
    robot = SimulatedRobot("usb", 20, 10, noise=0.6, seed=4, **fake)
    end = fo.evaluate("usb", 20, 10, walk=True, **fake).positive_mm
    inserted = {shift: sum(robot.insert(end + shift).inserted for _ in range(40)) for shift in (-0.3, 0.3)}
    # 36 and 4 are expected, with a deviation of 2; the grid of `evaluate` ends up to 0.1 mm before the end.
    assert 30 <= inserted[-0.3] and 1 <= inserted[0.3] <= 12
    with pytest.raises(fo.InputError, match="noise"):
        SimulatedRobot("usb", 20, 10, noise=float("nan"))
