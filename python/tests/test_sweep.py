"""Many fingers at once."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import numpy as np
import pytest
from test_stop import SOON_S

import finger_opt as fo

pandas = pytest.importorskip("pandas", reason="without the extra pandas")


def test_a_row_is_what_evaluate_finds(fake):
    table = fo.sweep("usb", [10, 20], np.array([0, 10]), no_cache=True, **fake)
    assert table.infill_density_percent.tolist() == [10, 10, 20, 20]
    assert table.infill_direction_deg.tolist() == [0, 10, 0, 10]
    for row in table.itertuples():
        one = fo.evaluate("usb", row.infill_density_percent, row.infill_direction_deg, **fake)
        assert (row.task, row.range_mm, row.negative_mm, row.positive_mm) == ("usb", one.range_mm, one.negative_mm, one.positive_mm)
        assert (row.failure_negative, row.failure_positive) == (one.failure_negative, one.failure_positive)


def test_rows_tasks_and_further_numbers(fake):
    table = fo.sweep(["usb", "rj45"], [10, 20], 30, set={"task.friction.plug_socket": [0.2, 0.3]}, grid=False,
                     no_cache=True, **fake)
    assert table.task.tolist() == ["usb", "usb", "rj45", "rj45"]
    assert table["task.friction.plug_socket"].tolist() == [0.2, 0.3, 0.2, 0.3]
    one = fo.evaluate("rj45", 20, 30, set={"task.friction.plug_socket": 0.3}, **fake)
    assert table.range_mm.iloc[3] == one.range_mm
    with pytest.raises(fo.InputError, match="density: has 2 values where others have 3; give one or all"):
        fo.sweep("usb", [10, 20], [1, 2, 3], grid=False, **fake)
    with pytest.raises(fo.InputError, match="density: has to be a number or a list of numbers"):
        fo.sweep("usb", [float("nan")], 3, **fake)
    for wrong in ([], ["a"], [[1.0], [2.0]], "20"):
        with pytest.raises((fo.InputError, TypeError), match="density: has to be"):
            fo.sweep("usb", wrong, 3, **fake)


def test_threads_cache_and_executors_change_nothing(fake, tmp_path):
    fingers = {"density": np.linspace(10, 30, 15), "direction": np.linspace(0, 40, 11)}
    expected = fo.sweep("usb", **fingers, no_cache=True, **fake)
    pandas.testing.assert_frame_equal(fo.sweep("usb", **fingers, threads=1, no_cache=True, **fake), expected)
    for _ in range(2):
        cached = fo.sweep("usb", **fingers, cache=tmp_path / "cache", **fake)
        pandas.testing.assert_frame_equal(cached, expected)
    with ThreadPoolExecutor(3) as threads:
        pandas.testing.assert_frame_equal(fo.sweep("usb", **fingers, executor=threads, **fake), expected)


def test_a_hundred_thousand_rows_stream_within_a_gigabyte(fake, tmp_path):
    pytest.importorskip("pyarrow", reason="without the extra parquet")
    code = f"""
import resource
import numpy as np, finger_opt as fo
resource.setrlimit(resource.RLIMIT_DATA, (1 << 30, 1 << 30))
fo.sweep("usb", np.linspace(10, 30, 400), np.linspace(0, 40, 250), out={str(tmp_path / "table.parquet")!r},
         no_cache=True, engine="fake")
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) < 1024, "MiB"
    import pyarrow.parquet

    assert pyarrow.parquet.read_metadata(tmp_path / "table.parquet").num_rows == 100_000


def test_processes_change_nothing_either(fake):
    fingers = {"density": [10, 20, 30], "direction": [0, 10]}
    expected = fo.sweep(["usb", "rj45"], **fingers, no_cache=True, **fake)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        pandas.testing.assert_frame_equal(fo.sweep(["usb", "rj45"], **fingers, executor=processes, **fake), expected)


STOPPED = """
import finger_opt as fo, multiprocessing, signal, sys, time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
if __name__ == "__main__":
    # A process begun in a shell's background inherits that Ctrl-C is ignored.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    executor = (ThreadPoolExecutor(2) if sys.argv[1] == "threads"
                else ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")))
    # The workers have begun when these are done.
    fo.sweep("usb", [10, 20], [0, 10], executor=executor, engine="fake")
    print("begun", flush=True)
    try:
        fo.sweep("usb", list(range(10, 31)), list(range(0, 41)), executor=executor)
    except fo.Interrupted:
        print("interrupted", flush=True)
"""


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_ctrl_c_ends_a_sweep_its_executor_and_its_process(executor, fake, tmp_path):
    (tmp_path / "stopped.py").write_text(STOPPED)
    process = subprocess.Popen([sys.executable, "stopped.py", executor], cwd=tmp_path, stdout=subprocess.PIPE,
                               stderr=subprocess.DEVNULL, text=True, start_new_session=True)
    assert process.stdout.readline() == "begun\n"
    time.sleep(1.0)
    # As a terminal does: to the workers, too.
    os.killpg(process.pid, signal.SIGINT)
    try:
        said, _ = process.communicate(timeout=SOON_S)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
    assert said == "interrupted\n"
