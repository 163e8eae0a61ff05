"""JSON of what callers hold, for the library."""

from __future__ import annotations

import json

import numpy as np


def dumps(value: object) -> str:
    """The text of a value, in which numbers and arrays of NumPy may be."""
    return json.dumps(value, default=_plain)


def _plain(value: object) -> object:
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} cannot be written as JSON")
