"""Executors by name, for ``optimize --executor``: ``dask://HOST:PORT``, ``slurm``, ``processes``.

``python -m finger_opt.executors WORDS..`` is what ``optimize WORDS.. --executor WHERE`` starts.
"""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import Any

from . import _native
from ._run import run_open

#: How often the folder of the jobs is looked into for results, s.
LOOK = 1.0
#: How often Slurm is asked which jobs it still has, s.
ASK = 30.0


class SlurmExecutor(Executor):
    """Slurm as an executor, by submitit: each measurement is a job.

    ``folder`` (shared by all nodes) takes submitit's files, ``workers`` is how many jobs are
    handed to Slurm at a time; ``parameters`` go to ``submitit.SlurmExecutor.update_parameters``
    (``partition="short", time=60, cpus_per_task=1``). A job takes some seconds to start: see
    ``docs/guide/clusters.md`` for what is better when evaluations take less.
    """

    def __init__(self, folder: str = "results/.slurm", workers: int = 64, **parameters: Any) -> None:
        try:
            import submitit
        except ImportError:
            raise _native.InputError(needs("slurm", "submitit")) from None
        self._executor = submitit.SlurmExecutor(folder=folder, python=sys.executable)
        self._executor.update_parameters(**{"time": 60, "job_name": "finger-opt", **parameters})
        self._max_workers = workers
        self._jobs: dict[Future[Any], Any] = {}
        self._gone: set[str] = set()
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._watch = threading.Thread(target=self._look, daemon=True)
        self._watch.start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Hands a job to Slurm."""
        future: Future[Any] = Future()
        future.set_running_or_notify_cancel()
        job = self._executor.submit(fn, *args, **kwargs)
        with self._lock:
            self._jobs[future] = job
        return future

    def _look(self) -> None:
        asked = time.monotonic()
        while not self._ended.wait(LOOK):
            with self._lock:
                jobs = list(self._jobs.items())
            lost: set[str] = set()
            if time.monotonic() - asked >= ASK:
                asked = time.monotonic()
                lost = self._lost({job.job_id for _, job in jobs})
            for future, job in jobs:
                done = job.done()
                if not done and job.job_id not in lost:
                    continue
                with self._lock:
                    del self._jobs[future]
                try:
                    if not done:
                        raise RuntimeError(f"Slurm job {job.job_id} ended without a result: see {job.paths.stderr}")
                    future.set_result(job.result())
                except Exception as error:
                    future.set_exception(error)

    def _lost(self, jobs: set[str]) -> set[str]:
        """Jobs that Slurm did not have the last two times it was asked.

        ``sacct`` knows a killed job only where Slurm keeps accounts. A job that has just ended may have
        a result that the file system does not show yet, hence twice.
        """
        try:
            said = subprocess.run(["squeue", "--me", "-h", "-o", "%i"], capture_output=True, text=True, timeout=ASK)
        except (OSError, subprocess.TimeoutExpired):
            return set()
        if said.returncode != 0:
            return set()
        gone = jobs - set(said.stdout.split())
        lost, self._gone = gone & self._gone, gone
        return lost

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends the watch; jobs that still run are cancelled."""
        while wait and not cancel_futures and self._jobs:
            time.sleep(LOOK)
        self._ended.set()
        with self._lock:
            for job in self._jobs.values():
                job.cancel(check=False)


def needs(extra: str, module: str) -> str:
    """What to install for an executor."""
    return f"--executor {extra} needs {module}: pip install 'finger-opt[{extra}]'"


@contextmanager
def named(name: str) -> Iterator[Executor]:
    """The executor of this name."""
    scheme, _, rest = name.partition(":")
    if scheme == "processes":
        workers = int(rest) if rest else os.cpu_count()
        # Not forked: a copy of a process with threads may stand still.
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            yield pool
    elif scheme == "slurm":
        slurm = SlurmExecutor(workers=int(rest) if rest else 64)
        try:
            yield slurm
        finally:
            slurm.shutdown(cancel_futures=True)
    elif scheme == "dask" and rest.startswith("//"):
        try:
            from distributed import Client
        except ImportError:
            raise _native.InputError(needs("dask", "distributed")) from None
        try:
            client = Client("tcp:" + rest, timeout=10)
        except OSError as error:
            raise _native.RunError(f"--executor {name}: no scheduler answers there: {error}") from None
        with client:
            yield client.get_executor()
    else:
        raise _native.InputError(
            f"--executor {name}: is none of dask://HOST:PORT, slurm, slurm:JOBS, processes, processes:N"
        )


def main(words: list[str]) -> int:
    """Runs the study of these words of ``optimize``; gives its exit code."""
    sources = os.environ.get("FINGER_OPT_SOURCES", _native.source_sha256())
    if sources != _native.source_sha256():
        raise _native.InputError(
            "the installed Python package finger-opt is of other sources than this program; "
            "install the one from the same folder: pip install ./python"
        )
    asked = _native.asked(words)
    if asked.executor is None:
        raise _native.InputError("give --executor")
    with named(asked.executor) as executor:
        text, unusable = run_open(asked.open, executor, not asked.quiet, None, 10)
    sys.stdout.write(text)
    if unusable is not None:
        raise _native.RunError(unusable)
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except KeyboardInterrupt:
        sys.exit(1)
    except (_native.InputError, _native.RunError) as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2 if isinstance(error, _native.InputError) else 1)
