"""Runs an open study on an executor: gives out work, takes in results."""

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

#: How often a waiting study looks whether it was interrupted, s.
LOOK = 0.2


class Performer:
    """The unit of work for one run, whose end also ends what is still performed in this process."""

    def __init__(self) -> None:
        self.stop = _native.Stop()
        # Dask names tasks by it.
        self.__name__ = "perform"

    def __call__(self, work: bytes) -> bytes:
        return bytes(_native.perform(work, f"{socket.gethostname()}:{os.getpid()}", self.stop))

    def __reduce__(self) -> tuple[type[Performer], tuple[()]]:
        # Another process knows nothing of the run.
        return Performer, ()


def perform(work: bytes) -> bytes:
    """The unit of work: bytes that a study gave out in, the result for it out.

    Depends on nothing else, so it may be done twice, anywhere; it refuses the work of another
    version of the program, with the name of this host and process.
    """
    return Performer()(work)


def workers_of(executor: Any) -> int:
    """How many tasks an executor runs at a time, as far as it can be known."""
    client = getattr(executor, "_client", None)
    if client is not None and hasattr(client, "ncores"):
        return max(1, int(sum(client.ncores().values())))
    return int(getattr(executor, "_max_workers", None) or os.cpu_count() or 1)


def lost(executor: Any) -> bool:
    """Whether Dask has given its scheduler up: what was submitted then waits for ever."""
    client = getattr(executor, "_client", None)
    return getattr(client, "status", None) in ("closing", "closed")


def say(text: str) -> None:
    """Writes to standard error. Where that has gone or is full nobody can be told, and no study ends for it."""
    with suppress(OSError, ValueError):
        if sys.stderr is not None:
            sys.stderr.write(text)
            sys.stderr.flush()


def terminal() -> bool:
    """Whether standard error is one."""
    with suppress(OSError, ValueError):
        return sys.stderr is not None and sys.stderr.isatty()
    return False


class Progress:
    """A line on standard error (in a notebook: under the cell) that says how far it is."""

    def __init__(self, shown: bool, callbacks: Sequence[Callable[[int], object]] = ()) -> None:
        self.shown = shown
        self.callbacks = callbacks
        self.done: int | None = None
        self.live = terminal() or "ipykernel" in sys.modules
        self.last = float("-inf") if self.live else time.monotonic()
        self.bar: Any | None = None
        if shown and self.live:
            with suppress(ImportError):
                self.bar = importlib.import_module("tqdm.auto").tqdm(unit="evaluation")

    def show(self, study: _native.AskTellStudy, ended: bool = False) -> None:
        """The line, if it is time for it: twice a second where it can be written over."""
        now = time.monotonic()
        if self.callbacks or self.bar is not None:
            done, evaluations, best = study.progress()
            if self.bar is not None:
                self.bar.total = evaluations
                self.bar.set_postfix_str(best, refresh=False)
                self.bar.update(done - self.bar.n)
            # Those of earlier runs are not new.
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
        """Ends the bar."""
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
    """Opens a study and runs it to its end; gives what it prints, and why it is of no use, if so."""
    own: Executor | None = None
    if executor is None:
        study = begin(None)
        executor = own = ThreadPoolExecutor(study.threads() or os.cpu_count())
    else:
        study = begin(workers or workers_of(executor))
    performer, shown = Performer(), Progress(progress, callbacks)
    try:
        ending = Course(study, executor, performer, retries, shown).run()
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


class Course:
    """The work that is out, and how often each was lost."""

    def __init__(
        self, study: _native.AskTellStudy, executor: Any, performer: Performer, retries: int, progress: Progress
    ) -> None:
        self.study = study
        self.executor = executor
        self.performer = performer
        self.retries = retries
        self.progress = progress
        self.running: dict[Future[bytes], tuple[int, bytes]] = {}
        self.lost: dict[int, int] = {}

    def run(self) -> str:
        """Until there is nothing more to do; gives how the study ended."""
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
        try:
            future = self.executor.submit(self.performer, work)
        except Exception as error:
            raise self.stopped(f"the executor takes no more work: {named(error)}") from error
        self.running[future] = (proposal, work)

    def collect(self) -> None:
        """Waits for a result at least, and takes in all that have come."""
        done: set[Future[bytes]] = set()
        while not done:
            done, _ = wait(self.running, timeout=LOOK, return_when=FIRST_COMPLETED)
            if not done and lost(self.executor):
                raise self.stopped("the scheduler does not answer any more")
        # In the order of proposals, so that equal ones arrive in an equal order.
        for future in sorted(done, key=lambda future: self.running[future][0]):
            proposal, work = self.running.pop(future)
            try:
                result = future.result()
            except _native.InputError:
                # Another version, or a design that cannot be: no other worker would do better.
                raise
            except (Exception, CancelledError) as error:
                self.again(proposal, work, error)
                continue
            try:
                if not isinstance(result, bytes):
                    raise _native.Refused(f"the result is no bytes: {type(result).__name__}")
                self.study.take(proposal, result)
            except _native.Refused as error:
                self.again(proposal, work, error)

    def again(self, proposal: int, work: bytes, error: BaseException) -> None:
        count = self.lost[proposal] = self.lost.get(proposal, 0) + 1
        if count > self.retries:
            raise self.stopped(
                f"evaluation {proposal} was lost {count} times, the last time by {named(error)}"
            ) from error
        self.submit(proposal, work)

    def stopped(self, why: str) -> _native.StudyError:
        return _native.StudyError(f"{why}\n{self.study.hint()}")


def named(error: BaseException) -> str:
    """The class of an error, and its text, if it has one."""
    try:
        text = str(error).strip()
    except Exception:
        text = ""
    return f"{type(error).__name__}: {text}" if text else type(error).__name__
