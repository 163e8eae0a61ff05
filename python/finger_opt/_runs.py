"""The file that says of each log what it is of: what ``optimize identify`` reads."""

from __future__ import annotations

import csv
import io
import os
import re
import warnings
from pathlib import Path

from ._attempts import Attempts, Tried
from ._native import InputError

#: Its columns.
COLUMNS = ["log", "infill_density_percent", "infill_direction_deg", "offset_mm", "outcome"]


class Runs:
    """``runs.csv`` in a folder, with a line for each log of all fingers measured into that folder."""

    def __init__(self, folder: Path, task: str, finger: dict[str, str], attempts: Attempts) -> None:
        """Adds what the attempts have and the file, since a measurement was killed, has not."""
        self.path, self.task, self.finger = folder / "runs.csv", task, finger
        for log in self._logs(self._whole()):
            self._check(log)
        if attempts.probed is not None:
            self.add_probe(attempts.probed)
        for tried in attempts.tried:
            self.add(tried)

    def _whole(self) -> bytes:
        """The lines so far; one that was cut off does not count."""
        text = self.path.read_bytes() if self.path.exists() else b""
        return text[: text.rfind(b"\n") + 1]

    def _logs(self, text: bytes) -> list[str]:
        lines = text.decode("utf-8-sig", "replace").splitlines()
        rows = csv.DictReader(line for line in lines if not line.startswith("#"))
        columns = list(rows.fieldnames or COLUMNS)
        if columns[: len(COLUMNS)] != COLUMNS:
            raise InputError(f"{self.path}: line 1: begins with {','.join(columns)}, not {','.join(COLUMNS)}; "
                             "move the file away to begin anew")
        return [row["log"] for row in rows]

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
        """Appends a line, unless the log has one, and returns once it is on the disk."""
        if not log.is_file():
            warnings.warn(f"{log}: the robot names this log, and there is no such file; {self.path} leaves it out",
                          stacklevel=2)
            return
        whole = self._whole()
        named = Path(os.path.relpath(log, self.path.parent)).as_posix()
        if named in self._logs(whole):
            return
        line = io.StringIO()
        writer = csv.writer(line, lineterminator="\n")
        if not whole:
            writer.writerow(COLUMNS)
        writer.writerow((named, *self.finger.values(), offset, outcome))
        with self.path.open("r+b" if self.path.exists() else "x+b") as file:
            file.truncate(len(whole))
            file.seek(len(whole))
            file.write(line.getvalue().encode())
            file.flush()
            os.fsync(file.fileno())
