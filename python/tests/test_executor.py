"""`optimize --executor`: what ends it, and what does not."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import finger_opt as fo
from finger_opt.executors import Processes
from test_study import journal

#: How long processes may take to end, s.
PATIENCE_S = 5
BUDGET = 30
WORDS = ["--task", "rj45", "--budget", str(BUDGET), "--seed", "4", "--batch", "4", "--engine", "fake",
         "--no-cache", "--no-confirm"]
SLOW = {**os.environ, "FINGER_OPT_FAKE_DELAY_US": "5000"}


@pytest.fixture
def expected(fake, tmp_path):
    """The journal of one machine."""
    study = fo.Study.create("rj45", budget=BUDGET, seed=4, batch=4, no_cache=True, no_confirm=True,
                            out=tmp_path / "expected", **fake)
    return journal(study.run(progress=False).path)


def begun(folder: Path, executor: str, **more) -> subprocess.Popen[str]:
    """The command, once some evaluations are done."""
    program = shutil.which("optimize", path=str(Path(sys.executable).parent))
    words = [program, *WORDS, "--executor", executor, "--out", "study"]
    process = subprocess.Popen(words, cwd=folder, env=SLOW, text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, start_new_session=True, **more)
    file = folder / "study" / "journal.jsonl"
    while not (file.exists() and file.read_text().count("\n") > 5):
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    return process


def below(process: int) -> list[int]:
    """Processes that a process has begun, theirs first."""
    children = Path(f"/proc/{process}/task/{process}/children")
    if not children.exists():
        pytest.skip("this system does not tell whose child a process is")
    return [one for child in map(int, children.read_text().split()) for one in [*below(child), child]]


def all_end(processes: list[int]) -> bool:
    end = time.monotonic() + PATIENCE_S
    while any(running(process) for process in processes) and time.monotonic() < end:
        time.sleep(0.02)
    return not any(running(process) for process in processes)


def running(process: int) -> bool:
    try:
        # Of one that has ended nobody may have taken notice.
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def goes_on(folder: Path) -> str:
    """The journal of the study, which nobody holds any more, at its end."""
    return journal(fo.load_study(folder / "study", no_cache=True, no_confirm=True).run(progress=False).path)


@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP", "SIGKILL"])
def test_a_signal_to_the_program_alone_ends_it_and_all_that_it_began(name, tmp_path, expected):
    process = begun(tmp_path, "processes:2")
    others = below(process.pid)
    assert len(others) >= 3
    process.send_signal(getattr(signal, name))
    assert process.wait(PATIENCE_S) == (-signal.SIGKILL if name == "SIGKILL" else 1)
    assert all_end(others)
    assert "continue with: optimize resume" in process.stderr.read()
    assert 3 < len(fo.load_study(tmp_path / "study")) < BUDGET
    assert goes_on(tmp_path) == expected


def test_ctrl_c_in_a_terminal_is_no_more_than_one(tmp_path, expected):
    process = begun(tmp_path, "processes:2")
    others = below(process.pid)
    # All that the terminal runs get it.
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(PATIENCE_S) == 1 and all_end(others)
    said = process.stderr.read()
    assert said.count("interrupted;") == 1 and "Traceback" not in said, said
    assert goes_on(tmp_path) == expected


def test_the_workers_end_when_their_driver_is_killed(tmp_path, expected):
    process = begun(tmp_path, "processes:2")
    *others, driver = below(process.pid)
    os.kill(driver, signal.SIGKILL)
    assert process.wait(PATIENCE_S) == 1
    assert all_end(others)
    assert "the Python package was terminated" in process.stderr.read()
    assert goes_on(tmp_path) == expected


def test_a_lost_worker_is_replaced(tmp_path, expected):
    process = begun(tmp_path, "processes:2")
    *_, driver = below(process.pid)
    # Neither the first, which only counts what the others share, nor those that replace a worker.
    _, *workers = map(int, Path(f"/proc/{driver}/task/{driver}/children").read_text().split())
    os.kill(workers[-1], signal.SIGKILL)
    assert process.wait(60) == 0, process.stderr.read()
    assert journal(tmp_path / "study") == expected


class Deadly(Processes):
    """Its processes end with whatever they are given."""

    def submit(self, fn, /, *args, **kwargs):
        return super().submit(os._exit, 3)


def test_workers_that_are_always_lost_end_the_study(tmp_path, fake):
    study = fo.Study.create("rj45", budget=4, batch=4, out=tmp_path / "study", no_cache=True, **fake)
    with Deadly(2) as deadly, pytest.raises(fo.StudyError, match="(?s)was lost 3 times.*BrokenProcessPool.*resume"):
        study.run(deadly, progress=False, retries=2)


@pytest.mark.parametrize("streams", ["2>/dev/full", "2>&-", "2>&1 >/dev/null | head -c 1", "0<&- >&- 2>&-"])
def test_a_study_does_not_end_for_what_nobody_reads(streams, tmp_path, expected):
    program = shutil.which("optimize", path=str(Path(sys.executable).parent))
    words = [program, *WORDS, "--executor", "processes:2", "--out", "study"]
    line = f"{subprocess.list2cmdline(words)} {streams}"
    done = subprocess.run(["bash", "-o", "pipefail", "-c", line], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done
    assert journal(tmp_path / "study") == expected
    assert (tmp_path / "study" / "report.html").exists()
    assert "evaluations" not in (tmp_path / "study" / ".lock").read_text()


def test_an_output_that_cannot_be_written_fails_after_the_study(command, tmp_path, expected):
    with open("/dev/full", "w") as full:
        program = shutil.which("optimize", path=str(Path(sys.executable).parent))
        words = [program, *WORDS, "--executor", "processes:2", "--out", "study", "--quiet"]
        done = subprocess.run(words, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 1 and done.stderr.startswith("error: cannot write the output"), done
    assert journal(tmp_path / "study") == expected
    assert (tmp_path / "study" / "report.html").exists()


def test_progress_is_not_needed_by_a_script_either(tmp_path, fake):
    code = ("import finger_opt as fo, sys\n"
            "sys.stderr.close()\n"
            "fo.Study.create('rj45', budget=8, engine='fake', no_cache=True, out='study').run()\n"
            "sys.stderr = None\n"
            "fo.Study.create('rj45', budget=8, engine='fake', no_cache=True, out='other').run()\n")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path)
    assert done.returncode == 0
    assert len(fo.load_study(tmp_path / "study")) == len(fo.load_study(tmp_path / "other")) == 8


@pytest.mark.parametrize(
    "executor, right",
    [
        *((f"processes:{number}", "a whole number from 1 to 1024") for number in ("0", "-1", "abc", "1.5", "", "²")),
        *((f"slurm:{number}", "a whole number from 1 to 10000") for number in ("abc", "0")),
        *((f"dask:{place}", "as in dask://127.0.0.1:8786")
          for place in ("", "//", "//127.0.0.1", "//:8786", "//127.0.0.1:x", "//127.0.0.1:70000")),
        ("cloud", "must be dask://HOST:PORT"),
    ],
)
def test_an_executor_that_cannot_be_is_one_line(executor, right, tmp_path, fake):
    done = subprocess.run([sys.executable, "-m", "finger_opt.executors", *WORDS, "--executor", executor],
                          cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: --executor {executor}: ") and right in done.stderr
    assert done.stderr.count("\n") == 1 and not any(tmp_path.iterdir())


def test_names_that_are_no_utf_8(command, tmp_path, fake):
    folder = tmp_path / os.fsdecode(b"caf\xe9")
    code, out, errors = command(*WORDS, "--executor", "processes:1", "--quiet", "--out", os.fspath(folder))
    assert code == 0, errors
    assert "next          optimize next" in out
    assert len(fo.load_study(folder)) == BUDGET
    task = tmp_path / os.fsdecode(b"\xe9.toml")
    task.write_text(fo.Task.from_toml("usb").to_toml())
    code, _, errors = command("--task", os.fspath(task), "--budget", "2", "--executor", "processes:1")
    assert code == 2 and errors.startswith("error: "), errors
    with pytest.raises(fo.InputError, match="must be valid UTF-8"):
        fo.evaluate(task, 20, 10, **fake)


def test_nothing_is_imported_from_the_current_folder(command, tmp_path, fake):
    for module in ("numpy", "socket", "multiprocessing", "array", "finger_opt", "sitecustomize"):
        (tmp_path / f"{module}.py").write_text("open('imported', 'a').write(__name__ + ' ')")
    words = [*WORDS, "--executor", "processes:2", "--quiet", "--out", "study"]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONSAFEPATH"}
    code, _, errors = command(*words, cwd=tmp_path, env=environment)
    assert code == 0, errors
    assert not (tmp_path / "imported").exists(), (tmp_path / "imported").read_text()
