"""Robots that lie, in every field and by every type; files of attempts that were changed; two processes at once."""

from __future__ import annotations

import dataclasses
import itertools
import json
import math
import os
import random
import signal
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from test_robot import FINGER, Steps, log_of
from test_runs import Recording, runs_of

import finger_opt as fo
from finger_opt.robot import Attempt, SimulatedRobot, measure_window


class Unprintable:
    """Neither a number nor a text, and not even that can be said of it."""

    def __repr__(self):
        raise RuntimeError("no words")

    __float__ = __str__ = __fspath__ = __repr__


@pytest.fixture
def out(tmp_path):
    return tmp_path / "bench.csv"


@pytest.mark.parametrize("failure, kept", [
    (3.0, 3), (np.float64(3), 3), (np.int8(3), 3), (np.array(3), 3), (Fraction(3), 3), (Decimal(3), 3), (3, 3),
])
def test_a_whole_number_of_any_type_is_a_failure_class(out, failure, kept):
    robot = Steps(answer=lambda _, done: done if done.inserted else dataclasses.replace(done, failure=failure))
    found = measure_window(robot, out=out, **FINGER)
    assert (found.doubtful, found.failure_negative, found.failure_positive) == (0, kept, kept)
    assert {line["failure"] for line in log_of(out)} == {None, kept}


@pytest.mark.parametrize("lie, said", [
    ({"failure": True}, "failure is True; it must be a failure class from 1 to 4, or None"),
    ({"failure": 2.5}, "failure is 2.5; it must be"),
    ({"failure": np.array([1, 2])}, r"failure is array\(\[1, 2\]\); it must be"),
    ({"peak_force_n": 1e10}, "peak_force_n is 10000000000.0; it must be a force from 0 to 5000 N"),
    ({"peak_force_n": 10**400}, "peak_force_n is 1000.*; it must be a force"),
    ({"depth_mm": -4e4}, "depth_mm is -40000.0; it must be a depth of at most 100 mm"),
    ({"log": 5}, "log is 5; it must be the path of a log"),
    ({"log": os.fsdecode(b"\xff.csv")}, r"log is '\\udcff.csv'; it must be the path of a log"),
    ({"log": "two\nlines.csv"}, "log is .*; it must be the path of a log"),
    ({"depth_mm": Unprintable()}, "depth_mm is a Unprintable; it must be"),
])
def test_what_cannot_be_is_marked_at_once_and_a_mended_robot_goes_on(out, lie, said):
    robot = Steps(answer=lambda _, done: done if done.inserted else dataclasses.replace(done, **lie))
    with pytest.raises(fo.StudyError, match=f"3 attempts in a row are implausible: {said}"):
        measure_window(robot, out=out, **FINGER)
    made = len(robot.offsets)
    robot.answer = None
    found = measure_window(robot, out=out, **FINGER)
    # Those that were made are there, and none but the lies is made again.
    assert found.settled and found.doubtful == 3 and found.attempts == len(robot.offsets) >= made
    assert len(out.read_text().splitlines()) == 2


#: What no field should be, and some of what each may be.
VALUES = (
    None, True, False, np.True_, 0, 1, 3, 4, 5, -1, 10**400, 2.0, 3.5, -0.0, math.nan, math.inf, -math.inf, 1e10, 1e-320,
    np.float32(3), np.int64(2), np.uint8(200), np.array(2.0), np.array([1.0]), np.array([]), Decimal("NaN"), Decimal(12),
    Fraction(1, 3), 1j, "", "3", "yes", "\udcff", "a\0b", "a\nb", "x.csv", b"x", b"\xff", Path("x.csv"), Path("."),
    (), [3], {}, {1}, object(), Unprintable(), Ellipsis, int, lambda: 1,
)


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(Attempt)])
@pytest.mark.filterwarnings("ignore:.*the robot returned this log")
def test_no_field_of_any_type_ends_in_anything_but_a_window_or_a_study_error(tmp_path, field):
    for number, value in enumerate(VALUES):
        folder = tmp_path / str(number)
        folder.mkdir()
        robot = Steps(answer=lambda _, done, value=value: dataclasses.replace(done, **{field: value}))
        try:
            assert measure_window(robot, out=folder / "bench.csv", **FINGER).attempts == len(robot.offsets)
        except fo.StudyError as error:
            assert "implausible" in str(error) or "teach another" in str(error)
        # Each attempt that was made stands in the file.
        lines = log_of(folder / "bench.csv")
        assert len([line for line in lines if "stopped" not in line]) == len(robot.offsets)
        robot.answer = None
        # And nothing of it keeps a mended robot from its window.
        assert measure_window(robot, out=folder / "bench.csv", **FINGER).settled


@pytest.mark.filterwarnings("ignore:.*the robot returned this log")
def test_robots_that_lie_at_random_lose_no_attempt(tmp_path):
    chance = random.Random(3)
    fields = [field.name for field in dataclasses.fields(Attempt)]
    for number in range(60):
        folder = tmp_path / str(number)
        folder.mkdir()
        robot = Steps(low=-chance.uniform(0, 3), high=chance.uniform(0, 3))

        def answer(_, done):
            lies = {field: chance.choice(VALUES) for field in fields if chance.random() < 0.08}
            return dataclasses.replace(done, **lies)

        robot.answer = answer
        for again in range(40):
            try:
                measure_window(robot, out=folder / "bench.csv", **FINGER)
                break
            except fo.StudyError:
                robot.answer = None if again > 20 else answer
        kept = [line for line in log_of(folder / "bench.csv") if "stopped" not in line]
        assert len(kept) == len(robot.offsets) and (folder / "bench.csv").exists()


class Wordless(Exception):
    def __str__(self):
        raise RuntimeError("no words")


@pytest.mark.parametrize("error, said", [
    (Wordless(), "the robot raised Wordless"),
    (OSError(5, "no bus"), r"the robot raised OSError: \[Errno 5\] no bus"),
    (UnicodeDecodeError("utf-8", b"\xff", 0, 1, "bad"), "the robot raised UnicodeDecodeError"),
    (SystemExit("the driver gave up"), "the robot raised SystemExit: the driver gave up"),
    (ValueError("\udcff"), "the robot raised ValueError"),
])
def test_whatever_a_robot_raises_is_a_study_error(out, error, said):
    def fails(count, done):
        if count == 3:
            raise error
        return done

    robot = Steps(answer=fails)
    with pytest.raises(fo.StudyError, match=said):
        measure_window(robot, out=out, **FINGER)
    assert measure_window(robot, out=out, **FINGER).attempts == len(robot.offsets) - 1


@pytest.mark.parametrize("timeout_s", [math.inf, math.nan, None, 0, -1, "9", 1e9, 10**400, np.array([1.0])])
def test_a_timeout_that_is_none_is_refused_before_the_robot_moves(out, timeout_s):
    robot = Steps()
    robot.timeout_s = timeout_s
    with pytest.raises(fo.InputError, match="robot: its timeout_s is .*; it must be a time above 0, 86400 s at most"):
        measure_window(robot, out=out, **FINGER)
    assert robot.offsets == [] and not list(out.parent.iterdir())


def test_a_full_disk_is_a_study_error_and_no_attempt_is_lost(out, monkeypatch):
    from finger_opt._attempts import Attempts

    real, robot = Attempts._append, Steps()

    def full(self, fields):
        if len(robot.offsets) == 5:
            self._file.write(b'{"offset_mm": 1.0, "ins')
            raise OSError(28, "No space left on device", str(self.path))
        real(self, fields)

    monkeypatch.setattr(Attempts, "_append", full)
    with pytest.raises(fo.StudyError, match="jsonl: No space left on device"):
        measure_window(robot, out=out, **FINGER)
    monkeypatch.undo()
    # That of the fifth, of which nothing is known, is made again.
    assert measure_window(robot, out=out, **FINGER).attempts == len(robot.offsets) - 1


@pytest.mark.parametrize("key, value, said", [
    ("offset_mm", "abc", "is 'abc'; it must be a start within the limit, 15 mm"),
    ("offset_mm", None, "is None; it must be a start"),
    ("offset_mm", math.nan, "is nan; it must be a start"),
    ("offset_mm", 1e9, "is 1000000000.0; it must be a start"),
    ("offset_mm", True, "is True; it must be a start"),
    ("inserted", "yes", "is 'yes'; it must be True or False"),
    ("inserted", 1, "is 1; it must be True or False"),
    ("failure", 5, "is 5; it must be a failure class"),
    ("failure", True, "is True; it must be a failure class"),
    ("depth_mm", "4", "is '4'; it must be a depth"),
    ("depth_mm", math.inf, "is inf; it must be a depth"),
    ("peak_force_n", "20", "is '20'; it must be a force"),
    ("peak_force_n", -1, "is -1; it must be a force"),
    ("log", 7, "is 7; it must be the path of a log"),
    ("doubt", 7, "is 7; it must be text, or None"),
    ("probed", 7, "is 7; it must be the path of a log"),
    ("more", 7, "is not a field of an attempt"),
])
def test_a_changed_line_of_attempts_is_an_error_with_its_place(out, key, value, said):
    measure_window(Steps(), out=out, **FINGER)
    (log,) = out.parent.glob("*.jsonl")
    out.unlink()
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    lines[3][key] = value
    log.write_text("".join(json.dumps(line) + "\n" for line in lines))
    robot = Steps()
    with pytest.raises(fo.InputError, match=f"line 4: {key}: {said}") as raised:
        measure_window(robot, out=out, **FINGER)
    assert (raised.value.file, raised.value.line, raised.value.key) == (str(log), 4, key)
    assert robot.offsets == []
    del lines[3]["offset_mm"]
    lines[3].pop("probed", None)
    log.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(fo.InputError, match="line 4: "):
        measure_window(robot, out=out, **FINGER)


def test_a_nested_line_or_other_bytes_are_no_attempt(out):
    measure_window(Steps(), out=out, **FINGER)
    (log,) = out.parent.glob("*.jsonl")
    out.unlink()
    text = log.read_bytes()
    for wrong in (b"[" * 100_000, b"\xff\xfe", b"null", b"[]", b"{'a': 1}"):
        log.write_bytes(text + wrong + b"\n")
        with pytest.raises(fo.InputError, match=r"line \d+: is not an attempt; move the file away"):
            measure_window(Steps(), out=out, **FINGER)


MEASURE = """
import sys, time
sys.path.insert(0, sys.argv[2])
from test_runs import Recording, measure_window

class Slow(Recording):
    def insert(self, offset_mm, log=None):
        time.sleep(float(sys.argv[4]))
        return super().insert(offset_mm, log)

density = float(sys.argv[3])
print(measure_window(Slow(), out=sys.argv[1], task="usb", density=density, direction=10, progress=False).attempts)
"""


def measuring(out, density, wait_s):
    words = [sys.executable, "-c", MEASURE, str(out), os.path.dirname(__file__), str(density), str(wait_s)]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_fingers_measured_at_once_into_a_folder_leave_every_line(out):
    for _ in range(2):
        all_ = [measuring(out, density, 0.001) for density in (10, 12, 14, 16, 18, 20)]
        ended = [process.communicate(timeout=200) for process in all_]
        assert all(process.returncode == 0 for process in all_), ended
        made = sum(int(said) for said, _ in ended)
        assert len(runs_of(out)) == made and len(out.read_text().splitlines()) == 7
        for file in out.parent.glob("*.csv"):
            file.unlink()
        for file in out.parent.glob("*.jsonl"):
            file.unlink()


def test_threads_that_measure_at_once_leave_every_line(out):
    from concurrent.futures import ThreadPoolExecutor

    def one(density):
        return measure_window(Recording(), out=out, task="usb", density=density, direction=10).attempts

    with ThreadPoolExecutor(6) as threads:
        made = sum(threads.map(one, range(10, 22, 2)))
    assert len(runs_of(out)) == made


def test_the_second_who_measures_a_finger_is_refused(out):
    both = [measuring(out, 20, 0.05) for _ in range(2)]
    ended = [process.communicate(timeout=200) for process in both]
    assert sorted(process.returncode for process in both) == [0, 1], ended
    (made,) = [int(said) for said, _ in ended if said]
    (error,) = [said for _, said in ended if said]
    assert "InputError" in error and "another process is measuring this finger; wait until it has ended" in error
    # Its robot has not moved.
    assert len([line for line in log_of(out) if "stopped" not in line]) == made == len(runs_of(out))
    # Afterwards the finger is free.
    assert measure_window(Recording(), out=out, **FINGER).attempts == made


def test_a_robot_that_changes_the_folder_keeps_its_result_with_its_attempts(tmp_path, monkeypatch):
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    there.mkdir()
    monkeypatch.chdir(here)
    own = fo.Task.from_toml("usb")
    own.name = "mine"
    (here / "mine.toml").write_text(own.to_toml())

    class Wanders(Recording):
        def insert(self, offset_mm, log=None):
            os.chdir(there)
            return super().insert(offset_mm, log)

    for task, folder in (("usb", here / "a"), ("mine.toml", here / "b")):
        os.chdir(here)
        folder.mkdir()
        found = measure_window(Wanders(), task=task, density=20, direction=10, out=f"{folder.name}/bench.csv")
        assert (folder / "bench.csv").exists() and len(runs_of(folder / "bench.csv")) == found.attempts
        assert found.log.parent == folder
    assert not list(there.iterdir())


def test_a_kill_while_it_begins_leaves_nothing_behind(out):
    code = f"""
import os, signal
from finger_opt import _bench
from finger_opt.robot import measure_window
real = _bench.Bench.add
def killed(self, *words):
    real(self, *words)
    os.kill(os.getpid(), signal.SIGKILL)
_bench.Bench.add = killed
measure_window(object(), out={str(out)!r}, task="usb", density=20, direction=10)
"""
    assert subprocess.run([sys.executable, "-c", code]).returncode == -signal.SIGKILL
    assert not list(out.parent.iterdir())


@pytest.mark.parametrize("name", ["bench.csv", "runs.csv"])
def test_an_unclosed_quotation_mark_is_told_before_the_robot_moves(out, name):
    measure_window(Recording(), out=out, **FINGER)
    file = out.with_name(name)
    lines = file.read_text().splitlines()
    file.write_text("\n".join([*lines[:1], lines[1].replace("20,10", '"20,10'), *lines[2:]]) + "\n")
    robot = Recording()
    with pytest.raises(fo.InputError, match=f"{name}: line 2: a quoted cell is not closed at the end of the line"):
        measure_window(robot, out=out, **{**FINGER, "density": 30})
    assert robot.offsets == []


@pytest.mark.parametrize("word, value", [
    ("noise", np.array([1.0, 2.0])), ("noise", Decimal("NaN")), ("noise", "0.2"), ("noise", 10**400), ("noise", -1.0),
    ("seed", 1.5), ("seed", -1), ("seed", 10**400), ("force_noise_n", math.inf), ("force_drift_n", None),
    ("density", "20"), ("engine", "fak"), ("cell", 5), ("cell", "a\0b"),
])
def test_words_of_the_simulated_robot_are_checked_by_name(word, value):
    with pytest.raises((fo.InputError, TypeError), match=word):
        SimulatedRobot(**{"task": "usb", "density": 20, "direction": 10, word: value})


@pytest.mark.parametrize("word, value", list(itertools.product(
    ("density", "direction", "step_mm", "resolution_mm", "limit_mm", "repeats", "attempts_max"),
    ("a", None, 10**400, math.nan, math.inf, [1], np.array([1.0]), True, 1j, Unprintable()),
)))
def test_words_of_a_measurement_are_checked_by_name(out, word, value):
    robot = Steps()
    with pytest.raises((fo.InputError, TypeError), match=f"{word}|infill_{word}|lengths in mm"):
        measure_window(robot, out=out, **{**FINGER, word: value})
    assert robot.offsets == []
