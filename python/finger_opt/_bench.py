"""The measurement file of a window that a robot measures."""

from __future__ import annotations

import csv
import datetime
import os
from pathlib import Path

from ._attempts import Attempts, newest
from ._call import called
from ._ends import Search
from ._measurement import Measurement
from ._native import InputError, StudyError, __version__
from ._result import Found
from ._task import Given, Task

#: How the note of a line begins.
NOTE = "50 % points"


class Bench:
    """The measurement file, and the line of this finger in it."""

    def __init__(self, out: Path, task: Given, density: float, direction: float) -> None:
        if not out.parent.is_dir():
            raise InputError(f"{out}: there is no folder {out.parent}")
        self.out = out
        self.task = task if isinstance(task, Task) else Task.from_toml(task)
        #: The name or the file of the task, if it has one: the caller may have changed a task.
        self.named = None if isinstance(task, Task) or "\n" in str(task) else str(task)
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
        if not self.out.exists():
            return False
        with self.out.open(newline="", encoding="utf-8-sig") as file:
            lines = (line for line in file if not line.startswith("#"))
            rows = [row for row in csv.DictReader(lines) if wanted.items() <= row.items()]
        return any((row.get("note") or "").startswith(NOTE) for row in rows)

    def check(self, date: str) -> None:
        """Whether a line of that day could be added, before the robot moves."""
        if self.written(date):
            return
        # In the same folder, from which the file names the files of tasks.
        copy = self.out.with_name(f".{self.out.stem}-{os.getpid()}.csv")
        try:
            if self.out.exists():
                copy.write_bytes(self.out.read_bytes())
            self.add(copy, {"range_mm": "1", "date": date}, InputError)
        finally:
            copy.unlink(missing_ok=True)

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
        self.add(self.out, cells, StudyError)

    def add(self, file: Path, cells: dict[str, str], error: type[Exception]) -> None:
        task = self.named
        if task is None:
            # Beside the measurements, which name it.
            own = self.out.with_name(f"{self.out.stem}-{self.task.name}.toml")
            own.write_text(self.task.to_toml(), encoding="utf-8")
            task = str(own)
        density, direction = self.finger.values()
        try:
            line = {"file": file, "task": task, "density": density, "direction": direction, **cells}
            called("measure add", line, Found)
        except (InputError, StudyError) as failed:
            raise error(str(failed).replace(str(file), str(self.out))) from None


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
