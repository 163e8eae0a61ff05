"""Measure the tolerance window of a finger with a robot, or rehearse that on a simulated one.

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

#: How long an attempt may take unless the robot says otherwise (``timeout_s``), s.
TIMEOUT_S = 120.0
#: Longest that may be: a day, s.
LONGEST_S = 86_400.0
#: What was inserted is at least so deep, as a share of the depth at which the task counts it as inserted.
LEAST_DEPTH = 0.5
#: How many attempts in a row may be doubtful.
DOUBTFUL = 3


class Robot(Protocol):
    """What can try an insertion.

    ``timeout_s``, if it has one, is how long an attempt may take, s; 120 otherwise.
    """

    def insert(self, offset_mm: float, log: Path | None = None) -> Attempt:
        """Tries to insert from the taught start shifted by ``offset_mm`` along y, the direction in which the
        jaws close; records force and pose in ``log``, if it can; leaves the robot ready for the next."""
        ...


class Probing(Robot, Protocol):
    """A robot that can also tell the friction."""

    def probe(self, log: Path) -> None:
        """Sets the plug down on the flat face beside the opening, slides it slowly back and forth along y, and
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

    The start is shifted outward by ``step_mm`` until two neighbouring starts fail, at most by ``limit_mm``.
    Then each end is a logistic curve, known by Bayes' rule from all attempts on its side (prior: its place
    uniform, its width from 90 to 10 % log-normal around 0.4 mm by a factor of 2, 1 attempt of 100 wrong
    for other reasons). The next start, a multiple of ``resolution_mm``, is the one whose outcome is expected
    to tell most of the end's place, until its standard deviation is ``resolution_mm`` and, within a step,
    ``repeats`` attempts inserted inside it and ``repeats`` failed outside. Starts that keep failing where
    others beyond insert are a gap, and no part of the curve.

    Each attempt is on the disk, in a file beside ``out``, before the next begins: the same call goes on
    there after whatever ended it. A window that was measured today is not measured again.

    With ``probe``, for which the robot is a :class:`Probing` one, it begins with the probe. The logs of probe and
    attempts, as far as the robot records and it is known how they ended, are lines of ``runs.csv`` beside
    ``out``, which all fingers measured into that folder share: what ``optimize identify`` reads.

    With ``progress``, each attempt is a line on standard error.

    Raises :class:`InputError`, before the robot moves, for wrong arguments and while another process measures the
    same finger into the same folder; and :class:`StudyError` if the robot raises, takes longer than its
    ``timeout_s``, reports what cannot be (three times in a row; once it is marked and tried again), if a file
    cannot be written, or if the taught start does not insert.
    """
    search = _checked(Search(float(step_mm), float(resolution_mm), float(limit_mm), int(repeats)), attempts_max)
    timeout_s = _timeout(robot)
    prober = robot if probe and _can_probe(robot) else None
    if probe and prober is None:
        raise InputError(f"probe: {type(robot).__name__} has no method probe(log); give it one, or probe=False")
    bench = Bench(Path(out), task, density, direction)
    try:
        with closing(bench.attempts(search)) as attempts:
            date = attempts.settings["date"]
            ended = bench.written(date)
            runs = Runs(bench.out.parent, bench.task.name, bench.finger, attempts)
            course = _Course(robot, search, attempts, runs, bench.task.success.depth_mm, timeout_s, progress)
            if prober is not None and attempts.probed is None:
                course.probe(prober)
            measured = course.run(0 if ended else attempts_max)
            bench.write(measured, date)
    except OSError as error:
        raise StudyError(f"{error.filename or bench.out}: {error.strerror or error}") from error
    return measured


def _timeout(robot: object) -> float:
    """How long an attempt of a robot may take, s."""
    given = getattr(robot, "timeout_s", TIMEOUT_S)
    found = number(given)
    if found is None or not 0.0 < found <= LONGEST_S:
        raise wrong("robot", f"its timeout_s is {shown(given)}; it must be a time above 0, {LONGEST_S:g} s at most")
    return found


def _can_probe(robot: Robot) -> TypeGuard[Probing]:
    return callable(getattr(robot, "probe", None))


def _checked(search: Search, attempts_max: int) -> Search:
    lengths = (search.resolution_mm, search.step_mm, search.limit_mm)
    # Written so that a NaN is outside.
    if not 0.01 <= lengths[0] <= lengths[1] <= lengths[2] <= 100.0:
        raise InputError(
            "resolution_mm, step_mm, limit_mm: are lengths in mm, each at most the next, from 0.01 to 100; "
            f"given {', '.join(f'{length:g}' for length in lengths)}"
        )
    if search.limit_mm > 1000.0 * search.resolution_mm:
        raise InputError("limit_mm: is at most 1000 times resolution_mm")
    for name, count in (("repeats", search.repeats), ("attempts_max", attempts_max)):
        if not 1 <= count <= 10_000:
            raise InputError(f"{name}: is {count}; it is a number from 1 to 10000")
    return search


def bag_to_csv(bag: StrPath, out: StrPath, **topics: str) -> None:
    """Writes the log of a ROS 1 or ROS 2 recording as a table that ``identify`` reads, in the base's frame.

    ``identify`` reads a recording itself; this names the topics where there are several: ``force`` (WrenchStamped),
    ``pose`` and ``target`` (PoseStamped). Needs the extra ``ros``.
    """
    unknown = set(topics) - {"force", "pose", "target"}
    if unknown:
        raise TypeError(f"bag_to_csv() has no keyword {min(unknown)!r}; it has force, pose and target")
    try:
        Path(out).write_text(text(bag, topics), encoding="utf-8")
    except ValueError as error:
        raise InputError(f"{os.fspath(bag)}: {error}") from error


class _Course:
    """The attempts of one measurement, one after the other."""

    def __init__(
        self, robot: Robot, search: Search, attempts: Attempts, runs: Runs, depth_mm: float, timeout_s: float,
        progress: bool,
    ) -> None:
        self.robot, self.search, self.attempts, self.runs = robot, search, attempts, runs
        self.depth_mm, self.timeout_s, self.progress = depth_mm, timeout_s, progress

    def run(self, attempts_max: int) -> Measurement:
        in_doubt = 0
        while True:
            tried = [(one.offset_mm, one.attempt.inserted) for one in self.attempts.counted()]
            window = Window(self.search, tried)
            offset = window.next()
            if offset is None or len(self.attempts.tried) >= attempts_max:
                break
            done = self.attempt(offset)
            self.attempts.add(done)
            self.runs.add(done)
            self.show(done)
            in_doubt = in_doubt + 1 if done.doubt else 0
            if in_doubt == DOUBTFUL:
                raise self.stopped(offset, f"{DOUBTFUL} attempts in a row cannot be: {done.doubt}")
        if not window.inserts:
            why = "the taught start does not insert: teach another; if none inserts, note it by "
            raise self.stopped(0.0, why + "`optimize measure add --not-measurable`")
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
        """The probe, by the robot, which is one that can."""

        def probed(log: Path) -> Path:
            robot.probe(log)
            return log

        log = self.asked("probe", "probe", probed)
        if not (log.is_file() and log.stat().st_size):
            raise self.stopped("probe", f"the robot recorded nothing in {log}")
        self.attempts.add_probe(log)
        self.runs.add_probe(log)

    def attempt(self, offset: float) -> Tried:
        """One attempt, and whether it can be believed."""
        name = f"{self.attempts.made + 1:03}"
        done = self.asked(offset, name, lambda log: self.robot.insert(offset, log))
        if not isinstance(done, Attempt):
            raise self.stopped(offset, f"the robot returned {shown(done)}, which is no Attempt")
        # What can be believed of it, and why not all of it.
        doubts: list[str] = []
        known: dict[str, Any] = {"inserted": False, "failure": None, "depth_mm": 0.0, "peak_force_n": 0.0, "log": None}
        for key in known:
            try:
                known[key] = taken(key, getattr(done, key))
            except ValueError as lie:
                doubts.append(str(lie))
        done = Attempt(**known)
        doubt = doubts[0] if doubts else self.doubt(done)
        return Tried(offset, replace(done, failure=None) if doubt else done, doubt)

    def asked(self, what: float | str, name: str, ask: Callable[[Path], T]) -> T:
        """What the robot answers, given where to record; the measurement stops if it raises."""
        folder = self.attempts.path.with_suffix("")
        folder.mkdir(exist_ok=True)
        try:
            return self.in_time(lambda: ask(folder / f"{name}.csv"))
        except (Exception, SystemExit) as error:
            raise self.stopped(what, f"the robot raised {named(error)}") from error
        finally:
            # Of use only to a robot that records.
            with suppress(OSError):
                folder.rmdir()

    def in_time(self, ask: Callable[[], T]) -> T:
        """What the robot returns, or raises; itself an error if that takes too long."""
        ended: list[T] = []
        failed: list[BaseException] = []

        def answer() -> None:
            try:
                ended.append(ask())
            except BaseException as error:
                failed.append(error)

        # A thread that hangs does not keep the process.
        thread = threading.Thread(target=answer, daemon=True)
        thread.start()
        thread.join(self.timeout_s)
        if failed:
            raise failed[0]
        if not ended:
            raise TimeoutError(f"no answer within {self.timeout_s:g} s; look at the robot before it goes on")
        return ended[0]

    def doubt(self, done: Attempt) -> str | None:
        """Why an attempt cannot be as it is reported, though each of its numbers could."""
        if done.inserted and done.failure is not None:
            return f"inserted, and failed with class {done.failure}"
        if done.inserted and done.depth_mm < LEAST_DEPTH * self.depth_mm:
            return f"inserted at a depth of {done.depth_mm:g} mm; the task counts from {self.depth_mm:g} mm on"
        return None

    def stopped(self, what: float | str, why: str) -> StudyError:
        """The error that stops the measurement at a start, mm, or at what else was asked of the robot."""
        self.attempts.stopped(what, why)
        kept = f"what was measured is in {self.attempts.path}; the same call goes on there"
        return StudyError(f"{what if isinstance(what, str) else f'start {what:+g} mm'}: {why}\n{kept}")

    def measurement(self, window: Window, settled: bool) -> Measurement:
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
        """The class met most, in a gap or beyond the end."""
        gaps = {start for run in side.gaps for start in run}
        classes = Counter(
            one.attempt.failure
            for one in self.attempts.counted()
            if not one.attempt.inserted and one.attempt.failure is not None and one.offset_mm * side.sign >= 0.0
            and (abs(one.offset_mm) in among if among else abs(one.offset_mm) not in gaps)
        )
        return classes.most_common(1)[0][0] if classes else None

    def gap(self, side: Side, run: list[float]) -> Gap:
        inserted = [start for start, tally in side.tallies.items() if tally.inserted]
        within = max(s for s in inserted if s < run[0]), min(s for s in inserted if s > run[-1])
        failed = _outward(side.sign, run[0], run[-1])
        return Gap(failed, _outward(side.sign, *within), self.failure(side, run))


def _outward(sign: int, near: float, far: float) -> tuple[float, float]:
    """Two lengths outward as places along y, the lower first."""
    return (near, far) if sign > 0 else (-far, -near)


def _end(side: Side) -> tuple[float | None, tuple[float, float] | None]:
    """The end in mm along y, and its interval."""
    if side.open:
        return None, None
    rest = (1.0 - INTERVAL) / 2.0
    low, middle, high = (round(side.quantile(share), 2) for share in (rest, 0.5, 1.0 - rest))
    # A start is not set finer than 0.02 mm, and a file with less is refused.
    middle = middle if middle >= 0.02 else 0.0
    return side.sign * middle + 0.0, _outward(side.sign, low, high)
