"""Tables, which need an extra."""

from __future__ import annotations

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
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise ImportError("Parquet needs pyarrow: pip install 'finger-opt[parquet]'") from None
    return pyarrow
