"""What the tests share: the command line of the same wheel, and the quick engine."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import finger_opt as fo


def has_fake() -> bool:
    try:
        fo.evaluate("usb", 20, 10, engine="fake")
    except fo.InputError:
        return False
    return True


@pytest.fixture
def fake() -> dict[str, str]:
    """Settings of the closed formula that takes no time."""
    if not has_fake():
        pytest.skip("built without the feature fake-engine")
    return {"engine": "fake"}


@pytest.fixture
def command():
    """Runs the wheel's `optimize`; gives exit code, output and errors."""
    program = shutil.which("optimize", path=str(Path(sys.executable).parent))
    assert program, "the wheel installs the command `optimize`"

    def run(*words: str, **more):
        done = subprocess.run([program, *words], capture_output=True, text=True, **more)
        return done.returncode, done.stdout, done.stderr

    return run


def there(value):
    """JSON without what there is not."""
    if isinstance(value, dict):
        return {key: there(one) for key, one in value.items() if one is not None}
    return [there(one) for one in value] if isinstance(value, list) else value


@pytest.fixture
def command_json(command):
    def run(*words: str):
        code, out, errors = command(*words, "--json")
        assert code == 0, errors
        return there(json.loads(out))

    return run
