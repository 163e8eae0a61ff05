"""What is found: frozen dataclasses, made of the JSON that ``--json`` prints."""

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

#: Marks the field that takes all keys which are no fields: the parameters of a design, which the space names.
REST: dict[str, bool] = {"rest": True}
#: Marks what ``--json`` does not have: drawings, pages, arrays.
DRAWN: dict[str, bool] = {"drawn": True}
#: Marks the field that takes the drawing or the page of the result.
PICTURE: dict[str, bool] = {**DRAWN, "picture": True}


@dataclasses.dataclass(frozen=True, repr=False)
class Result:
    """Fields carry the names and units of ``--json``; a notebook shows them."""

    @classmethod
    def from_json(cls: type[T], fields: Mapping[str, Any], picture: str | None = None) -> T:
        """The result of such fields of JSON, and a picture or a page of it."""
        drawn = [field.name for field in dataclasses.fields(cls) if field.metadata.get("picture")]
        return _built(cls, {**fields, **dict.fromkeys(drawn, picture or "")})

    def to_dict(self) -> dict[str, Any]:
        """The fields as plain lists, numbers and texts, without what there is not."""
        return _plain_fields(self)

    def __repr__(self) -> str:
        shown = ((field.name, getattr(self, field.name)) for field in dataclasses.fields(self) if field.repr)
        inner = ", ".join(f"{name}={_short(value)}" for name, value in shown if value is not None)
        return f"{type(self).__name__}({inner})"

    def _repr_html_(self) -> str:
        return _table(self)


@dataclasses.dataclass(frozen=True, repr=False)
class Found(Result):
    """What a command found, by the keys of ``--json``: as attributes and as items."""

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


#: Longest lists and texts of a repr that are not cut.
ITEMS, LETTERS = 6, 200


def _short(value: Any) -> str:
    """The repr of a field: of what is long its beginning and its length."""
    if (is_tuple(value) or is_list(value)) and len(value) > ITEMS:
        inner = ", ".join(_short(one) for one in value[: ITEMS // 2])
        return f"<{len(value)}: {inner}, ..>"
    if is_numpy(value):
        array: Any = value
        if array.size > ITEMS:
            return f"<array of {array.shape}>"
    text = repr(value)
    return text if isinstance(value, Result) or len(text) <= LETTERS else f"{text[:LETTERS]}.."


def equal(one: Any, other: Any) -> bool:
    """Whether two dataclasses with arrays hold the same."""
    if type(one) is not type(other):
        return False
    names = [field.name for field in dataclasses.fields(one) if field.compare]
    pairs: list[tuple[Any, Any]] = [(getattr(one, name), getattr(other, name)) for name in names]
    arrays = [(np.asarray(a), np.asarray(b)) for a, b in pairs if is_numpy(a)]
    return all(np.array_equal(a, b) for a, b in arrays) and all(bool(a == b) for a, b in pairs if not is_numpy(a))


def plain(hint: Any) -> Any:
    """The class of a generic type; of an alias, as newer versions of NumPy have, that of what it stands for."""
    origin = get_origin(hint)
    return get_origin(origin.__value__) if hasattr(origin, "__value__") else origin


def suffixed(file: str | os.PathLike[str] | None, suffix: str) -> None:
    """Refuses a file whose name promises something else than what is written."""
    if file is not None and not os.fspath(file).lower().endswith(suffix):
        error = InputError(f"{os.fspath(file)}: what is written is {suffix[1:].upper()}; let its name end in {suffix}")
        error.file = os.fspath(file)
        raise error


@functools.cache
def _hints(cls: type[Any]) -> dict[str, Any]:
    return get_type_hints(cls)


def _built(cls: type[T], fields: Mapping[str, Any]) -> T:
    kind: Any = cls
    hints, names, values = _hints(kind), set[str](), dict[str, Any]()
    rest = next((field.name for field in dataclasses.fields(cls) if field.metadata.get("rest")), None)
    for field in dataclasses.fields(cls):
        # A word of Python has a stroke behind it.
        key = field.name.rstrip("_")
        names.add(key)
        if field.name == rest:
            continue
        if key in fields:
            values[field.name] = _value(hints[field.name], fields[key])
        elif type(None) in get_args(hints[field.name]):
            # What there is not `to_dict` leaves out.
            values[field.name] = None
    others = {key: value for key, value in fields.items() if key not in names or key == rest}
    if rest is not None:
        values[rest] = _value(hints[rest], others.pop(rest, others))
    elif others:
        raise TypeError(f"{cls.__name__} has no field {', '.join(others)}")
    return cls(**values)


def _value(hint: Any, value: Any) -> Any:
    origin, args = plain(hint), get_args(hint)
    if value is None:
        return None
    if origin in (Union, types.UnionType):
        kinds = [one for one in args if one is not type(None)]
        return _value(kinds[0], value) if len(kinds) == 1 else value
    if origin is tuple:
        each = args[:1] * len(value) if args[-1] is Ellipsis else args
        return tuple(_value(kind, one) for kind, one in zip(each, value, strict=True))
    if origin is dict:
        return {key: _value(args[1], one) for key, one in value.items()}
    if origin is np.ndarray:
        return np.asarray(value)
    if hint is float:
        return float(value)
    return _built(hint, value) if isinstance(hint, type) and issubclass(hint, Result) else value


def _plain_fields(result: Result) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for field in dataclasses.fields(result):
        value = getattr(result, field.name)
        if field.metadata.get("rest"):
            found.update(value)
        elif value is not None and not field.metadata.get("drawn"):
            found[field.name.rstrip("_")] = _plain(value)
    return found


def _plain(value: Any) -> Any:
    if isinstance(value, Result):
        return _plain_fields(value)
    if is_list(value) or is_tuple(value):
        return [_plain(one) for one in value]
    if is_table(value):
        return {key: _plain(one) for key, one in value.items()}
    return value.tolist() if is_numpy(value) else value


def _table(result: Result) -> str:
    style = "text-align:left;vertical-align:top"
    rows = "".join(
        f"<tr><th style='{style}'>{html.escape(key)}</th><td style='{style}'>{_cell(value)}</td></tr>"
        for key, value in result.to_dict().items()
    )
    return f"<table>{rows}</table>"


def _cell(value: Any) -> str:
    """A value in a table: what is long is counted."""
    if isinstance(value, float):
        return f"{value:.6g}"
    if is_table(value):
        return ", ".join(f"{html.escape(key)} {_cell(one)}" for key, one in value.items())
    if is_list(value):
        shown = ", ".join(_cell(one) for one in value[:8])
        return f"{shown} .. {len(value)} in all" if len(value) > 8 else shown
    return html.escape(str(value))
