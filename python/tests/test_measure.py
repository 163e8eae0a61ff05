"""Evaluations, trials and stiffness give what the command line gives."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import finger_opt as fo


def without_time(found):
    fields = found if isinstance(found, dict) else found.to_dict()
    return {key: value for key, value in fields.items() if key != "wall_s"}


def test_an_evaluation_has_the_bits_of_the_command_line(command_json):
    words = ("evaluate", "--task", "usb", "--density", "20", "--direction", "10")
    # Without a model named the command measures the computed finger, too.
    there = command_json(*words, "--finger-model", "paper", "--set", "task.grip.force_n=25")
    here = fo.evaluate("usb", density=20, direction=10, finger_model="paper", set={"task.grip.force_n": 25})
    # JSON numbers read back as the same bits.
    assert without_time(here) == without_time(there)
    assert here.range_mm == there["range_mm"] > 0
    assert f"{here.range_mm:.1f} mm" in here._repr_html_() and "<svg" in here._repr_html_()


def test_an_evaluation_has_the_measured_ranges_of_its_finger(fake):
    found = fo.evaluate("usb", 10, 0, measurements="published", **fake).measured
    assert found is not None and [line.range_mm for line in found] == [4.7]
    assert fo.evaluate("usb", 12, 0, measurements="published", **fake).measured is None


def test_levers_have_the_bits_of_the_command_line(command_json, fake):
    there = command_json("levers", "--task", "usb", "--density", "20", "--direction", "10", "--engine", "fake")
    here = fo.levers("usb", density=20, direction=10, **fake)
    assert here.to_dict() == there
    assert here.svg.startswith("<svg") and here.base.range_mm == fo.evaluate("usb", 20, 10, start="taught", **fake).range_mm
    assert here.windows <= 20 and {lever.name for lever in here.levers} >= {"tilt", "grip force"}


def test_a_trial_and_its_course(command_json):
    there = command_json("trial", "--task", "usb", "--density", "20", "--direction", "10",
                         "--offset-mm", "-1")
    here = fo.trial("usb", 20, 10, offset_mm=-1)
    assert here.to_dict() == there
    series = vars(here.series)
    n = len(series["time_s"])
    assert series["tip_mm"].shape == series["force_n"].shape == series["tcp_mm"].shape == (n, 3)
    assert np.allclose(np.diff(series["time_s"]), 0.001)
    assert series["time_s"][-1] == pytest.approx(here.simulated_s, abs=0.002)
    # The tip goes in: the last sample is as deep as the trial says.
    assert -series["tip_mm"][-1, 2] == pytest.approx(here.depth_mm, abs=0.01)
    assert series["tip_mm"][0, 2] > 0
    # Unfiltered steps peak above the filtered force; nothing touches in the air.
    assert np.linalg.norm(series["force_n"], axis=1).max() > 0.9 * here.peak_force_n
    assert not series["force_n"][0].any()
    assert series["phase"][-1] < len(here.phases)
    assert (np.diff(series["phase"]) >= 0).all()
    coarse = fo.trial("usb", 20, 10, offset_mm=-1, every_s=0.01).series
    assert len(coarse.time_s) == pytest.approx(n / 10, abs=2)


def test_the_next_print_is_that_of_the_command_line(command_json, tmp_path, fake):
    bench = tmp_path / "bench.csv"
    bench.write_text("task,infill_density_percent,infill_direction_deg,range_mm\nusb,20,10,5.6\nusb,30,20,6.1\n")
    few = {"task": "usb", "simulations": 24, "samples": 20}
    there = command_json("next", "--measurements", str(bench), "--engine", "fake",
                         *(word for key, value in few.items() for word in (f"--{key}", str(value))))
    here = fo.next_print(bench, **few, **fake)
    assert here.to_dict() == there
    assert here.use_now is not None and here.use_now.range_mm == 6.1 and not here.reliable


def test_a_capture_map_is_that_of_the_command_line(command_json, fake):
    words = ("map", "--task", "usb", "--density", "20", "--direction", "10", "--engine", "fake")
    there = command_json(*words, "--axes", "y,yaw")
    here = fo.capture_map("usb", 20, 10, axes="y,yaw", **fake)
    assert here.to_dict() == there
    assert here.outcomes.shape == here.simulated.shape
    assert here.simulated.sum() == here.trials <= 300
    first, second = here.axes
    assert here.area == (here.outcomes == 0).sum() * first.step * second.step
    assert here.svg.startswith("<svg") and here._repr_html_() == here.svg
    with pytest.raises(fo.InputError, match="y,tilt"):
        fo.capture_map("usb", 20, 10, axes="y,z", **fake)


def test_a_changed_task_counts(fake):
    task = fo.Task.from_toml("usb")
    task["finger"] = {"rcc_mm": 11.0}
    assert fo.evaluate(task, 20, 10, **fake).positive_mm == pytest.approx(
        fo.evaluate("usb", 20, 10, **fake).positive_mm + 1.0
    )


def test_stiffness():
    predicted = fo.stiffness(20, 10)
    assert predicted == fo.evaluate("usb", 20, 10).stiffness
    fit = fo.stiffness()
    assert fit.designs == 11 and {"assembly", "compliance"} == set(fit.used)
    with pytest.raises(fo.InputError, match="density and direction"):
        fo.stiffness(20)


def test_an_infill_without_its_direction_is_refused():
    with pytest.raises(fo.InputError, match="direction"):
        fo.evaluate("usb", density=20)


@pytest.mark.parametrize(
    "words, settings",
    [
        (["--density", "5", "--direction", "10"], {"density": 5, "direction": 10}),
        (["--density", "20", "--direction", "10", "--set", "task.gripp=1"],
         {"density": 20, "direction": 10, "set": {"task.gripp": 1}}),
    ],
)
def test_errors_have_the_texts_of_the_command_line(command, words, settings):
    code, _, errors = command("evaluate", "--task", "usb", *words)
    assert code == 2
    with pytest.raises(fo.InputError) as raised:
        fo.evaluate("usb", **settings)
    said = str(raised.value).splitlines()
    # An option is called by its parameter.
    assert said[0] == errors.removeprefix("error: ").splitlines()[0].replace("--density", "density")
    assert isinstance(raised.value, ValueError)


def test_an_unknown_task_and_an_unknown_word():
    with pytest.raises(fo.InputError, match="did you mean `rj45`"):
        fo.evaluate("rj54", 20, 10)
    with pytest.raises(TypeError, match="unexpected keyword argument 'densty'; did you mean `density`?"):
        fo.evaluate("usb", densty=20)


def test_the_command_prints_and_fails_as_it_should(command):
    assert "usb" in command("tasks")[1]
    assert command("evaluate", "--task", "nothing", "--density", "20", "--direction", "10")[0] == 2


def test_ctrl_c_ends_a_long_call():
    # Success rates take many trials: minutes, if nothing ended it.
    code = (
        "import finger_opt as fo, signal, threading, os\n"
        # A process begun in a shell's background inherits that Ctrl-C is ignored.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "threading.Timer(2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
        "fo.evaluate('usb', 20, 10, uncertainty='typical')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100)
    assert "finger_opt.errors.Interrupted" in done.stderr


def test_other_threads_go_on_during_a_long_call():
    code = (
        "import finger_opt as fo, json, threading, time\n"
        "beats = []\n"
        "def beat():\n"
        "    while True: beats.append(1); time.sleep(0.01)\n"
        "threading.Thread(target=beat, daemon=True).start()\n"
        "fo.evaluate('usb', 20, 10)\n"
        "print(json.dumps(len(beats)))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) > 10


def test_paths_are_names_too(tmp_path, fake):
    # By commas several tasks are named; a path may have one in it.
    task, table = tmp_path / "a,b.toml", tmp_path / "mine.csv"
    task.write_text(fo.Task.from_toml("usb").to_toml())
    table.write_text((Path(__file__).parents[2] / "data" / "measured_stiffness.csv").read_text())
    measured = without_time(fo.evaluate("usb", 20, 10, **fake))
    assert without_time(fo.evaluate(task, 20, 10, stiffness_data=table, **fake)) == measured
    assert fo.trial(task, 20, 10, **fake).to_dict() == fo.trial("usb", 20, 10, **fake).to_dict()
    assert fo.stiffness(20, 10, stiffness_data=table) == fo.stiffness(20, 10)
    assert fo.stiffness(stiffness_data=table).models == fo.stiffness().models
    study = fo.Study.create([task, "rj45"], budget=1, out=tmp_path / "study", no_cache=True, **fake)
    assert study.run(progress=False).config["tasks"] == ["usb", "rj45"]


@pytest.mark.parametrize("number", [np.int64, np.int32, np.uint8])
def test_numbers_of_numpy_are_numbers(number, tmp_path, fake):
    twenty, ten, two = number(20), number(10), number(2)
    assert without_time(fo.evaluate("usb", twenty, ten, **fake)) == without_time(fo.evaluate("usb", 20, 10, **fake))
    assert fo.stiffness(twenty, ten) == fo.stiffness(20, 10)
    settings = {"seed": two, "batch": two, "threads": two, "no_cache": True, **fake}
    study = fo.Study.create("usb", budget=two, out=tmp_path / "study", **settings).run(progress=False)
    assert (len(study), study.config["seed"]) == (2, 2)


@pytest.mark.parametrize("infill", [(float("nan"), 10), (-1, 10), (1e300, 10), (20, -1), (20, 91), (0.05, 0)])
def test_a_finger_that_cannot_be_has_no_stiffness(infill):
    with pytest.raises(fo.InputError, match="(density|direction).*must lie in"):
        fo.stiffness(*infill)
