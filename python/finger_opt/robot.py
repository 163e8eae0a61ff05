"""Measures the tolerance window of a finger with a robot, or with a simulated one as a rehearsal.

>>> from finger_opt.robot import SimulatedRobot, measure_window          # doctest: +SKIP
>>> robot = SimulatedRobot("usb", 20, 10, noise=0.6)                      # doctest: +SKIP
>>> measure_window(robot, task="usb", density=20, direction=10)           # doctest: +SKIP
"""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any, Protocol, TypeGuard, TypeVar

from ._attempts import Attempt, Attempts, Tried, taken
from ._bag import text
from ._bench import Bench
from ._call import checked, number, shown, wrong
from ._ends import INTERVAL, Gap, Search, Side, Window
from ._measurement import Measurement
from ._native import InputError, StudyError
from ._run import named, say
from ._runs import Runs
from ._simulated import SimulatedRobot
from ._task import Given
from ._words import StrPath

T = TypeVar("T")

__all__ = ["Attempt", "Gap", "Measurement", "Probing", "Robot", "SimulatedRobot", "bag_to_csv", "measure_window"]

#: Default time limit of an attempt, s.
TIMEOUT_S = 120.0
#: Largest time limit, s: a day.
MAX_TIMEOUT_S = 86_400.0
#: Smallest plausible depth of an insertion, as a share of the task's success depth.
MIN_DEPTH_SHARE = 0.5
#: Implausible attempts in a row after which the measurement stops.
MAX_DOUBTFUL = 3


class Robot(Protocol):
    """Interface of a robot that can attempt an insertion.

    The optional attribute ``timeout_s`` limits the time of an attempt, s; the default is 120.
    """

    def insert(self, offset_mm: float, log: Path | None = None) -> Attempt:
        """Attempts an insertion from the taught start shifted by ``offset_mm`` along y, the closing direction of
        the jaws; records force and pose in ``log`` if possible; leaves the robot ready for the next attempt."""
        ...


class Probing(Robot, Protocol):
    """Interface of a robot that can also probe the friction."""

    def probe(self, log: Path) -> None:
        """Presses the plug on the flat face beside the opening, slides it slowly back and forth along y, and
        records force and pose in ``log``; leaves the robot ready for the first attempt."""
        ...


@checked
def measure_window(
    robot: Robot,
    *,
    step_mm: float = 0.5,
    resolution_mm: float = 0.1,
    limit_mm: float = 15.0,
    repeats: int = 2,
    out: str | os.PathLike[str] = "bench.csv",
    task: Given,
    density: float,
    direction: float,
    attempts_max: int = 60,
    probe: bool = False,
    progress: bool = True,
) -> Measurement:
    """Measures the tolerance window of a finger with a robot, and adds it to the measurement file ``out``.

    ``density`` is in percent, ``direction`` in degrees. The start is shifted outward by ``step_mm`` until two
    neighbouring starts fail, at most by ``limit_mm``. Each end is then modelled as a logistic curve and estimated
    by Bayesian inference from all attempts on its side (priors: position uniform; width from 90 to 10 % log-normal
    with median 0.4 mm and factor 2; lapse rate 1 %). The next start, a multiple of ``resolution_mm``, is the one
    with the largest expected information gain on the position of the end, until the position's standard deviation
    is at most ``resolution_mm`` and, within a step, ``repeats`` attempts inserted inside and ``repeats`` failed
    outside. Starts that keep failing while others beyond them insert form a gap, which the curve excludes.

    Each attempt is saved in a file beside ``out`` before the next begins: after an interruption the same call
    continues there. A window that was measured today is not measured again. ``attempts_max`` limits the attempts.

    With ``probe``, the friction is probed first, which needs a :class:`Probing` robot. Recorded logs with a known
    outcome are listed in ``runs.csv`` beside ``out``, the input of ``optimize identify``, together with those of
    all other fingers measured into that folder.

    With ``progress``, each attempt is reported on standard error.

    Raises :class:`InputError`, before the robot moves, for wrong arguments and if another process is measuring the
    same finger into the same folder; :class:`StudyError` if the robot raises an error, exceeds its ``timeout_s``, or
    reports implausible results three times in a row (a single one is marked and repeated), if a file cannot be
    written, or if the taught start does not insert or fails more often than it inserts.
    """
    search = _checked(Search(float(step_mm), float(resolution_mm), float(limit_mm), int(repeats)), attempts_max)
    timeout_s = _timeout(robot)
    prober = robot if probe and _can_probe(robot) else None
    if probe and prober is None:
        raise InputError(f"probe: {type(robot).__name__} has no method probe(log); add it, or set probe=False")
    bench = Bench(Path(out), task, density, direction)
    try:
        with closing(bench.attempts(search)) as attempts:
            date = attempts.settings["date"]
            ended = bench.written(date)
            runs = Runs(bench.out.parent, bench.task.name, bench.finger, attempts)
            measuring = _WindowMeasurement(
                robot, search, attempts, runs, bench.task.success.depth_mm, timeout_s, progress)
            if prober is not None and attempts.probed is None:
                measuring.probe(prober)
            measured = measuring.run(0 if ended else attempts_max)
            bench.write(measured, date)
    except OSError as error:
        raise StudyError(f"{error.filename or bench.out}: {error.strerror or error}") from error
    return measured


def _timeout(robot: object) -> float:
    """Returns the time limit of an attempt of a robot, s."""
    given = getattr(robot, "timeout_s", TIMEOUT_S)
    seconds = number(given)
    if seconds is None or not 0.0 < seconds <= MAX_TIMEOUT_S:
        raise wrong("robot", f"its timeout_s is {shown(given)}; it must be a time above 0, {MAX_TIMEOUT_S:g} s at most")
    return seconds


def _can_probe(robot: Robot) -> TypeGuard[Probing]:
    return callable(getattr(robot, "probe", None))


def _checked(search: Search, attempts_max: int) -> Search:
    """Returns the search after checking its values; raises InputError."""
    lengths = (search.resolution_mm, search.step_mm, search.limit_mm)
    # This form also rejects NaN.
    if not 0.01 <= lengths[0] <= lengths[1] <= lengths[2] <= 100.0:
        raise InputError(
            "resolution_mm, step_mm, limit_mm: must be lengths in mm, each at most the next, from 0.01 to 100; "
            f"given {', '.join(f'{length:g}' for length in lengths)}"
        )
    if search.limit_mm > 1000.0 * search.resolution_mm:
        raise InputError("limit_mm: must be at most 1000 times resolution_mm")
    for name, count in (("repeats", search.repeats), ("attempts_max", attempts_max)):
        if not 1 <= count <= 10_000:
            raise InputError(f"{name}: is {count}; it must be a number from 1 to 10000")
    return search


def bag_to_csv(bag: StrPath, out: StrPath, **topics: str) -> None:
    """Converts a ROS 1 or ROS 2 bag to a CSV log for ``identify``, in the base frame: s, m, rad, N.

    ``identify`` reads bags directly; this function is for bags with several candidate topics. ``topics`` are the
    names ``force`` (WrenchStamped), ``pose`` and ``target`` (PoseStamped). Needs the extra ``ros``.

    Raises :class:`InputError` if the bag has no usable force and pose.
    """
    unknown = set(topics) - {"force", "pose", "target"}
    if unknown:
        raise TypeError(f"bag_to_csv() has no keyword {min(unknown)!r}; it has force, pose and target")
    Path(out).write_text(text(bag, topics), encoding="utf-8")


class _WindowMeasurement:
    """Sequence of attempts of one measurement."""

    def __init__(
        self, robot: Robot, search: Search, attempts: Attempts, runs: Runs, depth_mm: float, timeout_s: float,
        progress: bool,
    ) -> None:
        self.robot, self.search, self.attempts, self.runs = robot, search, attempts, runs
        self.depth_mm, self.timeout_s, self.progress = depth_mm, timeout_s, progress

    def run(self, attempts_max: int) -> Measurement:
        """Makes attempts until both ends are known or the limit is reached; returns the measurement."""
        doubtful = 0
        while True:
            tried = [(one.offset_mm, one.attempt.inserted) for one in self.attempts.counted()]
            window = Window(self.search, tried)
            offset = window.next()
            if offset is None or window.start_fails or len(self.attempts.tried) >= attempts_max:
                break
            done = self.attempt(offset)
            self.attempts.add(done)
            self.runs.add(done)
            self.show(done)
            doubtful = doubtful + 1 if done.doubt else 0
            if doubtful == MAX_DOUBTFUL:
                raise self.stopped(offset, f"{MAX_DOUBTFUL} attempts in a row are implausible: {done.doubt}")
        if not window.inserts:
            why = "no attempt from the taught start inserts: teach another; if none inserts, record the finger with "
            raise self.stopped(0.0, why + "`optimize measure add --not-measurable`")
        if window.start_fails:
            near = "" if window.middle is None else f", near {window.middle:+.1f} mm"
            failed = f"{window.start.count(False)} of {len(window.start)} attempts from the taught start failed"
            raise self.stopped(0.0, f"{failed}: teach another{near}, and remove the attempts of this one")
        return self.measurement(window, settled=offset is None)

    def show(self, done: Tried) -> None:
        """Writes the outcome of an attempt to standard error."""
        if not self.progress:
            return
        attempt = done.attempt
        failed = "failed" if attempt.failure is None else f"failed, class {attempt.failure}"
        outcome = done.doubt or ("inserted" if attempt.inserted else failed)
        say(f"attempt {len(self.attempts.tried)}: start {done.offset_mm:+g} mm, {outcome}\n")

    def probe(self, robot: Probing) -> None:
        """Probes the friction with the robot, and saves its log."""

        def probed(log: Path) -> Path:
            robot.probe(log)
            return log

        log = self.call_robot("probe", "probe", probed)
        if not (log.is_file() and log.stat().st_size):
            raise self.stopped("probe", f"the robot recorded nothing in {log}")
        self.attempts.add_probe(log)
        self.runs.add_probe(log)

    def attempt(self, offset: float) -> Tried:
        """Makes an attempt, and checks the plausibility of its result."""
        name = f"{self.attempts.made + 1:03}"
        done = self.call_robot(offset, name, lambda log: self.robot.insert(offset, log))
        if not isinstance(done, Attempt):
            raise self.stopped(offset, f"the robot returned {shown(done)}, which is not an Attempt")
        # Implausible fields keep these values.
        doubts: list[str] = []
        fields: dict[str, Any] = {"inserted": False, "failure": None, "depth_mm": 0.0, "peak_force_n": 0.0, "log": None}
        for key in fields:
            try:
                fields[key] = taken(key, getattr(done, key))
            except ValueError as error:
                doubts.append(str(error))
        done = Attempt(**fields)
        doubt = doubts[0] if doubts else self.contradiction(done)
        return Tried(offset, replace(done, failure=None) if doubt else done, doubt)

    def call_robot(self, at: float | str, name: str, call: Callable[[Path], T]) -> T:
        """Calls the robot with the path of a log, and returns its result; stops the measurement if it raises."""
        folder = self.attempts.path.with_suffix("")
        folder.mkdir(exist_ok=True)
        try:
            return self.with_timeout(lambda: call(folder / f"{name}.csv"))
        except (Exception, SystemExit) as error:
            raise self.stopped(at, f"the robot raised {named(error)}") from error
        finally:
            # Removes the folder if it is empty: not every robot records.
            with suppress(OSError):
                folder.rmdir()

    def with_timeout(self, call: Callable[[], T]) -> T:
        """Returns the result of a call of the robot, or raises its error; TimeoutError after ``timeout_s``."""
        results: list[T] = []
        errors: list[BaseException] = []

        def answer() -> None:
            try:
                results.append(call())
            except BaseException as error:
                errors.append(error)

        # A daemon thread that hangs does not keep the process from exiting.
        thread = threading.Thread(target=answer, daemon=True)
        thread.start()
        thread.join(self.timeout_s)
        if errors:
            raise errors[0]
        if not results:
            raise TimeoutError(f"no answer within {self.timeout_s:g} s; check the robot before you continue")
        return results[0]

    def contradiction(self, done: Attempt) -> str | None:
        """Returns why the fields of an attempt contradict each other or the task; None if they do not."""
        if done.inserted and done.failure is not None:
            return f"inserted, and failed with class {done.failure}"
        if done.inserted and done.depth_mm < MIN_DEPTH_SHARE * self.depth_mm:
            return f"inserted at a depth of {done.depth_mm:g} mm; the task counts from {self.depth_mm:g} mm on"
        return None

    def stopped(self, at: float | str, why: str) -> StudyError:
        """Records why the measurement stops at a start, mm, or at the probe; returns the error."""
        self.attempts.stopped(at, why)
        kept = f"the attempts so far are in {self.attempts.path}; the same call continues there"
        return StudyError(f"{at if isinstance(at, str) else f'start {at:+g} mm'}: {why}\n{kept}")

    def measurement(self, window: Window, settled: bool) -> Measurement:
        """Returns the measurement; ``settled`` if both ends are known to the resolution."""
        counted = self.attempts.counted()
        (negative, low), (positive, high) = (_end(side) for side in window.sides)
        failures = [self.failure(side) for side in window.sides]
        return Measurement(
            negative_mm=negative,
            positive_mm=positive,
            negative_interval_mm=low,
            positive_interval_mm=high,
            failure_negative=failures[0],
            failure_positive=failures[1],
            gaps=tuple(self.gap(side, run) for side in window.sides for run in side.gaps),
            inserted_mm=(0.0 - window.sides[0].farthest, window.sides[1].farthest),
            peak_force_n=max(one.attempt.peak_force_n for one in counted if one.attempt.inserted),
            attempts=len(self.attempts.tried),
            doubtful=len(self.attempts.tried) - len(counted),
            settled=settled and not any(side.open for side in window.sides),
            log=self.attempts.path,
        )

    def failure(self, side: Side, among: list[float] | None = None) -> int | None:
        """Returns the most frequent failure class: from the starts ``among``, mm outward, or else outside the gaps."""
        gaps = {start for run in side.gaps for start in run}
        classes = Counter(
            one.attempt.failure
            for one in self.attempts.counted()
            if not one.attempt.inserted and one.attempt.failure is not None and one.offset_mm * side.sign >= 0.0
            and (abs(one.offset_mm) in among if among else abs(one.offset_mm) not in gaps)
        )
        return classes.most_common(1)[0][0] if classes else None

    def gap(self, side: Side, run: list[float]) -> Gap:
        """Returns the gap of a run of failed starts, mm outward."""
        inserted = [start for start, tally in side.tallies.items() if tally.inserted]
        neighbours = max(s for s in inserted if s < run[0]), min(s for s in inserted if s > run[-1])
        failed = _outward(side.sign, run[0], run[-1])
        return Gap(failed, _outward(side.sign, *neighbours), self.failure(side, run))


def _outward(sign: int, near: float, far: float) -> tuple[float, float]:
    """Converts two lengths outward, mm, to an interval along y, mm, the lower end first."""
    return (near, far) if sign > 0 else (-far, -near)


def _end(side: Side) -> tuple[float | None, tuple[float, float] | None]:
    """Returns the median of the end along y and its interval, mm; None if the end lies beyond the starts."""
    if side.open:
        return None, None
    tail = (1.0 - INTERVAL) / 2.0
    low, middle, high = (round(side.quantile(share), 2) for share in (tail, 0.5, 1.0 - tail))
    # Starts are not set finer than 0.02 mm, and a measurement file with smaller values is rejected.
    middle = middle if middle >= 0.02 else 0.0
    return side.sign * middle + 0.0, _outward(side.sign, low, high)
