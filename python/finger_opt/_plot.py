"""Axes and text for drawings with matplotlib (the extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def axes(ax: Axes | None, width: float = 6.4, height: float = 3.6) -> Axes:
    """Returns the given axes, or creates new ones (size in inches); raises ImportError without matplotlib."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("drawings need matplotlib: pip install 'finger-opt[plot]'") from None
    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def text(words: str) -> str:
    """Returns text with dollar signs escaped, which would start a formula in matplotlib."""
    return words.replace("$", r"\$")
