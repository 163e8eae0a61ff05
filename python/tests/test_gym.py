"""The environment keeps Gymnasium's rules, and what a trial inserts can be inserted in it."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import finger_opt as fo

pytest.importorskip("gymnasium", reason="the extra gym is not installed")

#: Control steps per second of one core on usb in contact; an optimised build has 5000.
FLOOR = 500


@pytest.fixture(scope="module")
def env():
    return fo.gym.InsertionEnv("usb", 20, 10)


def strategy(task, env):
    """The moves of the task's own search at constant speed, then the push."""
    touched = False
    for phase in (phase for phase in task.strategy.phase if phase.stage != "approach"):
        move = np.array(phase.move_mm, dtype=float)
        way, speed = np.linalg.norm(move), float(phase.speed_mm_per_s)
        steps = int(way / speed * 1000)
        for _ in range(steps):
            if phase.motion == "touch" and touched:
                break
            observation = yield move / way * speed
            touched = touched or bool(np.abs(observation[6:]).max() > 0.05)
        for _ in range(40):
            yield np.zeros(3)


def episode(env, offset_mm):
    task = fo.Task.from_toml("usb")
    env.reset(options={"offset_mm": offset_mm})
    moves, total, observation = strategy(task, env), 0.0, None
    info = {}
    try:
        while True:
            action = moves.send(observation)
            observation, reward, terminated, truncated, info = env.step(action)
            total += reward
            if terminated or truncated:
                break
    except StopIteration:
        pass
    return total, info


def test_gymnasium_finds_nothing_wrong(env):
    from gymnasium.utils.env_checker import check_env

    check_env(env, skip_render_check=True)


def test_the_strategy_of_the_task_inserts_and_a_start_too_far_off_does_not(env):
    total, info = episode(env, 0.0)
    assert (info["outcome"], info["failure"]) == ("inserted", None)
    assert info["distance_mm"] < 3 and total > 10
    far, info = episode(env, 15.0)
    assert info["outcome"] != "inserted" and far < total


def test_the_same_actions_give_the_same_numbers(env):
    assert episode(env, 0.5) == episode(env, 0.5)


def test_an_episode_ends_and_says_so(env):
    brief = fo.gym.InsertionEnv("usb", 20, 10, time_limit_s=0.003)
    with pytest.raises(fo.InputError, match="reset"):
        brief.step(np.zeros(3))
    observation, info = brief.reset(seed=3)
    assert observation.shape == (9,) and -1 <= info["offset_mm"] <= 1
    assert [brief.step(np.zeros(3))[3] for _ in range(3)] == [False, False, True]
    with pytest.raises(fo.InputError, match="finite"):
        env.reset()
        env.step(np.array([np.nan, 0, 0]))
    with pytest.raises(fo.InputError, match=r"shape \(3,\)"):
        env.step(np.zeros(2))


def test_what_cannot_be_is_refused(fake):
    with pytest.raises(fo.InputError, match="no driven simulation"):
        fo.gym.InsertionEnv("usb", 20, 10, **fake)
    with pytest.raises(fo.InputError, match="offset_mm"):
        fo.gym.InsertionEnv("usb", 20, 10, offset_mm=(1, -1))


def test_contact_is_quick(env):
    env.reset(options={"offset_mm": 0.0})
    while np.linalg.norm(env.step(np.array([0.0, 0.0, -20.0]))[0][6:]) < 30:
        pass
    rates, pressed = [], []
    for way in (20.0, -20.0) * 8:
        begin = time.process_time()
        for _ in range(25):
            pressed.append(np.linalg.norm(env.step(np.array([way, 0.0, 0.0]))[0][6:]))
        rates.append(25 / (time.process_time() - begin))
    assert min(pressed) > 1, "it slides, and touches all the time"
    print(f"{statistics.median(rates):.0f} control steps per second of processor time")
    assert max(rates) > FLOOR


def test_without_gymnasium_the_package_says_what_to_install():
    code = "import sys; sys.modules['gymnasium'] = None; import finger_opt as fo; fo.gym"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert "pip install 'finger-opt[gym]'" in done.stderr


def test_the_example_learns():
    example = Path(__file__).parents[2] / "examples" / "learn_search.py"
    done = subprocess.run([sys.executable, example, "1", "2"], capture_output=True, text=True)
    assert "the learned one" in done.stdout, done.stderr
