"""The measurement file of a window that a robot measures."""

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

#: How the note of a line begins.
NOTE = "50 % points"


class Bench:
    """The measurement file, and the line of this finger in it."""

    def __init__(self, out: Path, task: Given, density: float, direction: float) -> None:
        if not out.parent.is_dir():
            raise InputError(f"{out}: there is no folder {out.parent}")
        # Wherever the robot goes: it may change the folder in which this process works.
        self.out = Path(os.path.abspath(out))
        self.task = task if isinstance(task, Task) else Task.from_toml(task)
        #: The name or the file of the task, if it has one: the caller may have changed a task.
        self.named = None if isinstance(task, Task) or "\n" in str(task) else _from_anywhere(str(task))
        infill = {"infill_density_percent": density, "infill_direction_deg": direction}
        self.finger = {key: f"{float(value):.10g}" for key, value in infill.items()}

    def attempts(self, search: Search) -> Attempts:
        """The attempts to go on with: those of a measurement that has not ended, or that ended today."""
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
        """Whether the file has a line of this finger, measured so, of that day."""
        wanted = {"task": self.task.name, **self.finger, "date": date}
        try:
            content = self.out.read_bytes()
        except FileNotFoundError:
            # Also between two looks: while another finger is checked, the file exists for a moment.
            return False
        header, *lines = rows(self.out, content) or [[]]
        found = [row for row in (dict(zip(header, line)) for line in lines) if wanted.items() <= row.items()]
        return any(row.get("note", "").startswith(NOTE) for row in found)

    def check(self, date: str) -> None:
        """Whether a line of that day could be added, before the robot moves."""
        if self.written(date):
            return
        self.add({"range_mm": "1", "date": date}, True)

    def write(self, measured: Measurement, date: str) -> None:
        """Adds the line, unless it is there."""
        if self.written(date):
            return
        ends = {"negative_mm": measured.negative_mm, "positive_mm": measured.positive_mm}
        if measured.range_mm is None:
            # Of an end that was not met the file knows nothing; the farther one says: so wide, or wider.
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
        """Adds a line, or only checks that it can be added."""
        task = self.named
        if task is None:
            # Beside the measurements, which name it.
            own = self.out.with_name(f"{self.out.stem}-{self.task.name}.toml")
            _write(own, self.task.to_toml())
            task = str(own)
        density, direction = self.finger.values()
        try:
            line = {"file": self.out, "task": task, "density": density, "direction": direction, **cells}
            called("measure add", {**line, "dry_run": dry_run}, Found)
        except InputError as failed:
            if dry_run:
                raise
            raise StudyError(str(failed)) from None


def _from_anywhere(task: str) -> str:
    """The name of a shipped task, or the path of a file from wherever this process is later."""
    return task if task in get_args(TaskName) else os.path.abspath(task)


def _write(path: Path, text: str) -> None:
    """Writes a whole file at once: another finger of the task may be measured at the same time."""
    whole = path.with_name(f"{path.name}-{os.getpid()}-{threading.get_ident()}")
    whole.write_text(text, encoding="utf-8")
    os.replace(whole, path)


def _note(measured: Measurement) -> str:
    def end(interval: tuple[float, float] | None) -> str:
        return "not met" if interval is None else f"{interval[0]:g} to {interval[1]:g}"

    parts = [f"{NOTE} (95 %: {end(measured.negative_interval_mm)}; {end(measured.positive_interval_mm)})"]
    parts += [
        f"gap at {gap.failed_mm[0]:g} to {gap.failed_mm[1]:g} mm within {gap.within_mm[0]:g} to {gap.within_mm[1]:g}"
        + (f" (class {gap.failure})" if gap.failure else "")
        for gap in measured.gaps
    ]
    parts.append(f"{measured.attempts} attempts" + (f", {measured.doubtful} doubtful" if measured.doubtful else ""))
    return "; ".join(parts if measured.settled else [*parts, "ended before both ends were known"])
