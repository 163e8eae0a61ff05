"""Attempts of a robot, and the file in which each stands before the next is made."""

from __future__ import annotations

import glob
import json
import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from ._json import dumps
from ._native import InputError


@dataclass(frozen=True)
class Attempt:
    """How one insertion ended.

    ``failure`` is the class 1 to 4 of what did not insert, if it is known; ``depth_mm`` how deep the tip is in
    the socket at the end; ``peak_force_n`` the largest contact force; ``log`` what was recorded, if it was.
    """

    inserted: bool
    failure: int | None
    depth_mm: float
    peak_force_n: float
    log: Path | None = None


@dataclass(frozen=True)
class Tried:
    """An attempt from a start shifted by ``offset_mm``; ``doubt`` says why it does not count, if so."""

    offset_mm: float
    attempt: Attempt
    doubt: str | None = None


class Attempts:
    """The attempts of one measurement: lines of JSON in a file, the first of which says of what."""

    def __init__(self, path: Path, settings: dict[str, Any]) -> None:
        """Begins the file, or goes on where it ends; a line that was cut off does not count."""
        self.path, self.tried = path, list[Tried]()
        #: The log of the probe, if it was made.
        self.probed: Path | None = None
        text = path.read_bytes() if path.exists() else b""
        whole = text[: text.rfind(b"\n") + 1]
        lines = list(self._lines(whole))
        self.settings = lines[0] if lines else settings
        for key, now in settings.items():
            if key not in ("date", "version") and self.settings.get(key) != now:
                raise InputError(
                    f"{path}: was begun with {key} {self.settings.get(key)}, not {now}; "
                    "go on with the same, or move the file away to begin anew"
                )
        self._file = path.open("r+b" if path.exists() else "x+b")
        self._file.truncate(len(whole))
        self._file.seek(len(whole))
        if not lines:
            self._append(settings)
            _sync_folder(path.parent)
        for number, line in enumerate(lines[1:], 2):
            if "probed" in line:
                self.probed = Path(line["probed"])
            elif "stopped" not in line:
                self.tried.append(self._read(line, number))
        #: How many attempts the file has, also those that do not count any more.
        self.made = len(self.tried)
        # A start that never inserted was taught anew since.
        if not any(one.attempt.inserted for one in self.counted() if one.offset_mm == 0.0):
            self.tried = []

    def _lines(self, text: bytes) -> Iterator[dict[str, Any]]:
        for number, line in enumerate(text.splitlines(), 1):
            try:
                fields = json.loads(line)
            except ValueError:
                fields = None
            if not isinstance(fields, dict):
                raise InputError(f"{self.path}: line {number}: is no attempt; move the file away to begin anew")
            yield fields

    def _read(self, line: dict[str, Any], number: int) -> Tried:
        try:
            offset, doubt, log = line.pop("offset_mm"), line.pop("doubt"), line.pop("log")
            return Tried(offset, Attempt(**line, log=None if log is None else Path(log)), doubt)
        except (KeyError, TypeError) as error:
            raise InputError(f"{self.path}: line {number}: is no attempt: {error}") from None

    def counted(self) -> list[Tried]:
        """Those that are no doubt."""
        return [one for one in self.tried if one.doubt is None]

    def add(self, tried: Tried) -> None:
        """Appends an attempt, and returns once it is on the disk."""
        fields = {"offset_mm": tried.offset_mm, **asdict(tried.attempt), "doubt": tried.doubt}
        fields["log"] = None if tried.attempt.log is None else str(tried.attempt.log)
        self._append(fields)
        self.tried.append(tried)
        self.made += 1

    def add_probe(self, log: Path) -> None:
        """Appends that the probe was made, as its log tells."""
        self._append({"probed": str(log)})
        self.probed = log

    def stopped(self, what: float | str, why: str) -> None:
        """Writes down why there is no attempt from a start, mm, or no probe."""
        self._append({"stopped": why, **({} if isinstance(what, str) else {"offset_mm": what})})

    def _append(self, fields: dict[str, Any]) -> None:
        self._file.write(dumps(fields).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        self._file.close()


def newest(stem: Path) -> str | None:
    """The day of the last file of attempts ``<stem>-<day>.jsonl``."""
    found = glob.glob(f"{glob.escape(str(stem))}-[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9].jsonl")
    return max(found)[-len("2026-03-31.jsonl") : -len(".jsonl")] if found else None


def _sync_folder(folder: Path) -> None:
    # Not every system can.
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
