"""A process that was forked has not the threads of the library, and says so."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

FORKED = "forked after finger_opt had started threads; use the spawn or forkserver start method"

CALLS = {
    "evaluation": "fo.evaluate('usb', 20, 10)",
    "trial": "fo.trial('usb', 20, 10)",
    "stiffness": "fo.stiffness()",
    "predicted stiffness": "fo.stiffness(20, 10)",
    "new study": "fo.Study.create('usb', budget=2, out='forked')",
    "study": "study.run(progress=False)",
    "insertion": """_native.Insertion('{"task": "usb", "density": 20, "direction": 10}')""",
}

START = """
import finger_opt as fo, multiprocessing, os, sys
from finger_opt import _native

def perform(job):
    return len(fo.perform(job))

def evaluate(density):
    return fo.evaluate("usb", density, 10).range_mm

if __name__ == "__main__":
    study = fo.Study.create("usb", budget=2, batch=2, out="study", no_cache=True)
    expected = evaluate(20)
"""


def run(folder, body: str) -> subprocess.CompletedProcess[str]:
    (folder / "script.py").write_text(START + "".join(f"    {line}\n" for line in body.splitlines()))
    return subprocess.run([sys.executable, "script.py"], cwd=folder, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("what", CALLS)
def test_what_would_wait_for_threads_that_are_not_there_is_refused(what, tmp_path):
    if not hasattr(os, "fork"):
        pytest.skip("this system does not fork")
    done = run(tmp_path, f"""\
if os.fork() == 0:
    try:
        {CALLS[what]}
    except fo.StudyError as error:
        print(error, flush=True)
    os._exit(0)
os.wait()
assert evaluate(20) == expected""")
    assert done.returncode == 0, done.stderr
    assert FORKED in done.stdout


def test_the_unit_of_work_needs_no_such_threads(tmp_path):
    done = run(tmp_path, """\
jobs = [bytes(job) for _, job in study._open(None).next()[0]]
with multiprocessing.get_context("fork").Pool(2) as pool:
    assert all(pool.map(perform, jobs))""")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("method", ["spawn", "forkserver"])
def test_processes_that_are_started_otherwise_simulate(method, tmp_path):
    done = run(tmp_path, f"""\
with multiprocessing.get_context({method!r}).Pool(1) as pool:
    assert pool.map(evaluate, [20]) == [expected]""")
    assert done.returncode == 0, done.stderr


def test_a_process_that_was_forked_before_simulates(tmp_path):
    (tmp_path / "early.py").write_text("""
import finger_opt as fo, os
if os.fork() == 0:
    os._exit(int(fo.evaluate("usb", 20, 10).range_mm))
print(os.waitstatus_to_exitcode(os.wait()[1]) == int(fo.evaluate("usb", 20, 10).range_mm))
""")
    done = subprocess.run([sys.executable, "early.py"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.stdout == "True\n", done.stderr
