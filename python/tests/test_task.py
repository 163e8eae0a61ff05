"""Task files as objects."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import finger_opt as fo


def test_what_is_written_reads_back(tmp_path, fake):
    task = fo.Task.from_toml("usb")
    again = fo.Task.from_toml(task.to_toml())
    assert again.to_toml() == task.to_toml()
    file = tmp_path / "mine.toml"
    file.write_text(task.to_toml())
    for path in (file, str(file)):
        assert fo.Task.from_toml(path).to_toml() == task.to_toml()
    same = {key: fo.evaluate(one, 20, 10, **fake) for key, one in [("a", task), ("b", "usb")]}
    assert replace(same["a"], wall_s=0) == replace(same["b"], wall_s=0)


def test_fields_can_be_set_by_name_and_keep_their_units():
    task = fo.Task.from_toml("usb")
    task.strategy.tilt_deg = 8
    task.strategy.phase["side"].move_mm = [0, -9, 0]
    again = fo.Task.from_toml(task.to_toml())
    assert (again.strategy.tilt_deg, again.strategy.phase["side"].move_mm) == (8, [0, -9, 0])
    assert "tilt_deg" in dir(task.strategy)


def test_what_cannot_be_is_refused_and_changes_nothing():
    task = fo.Task.from_toml("usb")
    before = task.to_toml()
    with pytest.raises(fo.InputError, match="mass_g"):
        task.plug.mass_g = -1
    with pytest.raises(fo.InputError, match="strategy.tilt_deg: invalid type: string \"8\"") as raised:
        task.strategy.tilt_deg = "8"
    assert (raised.value.key, raised.value.line) == ("strategy.tilt_deg", None)
    with pytest.raises(fo.InputError, match="tilt_deg: is None"):
        task.strategy.tilt_deg = None
    with pytest.raises(AttributeError, match="^unknown field `tilt_degg`.*did you mean `tilt_deg`"):
        task.strategy.tilt_degg = 3
    with pytest.raises(AttributeError, match="unknown field `stratgy`"):
        task.stratgy
    with pytest.raises(KeyError, match="side"):
        task.strategy.phase["sdie"]
    assert task.to_toml() == before
    with pytest.raises(fo.InputError, match="did you mean"):
        fo.Task.from_toml("usbb")


@pytest.mark.parametrize("copied", [lambda task: pickle.loads(pickle.dumps(task)), copy.copy, copy.deepcopy])
def test_a_copy_is_a_task_of_its_own(copied):
    task = fo.Task.from_toml("usb")
    task.strategy.tilt_deg = 8
    again = copied(task)
    assert (again.to_toml(), again.file) == (task.to_toml(), task.file)
    again.strategy.tilt_deg = 7
    with pytest.raises(fo.InputError, match="mass_g"):
        again.plug.mass_g = -1
    assert task.strategy.tilt_deg == 8
    table = copied(task.strategy)
    table.tilt_deg = 6
    assert (table.tilt_deg, task.strategy.tilt_deg) == (6, 8)


def test_numbers_of_numpy_are_numbers():
    task = fo.Task.from_toml("usb")
    task.strategy.tilt_deg = np.int64(8)
    task.strategy.phase["side"].move_mm = np.array([0, -9, 0])
    again = fo.Task.from_toml(task.to_toml())
    assert (again.strategy.tilt_deg, again.strategy.phase["side"].move_mm) == (8, [0, -9, 0])
    before = task.to_toml()
    with pytest.raises(TypeError, match="object cannot be written as JSON"):
        task.strategy.tilt_deg = object()
    assert task.to_toml() == before
