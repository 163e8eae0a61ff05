"""The measurement file to which windows measured by a robot are written."""

from __future__ import annotations

import datetime
import os
import threading
from pathlib import Path
from typing import get_args

from ._attempts import Attempts, newest
from ._call import called
from ._ends import Search
from ._measurement import Measurement
from ._native import InputError, StudyError, __version__
from ._result import Found
from ._table import rows
from ._task import Given, Task
from ._words import TaskName

#: Beginning of the notes written here, which identifies the lines.
NOTE = "50 % points"


class Bench:
    """The measurement file, and the line of one finger in it."""

    def __init__(self, out: Path, task: Given, density: float, direction: float) -> None:
        if not out.parent.is_dir():
            raise InputError(f"{out}: there is no folder {out.parent}")
        # Absolute, since the robot may change the working folder of this process.
        self.out = Path(os.path.abspath(out))
        self.task = task if isinstance(task, Task) else Task.from_toml(task)
        #: Name or path of the task; None for a `Task` or a TOML text, which may differ from every file.
        self.task_source = None if isinstance(task, Task) or "\n" in str(task) else _absolute(str(task))
        infill = {"infill_density_percent": density, "infill_direction_deg": direction}
        self.finger = {key: f"{float(value):.10g}" for key, value in infill.items()}

    def attempts(self, search: Search) -> Attempts:
        """Returns the attempts of the unfinished measurement or of today's, otherwise a new file."""
        density, direction = self.finger.values()
        stem = self.out.with_name(f"{self.out.stem}-{self.task.name}-{density}-{direction}")
        date = datetime.date.today().isoformat()
        last = newest(stem)
        if last is not None and not self.written(last):
            date = last
        self.check(date)
        settings = {"task": self.task.name, "version": __version__, **self.finger, **vars(search), "date": date}
        return Attempts(Path(f"{stem}-{date}.jsonl"), settings)

    def written(self, date: str) -> bool:
        """Returns whether the file has a line of this finger, written by this module, with this date."""
        wanted = {"task": self.task.name, **self.finger, "date": date}
        try:
            content = self.out.read_bytes()
        except FileNotFoundError:
            # A dry run for another finger can create and remove the file at any moment.
            return False
        header, *lines = rows(self.out, content) or [[]]
        found = [row for row in (dict(zip(header, line)) for line in lines) if wanted.items() <= row.items()]
        return any(row.get("note", "").startswith(NOTE) for row in found)

    def check(self, date: str) -> None:
        """Checks, before the robot moves, that a line with this date can be added."""
        if self.written(date):
            return
        self.add({"range_mm": "1", "date": date}, True)

    def write(self, measured: Measurement, date: str) -> None:
        """Adds the line of the measurement, unless the file has it."""
        if self.written(date):
            return
        ends = {"negative_mm": measured.negative_mm, "positive_mm": measured.positive_mm}
        if measured.range_mm is None:
            # The file cannot express an open end: write only the farther one, as a lower bound of the range.
            farthest = zip(ends, ends.values(), measured.inserted_mm, strict=True)
            bounds = {key: inserted if end is None else end for key, end, inserted in farthest}
            widest = max(bounds, key=lambda key: abs(bounds[key]))
            ends = {widest: bounds[widest]}
        cells = {key: f"{end:g}" for key, end in ends.items()}
        for key in ("failure_negative", "failure_positive"):
            if getattr(measured, key) is not None:
                cells[key] = str(getattr(measured, key))
        cells |= {"peak_force_n": f"{measured.peak_force_n:.1f}", "date": date, "note": _note(measured)}
        self.add(cells)

    def add(self, cells: dict[str, str], dry_run: bool = False) -> None:
        """Adds a line; with ``dry_run``, only checks that it can be added."""
        task = self.task_source
        if task is None:
            # Store the task beside the measurements, which refer to it.
            task_file = self.out.with_name(f"{self.out.stem}-{self.task.name}.toml")
            _write(task_file, self.task.to_toml())
            task = str(task_file)
        density, direction = self.finger.values()
        try:
            line = {"file": self.out, "task": task, "density": density, "direction": direction, **cells}
            called("measure add", {**line, "dry_run": dry_run}, Found)
        except InputError as failed:
            if dry_run:
                raise
            raise StudyError(str(failed)) from None


def _absolute(task: str) -> str:
    """Returns the name of a shipped task, or the absolute path of a task file."""
    return task if task in get_args(TaskName) else os.path.abspath(task)


def _write(path: Path, text: str) -> None:
    """Writes a file atomically, since another process may measure another finger of the task."""
    temporary = path.with_name(f"{path.name}-{os.getpid()}-{threading.get_ident()}")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)


def _note(measured: Measurement) -> str:
    """Returns the note of a line: intervals, gaps and number of attempts."""

    def bounds(interval: tuple[float, float] | None) -> str:
        return "not met" if interval is None else f"{interval[0]:g} to {interval[1]:g}"

    parts = [f"{NOTE} (95 %: {bounds(measured.negative_interval_mm)}; {bounds(measured.positive_interval_mm)})"]
    parts += [
        f"gap at {gap.failed_mm[0]:g} to {gap.failed_mm[1]:g} mm within {gap.within_mm[0]:g} to {gap.within_mm[1]:g}"
        + (f" (class {gap.failure})" if gap.failure else "")
        for gap in measured.gaps
    ]
    parts.append(f"{measured.attempts} attempts" + (f", {measured.doubtful} doubtful" if measured.doubtful else ""))
    return "; ".join(parts if measured.settled else [*parts, "ended before both ends were known"])
