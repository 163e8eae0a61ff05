"""Names and colours of outcomes, and pages in notebooks."""

from __future__ import annotations

import html

from . import _native
from ._words import End

#: Names and colours of outcomes by their codes in a map, as on the pages.
WORDS = {number: words for number, words, _ in _native.outcomes()}
COLOURS = {number: colour for number, _, colour in _native.outcomes()}
#: Colour of curves and bars that show no outcome, as on the pages.
BLUE = "#1867B2"


def ending(end: End | None) -> str:
    """Returns the name of the outcome at an end of a window."""
    if end is None:
        return "not met"
    return "diverged" if isinstance(end, str) else f"{WORDS[end]} (class {end})"


def colour(end: End | None) -> str:
    """Returns the colour of the outcome at an end of a window."""
    return COLOURS[end if isinstance(end, int) else -1]


def finger(density: float | None, direction: float | None) -> str:
    """Returns the description of an infill."""
    return "given stiffness" if density is None or direction is None else f"{density:g} % infill at {direction:g}°"


def framed(page: str) -> str:
    """Returns a page embedded in a sandboxed iframe."""
    return (
        f"<iframe srcdoc=\"{html.escape(page)}\" sandbox='allow-scripts' "
        "style='width:100%;height:700px;border:0'></iframe>"
    )
