#!/usr/bin/env python3
"""Learns a faster and safer search for `usb` in `fo.gym.InsertionEnv`, with numpy alone.

    pip install './python[gym]'
    python examples/learn_search.py               # about a minute
    python examples/learn_search.py 2 4           # generations, candidates per generation

The search has the phases of the task's own search and four parameters: preload, stroke back, stroke
to the side, and speed. The cross-entropy method draws candidates from a normal distribution, evaluates each from
several shifted starts, and fits the distribution to the best quarter.
"""

from __future__ import annotations

import sys
from collections.abc import Generator

import numpy as np
from numpy.typing import NDArray

import finger_opt as fo

Floats = NDArray[np.float64]
Observation = NDArray[np.float32]

#: Preload, back, side (mm) and speed (mm/s): values of the task, initial standard deviations, lower bounds.
FIRST = np.array([0.3, 5.0, 10.0, 80.0])
SPREAD = np.array([0.1, 1.0, 2.0, 10.0])
LOWEST = np.array([0.0, 0.5, 1.0, 20.0])
SHIFTS_MM = (-2.0, 0.0, 2.0)


def moves(numbers: Floats) -> Generator[Floats, Observation, None]:
    """Yields velocities, mm/s, each for 1 ms; receives observations."""
    preload, back, side, speed = numbers
    observation = yield np.array([0.0, 0.0, -20.0])
    while np.linalg.norm(observation[6:]) < 0.05:
        observation = yield np.array([0.0, 0.0, -20.0])
    for move in np.array([[0, 0, -preload], [back, 0, 0], [-back, 0, 0], [0, -side, 0], [0, 0, -20]]):
        length = max(float(np.linalg.norm(move)), 1e-9)
        for _ in range(round(1000 * length / speed)):
            yield move / length * speed
        for _ in range(30):
            yield np.zeros(3)


def episode(env: fo.gym.InsertionEnv, numbers: Floats, shift_mm: float) -> tuple[float, str | None]:
    """Returns the sum of the rewards and the outcome of one insertion, ``None`` if it has none."""
    env.reset(options={"offset_mm": shift_mm})
    plan, total = moves(numbers), 0.0
    action = next(plan)
    while True:
        observation, reward, terminated, truncated, info = env.step(action)
        total += reward
        if terminated or truncated:
            return total, info["outcome"]
        try:
            action = plan.send(observation)
        except StopIteration:
            # The moves ended without an outcome.
            return total - 10.0, info["outcome"]


def score(env: fo.gym.InsertionEnv, numbers: Floats) -> tuple[float, int]:
    """Returns the mean reward over the shifts, and the number of shifts that insert."""
    found = [episode(env, numbers, shift) for shift in SHIFTS_MM]
    return float(np.mean([total for total, _ in found])), sum(end == "inserted" for _, end in found)


def learn(env: fo.gym.InsertionEnv, generations: int, candidates: int, seed: int = 0) -> Floats:
    """Returns the best parameters found; prints the progress."""
    draw = np.random.default_rng(seed)
    mean, spread = FIRST, SPREAD
    best = (score(env, FIRST)[0], FIRST)
    for generation in range(generations):
        tried: Floats = np.maximum(draw.normal(mean, spread, (candidates, 4)), LOWEST)
        scores = [score(env, numbers)[0] for numbers in tried]
        elite = tried[np.argsort(scores)[::-1][: max(2, candidates // 4)]]
        mean, spread = elite.mean(axis=0), elite.std(axis=0) + 0.05 * SPREAD
        best = max([best, *zip(scores, tried)], key=lambda pair: pair[0])
        print(f"generation {generation}: best reward {best[0]:.3f}")
    return best[1]


def main(generations: int = 8, candidates: int = 16) -> None:
    env = fo.gym.InsertionEnv("usb", density=20, direction=10)
    learned = learn(env, generations, candidates)
    for name, numbers in (("the task's search", FIRST), ("the learned one", learned)):
        reward, inserted = score(env, numbers)
        print(f"{name}: reward {reward:.3f}, {inserted} of {len(SHIFTS_MM)} shifts insert;"
              f" preload, back, side, speed {np.round(numbers, 2).tolist()}")


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
