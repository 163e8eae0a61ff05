"""The robot in MuJoCo: hidden numbers, the physics of its probe, and its errors."""

import dataclasses
from copy import copy
from pathlib import Path

import numpy as np
import pytest

import finger_opt as fo
from finger_opt._rehearsal import TICK_S, Rehearsal, _Attempt
from finger_opt.robot import SimulatedRobot

pytest.importorskip("mujoco")


def robot(seed: int = 5, density: float = 20, direction: float = 10, **more: object) -> SimulatedRobot:
    return SimulatedRobot("usb", density, direction, "mujoco", seed=seed, **more)  # type: ignore[arg-type]


def test_a_seed_is_a_cell_whatever_the_finger() -> None:
    one, other = robot(), robot(density=30, direction=0)
    assert one.hidden == other.hidden != robot(seed=6).hidden
    assert 0.5 <= one.hidden["friction plug-socket"] <= 2.0
    assert 0.01 <= one.hidden["backlash_mm"] <= 0.06


def test_the_same_seed_is_the_same_series_of_attempts_and_errors_differ_from_one_to_the_next(tmp_path: Path) -> None:
    runs = []
    for name in ("a", "b"):
        taught = robot(taught_mm=3.0)
        attempts = [taught.insert(0.0, tmp_path / f"{name}{i}.csv") for i in range(2)]
        runs.append([(dataclasses.replace(one, log=None), (tmp_path / f"{name}{i}.csv").read_text())
                     for i, one in enumerate(attempts)])
    assert runs[0] == runs[1]
    assert runs[0][0] != runs[0][1]
    assert runs[0][0][0].inserted


@pytest.mark.parametrize("seed", [2, 5])
def test_the_probe_slides_with_the_hidden_friction(seed: int, tmp_path: Path) -> None:
    robot(seed).probe(tmp_path / "probe.csv")
    log = np.loadtxt(tmp_path / "probe.csv", delimiter=",", skiprows=1)
    # As a lab does: zero before contact.
    across, down = (log[:, column] - log[:150, column].mean() for column in (6, 7))
    pressed = down > 3.0
    friction = float(np.median(np.abs(across[pressed]) / down[pressed]))
    # The task file has 0.2. Drift and play are of the order of a tenth.
    assert friction == pytest.approx(0.2 * robot(seed).hidden["friction plug-socket"], rel=0.2)


def test_far_from_the_opening_the_plug_misses_wherever_the_start_is_taught() -> None:
    missed, shifted = robot().insert(11.0), robot(taught_mm=3.0).insert(8.0)
    assert not missed.inserted and missed.failure == 2
    # Of the same errors.
    assert shifted == missed


def test_in_the_air_the_tool_follows_its_target_as_a_mass_on_a_damped_spring() -> None:
    cell = Rehearsal("usb", 20, 10, {}, 5)
    attempt = _Attempt(cell._mujoco, copy(cell._model), cell.task, dataclasses.replace(cell.unmodelled, backlash_mm=0.0))
    attempt.grasp()
    attempt.logging = True
    attempt.move(attempt.target + np.array([0.0, -0.03, 0.03, 0.0]), 0.1)
    attempt.rest(0.1)
    log = np.array(attempt.rows) * 1e-3
    mass = cell._model.body_subtreemass[attempt.flange] + cell._model.body_mass[attempt.plug]
    for axis, stiffness in ((2, 10e3), (3, 20e3)):
        damping, target = 2.0 * np.sqrt(stiffness * 2.0), log[:, axis + 7]
        place, speed, followed = target[0], 0.0, []
        for before, now in zip([target[0], *target], target):
            for share in np.arange(1, 21) / 20:
                behind, slower = before + share * (now - before) - place, (now - before) / TICK_S - speed
                speed += TICK_S / 20 * (stiffness * behind + damping * slower) / mass
                place += TICK_S / 20 * speed
            followed.append(place)
        lag = np.abs(target - followed).max()
        assert lag > 1e-3
        # Within half a period of the controller.
        fastest = np.abs(np.diff(target)).max() / TICK_S
        assert log[:, axis] == pytest.approx(followed, abs=0.5 * TICK_S * fastest)


@pytest.mark.parametrize(("aside_mm", "inserted"), [(0.0, True), (2.54, False)])
def test_a_plug_one_pitch_beside_its_mated_pose_is_not_inserted(aside_mm: float, inserted: bool) -> None:
    task = fo.Task.from_toml("usb")
    task.success.mated = {"tip_mm": [-1.4, aside_mm - 1.2, -12.5], "lateral_mm": 0.7}
    found = SimulatedRobot(task, 20, 10, "mujoco", seed=5, taught_mm=3.0).insert(0.0)
    assert found.depth_mm > 12.0 and found.inserted == inserted


@pytest.mark.parametrize(("name", "value", "words"), [
    ("taught_mm", 1e3, "a length in mm"),
    ("noise", -1.0, "a width in mm"),
])
def test_wrong_values_are_refused(name: str, value: float, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        robot(**{name: value})
