"""List of logs with finger, start and outcome, which ``optimize identify`` reads."""

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

#: Columns of ``runs.csv``.
COLUMNS = ["log", "infill_density_percent", "infill_direction_deg", "offset_mm", "outcome"]


class Runs:
    """File ``runs.csv`` in a folder, with a line for each log of all fingers measured in that folder."""

    def __init__(self, folder: Path, task: str, finger: dict[str, str], attempts: Attempts) -> None:
        """Checks the file, and adds attempts that it lacks because a measurement was killed."""
        self.path, self.task, self.finger = folder / "runs.csv", task, finger
        for log in self._logs(self.path.read_bytes() if self.path.exists() else b""):
            self._check(log)
        if attempts.probed is not None:
            self.add_probe(attempts.probed)
        for tried in attempts.tried:
            self.add(tried)

    def _logs(self, text: bytes) -> list[str]:
        """Returns the logs of all lines except an incomplete last one; raises InputError for other columns."""
        header, *lines = rows(self.path, text[: text.rfind(b"\n") + 1]) or [COLUMNS]
        if header[: len(COLUMNS)] != COLUMNS:
            raise InputError(f"{self.path}: line 1: the columns are {','.join(header)}, not {','.join(COLUMNS)}; "
                             "move the file away to start again")
        return [cells[0] for cells in lines]

    def _check(self, log: str) -> None:
        """Checks that a log belongs to this task, by the name of its folder; raises InputError otherwise."""
        measured = re.fullmatch(r"(.+)-[\d.]+-[\d.]+-\d{4}-\d\d-\d\d", Path(log).parent.name)
        if measured and not measured[1].endswith(f"-{self.task}"):
            raise InputError(f"{self.path}: lists {log}, which is not a log of {self.task}; "
                             "use a separate folder for each task")

    def add(self, tried: Tried) -> None:
        """Adds the log of an attempt, if the attempt counts and its log and outcome are known."""
        attempt = tried.attempt
        outcome = "inserted" if attempt.inserted else attempt.failure
        if attempt.log is not None and outcome is not None and tried.doubt is None:
            self._add(Path(attempt.log), f"{tried.offset_mm:g}", str(outcome))

    def add_probe(self, log: Path) -> None:
        """Adds the log of the probe."""
        self._add(log, "", "probe")

    def _add(self, log: Path, offset: str, outcome: str) -> None:
        """Appends a line, unless the log has one, and flushes it to the disk.

        The file is locked meanwhile, since other fingers may be measured in the folder at the same time.
        """
        if not log.is_file():
            warnings.warn(f"{log}: the robot returned this log, but the file does not exist; {self.path} omits it",
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
            complete = text.rfind(b"\n") + 1
            if not complete:
                writer.writerow(COLUMNS)
            writer.writerow((named, *self.finger.values(), offset, outcome))
            file.truncate(complete)
            file.write(line.getvalue().encode())
            file.flush()
            os.fsync(file.fileno())
