"""Tolerance window of a finger."""

from __future__ import annotations

import html
import textwrap
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ._calibration import Line
from ._drawn import COLOURS, colour, ending, finger
from ._plot import axes as axes_of
from ._result import Result
from ._words import End, FingerModel, Outcome

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing


@dataclass(frozen=True, repr=False)
class Springs(Result):
    """Stiffness of a finger, N/mm, with standard deviations.

    ``inside_hull`` is whether the infill lies in the convex hull of the measured designs.
    """

    compliance_n_per_mm: float
    compliance_sd_n_per_mm: float
    assembly_n_per_mm: float
    assembly_sd_n_per_mm: float
    #: Distance to the hull of the measured designs, in units of their span; 0 inside.
    hull_distance: float
    inside_hull: bool


@dataclass(frozen=True, repr=False)
class Window(Result):
    """Tolerance window: the interval of start errors along y, mm, from which the plug inserts.

    ``failure_negative`` and ``failure_positive`` are the failures beyond its ends: class 1 contact loss before
    insertion, 2 plug missed, 3 jammed, 4 contact loss during insertion. The fields from ``success_rate`` on require
    ``uncertainty``: share of sampled errors under which the plug inserts, and range under these errors.
    """

    range_mm: float
    negative_mm: float
    positive_mm: float
    #: Outcome from the nominal start.
    nominal: Outcome
    failure_negative: End | None
    failure_positive: End | None
    #: Number of failed trials by class, 1 to 4.
    failure_counts: tuple[int, int, int, int]
    diverged: int
    #: Largest contact force between plug and socket, N, and largest slip in the grasp, mm, over the inserted trials.
    peak_force_n: float | None
    slip_mm: float | None
    trials: int
    simulated_s: float
    #: Position of each end in the grid step beyond it, 0 to 1; if the nominal start fails, its margin, -1 to 0.
    end_shares: tuple[float, float]
    #: Number of trials that a protective stop of the robot ended.
    robot_stops: int = 0
    #: Shift of the taught start, mm, if the start was taught.
    taught_start_mm: float | None = None
    success_rate: float | None = None
    success_low: float | None = None
    success_high: float | None = None
    success_at_most: float | None = None
    raced_draws: int | None = None
    success_confidence: float | None = None
    success_inserted: int | None = None
    success_failure_counts: tuple[int, int, int, int] | None = None
    success_diverged: int | None = None
    success_failed_draws: tuple[int, ...] | None = None
    success_spared_draws: int | None = None
    robust_range_mm: float | None = None
    robust_mean_mm: float | None = None
    robust_sd_mm: float | None = None
    robust_windows: int | None = None
    robust_ranges_mm: tuple[float, ...] | None = None
    robust_diverged: int | None = None
    robust_trials: int | None = None


@dataclass(frozen=True, repr=False)
class Bands(Result):
    """Firm window, whose ends insert in all repeats, and the bands at both ends in which the outcomes of repeats differ:
    widths, mm (``None``: more than 2 mm).

    ``unsure_inside_mm`` are the offsets, of those tried between the bands, at which not all repeats insert.
    ``impossible_draws`` is the number of draws of the cell's numbers that are impossible on this task, and left out.
    """

    firm_negative_mm: float | None
    firm_positive_mm: float | None
    negative_band_mm: float | None
    positive_band_mm: float | None
    offsets_tried_inside: int
    unsure_inside_mm: tuple[float, ...]
    impossible_draws: int


@dataclass(frozen=True, kw_only=True, repr=False)
class Subject(Result):
    """Simulated finger, task and cell."""

    task: str
    robot: str
    #: Name of the cell, if one was given.
    cell: str | None = None
    #: Parameters of the cell that apply to the task, and those that were identified on another task.
    cell_applied: tuple[str, ...] | None = None
    cell_not_applied: tuple[str, ...] | None = None
    infill_density_percent: float | None = None
    infill_direction_deg: float | None = None
    #: Numbers given as ``set``, by key.
    set: dict[str, float] = field(default_factory=dict[str, float])
    finger_model: FingerModel
    #: Height of the remote centre of compliance above the finger tips, mm, and its source.
    rcc_mm: float
    rcc_from: str
    tilting_nm_per_rad: float
    stiffness: Springs


@dataclass(frozen=True, repr=False)
class ShorterPush(Result):
    """Push that inserts without a robot stop: its number, the value it replaces, and range and force with it."""

    key: str
    value_mm: float
    instead_of_mm: float
    range_mm: float
    peak_force_n: float


@dataclass(frozen=True, kw_only=True, repr=False)
class Evaluation(Window, Subject):
    """Tolerance window of one finger on one task.

    ``range_mm`` is its width, ``negative_mm`` and ``positive_mm`` are its ends.
    """

    #: Shorter push, if the robot stops in most insertions and such a push is found.
    shorter_push: ShorterPush | None = None
    wall_s: float = field(compare=False)
    #: Bands in which the outcomes differ; only with ``repeat``.
    bands: Bands | None = None
    #: Lines with a measured range of the finger; only with ``measurements``.
    measured: tuple[Line, ...] | None = None

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the window; returns the axes."""
        return _bar(self, ax)

    def _repr_html_(self) -> str:
        return _card(self)


def _bar(found: Evaluation, ax: Drawing | None) -> Drawing:
    """Draws the window as a bar, with the failures beyond its ends; returns the axes."""
    ax = axes = axes_of(ax, height=1.8)
    low, high = found.negative_mm, found.positive_mm
    label = f"{found.task}, {finger(found.infill_density_percent, found.infill_direction_deg)}"
    y = len(axes.patches)
    axes.barh(y, high - low, left=low, height=0.6, color=COLOURS[0], edgecolor="0.3")
    ends: list[tuple[float, End | None, str]] = [
        (low, found.failure_negative, "right"), (high, found.failure_positive, "left"),
    ]
    inserts = found.nominal == "inserted"
    for at, end, side in ends if inserts else ends[1:]:
        text = textwrap.fill(ending(end).replace("class ", "class\u00a0"), 20)
        text = text if inserts else f"does not insert from its start:\n{ending(end)}"
        axes.annotate(text, (at, y), (4 if side == "left" else -4, 0), textcoords="offset points", ha=side, va="center",
                      fontsize=8)
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set_yticks([*axes.get_yticks(), y] if y else [y],
                    [*(tick.get_text() for tick in axes.get_yticklabels()), label] if y else [label])
    reach = max(2.2 * max(-low, high, 1.0), *(abs(edge) for edge in axes.get_xlim()))
    axes.set_xlim(-reach, reach)
    axes.set_xlabel("shift of the start along y, mm")
    return axes


def _card(found: Evaluation) -> str:
    """Returns an HTML summary: the window as a bar over the shift of the start."""
    low, high = found.negative_mm, found.positive_mm
    title = html.escape(f"{found.task}, {finger(found.infill_density_percent, found.infill_direction_deg)}")
    if found.nominal != "inserted":
        return f"<p><b>{title}</b>: does not insert from its start: {ending(found.failure_negative)}</p>"
    reach = max(-low, high, 1.0) * 1.25
    width = 520.0

    def at(mm: float) -> float:
        return width * (mm + reach) / (2 * reach)

    below, above = colour(found.failure_negative), colour(found.failure_positive)
    bars = [(-reach, low, below), (low, high, COLOURS[0]), (high, reach, above)]
    drawn = "".join(
        f"<rect x='{at(a):.1f}' y='8' width='{max(0.0, at(b) - at(a)):.1f}' height='18' fill='{fill}'/>"
        for a, b, fill in bars
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
