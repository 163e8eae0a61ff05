"""Keywords to words of the command line."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from ._task import Task

#: Options that are given once for each value; the values of others stand in one, by commas.
REPEATED = ("constraint",)


def words(settings: Mapping[str, Any]) -> list[str]:
    """The words of these settings.

    ``True`` gives the option without a value, ``None`` and ``False`` leave it out. A name with
    a dot is a number of the task or the finger (``task.strategy.tilt_deg``), as after ``--set``;
    several of them may also stand in a dict ``set``.
    """
    found: list[str] = []
    for name, value in settings.items():
        if "." in name:
            found.append(f"--set={name}={value}")
        elif name == "set":
            found.extend(f"--set={key}={number}" for key, number in dict(value).items())
        else:
            found.extend(_option("--" + name.rstrip("_").replace("_", "-"), name, value))
    return found


def _option(option: str, name: str, value: Any) -> list[str]:
    if value is None or value is False:
        return []
    if value is True:
        return [option]
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes)):
        if name in REPEATED:
            return [f"{option}={one}" for one in value]
        value = ",".join(str(one) for one in value)
    return [f"{option}={value}"]


def tasks(task: str | Task | Iterable[str | Task]) -> tuple[str, list[tuple[str, str]]]:
    """The word for ``--task``, and the files in its place if any of them is a :class:`Task`."""
    given = [task] if isinstance(task, (str, Task)) else list(task)
    if all(isinstance(one, str) for one in given):
        return ",".join(str(one) for one in given), []
    made = [one if isinstance(one, Task) else Task.from_toml(one) for one in given]
    return ",".join(one.name for one in made), [(one.file, one.to_toml()) for one in made]
