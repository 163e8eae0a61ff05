"""Conversion of Python values to JSON for the native library."""

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
    """NumPy number or array."""

    def tolist(self) -> Any: ...


def dumps(value: object) -> str:
    """Returns a value as JSON; it may contain NumPy numbers and arrays.

    Raises :class:`InputError` for NaN and infinity.
    """
    try:
        return json.dumps(value, default=_plain, allow_nan=False)
    except ValueError:
        raise InputError("a number is NaN or infinite; all numbers must be finite") from None


def word(value: object) -> Any:
    """Returns a keyword value in JSON types: paths become text, iterables lists, mappings objects.

    Raises :class:`InputError` for text that UTF-8 cannot encode.
    """
    if _is_path(value):
        return word(os.fspath(value))
    if isinstance(value, str):
        try:
            value.encode()
        except UnicodeEncodeError:
            raise InputError(f"{value!a}: must be valid UTF-8") from None
        return value
    if is_numpy(value):
        return word(value.tolist())
    if _is_mapping(value):
        return {key: word(one) for key, one in value.items()}
    if _is_iterable(value):
        return [word(one) for one in value]
    if isinstance(value, Real) and not isinstance(value, int):
        # JSON has no NaN or infinity: as text, the library rejects them with its own message.
        return float(value) if math.isfinite(value) else str(float(value))
    return value


def _is_path(value: object) -> TypeGuard[os.PathLike[str]]:
    return isinstance(value, os.PathLike)


def _is_mapping(value: object) -> TypeGuard[Mapping[str, Any]]:
    return isinstance(value, Mapping)


def _is_iterable(value: object) -> TypeGuard[Iterable[Any]]:
    return isinstance(value, Iterable)


def is_table(value: object) -> TypeGuard[dict[str, Any]]:
    """Returns whether a value is a JSON object."""
    return isinstance(value, dict)


def is_list(value: object) -> TypeGuard[list[Any]]:
    """Returns whether a value is a JSON array."""
    return isinstance(value, list)


def is_tuple(value: object) -> TypeGuard[tuple[Any, ...]]:
    """Returns whether a value is a tuple, which becomes a JSON array."""
    return isinstance(value, tuple)


def is_numpy(value: object) -> TypeGuard[Numbers]:
    """Returns whether a value is a NumPy number or array."""
    return isinstance(value, (np.generic, np.ndarray))


def _plain(value: object) -> Any:
    if is_numpy(value):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")
