"""Axes and texts of drawings by matplotlib (the extra ``plot``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def axes(ax: Axes | None, width: float = 6.4, height: float = 3.6) -> Axes:
    """The axes given, or new ones."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("drawings need matplotlib: pip install 'finger-opt[plot]'") from None
    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def text(words: str) -> str:
    """Words as they are: a dollar would begin a formula."""
    return words.replace("$", r"\$")
