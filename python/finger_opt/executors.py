"""Executors by name, for ``optimize --executor``: ``dask://HOST:PORT``, ``slurm``, ``processes``.

``optimize WORDS.. --executor WHERE`` starts :func:`command` in a process of its own.
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

#: How often the folder of the jobs is looked into for results, s.
LOOK = 1.0
#: How often Slurm is asked which jobs it still has, s.
ASK = 30.0
#: Most processes and most jobs.
PROCESSES, JOBS = 1024, 10_000


class Processes(Executor):
    """Processes of this machine. Where one is lost, which its pool does not survive, a new pool goes on.

    They end with this process, however it ends.
    """

    def __init__(self, workers: int) -> None:
        self._max_workers = workers
        # Not forked: a copy of a process with threads may stand still.
        self._context = get_context("spawn")
        # Nothing is ever said: its end is all that counts.
        self._alive, self._tied = self._context.Pipe(duplex=False)
        self._pool = self._new()

    def _new(self) -> ProcessPoolExecutor:
        with apart():
            return ProcessPoolExecutor(self._max_workers, self._context, tied, (self._alive,))

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        with apart():
            try:
                return self._pool.submit(fn, *args, **kwargs)
            except BrokenProcessPool:
                self._pool = self._new()
                return self._pool.submit(fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Ends all processes, whatever they do."""
        # The pool first: once its processes have gone it trips over work that was cancelled.
        self._pool.shutdown(wait=False, cancel_futures=cancel_futures)
        self._tied.close()


def tied(alive: Connection) -> None:
    """Ends this process with the one that began it, to which it also leaves Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def end() -> None:
        with suppress(EOFError, OSError):
            alive.recv_bytes()
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()


@contextmanager
def apart() -> Generator[None, None, None]:
    """Processes that begin meanwhile get no Ctrl-C, and import nothing from the user's folder."""
    masked = hasattr(signal, "pthread_sigmask")
    before: set[int | signal.Signals] = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT]) if masked else set()
    # Later versions are told by PYTHONSAFEPATH.
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
def named(name: str) -> Generator[Executor, None, None]:
    """The executor of this name."""
    scheme, colon, rest = name.partition(":")
    if scheme in ("processes", "slurm"):
        most = PROCESSES if scheme == "processes" else JOBS
        if colon and not (re.fullmatch("[0-9]{1,5}", rest) and 1 <= int(rest) <= most):
            raise _native.InputError(
                f"--executor {name}: after {scheme}: comes a whole number from 1 to {most}"
            )
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
                f"--executor {name}: names no scheduler; give its host and port, as in dask://127.0.0.1:8786"
            )
        try:
            from distributed import Client
        except ImportError:
            raise _native.InputError(needs("dask", "distributed")) from None
        try:
            client = Client("tcp:" + rest, timeout=10)
        except OSError as error:
            raise _native.StudyError(f"--executor {name}: no scheduler answers there: {error}") from None
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
    asked = _native.StudyRequest.in_words(words)
    if asked.executor is None:
        raise _native.InputError("give --executor")
    with named(asked.executor) as executor:
        text, unusable = run_open(asked.open, executor, not asked.quiet, None, 10)
    show(text)
    if unusable is not None:
        raise _native.StudyError(unusable)
    return 0


def show(text: str) -> None:
    """Prints to standard output, as the program does; a reader that has gone away is no error."""
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
    """Keeps the interpreter from failing at its end for what a stream could not take."""
    if stream is None:
        return
    try:
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def nothing(*_: object) -> None:
    """What a signal does that changes nothing."""


def stop_once(*_: object) -> None:
    """Ends the study as Ctrl-C does; who asks again changes nothing."""
    for name in STOPS:
        # Not SIG_IGN: of a signal that came meanwhile Python would complain.
        signal.signal(name, nothing)
    raise KeyboardInterrupt


#: What ends the study.
STOPS = [signal.SIGINT, signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]


def watch_input() -> None:
    """Ends the study when the input ends: the program wants it to, or has gone."""
    with suppress(OSError):
        os.read(0, 1)
    _thread.interrupt_main()


def command() -> int:
    """The command line of this process; gives its exit code."""
    try:
        open_streams()
        for name in STOPS:
            signal.signal(name, stop_once)
        # The program has begun this process, and holds the other end of its input.
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
