"""Ctrl-C ends what simulates soon, and only that."""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import finger_opt as fo
from test_study import journal

#: How long after Ctrl-C a call may still take, s; on a machine that does nothing else 0.2 s.
SOON_S = 5.0
#: The way to the socket, or along it, takes a trial half a minute of simulated time.
APPROACH = "set={'task.strategy.phase.approach.speed_mm_per_s': 0.25}"
SIDE = "set={'task.strategy.phase.side.speed_mm_per_s': 0.25}"

#: When Ctrl-C comes, where that is not 0.4 s: the longest way there may be takes no longer on a fast machine.
DELAYS_S = {"insertion": 0.1}
CALLS = {
    "evaluation": f"fo.evaluate('usb', 20, 10, {SIDE})",
    "taught start": f"fo.evaluate('usb', 20, 10, start='taught', {SIDE})",
    "repeats": "fo.evaluate('usb', 20, 10, repeat=1000)",
    "trial": f"fo.trial('usb', 20, 10, {SIDE})",
    "film": f"fo.trial('usb', 20, 10, record='film.html', {SIDE})",
    "insertion": f"fo.gym.InsertionEnv('usb', 20, 10, {APPROACH})",
    "study": "fo.Study.create('usb', budget=200, out='study', no_cache=True).run(progress=False)",
    "study of threads": "fo.Study.create('usb', budget=200, out='study', no_cache=True)"
                        ".run(ThreadPoolExecutor(2), progress=False)",
    "unit of work": "fo.perform(work)",
}


def run(code: str, folder: Path, **more) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=folder, **more)


@pytest.mark.parametrize("what", CALLS)
def test_one_ctrl_c_ends_a_call_soon(what, tmp_path):
    if what == "insertion":
        pytest.importorskip("gymnasium", reason="the extra gym is not installed")
    code = f"""
import finger_opt as fo, os, signal, threading, time
from concurrent.futures import ThreadPoolExecutor

def stop():
    global sent
    sent = time.monotonic()
    os.kill(os.getpid(), signal.SIGINT)

# A process begun in a shell's background inherits that Ctrl-C is ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
{"fo.gym" if what == "insertion" else ""}
long = fo.Study.create("usb", budget=1, objective="robust-range", out="long", no_cache=True)
work = long._open(None).next()[0][0][1]
threading.Timer({DELAYS_S.get(what, 0.4)}, stop).start()
try:
    {CALLS[what]}
except KeyboardInterrupt:
    print(time.monotonic() - sent)
"""
    done = run(code, tmp_path, timeout=100)
    assert done.stdout, f"it was not interrupted: {done.stderr}"
    assert float(done.stdout) < SOON_S
    assert not (tmp_path / "film.csv").exists()
    if (tmp_path / "study").exists():
        assert len(fo.load_study(tmp_path / "study")) < 200


def test_an_interrupted_run_stops_no_later_one(tmp_path, fake):
    code = f"""
import finger_opt as fo, os, signal, threading, time
from concurrent.futures import ThreadPoolExecutor

def stop():
    while not os.path.exists("study/journal.jsonl") or open("study/journal.jsonl").read().count(chr(10)) < 5:
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)

signal.signal(signal.SIGINT, signal.default_int_handler)
study = fo.Study.create("rj45", budget=22, seed=4, batch=4, engine="fake", no_cache=True, out="study")
threading.Thread(target=stop, daemon=True).start()
with ThreadPoolExecutor(2) as threads:
    try:
        study.run(threads, progress=False)
    except KeyboardInterrupt:
        print(len(study))
    study.run(threads, progress=False)
print(len(study))
"""
    slow = {**os.environ, "FINGER_OPT_FAKE_DELAY_US": "5000"}
    done = run(code, tmp_path, env=slow, timeout=100)
    assert done.returncode == 0, done.stderr
    before, after = map(int, done.stdout.split())
    assert before < after == 22
    whole = fo.Study.create("rj45", budget=22, seed=4, batch=4, no_cache=True, out=tmp_path / "whole", **fake)
    assert journal(whole.run(progress=False).path) == journal(tmp_path / "study")


def test_the_end_of_a_run_ends_what_it_still_performs_and_nothing_else(tmp_path, fake):
    from finger_opt._run import Performer

    study = fo.Study.create("rj45", budget=4, batch=4, no_cache=True, out=tmp_path / "study", **fake)
    work = study._open(None).next()[0][0][1]
    ended, other = Performer(), Performer()
    ended.stop.set()
    with ThreadPoolExecutor(1) as threads:
        with pytest.raises(fo.StudyError, match="interrupted"):
            threads.submit(ended, work).result()
        assert threads.submit(other, work).result()
