"""Values that no parameter takes: each is refused by its name, before anything is written."""

from __future__ import annotations

import inspect
import os
import random

import numpy as np
import pytest
from test_lies import VALUES

import finger_opt as fo
from finger_opt.robot import SimulatedRobot

HUGE = 10**400
PLUG = {"plug": (8, 2.4, 25), "clearance": 0.1}


@pytest.mark.parametrize("word, call", [
    ("density", lambda: fo.stiffness(HUGE, 10)),
    ("density", lambda: fo.sweep("usb", [HUGE], [0], engine="fake")),
    ("density", lambda: fo.sweep("usb", HUGE, [0], engine="fake")),
    ("density", lambda: fo.evaluate("usb", HUGE, 10)),
    ("task.friction.plug_socket", lambda: fo.evaluate("usb", 20, 10, set={"task.friction.plug_socket": HUGE})),
    ("plug", lambda: fo.new_task("m", plug=(HUGE, 2, 3), clearance=0.1)),
    ("plug", lambda: fo.new_task("m", plug=np.array(20.0), clearance=0.1)),
    ("clearance", lambda: fo.new_task("m", plug=(8, 2.4, 25), clearance=HUGE)),
    ("name", lambda: fo.new_task("\udcff", **PLUG)),
    ("name", lambda: fo.new_task("a\0b", **PLUG)),
    ("plug", lambda: fo.import_parts("a\0b", out="o.toml")),
    ("task", lambda: fo.evaluate("a\0b", 20, 10)),
    ("out", lambda: fo.export_finger(density=20, direction=10, format="stl", out="a\0b.stl")),
    ("seed", lambda: fo.Study.create("usb", seed=HUGE)),
])
def test_what_no_parameter_takes_is_refused_by_name(word, call, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises((fo.InputError, TypeError), match=word):
        call()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("call", [
    lambda out: fo.export_finger(density=20, direction=10, format="stl", out=out),
    lambda out: fo.export_mjcf("usb", 20, 10, out=out),
    lambda out: fo.new_task("mine", **PLUG, out=out),
    lambda out: fo.tune_task("usb", out=out, engine="fake"),
])
def test_a_name_that_is_no_utf_8_is_refused_before_it_is_written(call, tmp_path):
    with pytest.raises(fo.InputError, match="UTF-8"):
        call(tmp_path / os.fsdecode(b"\xff.stl"))
    assert not list(tmp_path.iterdir())


CALLS = (
    fo.evaluate, fo.trial, fo.stiffness, fo.finger, fo.check_task, fo.export_finger, fo.export_mjcf, fo.Optimizer, fo.sweep,
    fo.compare, fo.load_study, fo.Study.create, SimulatedRobot,
)
#: What parameters may be; the closed formula takes no time.
RIGHT = {"engine": "fake", "task": "usb", "density": 20, "direction": 10, "format": "stl", "out": "o.stl", "space": "infill"}
MORE = ("usb", "nope.toml", "--help", "x" * 500, {1: 2}, {"task.friction.plug_socket": "x"}, [None], (1, 2, 3), 1 << 70, "[]")


def test_keywords_of_any_type_end_in_a_result_or_in_an_error_with_their_name(tmp_path, monkeypatch, fake):
    monkeypatch.chdir(tmp_path)
    chance = random.Random(5)
    refused = 0
    for _ in range(int(os.environ.get("FINGER_OPT_CALLS", "120"))):
        call = chance.choice(CALLS)
        words = {}
        for name, parameter in inspect.signature(call).parameters.items():
            needed = parameter.default is parameter.empty
            if name in RIGHT and (name == "engine" or chance.random() < 0.7):
                words[name] = RIGHT[name]
            elif needed or chance.random() < 0.15:
                words[name] = chance.choice((*VALUES, *MORE))
        try:
            call(**words)
        except TypeError as error:
            refused += 1
            assert any(name in str(error) for name in inspect.signature(call).parameters), (call, words, error)
        except (fo.InputError, fo.StudyError, ImportError):
            refused += 1
    assert refused > 20
