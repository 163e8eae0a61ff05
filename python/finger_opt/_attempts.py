"""Attempts of a robot, and the file in which each stands before the next is made."""

from __future__ import annotations

import glob
import json
import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from ._call import misplaced, number, shown
from ._json import dumps, is_table
from ._lock import locked
from ._native import LARGEST_FORCE_N, LARGEST_LENGTH_MM


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


def _whole(value: object) -> int | None:
    """The failure class that a value is, of any type of number."""
    found = number(value)
    return None if found not in (1, 2, 3, 4) else int(found)


def _truth(value: object) -> bool | None:
    return bool(cast("bool", value)) if isinstance(value, (bool, np.bool_)) else None


def _within(low: float, high: float) -> Callable[[object], float | None]:
    """The number that a value is, if it is within bounds."""

    def found(value: object) -> float | None:
        one = number(value)
        return one if one is not None and low <= one <= high else None

    return found


def _path(value: object) -> Path | None:
    """The path that a value is, from wherever this process is later; it can stand in a line of a file."""
    try:
        text: object = os.fspath(cast("os.PathLike[Any]", value)) if isinstance(value, (str, os.PathLike)) else b""
    except Exception:
        # A path of the caller's making.
        return None
    return Path(os.path.abspath(text)) if isinstance(text, str) and text and text.isprintable() else None


#: What the fields of an attempt may be: how each is taken, and what it must be. Numbers beyond these bounds
#: are in another unit, and the measurement file would refuse them.
FIELDS: dict[str, tuple[Callable[[object], Any], str]] = {
    "inserted": (_truth, "True or False"),
    "failure": (_whole, "a failure class from 1 to 4, or None"),
    "depth_mm": (_within(-LARGEST_LENGTH_MM, LARGEST_LENGTH_MM), f"a depth of at most {LARGEST_LENGTH_MM:g} mm"),
    "peak_force_n": (_within(0.0, LARGEST_FORCE_N), f"a force from 0 to {LARGEST_FORCE_N:g} N"),
    "log": (_path, "the path of a log, without control characters, or None"),
}
#: Those that may be unknown.
OPTIONAL = ("failure", "log")


def taken(key: str, value: object) -> Any:
    """The value of an attempt's field, as plain Python has it; raises ValueError with what is wrong."""
    take, wanted = FIELDS[key]
    found = None if value is None else take(value)
    if found is None and not (value is None and key in OPTIONAL):
        raise ValueError(f"{key} is {shown(value)}; it must be {wanted}")
    return found


class Attempts:
    """The attempts of one measurement: lines of JSON in a file, the first of which says of what."""

    def __init__(self, path: Path, settings: dict[str, Any]) -> None:
        """Begins the file, or goes on where it ends; a line that was cut off does not count.

        Raises :class:`InputError` if another measurement has the file, or if it is not one of these settings.
        """
        self.path, self.settings, self.tried = path, settings, list[Tried]()
        #: The log of the probe, if it was made.
        self.probed: Path | None = None
        self._file = path.open("a+b")
        try:
            self._begin()
        except BaseException:
            self.close()
            raise
        #: How many attempts the file has, also those that do not count any more.
        self.made = len(self.tried)
        # A start that never inserted was taught anew since.
        if not any(one.attempt.inserted for one in self.counted() if one.offset_mm == 0.0):
            self.tried = []

    def _begin(self) -> None:
        if not locked(self._file, wait=False):
            problem = "another process measures this finger; wait until it has ended"
            raise misplaced(self.path, None, None, problem)
        self._file.seek(0)
        text = self._file.read()
        whole = text[: text.rfind(b"\n") + 1]
        lines = list(self._lines(whole))
        for key, now in self.settings.items() if lines else ():
            if key != "version" and lines[0].get(key) != now:
                problem = (f"was begun with {key} {shown(lines[0].get(key))}, not {now}; "
                           "go on with the same, or move the file away to begin anew")
                raise misplaced(self.path, None, key, problem)
        self._file.truncate(len(whole))
        if not lines:
            self._append(self.settings)
            _sync_folder(self.path.parent)
        for at, line in enumerate(lines[1:], 2):
            if "probed" in line:
                self.probed = self._field(line, "probed", "log", at)
            elif "stopped" not in line:
                self.tried.append(self._read(line, at))

    def _lines(self, text: bytes) -> Iterator[dict[str, Any]]:
        for at, line in enumerate(text.split(b"\n")[:-1], 1):
            try:
                fields = json.loads(line)
            except (ValueError, RecursionError):
                fields = None
            if not is_table(fields):
                raise misplaced(self.path, at, None, "is no attempt; move the file away to begin anew")
            yield fields

    def _field(self, line: dict[str, Any], key: str, field: str, at: int) -> Any:
        value = line.get(key)
        if field == "log" and isinstance(value, str) and (self.path.parent / value).is_file():
            # Up to 0.5.0 as the robot was given it: from its working folder, most often this one.
            value = self.path.parent / value
        try:
            return taken(field, value)
        except ValueError as wrong:
            raise misplaced(self.path, at, key, str(wrong).replace(f"{field} ", "", 1)) from None

    def _read(self, line: dict[str, Any], at: int) -> Tried:
        known = {"offset_mm", "doubt", *FIELDS}
        for key in sorted(known ^ line.keys()):
            raise misplaced(self.path, at, key, "is missing" if key in known else "is no field of an attempt")
        offset, doubt = number(line["offset_mm"]), line["doubt"]
        limit = self.settings["limit_mm"]
        if offset is None or abs(offset) > limit + 1e-6:
            problem = f"is {shown(line['offset_mm'])}; it must be a start within the limit, {limit:g} mm"
            raise misplaced(self.path, at, "offset_mm", problem)
        if not isinstance(doubt, (str, type(None))):
            raise misplaced(self.path, at, "doubt", f"is {shown(doubt)}; it must be text, or None")
        fields = {key: self._field(line, key, key, at) for key in FIELDS}
        return Tried(offset, Attempt(**fields), doubt)

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
