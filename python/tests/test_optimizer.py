"""The optimizers from Python: the lines of ask-tell."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import pytest

import finger_opt as fo

SPACE = {"x": (-5.0, 5.0), "n": (1.0, 9.0, 2.0)}


def value(point):
    return -((point["x"] - 1.0) ** 2) - (point["n"] - 5.0) ** 2


def run(optimizer, rounds=6):
    asked = []
    for _ in range(rounds):
        points = optimizer.ask(4)
        asked += [dict(point) for point in points]
        # In any order.
        optimizer.tell(points[::-1], [value(point) for point in points[::-1]])
    return asked


@pytest.mark.parametrize("name", ["gp", "cma-es", "sobol", "grid", "random"])
def test_every_optimizer_repeats_itself_with_its_seed(name):
    first, second = (fo.Optimizer(SPACE, name, 3) for _ in range(2))
    assert run(first) == run(second)
    assert first.best == second.best


def test_gp_finds_the_maximum_and_minimises_too():
    optimizer = fo.Optimizer(SPACE, "gp", 1)
    run(optimizer, 8)
    assert optimizer.best["value"] > -0.05
    down = fo.Optimizer([{"name": "x", "low": 0, "high": 4, "step": 1}], "grid", direction="minimize")
    points = down.ask(5)
    down.tell(points, [point["x"] for point in points])
    assert (down.best["value"], down.stop) == (0.0, "space_exhausted")
    assert down.ask(1) == []


def test_the_lines_are_those_of_the_command(command):
    header = {"parameters": [{"name": "x", "low": -5, "high": 5}], "optimizer": "gp", "seed": 7,
              "direction": "maximize", "batch": None}
    code, out, _ = command("ask-tell", input=json.dumps(header) + '\n{"ask":3}\n')
    there = json.loads(out)["asked"]
    here = fo.Optimizer({"x": (-5, 5)}, "gp", 7).ask(3)
    assert code == 0
    assert [{"id": point.id, "values": dict(point)} for point in here] == there


@pytest.mark.parametrize("points, values, word", [
    ([{"x": 9}], [1], "tell: parameter `n` is missing; accepted: x, n"), ({"x": 9, "m": 1}, 1, "tell: unknown parameter `m`; accepted: x, n"),
    ({"x": 9, "n": 1}, 1, "tell: `x` is 9; accepted: -5 to 5"), ({"x": 0, "n": 2}, 1, "tell: `n` is 2; accepted: 1 to 9 in steps of 2"),
    ([{"x": None, "n": 1}], [1], "points: `x` is None"), ([-1], [1], "points: -1"),
    ([True], [1], "points: True"), ([1.5], [1], "points: 1.5"), (["0"], [1], "points: '0'"), ([None], [1], "points: None"),
    ("ab", [1, 2], "points: is 'ab'"), (None, [1], "points: is None"), ([0], ["a"], "values: 'a'; accepted: a finite number"),
    ([0], [float("nan")], "values: nan; accepted"), ([0], [10**400], "values: 1000"), ([0], [[1]], r"values: [1]"),
    ([0], 1.0, "values: is 1.0"), ([0, 1], [1], "values: 1 values for 2 points"), (0, "a", "values: 'a'"),
])
def test_what_is_told_is_checked_by_name(points, values, word):
    optimizer = fo.Optimizer(SPACE, "random")
    optimizer.ask(2)
    with pytest.raises(fo.InputError) as raised:
        optimizer.tell(points, values)
    assert str(raised.value).startswith(word)
    # It goes on, with numbers of any type.
    optimizer.tell(np.array([0, 1]), np.array([1, 2], dtype=np.float32))
    assert optimizer.best["value"] == 2.0


@pytest.mark.parametrize("space, word", [
    (["usb"], "space: "), ([1], "space: "), ({"x": (1,)}, "x: "), ({"x": (1, "a")}, "x: "), ({"x": (0, 10**400)}, "x: "),
    ({"x": (0, float("nan"))}, "x: "), ({"x": "12"}, "x: "), ("infil", "did you mean `infill`"), ("a\0b.toml", "space: "),
])
def test_a_space_is_checked_by_name(space, word):
    with pytest.raises(fo.InputError, match=word):
        fo.Optimizer(space)


@pytest.mark.parametrize("name", ["gp", "cma-es", "random"])
def test_known_results_are_dictionaries_and_an_optimizer_can_be_pickled(name):
    known = [{"x": 1.0, "n": 5.0}, {"n": 3, "x": -2}]
    optimizer = fo.Optimizer(SPACE, name, 3, batch=4)
    optimizer.tell(known, [value(point) for point in known])
    assert optimizer.best == {"id": None, "values": {"x": 1.0, "n": 5.0}, "value": 0.0}
    with pytest.raises(fo.InputError, match="told twice"):
        optimizer.tell(known[0], 1.0)
    points = [*optimizer.ask(2), *optimizer.ask(1)]
    optimizer.tell(points[0], value(points[0]))
    # Within a batch: one point is told, two are asked, one is left.
    resumed, points = pickle.loads(pickle.dumps((optimizer, points)))
    assert (resumed.best, resumed.stop) == (optimizer.best, optimizer.stop)
    for one in (optimizer, resumed):
        rest = [*points[1:], *one.ask(1)]
        one.tell(rest, [value(point) for point in rest])
    assert run(optimizer) == run(resumed)
    assert optimizer.best == resumed.best


def test_shipped_spaces_and_errors():
    point = fo.Optimizer("infill", "sobol").ask(1)[0]
    assert set(point) == {"infill_density_percent", "infill_direction_deg"}
    with pytest.raises(fo.InputError, match="optimizer: unknown value `bayes`; available: gp"):
        fo.Optimizer(SPACE, "bayes")
    with pytest.raises(fo.InputError, match="low must not be above high"):
        fo.Optimizer({"x": (1, 0)})
    optimizer = fo.Optimizer(SPACE)
    optimizer.ask(1)
    with pytest.raises(fo.InputError, match="was not asked"):
        optimizer.tell(5, 1.0)
    with pytest.raises(fo.InputError, match="2 values for 1 points"):
        optimizer.tell([0], [1.0, 2.0])
    optimizer.tell(0, None)


@pytest.mark.parametrize("number", [np.int64, np.int32, np.float32])
def test_numbers_of_numpy_are_numbers(number):
    whole = np.int64 if number is np.float32 else number
    plain = fo.Optimizer({"x": (1, 5), "n": (1, 9, 2)}, "sobol", seed=3, batch=2)
    given = {"x": (number(1), number(5)), "n": (number(1), number(9), number(2))}
    numpy = fo.Optimizer(given, "sobol", seed=whole(3), batch=whole(2))
    assert numpy.ask(whole(2)) == plain.ask(2)
    numpy.tell(whole(0), number(7))
    numpy.tell(np.array([1], dtype=whole), np.array([8], dtype=number))
    assert numpy.best["value"] == 8


def test_a_space_is_found_at_a_path():
    file = Path(__file__).parents[2] / "spaces" / "infill.toml"
    assert fo.Optimizer(file, seed=1).ask(2) == fo.Optimizer("infill", seed=1).ask(2)
