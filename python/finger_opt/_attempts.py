"""Attempts of a robot, and the file to which each is written before the next one starts."""

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
    """Result of one attempted insertion.

    ``failure`` is the failure class, 1 to 4, if it failed and the class is known; ``depth_mm`` the final depth of the
    tip in the socket; ``peak_force_n`` the largest contact force; ``log`` the file of the recording, if there is one.
    """

    inserted: bool
    failure: int | None
    depth_mm: float
    peak_force_n: float
    log: Path | None = None


@dataclass(frozen=True)
class Tried:
    """An attempt from a start shifted by ``offset_mm``; ``doubt`` is the reason if it does not count."""

    offset_mm: float
    attempt: Attempt
    doubt: str | None = None


def _failure_class(value: object) -> int | None:
    """Returns a value as failure class, 1 to 4; None if it is not one."""
    found = number(value)
    return None if found not in (1, 2, 3, 4) else int(found)


def _boolean(value: object) -> bool | None:
    """Returns a boolean of Python or NumPy; None for other values."""
    return bool(cast("bool", value)) if isinstance(value, (bool, np.bool_)) else None


def _within(low: float, high: float) -> Callable[[object], float | None]:
    """Returns a function that returns a value as float if it is a number within the bounds, otherwise None."""

    def checked(value: object) -> float | None:
        found = number(value)
        return found if found is not None and low <= found <= high else None

    return checked


def _path(value: object) -> Path | None:
    """Returns a value as absolute path; None if it is not a path, or not printable."""
    try:
        text: object = os.fspath(cast("os.PathLike[Any]", value)) if isinstance(value, (str, os.PathLike)) else b""
    except Exception:
        # `__fspath__` of the caller raised.
        return None
    return Path(os.path.abspath(text)) if isinstance(text, str) and text and text.isprintable() else None


#: Conversion of each field of an attempt, and the description of accepted values. Numbers outside these bounds are
#: probably in another unit; the measurement file does not accept them either.
FIELDS: dict[str, tuple[Callable[[object], Any], str]] = {
    "inserted": (_boolean, "True or False"),
    "failure": (_failure_class, "a failure class from 1 to 4, or None"),
    "depth_mm": (_within(-LARGEST_LENGTH_MM, LARGEST_LENGTH_MM), f"a depth of at most {LARGEST_LENGTH_MM:g} mm"),
    "peak_force_n": (_within(0.0, LARGEST_FORCE_N), f"a force from 0 to {LARGEST_FORCE_N:g} N"),
    "log": (_path, "the path of a log, without control characters, or None"),
}
#: Fields that may be None.
OPTIONAL = ("failure", "log")


def taken(key: str, value: object) -> Any:
    """Returns a field of an attempt as a plain Python value; raises ValueError if it is invalid."""
    convert, accepted = FIELDS[key]
    found = None if value is None else convert(value)
    if found is None and not (value is None and key in OPTIONAL):
        raise ValueError(f"{key} is {shown(value)}; it must be {accepted}")
    return found


class Attempts:
    """The attempts of one measurement: a file of JSON lines, the first of which contains the settings."""

    def __init__(self, path: Path, settings: dict[str, Any]) -> None:
        """Creates or continues the file; an incomplete last line is removed.

        Raises :class:`InputError` if another process has the file open, or if its settings differ.
        """
        self.path, self.settings, self.tried = path, settings, list[Tried]()
        #: The log of the probe, if the robot has probed.
        self.probed: Path | None = None
        self._file = path.open("a+b")
        try:
            self._begin()
        except BaseException:
            self.close()
            raise
        #: Number of attempts in the file, including discarded ones.
        self.made = len(self.tried)
        # If no attempt from the taught start inserted, it has been taught anew: discard all attempts.
        if not any(one.attempt.inserted for one in self.counted() if one.offset_mm == 0.0):
            self.tried = []

    def _begin(self) -> None:
        """Locks the file, checks its settings and reads its attempts; writes the settings if it is new."""
        if not locked(self._file, wait=False):
            problem = "another process is measuring this finger; wait until it has ended"
            raise misplaced(self.path, None, None, problem)
        self._file.seek(0)
        text = self._file.read()
        complete = text[: text.rfind(b"\n") + 1]
        lines = list(self._lines(complete))
        for key, value in self.settings.items() if lines else ():
            if key != "version" and lines[0].get(key) != value:
                problem = (f"was started with {key} {shown(lines[0].get(key))}, not {value}; "
                           "use the same value, or move the file away to start again")
                raise misplaced(self.path, None, key, problem)
        self._file.truncate(len(complete))
        if not lines:
            self._append(self.settings)
            _sync_folder(self.path.parent)
        for at, line in enumerate(lines[1:], 2):
            if "probed" in line:
                self.probed = self._field(line, "probed", "log", at)
            elif "stopped" not in line:
                self.tried.append(self._read(line, at))

    def _lines(self, text: bytes) -> Iterator[dict[str, Any]]:
        """Yields the JSON object of each complete line."""
        for at, line in enumerate(text.split(b"\n")[:-1], 1):
            try:
                fields = json.loads(line)
            except (ValueError, RecursionError):
                fields = None
            if not is_table(fields):
                raise misplaced(self.path, at, None, "is not an attempt; move the file away to start again")
            yield fields

    def _field(self, line: dict[str, Any], key: str, field: str, at: int) -> Any:
        """Returns the value of ``key`` in line ``at``, checked like ``field`` of an attempt."""
        value = line.get(key)
        if field == "log" and isinstance(value, str) and (self.path.parent / value).is_file():
            # Up to version 0.5.0, paths were relative to the working folder, which usually was this folder.
            value = self.path.parent / value
        try:
            return taken(field, value)
        except ValueError as wrong:
            raise misplaced(self.path, at, key, str(wrong).replace(f"{field} ", "", 1)) from None

    def _read(self, line: dict[str, Any], at: int) -> Tried:
        """Returns the attempt of line ``at``; raises InputError for missing, unknown or invalid fields."""
        known = {"offset_mm", "doubt", *FIELDS}
        for key in sorted(known ^ line.keys()):
            raise misplaced(self.path, at, key, "is missing" if key in known else "is not a field of an attempt")
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
        """Returns the attempts that count."""
        return [one for one in self.tried if one.doubt is None]

    def add(self, tried: Tried) -> None:
        """Appends an attempt and flushes it to the disk."""
        fields = {"offset_mm": tried.offset_mm, **asdict(tried.attempt), "doubt": tried.doubt}
        fields["log"] = None if tried.attempt.log is None else str(tried.attempt.log)
        self._append(fields)
        self.tried.append(tried)
        self.made += 1

    def add_probe(self, log: Path) -> None:
        """Appends the log of the probe."""
        self._append({"probed": str(log)})
        self.probed = log

    def stopped(self, at: float | str, why: str) -> None:
        """Appends the reason why the measurement stopped at a start, mm, or at the probe (text)."""
        self._append({"stopped": why, **({} if isinstance(at, str) else {"offset_mm": at})})

    def _append(self, fields: dict[str, Any]) -> None:
        self._file.write(dumps(fields).encode() + b"\n")
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        self._file.close()


def newest(stem: Path) -> str | None:
    """Returns the date of the latest file of attempts ``<stem>-<date>.jsonl``, None if there is none."""
    found = glob.glob(f"{glob.escape(str(stem))}-[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9].jsonl")
    return max(found)[-len("2026-03-31.jsonl") : -len(".jsonl")] if found else None


def _sync_folder(folder: Path) -> None:
    # Not supported on every system.
    with suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
