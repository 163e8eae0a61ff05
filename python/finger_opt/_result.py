"""Results of functions: frozen dataclasses built from the JSON that ``--json`` prints."""

from __future__ import annotations

import dataclasses
import functools
import html
import os
import types
from collections.abc import Mapping
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from ._json import is_list, is_numpy, is_table, is_tuple
from ._native import InputError

T = TypeVar("T", bound="Result")

#: Marks the field for all keys without a field of their own, for example the parameters of a design.
REST: dict[str, bool] = {"rest": True}
#: Marks fields that ``--json`` does not contain: drawings, pages, arrays.
DRAWN: dict[str, bool] = {"drawn": True}
#: Marks the field for the drawing or the page of the result.
PICTURE: dict[str, bool] = {**DRAWN, "picture": True}


@dataclasses.dataclass(frozen=True, repr=False)
class Result:
    """Result whose fields have the names and units of ``--json``; notebooks display it as a table."""

    @classmethod
    def from_json(cls: type[T], fields: Mapping[str, Any], picture: str | None = None) -> T:
        """Creates the result from JSON fields, and its picture or page; raises TypeError for an unknown field."""
        drawn = [field.name for field in dataclasses.fields(cls) if field.metadata.get("picture")]
        return _built(cls, {**fields, **dict.fromkeys(drawn, picture or "")})

    def to_dict(self) -> dict[str, Any]:
        """Returns the fields as plain dicts, lists, numbers and text; omits ``None`` and drawings."""
        return _plain_fields(self)

    def __repr__(self) -> str:
        shown = ((field.name, getattr(self, field.name)) for field in dataclasses.fields(self) if field.repr)
        inner = ", ".join(f"{name}={_short(value)}" for name, value in shown if value is not None)
        return f"{type(self).__name__}({inner})"

    def _repr_html_(self) -> str:
        return _table(self)


@dataclasses.dataclass(frozen=True, repr=False)
class Found(Result):
    """Result with the keys of ``--json`` as attributes and as items."""

    _found: dict[str, Any] = dataclasses.field(default_factory=dict[str, Any], metadata=REST)
    svg: str = dataclasses.field(default="", repr=False, metadata=PICTURE)

    def __getitem__(self, key: str) -> Any:
        return self._found[key]

    def __getattr__(self, key: str) -> Any:
        if key.startswith("_") or key not in self._found:
            raise AttributeError(key)
        return self._found[key]

    def __dir__(self) -> list[str]:
        return [*self._found, *super().__dir__()]

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{key}={_short(value)}' for key, value in self._found.items())})"


#: Largest numbers of items and of characters that a repr does not abbreviate.
MAX_ITEMS, MAX_CHARACTERS = 6, 200


def _short(value: Any) -> str:
    """Returns the repr of a field value, abbreviated if it is long."""
    if (is_tuple(value) or is_list(value)) and len(value) > MAX_ITEMS:
        inner = ", ".join(_short(one) for one in value[: MAX_ITEMS // 2])
        return f"<{len(value)}: {inner}, ..>"
    if is_numpy(value):
        array: Any = value
        if array.size > MAX_ITEMS:
            return f"<array of {array.shape}>"
    text = repr(value)
    return text if isinstance(value, Result) or len(text) <= MAX_CHARACTERS else f"{text[:MAX_CHARACTERS]}.."


def equal(one: Any, other: Any) -> bool:
    """Returns whether two dataclasses with arrays are equal."""
    if type(one) is not type(other):
        return False
    names = [field.name for field in dataclasses.fields(one) if field.compare]
    pairs: list[tuple[Any, Any]] = [(getattr(one, name), getattr(other, name)) for name in names]
    arrays = [(np.asarray(a), np.asarray(b)) for a, b in pairs if is_numpy(a)]
    return all(np.array_equal(a, b) for a, b in arrays) and all(bool(a == b) for a, b in pairs if not is_numpy(a))


def plain(hint: Any) -> Any:
    """Returns the class of a generic type, with an alias resolved (newer versions of NumPy have aliases)."""
    origin = get_origin(hint)
    return get_origin(origin.__value__) if hasattr(origin, "__value__") else origin


def suffixed(file: str | os.PathLike[str] | None, suffix: str) -> None:
    """Checks the suffix of a file to write; raises :class:`InputError` if it does not match the format."""
    if file is not None and not os.fspath(file).lower().endswith(suffix):
        error = InputError(f"{os.fspath(file)}: the format is {suffix[1:].upper()}; the file name must end in {suffix}")
        error.file = os.fspath(file)
        raise error


@functools.cache
def _hints(cls: type[Any]) -> dict[str, Any]:
    return get_type_hints(cls)


def _built(cls: type[T], fields: Mapping[str, Any]) -> T:
    """Builds a result from JSON fields; raises TypeError for an unknown field."""
    kind: Any = cls
    hints, names, values = _hints(kind), set[str](), dict[str, Any]()
    rest = next((field.name for field in dataclasses.fields(cls) if field.metadata.get("rest")), None)
    for field in dataclasses.fields(cls):
        # Fields named like Python keywords have a trailing underscore.
        key = field.name.rstrip("_")
        names.add(key)
        if field.name == rest:
            continue
        if key in fields:
            values[field.name] = _converted(hints[field.name], fields[key])
        elif type(None) in get_args(hints[field.name]):
            # JSON omits optional fields that are None.
            values[field.name] = None
    others = {key: value for key, value in fields.items() if key not in names or key == rest}
    if rest is not None:
        values[rest] = _converted(hints[rest], others.pop(rest, others))
    elif others:
        raise TypeError(f"{cls.__name__} has no field {', '.join(others)}")
    return cls(**values)


def _converted(hint: Any, value: Any) -> Any:
    """Converts a JSON value to the type of a field."""
    origin, args = plain(hint), get_args(hint)
    if value is None:
        return None
    if origin in (Union, types.UnionType):
        kinds = [one for one in args if one is not type(None)]
        return _converted(kinds[0], value) if len(kinds) == 1 else value
    if origin is tuple:
        each = args[:1] * len(value) if args[-1] is Ellipsis else args
        return tuple(_converted(kind, one) for kind, one in zip(each, value, strict=True))
    if origin is dict:
        return {key: _converted(args[1], one) for key, one in value.items()}
    if origin is np.ndarray:
        return np.asarray(value)
    if hint is float:
        return float(value)
    return _built(hint, value) if isinstance(hint, type) and issubclass(hint, Result) else value


def _plain_fields(result: Result) -> dict[str, Any]:
    """Returns the fields of a result by their JSON keys."""
    found: dict[str, Any] = {}
    for field in dataclasses.fields(result):
        value = getattr(result, field.name)
        if field.metadata.get("rest"):
            found.update(value)
        elif value is not None and not field.metadata.get("drawn"):
            found[field.name.rstrip("_")] = _plain(value)
    return found


def _plain(value: Any) -> Any:
    """Returns a value in JSON types."""
    if isinstance(value, Result):
        return _plain_fields(value)
    if is_list(value) or is_tuple(value):
        return [_plain(one) for one in value]
    if is_table(value):
        return {key: _plain(one) for key, one in value.items()}
    return value.tolist() if is_numpy(value) else value


def _table(result: Result) -> str:
    """Returns a result as an HTML table."""
    style = "text-align:left;vertical-align:top"
    rows = "".join(
        f"<tr><th style='{style}'>{html.escape(key)}</th><td style='{style}'>{_cell(value)}</td></tr>"
        for key, value in result.to_dict().items()
    )
    return f"<table>{rows}</table>"


def _cell(value: Any) -> str:
    """Returns a value as HTML, with long lists abbreviated."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if is_table(value):
        return ", ".join(f"{html.escape(key)} {_cell(one)}" for key, one in value.items())
    if is_list(value):
        shown = ", ".join(_cell(one) for one in value[:8])
        return f"{shown} .. {len(value)} in all" if len(value) > 8 else shown
    return html.escape(str(value))
