"""JSON of what callers hold, for the library."""

from __future__ import annotations

import json
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
