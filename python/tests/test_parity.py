"""Python has what the command line has, under the same words."""

from __future__ import annotations

import dataclasses
import functools
import importlib
import inspect
import json
import pickle
import pydoc
import subprocess
import sys
from pathlib import Path
from typing import Literal, get_args, get_origin, get_type_hints

import pytest

import finger_opt as fo
from finger_opt import _native, _words

#: What a command is called in Python.
COUNTERPARTS = {
    "study": fo.Study.create,
    "resume": fo.load_study,
    "report": fo.Study.report,
    "evaluate": fo.evaluate,
    "trial": fo.trial,
    "map": fo.capture_map,
    "stiffness": fo.stiffness,
    "finger": fo.finger,
    "compare": fo.compare,
    "sensitivity": fo.sensitivity,
    "levers": fo.levers,
    "calibrate": fo.calibrate,
    "identify": fo.identify,
    "next": fo.next_print,
    "measure add": fo.Measurements.add,
    "measure check": fo.Measurements.check,
    "measure sheet": fo.measuring_sheet,
    "export mjcf": fo.export_mjcf,
    "export finger": fo.export_finger,
    "ask-tell": fo.Optimizer,
    "robots": fo.robots,
    "tasks": fo.tasks,
    "task new": fo.new_task,
    "task show": fo.Task.from_toml,
    "task check": fo.check_task,
    "task import": fo.import_parts,
    "task tune": fo.tune_task,
}
#: What has none, and why.
SHELL_ONLY = {
    "completions": "a script for a shell",
    "man": "a page for a terminal; Python has help()",
}
#: How it is printed: Python gives the result.
PRINTED = {"json", "quiet", "verbose"}
#: Words that stand elsewhere, or go by another name, and why.
ELSEWHERE = {
    ("study", "executor"): "Study.run takes it",
    ("resume", "executor"): "Study.run takes it",
    ("resume", "dir"): "folder",
    ("report", "dir"): "the study itself",
    ("compare", "dirs"): "studies",
    ("export finger", "dir"): "study",
    ("measure add", "file"): "Measurements(file)",
    ("measure check", "file"): "Measurements(file)",
    ("measure check", "task"): "Measurements(tasks=)",
    ("measure sheet", "finger"): "fingers: several",
    ("task show", "name"): "source",
    ("task show", "html"): "trial(film=True)",
    ("task check", "file"): "task",
    ("task tune", "file"): "task",
}
@functools.cache
def described():
    shown = [sys.executable, "-m", "finger_opt", "man", "--format", "json"]
    return json.loads(subprocess.run(shown, stdout=subprocess.PIPE, text=True, check=True).stdout)


def commands():
    return {command["name"]: command["options"] for command in described()}


def test_every_command_has_a_counterpart_or_a_reason():
    assert set(COUNTERPARTS) | set(SHELL_ONLY) <= set(commands())
    for name in set(commands()) - set(COUNTERPARTS) - set(SHELL_ONLY):
        assert callable(getattr(fo, name.replace(" ", "_").replace("-", "_"))), name


def test_the_calls_are_those_that_their_script_writes(monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "scripts")
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    modules = importlib.import_module("python_modules").modules
    for name, text in modules(described()).items():
        assert Path(fo.__file__).with_name(name).read_text() == text, f"{name}: scripts/generate.py writes it"


@pytest.mark.parametrize("name", COUNTERPARTS)
def test_a_call_takes_the_words_of_its_command_with_their_defaults(name):
    call = COUNTERPARTS[name]
    signature, hints = inspect.signature(call), get_type_hints(call)
    for option in commands()[name]:
        word = option["name"]
        if word in PRINTED or (name, word) in ELSEWHERE:
            continue
        parameter = signature.parameters.get(word) or signature.parameters.get(f"{word}_")
        assert parameter is not None, f"{name}: Python lacks {word}: {option['help']}"
        words = literals(hints[parameter.name])
        if option["words"]:
            assert words - {"fake"} == set(option["words"]) - {"fake"}, f"{name}: {word}"
        if option["default"] and parameter.default is not inspect.Parameter.empty:
            default = parameter.default
            if default is None:
                # The program's own.
                continue
            text = default if isinstance(default, str) else ",".join(f"{one:g}" for one in listed(default))
            assert text == option["default"], f"{name}: {word}"


def listed(value):
    return value if isinstance(value, tuple) else (value,)


def literals(hint) -> set[str]:
    if get_origin(hint) is Literal:
        return set(get_args(hint))
    return {word for one in get_args(hint) if one is not type(None) for word in literals(one)}


def test_the_names_in_signatures_are_those_that_are_shipped():
    shipped = fo.tasks()
    assert [task.name for task in shipped.tasks] == list(get_args(_words.TaskName))
    assert [space.name for space in shipped.spaces] == list(get_args(_words.SpaceName))
    assert {robot.name for robot in fo.robots().robots} == set(get_args(_words.RobotName))


def test_the_words_of_a_study_are_those_that_the_library_takes():
    for word, hint in (("optimizer", _words.OptimizerName), ("objective", _words.Objective)):
        with pytest.raises(fo.InputError) as raised:
            _native.StudyRequest(json.dumps({"task": "usb", word: "nothing"}))
        assert all(name in str(raised.value) for name in get_args(hint)), raised.value
        for name in get_args(hint):
            _native.StudyRequest(json.dumps({"task": "usb", word: name}))


WRONG = [
    (lambda: fo.evaluate("usb", 20, 10, walks=True), TypeError, r"keyword argument 'walks'; did you mean `walk`\?"),
    (lambda: fo.evaluate("usb", density=[10, 20]), TypeError, "density: has to be a number or None, not list; fo.sweep"),
    (lambda: fo.evaluate("usb", "20", 10), TypeError, "density: has to be a number or None, not str"),
    (lambda: fo.evaluate("usb", True, 10), TypeError, "density: has to be a number or None, not bool"),
    (lambda: fo.evaluate("usb", 20, 10, walk=1), TypeError, "walk: has to be True or False, not int"),
    (lambda: fo.evaluate("usb", 20, 10, repeat=1.5), TypeError, "repeat: has to be a whole number or None, not float"),
    (lambda: fo.evaluate("usb", 20, 10, set=8), TypeError, "set: has to be a mapping or None, not int"),
    (lambda: fo.evaluate(7, 20, 10), TypeError, "task: has to be .*text or a path or Task, not int"),
    (lambda: fo.evaluate("usb", 20, 10, engine="direkt"), fo.InputError,
     "engine: unknown value `direkt`; .*did you mean `direct`"),
    (lambda: fo.evaluate(density=20), TypeError, r"evaluate\(\) missing a required argument: 'task'"),
    (lambda: fo.Study.create("usb", budget="12"), TypeError, "budget: has to be a whole number or None, not str"),
    (lambda: fo.new_task("plug", round=(1, 2, 3)), TypeError, "round: has to be 2 numbers or None, not 3"),
]


@pytest.mark.parametrize(("call", "error", "text"), WRONG)
def test_what_is_wrong_is_named_with_what_would_be_right(call, error, text):
    with pytest.raises(error, match=text):
        call()


#: What does not go together, as on the command line.
TOGETHER = [
    (lambda: fo.new_task("x", plug=(8, 2.4, 25)), "clearance"),
    (lambda: fo.new_task("x", plug=(8, 2.4, 25), round=(8, 25), clearance=0.1), "round"),
    (lambda: fo.new_task("x", like="usb", clearance=0.1), "clearance"),
    (lambda: fo.new_task("x", pins=(2, 5)), "clearance"),
    (lambda: fo.export_finger("study", format="stl", out="x.stl", density=12, direction=30), "density"),
    (lambda: fo.Measurements("x.csv").add("usb", not_measurable=True, range_mm=3.0), "range_mm"),
    (lambda: fo.trial("usb", 20, 10, probe=True), "probe"),
    (lambda: fo.trial("usb", 20, 10, probe=True, log="x.csv", repeat=3), "repeat"),
    (lambda: fo.stiffness(20, 10, svg="x.svg"), "svg"),
    (lambda: fo.sweep("usb", 20, 10, set={"density": [25]}), "set"),
    (lambda: fo.evaluate("usb", density=20), "density"),
]


@pytest.mark.parametrize(("call", "key"), TOGETHER)
def test_what_does_not_go_together_is_refused(call, key):
    with pytest.raises(fo.InputError) as raised:
        call()
    assert raised.value.key == key and "--" not in str(raised.value)


def test_a_file_is_what_its_name_says(fake, tmp_path):
    calls = [
        lambda file: fo.trial("usb", 20, 10, plot=file), lambda file: fo.levers("usb", 20, 10, svg=file, **fake),
        lambda file: fo.capture_map("usb", 20, 10, svg=file, **fake), lambda file: fo.sweep("usb", 20, 10, out=file, **fake),
    ]
    for call in calls:
        with pytest.raises(fo.InputError, match="the file name must end in") as raised:
            call(tmp_path / "x.png")
        assert raised.value.file == str(tmp_path / "x.png")
    assert not list(tmp_path.iterdir())


def test_what_differs_is_not_equal(fake):
    assert fo.evaluate("usb", 20, 10, **fake) == fo.evaluate("usb", 20, 10, **fake)
    assert fo.trial("usb", 20, 10) == fo.trial("usb", 20, 10) != fo.trial("usb", 20, 10, offset_mm=9.0)
    assert fo.capture_map("usb", 20, 10, **fake) != fo.capture_map("usb", 20, 10, axes="y,yaw", **fake)


def test_an_error_says_where(tmp_path):
    task = tmp_path / "mine.toml"
    task.write_text(fo.Task.from_toml("usb").to_toml().replace("mass_g", "mass_gg"))
    with pytest.raises(fo.TaskError) as raised:
        fo.evaluate(task, 20, 10)
    assert raised.value.file == str(task) and "mass_gg" in str(raised.value) and raised.value.line
    table = tmp_path / "bench.csv"
    table.write_text("task,infill_density_percent,infill_direction_deg,range_mm\nusb,20,10,five\n")
    with pytest.raises(fo.InputError) as raised:
        fo.Measurements(table).check()
    assert (raised.value.file, raised.value.line) == (str(table), 2)
    assert issubclass(fo.TaskError, fo.InputError) and issubclass(fo.Interrupted, KeyboardInterrupt)


def test_results_pickle_and_are_frozen(fake):
    found = fo.evaluate("usb", 20, 10, **fake)
    assert pickle.loads(pickle.dumps(found)) == found
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.range_mm = 3.0
    trial = fo.trial("usb", 20, 10, **fake)
    assert pickle.loads(pickle.dumps(trial)).to_dict() == trial.to_dict()
    for kind in (fo.capture_map, fo.levers):
        found = kind("usb", 20, 10, **fake)
        assert pickle.loads(pickle.dumps(found)).to_dict() == found.to_dict()


def test_help_fits_three_screens():
    text = pydoc.plain(pydoc.render_doc(fo))
    assert len(text.splitlines()) <= 3 * 50
    public = {name for name in dir(fo) if not name[0].isupper()}
    assert public <= set(text.replace(".", " ").replace(",", " ").split())


def test_importing_loads_no_more_than_it_needs():
    heavy = {"pandas", "matplotlib", "gymnasium", "pyarrow", "submitit", "distributed"}
    code = f"import sys, finger_opt; print(*({heavy!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_the_package_runs_as_the_program(command):
    for words in (["--version"], ["task", "show", "usb"], ["--task", "usb", "--engine", "drect"]):
        done = subprocess.run([sys.executable, "-m", "finger_opt", *words], capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == command(*words)
