"""Task files as Python objects."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Union

from . import _native
from ._json import dumps, is_list, is_table, word
from ._words import StrPath, TaskName
from .errors import InputError


class Fields:
    """One table of a task file: its keys are attributes, and its tables fields again.

    One of several tables is found by its name or its place: ``strategy.phase["side"]``.
    """

    __slots__ = ("_changed", "_table")

    #: What the file holds: a table (a dict), or several (a list of dicts).
    _table: Any
    #: Checks what was changed.
    _changed: Callable[[], object]

    def __init__(self, table: Any, changed: Callable[[], object]) -> None:
        object.__setattr__(self, "_table", table)
        object.__setattr__(self, "_changed", changed)

    def _wrap(self, value: Any) -> Any:
        tables = is_list(value) and any(is_table(one) for one in value)
        return Fields(value, self._changed) if is_table(value) or tables else value

    def _place(self, key: str | int) -> Any:
        tables = self._table
        if is_list(tables) and isinstance(key, str):
            for place, one in enumerate(tables):
                if one.get("name") == key:
                    return place
            names = ", ".join(str(one.get("name")) for one in tables)
            raise KeyError(f"{key}: there are {names}")
        return key

    def __getitem__(self, key: str | int) -> Any:
        return self._wrap(self._table[self._place(key)])

    def __setitem__(self, key: str | int, value: Any) -> None:
        if isinstance(value, Fields):
            value = value._table
        table, place = self._table, self._place(key)
        known = not is_table(table) or place in table
        before = table[place] if known else None
        table[place] = value
        try:
            self._changed()
        except Exception:
            if known:
                table[place] = before
            else:
                del table[place]
            raise

    def __reduce__(self) -> tuple[Callable[..., Fields], tuple[Any, ...]]:
        return Fields, (copy.deepcopy(self._table), _unchecked)

    def __getattr__(self, key: str) -> Any:
        if is_table(self._table) and key in self._table:
            return self[key]
        there = f"; there are {', '.join(self._table)}" if is_table(self._table) else ""
        raise AttributeError(f"no field is called `{key}`{there}")

    def __setattr__(self, key: str, value: Any) -> None:
        try:
            self[key] = value
        except InputError as error:
            # Files refuse a key that they do not know; an attribute that does not exist is Python's own error.
            unknown = f"unknown field `{key}`"
            if unknown not in str(error):
                raise
            raise AttributeError(unknown + str(error).rpartition(unknown)[2], name=key) from None

    def __iter__(self) -> Iterator[Any]:
        if is_table(self._table):
            return iter(self._table)
        return (self._wrap(one) for one in self._table)

    def __len__(self) -> int:
        return len(self._table)

    def __dir__(self) -> list[str]:
        keys = list(self._table) if is_table(self._table) else []
        return [*keys, *super().__dir__()]

    def __repr__(self) -> str:
        return repr(self._table)


def _unchecked() -> None:
    """The copy of a table belongs to no task, which would check it."""


class Task(Fields):
    """A connector task: plug, socket, grip, friction, search strategy and success.

    Fields are those of the task file (``docs/guide/tasks.md``), each with the unit that its
    key carries. Setting one checks the whole task; what cannot be simulated raises
    :class:`InputError` and changes nothing.

    >>> task = Task.from_toml("usb")
    >>> task.strategy.tilt_deg = 8
    >>> task.strategy.phase["side"].speed_mm_per_s = 40
    """

    __slots__ = ("file",)

    #: What errors call it.
    file: str

    def __init__(self, file: str, text: str) -> None:
        """Of the text of a task file; ``file`` is what errors call it."""
        fields = json.loads(_native.task_fields(file, text))
        super().__init__(fields, self.to_toml)
        object.__setattr__(self, "file", file)

    def __reduce__(self) -> tuple[Callable[..., Task], tuple[str, str]]:
        return type(self), (self.file, self.to_toml())

    @classmethod
    def from_toml(cls, source: TaskName | StrPath) -> Task:
        """The task of a shipped name (``"usb"``), of the file at a path, or of a TOML text."""
        if isinstance(source, str) and "\n" in source:
            return cls("task", source)
        return cls(*_native.task(word(source)))

    def to_toml(self) -> str:
        """The text of the task file, without the comments of the original."""
        return str(_native.task_text(getattr(self, "file", "task"), dumps(self._table)))

    def __repr__(self) -> str:
        return f"<Task {self.name}: {self.description}>"


#: A task: a shipped name, the path of a task file, or the task itself.
Given = Union[TaskName, str, os.PathLike[str], Task]


def sources(task: Given | Iterable[Given] | None) -> str | None:
    """Tasks for the library: names, and of a :class:`Task` what messages call it and its text."""
    if task is None:
        return None
    found: list[str | dict[str, str]] = []
    for one in listed(task):
        if isinstance(one, Task):
            found.append({"file": one.file, "text": one.to_toml()})
        elif isinstance(one, str) and not os.path.isfile(one):
            found += [name.strip() for name in one.split(",") if name]
        elif isinstance(one, (str, os.PathLike)):
            # A path may have a comma in it.
            found.append(os.fspath(one))
        else:
            raise TypeError(f"task: is {one!r}; give a name, the path of a task file, or a Task")
    return "\0" + dumps(word(found))


def listed(task: Given | Iterable[Given]) -> list[Given]:
    """One task, or several."""
    return [task] if isinstance(task, (str, os.PathLike, Task)) else list(task)
