"""The file that says of each log what it is of: what ``optimize identify`` reads."""

from __future__ import annotations

import csv
import io
import os
import re
import warnings
from pathlib import Path

from ._attempts import Attempts, Tried
from ._lock import locked
from ._native import InputError
from ._table import rows

#: Its columns.
COLUMNS = ["log", "infill_density_percent", "infill_direction_deg", "offset_mm", "outcome"]


class Runs:
    """``runs.csv`` in a folder, with a line for each log of all fingers measured into that folder."""

    def __init__(self, folder: Path, task: str, finger: dict[str, str], attempts: Attempts) -> None:
        """Adds what the attempts have and the file, since a measurement was killed, has not."""
        self.path, self.task, self.finger = folder / "runs.csv", task, finger
        for log in self._logs(self.path.read_bytes() if self.path.exists() else b""):
            self._check(log)
        if attempts.probed is not None:
            self.add_probe(attempts.probed)
        for tried in attempts.tried:
            self.add(tried)

    def _logs(self, text: bytes) -> list[str]:
        """The logs of the whole lines; one that was cut off does not count."""
        header, *lines = rows(self.path, text[: text.rfind(b"\n") + 1]) or [COLUMNS]
        if header[: len(COLUMNS)] != COLUMNS:
            raise InputError(f"{self.path}: line 1: begins with {','.join(header)}, not {','.join(COLUMNS)}; "
                             "move the file away to begin anew")
        return [cells[0] for cells in lines]

    def _check(self, log: str) -> None:
        """Whether the log, as its folder is named, is of this task."""
        measured = re.fullmatch(r"(.+)-[\d.]+-[\d.]+-\d{4}-\d\d-\d\d", Path(log).parent.name)
        if measured and not measured[1].endswith(f"-{self.task}"):
            raise InputError(f"{self.path}: names {log}, which is not of {self.task}; "
                             "measure each task into a folder of its own")

    def add(self, tried: Tried) -> None:
        """Adds the log of an attempt, if it has one and it is known how it ended."""
        done = tried.attempt
        outcome = "inserted" if done.inserted else done.failure
        if done.log is not None and outcome is not None and tried.doubt is None:
            self._add(Path(done.log), f"{tried.offset_mm:g}", str(outcome))

    def add_probe(self, log: Path) -> None:
        """Adds the log of the probe."""
        self._add(log, "", "probe")

    def _add(self, log: Path, offset: str, outcome: str) -> None:
        """Appends a line, unless the log has one, and returns once it is on the disk.

        Other fingers may be measured into the folder at the same time: the file is locked meanwhile.
        """
        if not log.is_file():
            warnings.warn(f"{log}: the robot names this log, and there is no such file; {self.path} leaves it out",
                          stacklevel=2)
            return
        named = Path(os.path.relpath(log, self.path.parent)).as_posix()
        line = io.StringIO()
        writer = csv.writer(line, lineterminator="\n")
        with self.path.open("a+b") as file:
            locked(file, wait=True)
            file.seek(0)
            text = file.read()
            if named in self._logs(text):
                return
            whole = text.rfind(b"\n") + 1
            if not whole:
                writer.writerow(COLUMNS)
            writer.writerow((named, *self.finger.values(), offset, outcome))
            file.truncate(whole)
            file.write(line.getvalue().encode())
            file.flush()
            os.fsync(file.fileno())
