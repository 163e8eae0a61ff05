"""The examples in docstrings."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import finger_opt as fo

pytest.importorskip("pandas", reason="without the extra pandas")


def modules() -> list[str]:
    return ["finger_opt", *(f"finger_opt.{module.name}" for module in pkgutil.iter_modules(fo.__path__))]


@pytest.mark.parametrize("name", modules())
def test_examples_in_docstrings_give_what_they_say(name, tmp_path, monkeypatch):
    if name == "finger_opt.gym":
        pytest.importorskip("gymnasium", reason="without the extra gym")
    # Studies and caches are written where one stands.
    monkeypatch.chdir(tmp_path)
    assert doctest.testmod(importlib.import_module(name)).failed == 0
