"""Executors for ``optimize --executor``: ``dask://HOST:PORT``, ``slurm``, ``processes``.

``optimize ARGUMENTS.. --executor WHERE`` runs :func:`command` in a separate process.
"""

from __future__ import annotations

import _thread
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Generator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any, TextIO

from . import _native
from ._run import run_open, say
from ._shell import open_streams

#: Period of polling the jobs' folder for results, s.
POLL_S = 1.0
#: Period of querying Slurm for its jobs, and time limit of the query, s.
ASK = 30.0
#: Largest number of processes and of jobs.
MAX_PROCESSES, MAX_JOBS = 1024, 10_000


class Processes(Executor):
    """Executor of processes on this machine; replaces its pool when a lost process has broken it.

    The processes end with this process, even if it is killed.
    """

    def __init__(self, workers: int) -> None:
        self._max_workers = workers
        # Not "fork": a forked copy of a process with threads can deadlock.
        self._context = get_context("spawn")
        # Nothing is ever sent: the workers exit when the pipe closes.
        self._alive, self._parent_end = self._context.Pipe(duplex=False)
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        with apart():
            return ProcessPoolExecutor(self._max_workers, self._context, tied, (self._alive,))

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submits a call to the pool."""
        with apart():
            try:
                return self._pool.submit(fn, *args, **kwargs)
            except BrokenProcessPool:
                self._pool = self._new_pool()
                return self._pool.submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Terminates all processes, including busy ones."""
        # The pool first: it fails on cancelled work once its processes have exited.
        self._pool.shutdown(wait=False, cancel_futures=cancel_futures)
        self._parent_end.close()


def tied(alive: Connection) -> None:
    """Makes this worker exit with its parent process, and ignore Ctrl-C, which the parent handles."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def end() -> None:
        with suppress(EOFError, OSError):
            alive.recv_bytes()
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()


@contextmanager
def apart() -> Generator[None, None, None]:
    """Shields processes that start within the context from Ctrl-C and from modules in the user's folder."""
    masked = hasattr(signal, "pthread_sigmask")
    before: set[int | signal.Signals] = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT]) if masked else set()
    # For Python 3.11 and later, PYTHONSAFEPATH has this effect.
    folder = os.getcwd() if sys.version_info < (3, 11) else None
    if folder is not None:
        os.chdir(os.sep)
    try:
        yield
    finally:
        if folder is not None:
            os.chdir(folder)
        if masked:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


class SlurmExecutor(Executor):
    """Slurm executor, based on submitit: each evaluation is a job.

    ``folder`` (shared by all nodes) is for submitit's files; ``workers`` is the number of jobs submitted at a time;
    ``parameters`` are passed to ``submitit.SlurmExecutor.update_parameters`` (``partition="short", time=60,
    cpus_per_task=1``; ``time`` is in minutes). A job takes some seconds to start: ``docs/guide/clusters.md``
    describes alternatives for shorter evaluations.
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
        #: Jobs that were missing in the last reply of Slurm.
        self._missing: set[str] = set()
        self._lock = threading.Lock()
        self._ended = threading.Event()
        threading.Thread(target=self._poll, daemon=True).start()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Submits a call as a job to Slurm."""
        future: Future[Any] = Future()
        future.set_running_or_notify_cancel()
        job = self._executor.submit(fn, *args, **kwargs)
        with self._lock:
            self._jobs[future] = job
        return future

    def _poll(self) -> None:
        """Polls for results until the shutdown; sets the results and errors of the futures."""
        queried = time.monotonic()
        while not self._ended.wait(POLL_S):
            with self._lock:
                jobs = list(self._jobs.items())
            lost: set[str] = set()
            if time.monotonic() - queried >= ASK:
                queried = time.monotonic()
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
        """Returns the jobs that were missing in the last two replies of Slurm.

        ``sacct`` would list killed jobs only where accounting is enabled. One reply is not enough: the result of a job
        that has just ended may not be visible in the file system yet.
        """
        try:
            reply = subprocess.run(["squeue", "--me", "-h", "-o", "%i"], capture_output=True, text=True, timeout=ASK)
        except (OSError, subprocess.TimeoutExpired):
            return set()
        if reply.returncode != 0:
            return set()
        missing = jobs - set(reply.stdout.split())
        lost, self._missing = missing & self._missing, missing
        return lost

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Waits for the jobs with ``wait``, unless ``cancel_futures``; then stops polling and cancels the rest."""
        while wait and not cancel_futures and self._jobs:
            time.sleep(POLL_S)
        self._ended.set()
        with self._lock:
            for job in self._jobs.values():
                job.cancel(check=False)


def needs(extra: str, module: str) -> str:
    """Returns the message about a missing package of an executor."""
    return f"--executor {extra} needs {module}: pip install 'finger-opt[{extra}]'"


@contextmanager
def named(name: str) -> Generator[Executor, None, None]:
    """Opens the executor that ``--executor`` names; shuts it down at the end of the context."""
    scheme, colon, rest = name.partition(":")
    if scheme in ("processes", "slurm"):
        largest = MAX_PROCESSES if scheme == "processes" else MAX_JOBS
        if colon and not (re.fullmatch("[0-9]{1,5}", rest) and 1 <= int(rest) <= largest):
            raise _native.InputError(f"--executor {name}: `{scheme}:` needs a whole number from 1 to {largest}")
        own: Processes | SlurmExecutor
        if scheme == "processes":
            own = Processes(int(rest) if colon else os.cpu_count() or 1)
        else:
            own = SlurmExecutor(workers=int(rest) if colon else 64)
        try:
            yield own
        finally:
            own.shutdown(cancel_futures=True)
    elif scheme == "dask":
        port = re.fullmatch(r"//(?:\[[0-9a-fA-F:.]+\]|[^\s/:\[\]]+):([0-9]{1,5})", rest)
        if port is None or not 1 <= int(port[1]) <= 65535:
            raise _native.InputError(
                f"--executor {name}: needs host and port of a scheduler, as in dask://127.0.0.1:8786"
            )
        try:
            from distributed import Client
        except ImportError:
            raise _native.InputError(needs("dask", "distributed")) from None
        try:
            client = Client("tcp:" + rest, timeout=10)
        except OSError as error:
            raise _native.StudyError(f"--executor {name}: no scheduler answers at this address: {error}") from None
        with client:
            yield client.get_executor()
    else:
        raise _native.InputError(
            f"--executor {name}: must be dask://HOST:PORT, slurm, slurm:JOBS, processes or processes:N"
        )


def main(words: list[str]) -> int:
    """Runs a study from the arguments of ``optimize``; returns the exit code, or raises InputError or StudyError."""
    sources = os.environ.get("FINGER_OPT_SOURCES", _native.source_sha256())
    if sources != _native.source_sha256():
        raise _native.InputError(
            "the installed Python package finger-opt was built from other sources than this program; "
            "install it from the project's folder: pip install ./python"
        )
    request = _native.StudyRequest.in_words(words)
    if request.executor is None:
        raise _native.InputError("give --executor")
    with named(request.executor) as executor:
        text, unusable = run_open(request.open, executor, not request.quiet, None, 10)
    show(text)
    if unusable is not None:
        raise _native.StudyError(unusable)
    return 0


def show(text: str) -> None:
    """Prints to standard output like the program; ignores a broken pipe."""
    if sys.stdout is None:
        return
    try:
        sys.stdout.buffer.write(text.encode())
        sys.stdout.flush()
    except BrokenPipeError:
        pass
    except OSError as error:
        raise _native.StudyError(f"cannot write the output: {error}") from None


def let_go(stream: TextIO | None) -> None:
    """Flushes a stream; on failure discards the rest, which would make the interpreter fail at exit."""
    if stream is None:
        return
    try:
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def nothing(*_: object) -> None:
    """Ignores a signal."""


def stop_once(*_: object) -> None:
    """Ends the study like Ctrl-C; later signals have no effect."""
    for name in STOP_SIGNALS:
        # Not SIG_IGN: Python would report an error for a signal that is already pending.
        signal.signal(name, nothing)
    raise KeyboardInterrupt


#: Signals that end the study.
STOP_SIGNALS = [signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]


def watch_input() -> None:
    """Ends the study when standard input closes: the program has cancelled it or has exited."""
    with suppress(OSError):
        os.read(0, 1)
    _thread.interrupt_main()


def command() -> int:
    """Runs the command line of this process; returns its exit code."""
    try:
        open_streams()
        for name in STOP_SIGNALS:
            signal.signal(name, stop_once)
        # Set by the program, which holds the other end of the standard input.
        if "FINGER_OPT_SOURCES" in os.environ:
            threading.Thread(target=watch_input, daemon=True).start()
        return main(sys.argv[1:])
    except KeyboardInterrupt:
        return 1
    except (_native.InputError, _native.StudyError) as error:
        say(f"error: {error}\n")
        return 2 if isinstance(error, _native.InputError) else 1
    finally:
        let_go(sys.stdout)
        let_go(sys.stderr)


if __name__ == "__main__":
    sys.exit(command())
