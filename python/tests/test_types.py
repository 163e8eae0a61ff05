"""Types: pyright in strict mode on package and examples, mypy, and what an editor sees of the installed package."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

pytestmark = pytest.mark.types

#: The folder of pyproject.toml, which says what is checked and how.
SOURCES = Path(__file__).resolve().parents[1]
#: Whose types the package speaks of.
OTHERS = ("numpy", "pandas-stubs", "matplotlib", "gymnasium", "submitit", "distributed", "pyarrow")


def run(tool: str, *words: str, cwd: Path = SOURCES) -> str:
    """What the tool says; skips where it, or what it has to read, is not there."""
    for name in (tool, *OTHERS):
        try:
            metadata.distribution(name)
        except metadata.PackageNotFoundError:
            pytest.skip(f"{name} is not installed")
    # Pyright finds its interpreter by PATH, and needs Node for itself.
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    command = [sys.executable, "-m", tool]
    if subprocess.run([*command, "--version"], capture_output=True, check=False).returncode != 0:
        pytest.skip(f"{tool} is installed, and does not start")
    done = subprocess.run(
        [*command, *words], cwd=cwd, env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_pyright_finds_no_error_in_package_and_examples():
    assert "0 errors" in run("pyright", "--project", str(SOURCES), "--pythonpath", sys.executable)


def test_mypy_finds_no_error_in_the_package(tmp_path):
    assert "Success" in run("mypy", "--config-file", "pyproject.toml", "--cache-dir", str(tmp_path))


def test_all_types_that_an_editor_sees_are_known(tmp_path):
    # Types that others left out are theirs.
    said = run("pyright", "--verifytypes", "finger_opt", "--ignoreexternal", cwd=tmp_path)
    assert "Type completeness score: 100%" in said


#: What a program means, with the type that comes out of it.
USED = """
import finger_opt as fo

reveal_type(fo.evaluate("usb", density=20, direction=10))
reveal_type(fo.stiffness(20, 10))
reveal_type(fo.Study.create("usb", optimizer="cma-es", objective=["range", "slip"]).run())
reveal_type(fo.gym.InsertionEnv("usb", density=20, direction=10))
"""
#: What is wrong, a line each.
MISUSED = """
import finger_opt as fo

fo.evaluate("usb", walks=True)
fo.evaluate("usb", density=[10, 20])
fo.Study.create("usb", optimizer="cmaes")
fo.Study.create("usb").run(worker=2)
fo.gym.InsertionEnv("usb", engine="bullet")
"""


def test_calls_keep_their_keywords_and_words(tmp_path):
    (tmp_path / "used.py").write_text(USED)
    said = run("pyright", "used.py", cwd=tmp_path)
    for kind in ("Evaluation", "Springs", "Study", "InsertionEnv"):
        assert f'is "{kind}"' in said
    (tmp_path / "misused.py").write_text(MISUSED)
    with pytest.raises(AssertionError) as found:
        run("pyright", "misused.py", cwd=tmp_path)
    calls = [number for number, line in enumerate(MISUSED.splitlines(), 1) if "(" in line]
    assert all(f"misused.py:{number}:" in str(found.value) for number in calls), found.value
