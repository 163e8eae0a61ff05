"""Optional dependencies for tables."""

from __future__ import annotations

import importlib
from typing import Any


def pandas() -> Any:
    """Imports pandas; raises ImportError with the extra to install."""
    try:
        import pandas as module
    except ImportError:
        raise ImportError("tables need pandas: pip install 'finger-opt[pandas]'") from None
    return module


def pyarrow() -> Any:
    """Imports pyarrow with its module for Parquet; raises ImportError with the extra to install."""
    try:
        importlib.import_module("pyarrow.parquet")
        return importlib.import_module("pyarrow")
    except ImportError:
        raise ImportError("Parquet needs pyarrow: pip install 'finger-opt[parquet]'") from None
