"""Tables, which need an extra."""

from __future__ import annotations

import importlib
from typing import Any


def pandas() -> Any:
    """The module pandas."""
    try:
        import pandas as module
    except ImportError:
        raise ImportError("tables need pandas: pip install 'finger-opt[pandas]'") from None
    return module


def pyarrow() -> Any:
    """The module pyarrow, with its Parquet."""
    try:
        importlib.import_module("pyarrow.parquet")
        return importlib.import_module("pyarrow")
    except ImportError:
        raise ImportError("Parquet needs pyarrow: pip install 'finger-opt[parquet]'") from None
