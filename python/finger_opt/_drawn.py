"""Pieces of HTML for notebooks."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING

from . import _native

if TYPE_CHECKING:
    from ._calibration import Calibration
    from ._evaluation import End, Evaluation

#: Words and colours of outcomes by their numbers in a map, as on the pages.
WORDS = {number: words for number, words, _ in _native.outcomes()}
COLOURS = {number: colour for number, _, colour in _native.outcomes()}


def ending(end: End | None) -> str:
    """What ends a window, in words."""
    if end is None:
        return "not met"
    return "diverged" if isinstance(end, str) else f"{WORDS[end]} (class {end})"


def colour(end: End | None) -> str:
    """Its colour."""
    return COLOURS[end if isinstance(end, int) else -1]


def finger(density: float | None, direction: float | None) -> str:
    """An infill in words."""
    return "given stiffness" if density is None or direction is None else f"{density:g} % infill at {direction:g}°"


def window(found: Evaluation) -> str:
    """A card: the window as a bar over the shift of the start."""
    low, high = found.negative_mm, found.positive_mm
    title = html.escape(f"{found.task}, {finger(found.infill_density_percent, found.infill_direction_deg)}")
    if found.nominal != "inserted":
        return f"<p><b>{title}</b>: does not insert from its start: {ending(found.failure_negative)}</p>"
    reach = max(-low, high, 1.0) * 1.25
    width = 520.0

    def at(mm: float) -> float:
        return width * (mm + reach) / (2 * reach)

    bars = [(-reach, low, colour(found.failure_negative)), (low, high, COLOURS[0]), (high, reach, colour(found.failure_positive))]
    drawn = "".join(
        f"<rect x='{at(a):.1f}' y='8' width='{max(0.0, at(b) - at(a)):.1f}' height='18' fill='{fill}' "
        f"fill-opacity='{0.9 if fill == COLOURS[0] else 0.35}'/>" for a, b, fill in bars
    )
    marks = "".join(
        f"<text x='{at(mm):.1f}' y='42' font-size='12' text-anchor='middle' fill='currentColor'>{text}</text>"
        for mm, text in ((low, f"{low:+.1f}"), (0.0, "0"), (high, f"{high:+.1f} mm"))
        if mm == 0.0 or abs(at(mm) - at(0.0)) > 28
    )
    line = f"<line x1='{at(0):.1f}' y1='4' x2='{at(0):.1f}' y2='30' stroke='currentColor'/>"
    return (
        f"<div><b>{title}: {found.range_mm:.1f} mm</b><br><svg viewBox='0 0 {width:.0f} 48' width='{width:.0f}' "
        f"role='img' aria-label='window from {low} to {high} mm'>{drawn}{line}{marks}</svg><br>"
        f"below: {ending(found.failure_negative)}; above: {ending(found.failure_positive)}</div>"
    )


def framed(page: str) -> str:
    """A page within a page, whose scripts touch nothing around it."""
    return (
        f"<iframe srcdoc=\"{html.escape(page)}\" sandbox='allow-scripts' style='width:100%;height:700px;border:0'></iframe>"
    )


def calibration(found: Calibration) -> str:
    """A table of the fingers that are expected to be best, for each task."""
    pieces: list[str] = []
    for task in found.tasks:
        best = sorted(task.predictions, key=lambda one: -one.range_mm)[:5]
        rows = "".join(
            f"<tr><td>{html.escape(', '.join(f'{key} {value:g}' for key, value in one.values.items()))}</td>"
            f"<td>{one.range_mm:.1f} mm</td><td>{one.low_mm:.1f} to {one.high_mm:.1f}</td>"
            f"<td>{one.probability_best:.0%}</td></tr>" for one in best
        )
        error = task.loo_mean_deviation_percent
        trust = "" if error is None else f": {error:.0f} % off on average for fingers left out"
        warnings = "".join(f"<p>{html.escape(text)}</p>" for text in task.warnings)
        pieces.append(
            f"<b>{html.escape(task.task)}</b>{trust}<table><tr><th>finger</th><th>range</th><th>80 %</th>"
            f"<th>best</th></tr>{rows}</table>{warnings}"
        )
    return "".join(pieces)
