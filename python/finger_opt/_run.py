"""Runs an open study on an executor: submits work, collects results."""

from __future__ import annotations

import importlib
import os
import socket
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from typing import Any

from . import _native

#: Interval at which a waiting study checks for an interruption, s.
LOOK = 0.2


class Performer:
    """Function that performs the units of work of one run.

    Setting ``stop`` also ends the units that are still being performed in this process.
    """

    def __init__(self) -> None:
        self.stop = _native.Stop()
        # Dask uses this name for tasks.
        self.__name__ = "perform"

    def __call__(self, work: bytes) -> bytes:
        return bytes(_native.perform(work, f"{socket.gethostname()}:{os.getpid()}", self.stop))

    def __reduce__(self) -> tuple[type[Performer], tuple[()]]:
        # `stop` has no effect in another process.
        return Performer, ()


def perform(work: bytes) -> bytes:
    """Performs a unit of work, given as bytes by a study, and returns its result as bytes.

    The result depends on ``work`` alone, so that a unit can be repeated and performed anywhere.

    Raises :class:`InputError`, with the name of this host and process, for work of another version of the program.
    """
    return Performer()(work)


def workers_of(executor: Any) -> int:
    """Returns the number of tasks that an executor runs at a time; if unknown, the number of processors."""
    client = getattr(executor, "_client", None)
    if client is not None and hasattr(client, "ncores"):
        return max(1, int(sum(client.ncores().values())))
    return int(getattr(executor, "_max_workers", None) or os.cpu_count() or 1)


def scheduler_lost(executor: Any) -> bool:
    """Returns whether Dask has closed the connection to its scheduler, so that futures never finish."""
    client = getattr(executor, "_client", None)
    return getattr(client, "status", None) in ("closing", "closed")


def say(text: str) -> None:
    """Writes to standard error; ignores a closed or full one, which must not end a study."""
    with suppress(OSError, ValueError):
        if sys.stderr is not None:
            sys.stderr.write(text)
            sys.stderr.flush()


def is_terminal() -> bool:
    """Returns whether standard error is a terminal."""
    with suppress(OSError, ValueError):
        return sys.stderr is not None and sys.stderr.isatty()
    return False


class Progress:
    """Progress line on standard error (in a notebook: below the cell), and progress callbacks."""

    def __init__(self, shown: bool, callbacks: Sequence[Callable[[int], object]] = ()) -> None:
        self.shown = shown
        self.callbacks = callbacks
        self.done: int | None = None
        self.live = is_terminal() or "ipykernel" in sys.modules
        self.last = float("-inf") if self.live else time.monotonic()
        self.bar: Any | None = None
        if shown and self.live:
            with suppress(ImportError):
                self.bar = importlib.import_module("tqdm.auto").tqdm(unit="evaluation")

    def show(self, study: _native.AskTellStudy, ended: bool = False) -> None:
        """Updates the line: twice a second if it can be overwritten, otherwise every 10 s; calls the callbacks."""
        now = time.monotonic()
        if self.callbacks or self.bar is not None:
            done, evaluations, best = study.progress()
            if self.bar is not None:
                self.bar.total = evaluations
                self.bar.set_postfix_str(best, refresh=False)
                self.bar.update(done - self.bar.n)
            # Evaluations of earlier runs are not reported.
            for callback in self.callbacks if self.done not in (None, done) else ():
                callback(done)
            self.done = done
            if self.bar is not None:
                return
        if not self.shown or not (ended or now - self.last > (0.5 if self.live else 10.0)):
            return
        self.last = now
        done, evaluations, best = study.progress()
        line = f"{done}/{evaluations} evaluations, {best}"[:78]
        end = "\n" if ended or not self.live else ""
        say((f"\r{line:78}" if self.live else line) + end)

    def close(self) -> None:
        """Closes the bar."""
        if self.bar is not None:
            self.bar.close()


def run_open(
    begin: Callable[[int | None], _native.AskTellStudy],
    executor: Any | None,
    progress: bool,
    workers: int | None,
    retries: int,
    callbacks: Sequence[Callable[[int], object]] = (),
) -> tuple[str, str | None]:
    """Opens a study and runs it to its end; returns its output, and the reason if it has no result.

    Raises :class:`StudyError` if the executor fails, :class:`Interrupted` after Ctrl-C.
    """
    own: Executor | None = None
    if executor is None:
        study = begin(None)
        executor = own = ThreadPoolExecutor(study.threads() or os.cpu_count())
    else:
        study = begin(workers or workers_of(executor))
    performer, shown = Performer(), Progress(progress, callbacks)
    try:
        ending = Scheduler(study, executor, performer, retries, shown).run()
        shown.show(study, ended=True)
        return study.finish(ending)
    except KeyboardInterrupt:
        say(f"\ninterrupted; {study.hint()}\n")
        raise _native.Interrupted(f"interrupted; {study.hint()}") from None
    finally:
        shown.close()
        performer.stop.set()
        if own is not None:
            own.shutdown(wait=True, cancel_futures=True)
        study.close()


class Scheduler:
    """Submitted work of a study, and the number of losses of each unit."""

    def __init__(
        self, study: _native.AskTellStudy, executor: Any, performer: Performer, retries: int, progress: Progress
    ) -> None:
        self.study = study
        self.executor = executor
        self.performer = performer
        self.retries = retries
        self.progress = progress
        self.running: dict[Future[bytes], tuple[int, bytes]] = {}
        self.losses: dict[int, int] = {}

    def run(self) -> str:
        """Submits work and collects results until the study ends; returns the ending."""
        try:
            while True:
                work, ending = self.study.next()
                if ending is not None:
                    return str(ending)
                for proposal, job in work:
                    self.submit(proposal, bytes(job))
                if not work:
                    self.collect()
                self.progress.show(self.study)
        finally:
            for future in self.running:
                future.cancel()

    def submit(self, proposal: int, work: bytes) -> None:
        """Submits a unit of work; raises StudyError if the executor does not accept it."""
        try:
            future = self.executor.submit(self.performer, work)
        except Exception as error:
            raise self.stopped(f"the executor accepts no more work: {named(error)}") from error
        self.running[future] = (proposal, work)

    def collect(self) -> None:
        """Waits for at least one result, and passes all finished ones to the study; resubmits lost units."""
        done: set[Future[bytes]] = set()
        while not done:
            done, _ = wait(self.running, timeout=LOOK, return_when=FIRST_COMPLETED)
            if not done and scheduler_lost(self.executor):
                raise self.stopped("the connection to the scheduler is closed")
        # In the order of proposals, for a reproducible order of results.
        for future in sorted(done, key=lambda future: self.running[future][0]):
            proposal, work = self.running.pop(future)
            try:
                result = future.result()
            except _native.InputError:
                # Another program version or an invalid design: a retry would fail, too.
                raise
            except (Exception, CancelledError) as error:
                self.resubmit(proposal, work, error)
                continue
            try:
                if not isinstance(result, bytes):
                    raise _native.Refused(f"the result is not bytes but {type(result).__name__}")
                self.study.take(proposal, result)
            except _native.Refused as error:
                self.resubmit(proposal, work, error)

    def resubmit(self, proposal: int, work: bytes, error: BaseException) -> None:
        """Submits lost work again; raises StudyError after too many losses."""
        count = self.losses[proposal] = self.losses.get(proposal, 0) + 1
        if count > self.retries:
            raise self.stopped(
                f"evaluation {proposal} was lost {count} times, the last time by {named(error)}"
            ) from error
        self.submit(proposal, work)

    def stopped(self, why: str) -> _native.StudyError:
        """Returns the error that ends the run, with the command that continues the study."""
        return _native.StudyError(f"{why}\n{self.study.hint()}")


def named(error: BaseException) -> str:
    """Returns the class of an error, and its text if there is one."""
    try:
        text = str(error).strip()
    except Exception:
        text = ""
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
