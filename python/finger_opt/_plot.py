"""Drawings by matplotlib (the extra ``plot``)."""

from __future__ import annotations

import json
import os
import textwrap
from typing import TYPE_CHECKING

import numpy as np

from . import _native
from ._drawn import COLOURS, WORDS, colour, ending, finger

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ._connector import Tuned
    from ._evaluation import End, Evaluation
    from ._map import CaptureMap, Levers
    from ._springs import StiffnessModel
    from ._study import Study
    from ._trial import Trial


def _axes(ax: Axes | None, width: float = 6.4, height: float = 3.6) -> Axes:
    """The axes given, or new ones."""
    if ax is not None:
        return ax
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("drawings need matplotlib: pip install 'finger-opt[plot]'") from None
    return pyplot.subplots(figsize=(width, height), layout="constrained")[1]


def window(found: Evaluation, ax: Axes | None) -> Axes:
    """The window as a bar, with what ends it."""
    ax = axes = _axes(ax, height=1.8)
    low, high = found.negative_mm, found.positive_mm
    label = f"{found.task}, {finger(found.infill_density_percent, found.infill_direction_deg)}"
    y = len(axes.patches)
    axes.barh(y, high - low, left=low, height=0.6, color=COLOURS[0])
    ends: list[tuple[float, End | None, str]] = [
        (low, found.failure_negative, "right"), (high, found.failure_positive, "left"),
    ]
    inserts = found.nominal == "inserted"
    for at, end, side in ends if inserts else ends[1:]:
        text = textwrap.fill(ending(end).replace("class ", "class\u00a0"), 20)
        text = text if inserts else f"does not insert from its start:\n{ending(end)}"
        axes.annotate(text, (at, y), (4 if side == "left" else -4, 0), textcoords="offset points", ha=side, va="center",
                      fontsize=8, color=colour(end))
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set_yticks([*axes.get_yticks(), y] if y else [y], [*(tick.get_text() for tick in axes.get_yticklabels()), label] if y else [label])
    reach = max(2.2 * max(-low, high, 1.0), *(abs(edge) for edge in axes.get_xlim()))
    axes.set_xlim(-reach, reach)
    axes.set_xlabel("shift of the start along y, mm")
    return axes


def force(trial: Trial, ax: Axes | None) -> Axes:
    """The contact force over time; a stroke where a phase ends."""
    axes = _axes(ax)
    series = trial.series
    line = axes.plot(series.time_s, np.linalg.norm(series.force_n, axis=1), color=COLOURS[0], linewidth=1.0)[0]
    # Room above for the names of the phases, none below.
    line.sticky_edges.y.append(0.0)
    axes.margins(y=0.2)
    begin = float(series.time_s[0]) if len(series.time_s) else 0.0
    for phase in trial.phases:
        if phase.time_s > begin:
            axes.axvline(phase.time_s, color="0.7", linewidth=0.6)
            axes.text(phase.time_s, 0.98, phase.name, transform=axes.get_xaxis_transform(), rotation=90, ha="right", va="top",
                      fontsize=7, color="0.35")
    outcome = trial.outcome if trial.failure is None else WORDS[trial.failure]
    axes.set(xlabel="time, s", ylabel="force of the socket on the plug, N",
             title=f"{_text(trial.task)}, start {trial.offset_mm:+g} mm: {outcome}")
    return axes


def _named(study: Study) -> str:
    """The study's folder, without those that it is in."""
    return _text(os.path.basename(study.path))


def _text(words: str) -> str:
    """Words as they are: a dollar would begin a formula."""
    return words.replace("$", r"\$")


def _objective(study: Study) -> tuple[str, str, bool] | None:
    """Column of the first objective, what it is in words with its unit, and whether less is better."""
    columns = [str(column) for column in study.to_dataframe().columns]
    column = next((column for column in columns if column.startswith("objective")), None)
    if column is None:
        return None
    name = str(study.config["objective"]).split(",")[0].strip()
    words = "tolerable range" if name == "range" else name.replace("-", " ")
    unit = column.rpartition("_")[2] if column.count("_") > column.startswith("objective_1") else ""
    return column, f"{words}, {unit}" if unit in ("mm", "n") else words, name in ("peak-force", "slip")


def convergence(study: Study, ax: Axes | None) -> Axes:
    """Each evaluation, and the best so far."""
    axes = _axes(ax)
    objective = _objective(study)
    if objective is not None:
        column, label, least = objective
        values = study.to_dataframe()[column].to_numpy(dtype=float)
        best = np.fmin.accumulate(values) if least else np.fmax.accumulate(values)
        axes.plot(np.arange(1, len(values) + 1), values, ".", color="0.6", label="evaluation")
        axes.step(np.arange(1, len(values) + 1), best, where="post", color=COLOURS[0], label="best so far")
        axes.set_ylabel(label)
        axes.legend(loc="lower right")
    axes.set(xlabel="evaluation", title=_named(study))
    return axes


def surface(study: Study, ax: Axes | None) -> Axes:
    """The designs, coloured by their objective, and the recommended one."""
    axes = _axes(ax, height=4.2)
    keys = ("infill_density_percent", "infill_direction_deg")
    objective, frame = _objective(study), study.to_dataframe()
    if objective is not None:
        column, label, _ = objective
        dots = axes.scatter(frame[keys[0]], frame[keys[1]], c=frame[column], cmap="viridis", s=28)
        axes.figure.colorbar(dots, ax=axes, label=label)
    best = study.best
    if best is not None and all(key in best.values for key in keys):
        axes.plot(*(best.values[key] for key in keys), "o", markersize=13, markerfacecolor="none", color=COLOURS[3],
                  label="recommended")
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), frameon=False)
    axes.set(xlabel="infill density, percent", ylabel="infill direction, degrees")
    axes.set_title(_named(study), loc="left")
    return axes


def outcomes(found: CaptureMap, ax: Axes | None) -> Axes:
    """How insertions end over the two errors."""
    axes = _axes(ax, height=4.2)
    from matplotlib.colors import BoundaryNorm, ListedColormap
    from matplotlib.patches import Patch

    numbers = [-1, 0, 1, 2, 3, 4]
    colours = ListedColormap([COLOURS[number] for number in numbers])
    edges = [np.arange(axis.low - axis.step / 2, axis.high + axis.step, axis.step) for axis in found.axes]
    shape = found.outcomes.shape
    axes.pcolormesh(edges[0][: shape[1] + 1], edges[1][: shape[0] + 1], found.outcomes, cmap=colours,
                    norm=BoundaryNorm(np.arange(-1.5, 5.0), colours.N), alpha=0.85)
    met = [number for number in numbers if (found.outcomes == number).any()]
    axes.legend(handles=[Patch(color=COLOURS[number], label=WORDS[number]) for number in met], loc="upper left",
                bbox_to_anchor=(1.0, 1.0), frameon=False)
    axes.plot(0, 0, "+", color="white", markersize=10)
    labels = [f"error of the start in {axis.name}, {axis.unit}" for axis in found.axes]
    axes.set(xlabel=labels[0], ylabel=labels[1],
             title=f"{found.task}: {found.area:.3g} {found.area_unit.replace('mm2', 'mm²')} insert")
    return axes


def tornado(found: Levers, ax: Axes | None) -> Axes:
    """The ranges at both ends of each lever."""
    axes = _axes(ax, width=7.4, height=4.2)
    base = found.base.range_mm or 0.0
    rows = list(reversed(found.levers))
    for y, lever in enumerate(rows):
        ends = zip(lever.range_mm, (lever.low, lever.high), (y + 0.2, y - 0.2), ("#9cc3e6", COLOURS[0]), strict=True)
        for end, value, place, fill in ends:
            reach = end or 0.0
            axes.barh(place, reach - base, left=base, height=0.4, color=fill)
            axes.annotate(f"{value:g}" if isinstance(value, float) else str(value), (reach, place),
                          (3 if reach >= base else -3, 0), textcoords="offset points", va="center",
                          ha="left" if reach >= base else "right", fontsize=7)
    axes.set_yticks(range(len(rows)), [f"{lever.name}{f', {lever.unit}' if lever.unit else ''}" for lever in rows], fontsize=8)
    axes.axvline(base, color="0.3", linewidth=0.8)
    axes.set(xlabel="tolerable range, mm", title=found.sentence)
    axes.margins(x=0.15)
    return axes


def stiffness(found: StiffnessModel, ax: Axes | None) -> Axes:
    """The stiffness in the compliance direction over density and direction."""
    from ._springs import stiffness as predicted

    axes = _axes(ax, height=4.2)
    infill: list[dict[str, float]] = json.loads(_native.space("infill"))
    density, direction = (np.linspace(axis["low"], axis["high"], 21) for axis in infill)
    values = np.array([
        [predicted(float(x), float(y), stiffness_data=found.stiffness_data, finger=found.finger).compliance_n_per_mm for x in density]
        for y in direction
    ])
    filled = axes.contourf(density, direction, values, levels=14, cmap="viridis")
    axes.figure.colorbar(filled, ax=axes, label="stiffness in the compliance direction, N/mm")
    axes.set(xlabel="infill density, percent", ylabel="infill direction, degrees", title=f"fitted to {found.designs} designs")
    return axes


def strategies(found: Tuned, ax: Axes | None) -> Axes:
    """The strategies that were tried; a cross fails once the socket is turned, a ring is what was taken."""
    axes = _axes(ax, width=9.0)
    names = {"as-it-is": "as it is", "start": "start taught", "families": "like a shipped task", "search": "searched"}
    colours = dict(zip(names, ("black", *(COLOURS[number] for number in (2, 4, 0))), strict=True))
    taken = next(at for at, step in enumerate(found.steps, 1) if (step.stage, step.what) == (found.by.stage, found.by.what))
    for at, step in enumerate(found.steps, 1):
        axes.plot(at, step.least_range_mm or 0.0, "x" if step.turned_least_range_mm == 0.0 else "o", color=colours[step.stage])
    axes.plot(taken, found.steps[taken - 1].least_range_mm or 0.0, "o", markersize=13, markerfacecolor="none",
              color=COLOURS[3], label="taken")
    for stage in dict.fromkeys(step.stage for step in found.steps):
        axes.plot([], [], "o", color=colours[stage], label=names[stage])
    if any(step.turned_least_range_mm == 0.0 for step in found.steps):
        axes.plot([], [], "x", color=colours["search"], label="fails with the socket\nturned by 1°")
    axes.set(xlabel="strategy tried", ylabel="narrowest window of three fingers, mm", title=_text(f"{found.task}: {found.by.what}"))
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    return axes
