"""Task files as Python objects."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Union

from . import _native
from ._call import wrong
from ._json import dumps, is_list, is_table, word
from ._words import StrPath, TaskName
from .errors import InputError


class Fields:
    """Table of a task file with its keys as attributes; nested tables are ``Fields``, too.

    An item of an array of tables is accessed by its name or index: ``strategy.phase["side"]``.
    """

    __slots__ = ("_check", "_table")

    #: A table (dict), or an array of tables (list of dicts).
    _table: Any
    #: Function that checks the task after a change.
    _check: Callable[[], object]

    def __init__(self, table: Any, check: Callable[[], object]) -> None:
        object.__setattr__(self, "_table", table)
        object.__setattr__(self, "_check", check)

    def _wrap(self, value: Any) -> Any:
        tables = is_list(value) and any(is_table(one) for one in value)
        return Fields(value, self._check) if is_table(value) or tables else value

    def _resolved(self, key: str | int) -> Any:
        """Returns the index of a named item, or the key itself; raises KeyError for an unknown name."""
        tables = self._table
        if is_list(tables) and isinstance(key, str):
            for index, table in enumerate(tables):
                if table.get("name") == key:
                    return index
            names = ", ".join(str(table.get("name")) for table in tables)
            raise KeyError(f"unknown name `{key}`; available: {names}")
        return key

    def __getitem__(self, key: str | int) -> Any:
        return self._wrap(self._table[self._resolved(key)])

    def __setitem__(self, key: str | int, value: Any) -> None:
        if isinstance(value, Fields):
            value = value._table
        if value is None:
            raise wrong(str(key), "is None; accepted: a number, a text, True or False, a list or a table")
        table, index = self._table, self._resolved(key)
        known = not is_table(table) or index in table
        before = table[index] if known else None
        table[index] = value
        try:
            self._check()
        except Exception:
            if known:
                table[index] = before
            else:
                del table[index]
            raise

    def __reduce__(self) -> tuple[Callable[..., Fields], tuple[Any, ...]]:
        return Fields, (copy.deepcopy(self._table), _unchecked)

    def __getattr__(self, key: str) -> Any:
        if is_table(self._table) and key in self._table:
            return self[key]
        available = f"; available: {', '.join(self._table)}" if is_table(self._table) else ""
        raise AttributeError(f"unknown field `{key}`{available}")

    def __setattr__(self, key: str, value: Any) -> None:
        try:
            self[key] = value
        except InputError as error:
            # The parser reports an unknown key as InputError; for an attribute, Python expects AttributeError.
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
    """Accepts any change: a copied table is not part of a task."""


class Task(Fields):
    """Connector task: plug, socket, grip, friction, search strategy and success criterion.

    The fields are those of the task file (``docs/guide/tasks.md``), whose keys contain the units. Setting a field
    checks the whole task; an invalid value raises :class:`InputError` and is not set.

    >>> task = Task.from_toml("usb")
    >>> task.strategy.tilt_deg = 8
    >>> task.strategy.phase["side"].speed_mm_per_s = 40
    """

    __slots__ = ("file",)

    #: Name of the task in error messages.
    file: str

    def __init__(self, file: str, text: str) -> None:
        """Creates a task from the text of a task file; ``file`` is its name in error messages."""
        fields = json.loads(_native.task_fields(file, text))
        super().__init__(fields, self.to_toml)
        object.__setattr__(self, "file", file)

    def __reduce__(self) -> tuple[Callable[..., Task], tuple[str, str]]:
        return type(self), (self.file, self.to_toml())

    @classmethod
    def from_toml(cls, source: TaskName | StrPath) -> Task:
        """Reads a shipped task (``"usb"``), a task file, or a TOML text (of several lines)."""
        if isinstance(source, str) and "\n" in source:
            return cls("task", source)
        return cls(*_native.task(word(source)))

    def to_toml(self) -> str:
        """Checks the task and returns it as the text of a task file, without the original comments."""
        return str(_native.task_text(getattr(self, "file", "task"), dumps(self._table)))

    def __repr__(self) -> str:
        return f"<Task {self.name}: {self.description}>"


_ACCEPTED = "a name, the path of a task file, or a Task"
#: Task: a shipped name, the path of a task file, or a :class:`Task`.
Given = Union[TaskName, str, os.PathLike[str], Task]


def sources(task: Given | Iterable[Given] | None) -> str | None:
    """Returns tasks as text for the library: names and paths, and name and text of each :class:`Task`."""
    if task is None:
        return None
    found: list[str | dict[str, str]] = []
    for one in listed(task):
        if isinstance(one, Task):
            found.append({"file": one.file, "text": one.to_toml()})
        elif isinstance(one, str) and not os.path.isfile(one):
            found += [name.strip() for name in one.split(",") if name]
        elif isinstance(one, (str, os.PathLike)):
            # Paths are not split, since they may contain commas.
            found.append(os.fspath(one))
        else:
            raise TypeError(f"task: is {one!r}; accepted: {_ACCEPTED}")
    return "\0" + dumps(word(found))


def listed(task: Given | Iterable[Given]) -> list[Given]:
    """Returns one or several tasks as a list."""
    if isinstance(task, (str, os.PathLike, Task)):
        return [task]
    try:
        return list(task)
    except TypeError:
        raise TypeError(f"task: is {task!r}; accepted: {_ACCEPTED}, or several") from None
