"""JSON of what callers hold, for the library."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping
from numbers import Real
from typing import Any, Protocol, TypeGuard

import numpy as np

from ._native import InputError


class Numbers(Protocol):
    """A number or an array of NumPy."""

    def tolist(self) -> Any: ...


def dumps(value: object) -> str:
    """The text of a value, in which numbers and arrays of NumPy may be."""
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except ValueError:
        raise InputError("a number is NaN or infinite; all have to be finite") from None


def word(value: object) -> Any:
    """The value of a keyword for the library: paths are text, what holds several a list or a table."""
    if _is_path(value):
        return word(os.fspath(value))
    if isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            raise InputError(f"{value!a}: its name has to be UTF-8") from None
        return value
    if is_numpy(value):
        return word(value.tolist())
    if _is_mapping(value):
        return {key: word(one) for key, one in value.items()}
    if _is_several(value):
        return [word(one) for one in value]
    if isinstance(value, Real) and not isinstance(value, int):
        # The library says what is wrong with a number that JSON does not know.
        return float(value) if math.isfinite(value) else str(float(value))
    return value


def _is_path(value: object) -> TypeGuard[os.PathLike[str]]:
    return isinstance(value, os.PathLike)


def _is_mapping(value: object) -> TypeGuard[Mapping[str, Any]]:
    return isinstance(value, Mapping)


def _is_several(value: object) -> TypeGuard[Iterable[Any]]:
    return isinstance(value, Iterable)


def is_table(value: object) -> TypeGuard[dict[str, Any]]:
    """Whether it is an object of JSON."""
    return isinstance(value, dict)


def is_list(value: object) -> TypeGuard[list[Any]]:
    """Whether it is an array of JSON."""
    return isinstance(value, list)


def is_tuple(value: object) -> TypeGuard[tuple[Any, ...]]:
    """Whether it is a tuple, which JSON writes as an array."""
    return isinstance(value, tuple)


def is_numpy(value: object) -> TypeGuard[Numbers]:
    """Whether it is a number or an array of NumPy."""
    return isinstance(value, (np.generic, np.ndarray))


def _plain(value: object) -> Any:
    if is_numpy(value):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")
