#!/usr/bin/env python3
"""Plots the committed tables of ranges. Needs matplotlib.

    scripts/figures.py results/reference/validation   ranges.svg from validation.csv
    scripts/figures.py results/reference/bench        ranges.svg from leave_one_out_*.csv
"""
import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams.update({"svg.hashsalt": "finger-opt", "font.size": 9})
import matplotlib.pyplot as plt  # noqa: E402

TASKS = ["ket8", "ket12", "rj45", "usb"]


def rows(path):
    """Returns the rows of a CSV file, numbers as float."""
    with open(path, newline="") as file:
        return [
            {key: float(value) if value.replace(".", "", 1).lstrip("-").isdigit() else value for key, value in row.items()}
            for row in csv.DictReader(file)
        ]


def validation(folder, axes):
    """Plots our range, that of the published simulation and that of the robot over the compliance stiffness."""
    table = rows(folder / "validation.csv")
    for task, ax in zip(TASKS, axes):
        own = [row for row in table if row["task"] == task]
        for key, label, style in [
            ("range_mm", "ours", "o"),
            ("simulation_range_mm", "published simulation", "s"),
            ("bench_range_mm", "robot", "^"),
        ]:
            pairs = [(row["stiffness_compliance_n_per_mm"], row[key]) for row in own if row[key] != ""]
            ax.plot(*zip(*pairs), style, label=label, markersize=4)
        ax.set(title=task, xlabel="compliance stiffness (N/mm)", ylabel="tolerable range (mm)", ylim=(0, None))


def bench(folder, axes):
    """Plots the leave-one-out prediction of each measured finger with its 80 % interval."""
    for task, ax in zip(TASKS, axes):
        own = rows(folder / f"leave_one_out_{task}.csv")
        measured, predicted = ([row[key] for row in own] for key in ("measured_mm", "range_mm"))
        below = [row["range_mm"] - row["low_mm"] for row in own]
        above = [row["high_mm"] - row["range_mm"] for row in own]
        ax.errorbar(measured, predicted, yerr=[below, above], fmt="o", markersize=4, label="predicted, 80 % interval")
        ends = [min(measured + predicted), max(measured + predicted)]
        ax.plot(ends, ends, "--", linewidth=1, color="grey", label="equal")
        ax.set(title=task, xlabel="measured range (mm)", ylabel="predicted range (mm)")


def main(folder):
    folder = Path(folder)
    figure, axes = plt.subplots(2, 2, figsize=(8, 6), layout="constrained")
    draw = validation if (folder / "validation.csv").exists() else bench
    draw(folder, axes.flat)
    axes.flat[0].legend()
    figure.savefig(folder / "ranges.svg", metadata={"Date": None})


if __name__ == "__main__":
    main(sys.argv[1])
