"""What version 0.5.0 wrote is read and gone on with."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from test_robot import Steps

import finger_opt as fo
from finger_opt.robot import measure_window

FIXTURE = Path(__file__).parents[2] / "tests" / "fixtures" / "v0.5.0"


@pytest.fixture
def copy(tmp_path):
    return shutil.copytree(FIXTURE, tmp_path / "copy")


def test_a_study_is_read_and_asks_before_it_goes_on(copy):
    study = fo.load_study(copy / "study")
    assert len(study) == 12 and study.config["optimizer"] == "gp"
    assert "14 %" in study.answer.expectation and "15 %" in study.answer.headline
    assert list(study.to_dataframe()["range_mm"])[4] == 5.5
    with pytest.raises(fo.InputError, match="--accept-changed"):
        study.run()


def test_an_attempts_file_is_gone_on_with(copy, monkeypatch):
    # It was begun there, and names its log from there.
    monkeypatch.chdir(copy / "robot")
    out = Path("bench.csv")
    log = out.with_name("bench-ket8-20-10-2026-11-24.jsonl")
    before, runs = log.read_text(), out.with_name("runs.csv").read_text()
    robot = Steps(low=-2.7, high=2.2)
    found = measure_window(robot, out=out, task="ket8", density=20, direction=10)
    # There are six, to -2.5 mm; the robot stopped at the next.
    assert robot.offsets[0] == -3.0 and found.attempts == 6 + len(robot.offsets)
    assert found.settled and found.negative_mm == pytest.approx(-2.7, abs=0.15)
    assert log.read_text().startswith(before) and out.with_name("runs.csv").read_text() == runs
    (line,) = fo.Measurements(out).check()
    assert line.range_mm == found.range_mm
    assert ",2026-11-24," in out.read_text()
