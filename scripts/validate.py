#!/usr/bin/env python3
"""Compares our tolerance windows with the published ones: validation.csv and accuracy.md.

    scripts/validate.py PROGRAM FOLDER [--strides] [OPTION..]   OPTION: of `optimize evaluate`, for example --robot ur5e

Simulates the windows of all published designs, with their measured stiffness, by exhaustive search as in the paper, or
with --strides by the coarse-to-fine search.
"""
import csv
import json
import math
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

DATA = Path(__file__).resolve().parent.parent / "data"
TASKS = ["ket8", "ket12", "rj45", "usb"]
SOURCES = ["", "simulation_", "bench_"]
#: Compared sources, each with its reference.
COMPARISONS = [("", "simulation_"), ("", "bench_"), ("simulation_", "bench_")]
INFILL = ["infill_density_percent", "infill_direction_deg"]
STIFFNESS = ["stiffness_assembly_n_per_mm", "stiffness_compliance_n_per_mm"]
READING = ["range_mm", "failure_negative", "failure_positive"]


def rows(name):
    """Returns the rows of a table in data/."""
    with open(DATA / name, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def rounded(value, digits=1):
    """Formats a number, rounded half away from zero and never as a negative zero; empty without a value."""
    if value is None:
        return ""
    scaled = math.floor(abs(value) * 10**digits + 0.5) / 10**digits
    return f"{math.copysign(scaled, value) if scaled else 0.0:.{digits}f}"


def window(program, options, task, design):
    """Simulates the window of a design on a task."""
    command = [program, "evaluate", "--json", "--quiet", "--no-config", "--no-ribs", "--task", task, *options]
    names = ["--density", "--direction", "--stiffness-assembly", "--stiffness-compliance"]
    for option, column in zip(names, INFILL + STIFFNESS):
        command += [option, design[column]]
    found = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    row = {"task": task, **{key: f"{float(value):g}" for key, value in design.items()}, "nominal": found["nominal"]}
    row |= {key: f"{found[key]:g}" for key in ("negative_mm", "positive_mm")}
    # If the nominal start diverges, the range is unknown; if it fails, the range is 0. Neither has ends.
    row["range_mm"] = "" if found["nominal"] == "diverged" else rounded(found["range_mm"])
    inserted = found["nominal"] == "inserted"
    return row | {key: str(found[key] or "") if inserted else "" for key in READING[1:]}


def compared(row, published):
    """Returns a row with the published readings and the differences of the ranges; an error is range minus reference."""
    for source, table in published.items():
        same = (one for one in table if one["task"] == row["task"] and all(float(one[key]) == float(row[key]) for key in INFILL))
        found = next(same, {})
        measurable = found.get("range_mm", "").replace(".", "", 1).isdigit()
        row[f"{source}range_mm"] = rounded(float(found["range_mm"])) if measurable else ""
        row |= {source + key: found.get(key, "") for key in READING[1:]}
    for source, reference in COMPARISONS:
        pair = [row[f"{one}range_mm"] for one in (source, reference)]
        error = float(pair[0]) - float(pair[1]) if all(pair) else None
        row[f"{source}error_to_{reference}mm"] = rounded(error)
        # The paper's deviation.
        percent = None if error is None else 100 * abs(error) / float(pair[1])
        row[f"{source}deviation_to_{reference}percent"] = rounded(percent)
    return row


def ranks(values):
    """Returns the ranks of values; tied ones share the mean of their ranks."""
    return [sum(other < value for other in values) + (values.count(value) - 1) / 2 for value in values]


def pearson(pairs):
    """Returns the correlation coefficient, or None if a variable is constant."""
    means = [math.fsum(values) / len(pairs) for values in zip(*pairs)]
    sums = [math.fsum((p[i] - means[i]) * (p[j] - means[j]) for p in pairs) for i, j in ((0, 0), (1, 1), (0, 1))]
    return sums[2] / math.sqrt(sums[0] * sums[1]) if sums[0] * sums[1] > 0 else None


def agreement(table, source, reference):
    """Returns mean absolute error, Spearman's rank correlation and the paper's failure match score as text."""
    pairs = [[float(row[f"{one}range_mm"]) for one in (source, reference)] for row in table
             if row[f"{source}range_mm"] and row[f"{reference}range_mm"]]
    ends = [(row[source + end], row[reference + end]) for row in table for end in READING[1:] if row[reference + end]]
    error = f"{math.fsum(abs(a - b) for a, b in pairs) / len(pairs):.2f} mm" if pairs else "-"
    rank = pearson(list(zip(*map(ranks, zip(*pairs))))) if len(pairs) > 2 else None
    rank = "-" if rank is None else ("" if float(rounded(rank, 2)) < 0 else "+") + rounded(rank, 2)
    share = f"{100 * sum(a == b for a, b in ends) / len(ends):.1f} %" if ends else "-"
    return f"{error}, {rank}, {share}"


def main(program, folder, *options):
    published = {"simulation_": rows("published_simulation.csv"), "bench_": rows("published_bench.csv")}
    options = [option for option in options if option != "--strides"] + ["--walk"] * ("--strides" not in options)
    pairs = [(task, design) for task in TASKS for design in rows("measured_stiffness.csv")]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = pool.map(lambda pair: compared(window(program, options, *pair), published), pairs)
        found = list(found)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "validation.csv", "w", newline="") as file:
        columns = ["task", "design", *INFILL, *STIFFNESS, "nominal", "negative_mm", "positive_mm"]
        columns += [source + key for source in SOURCES for key in READING]
        columns += [f"{source}{kind}_to_{reference}{unit}" for source, reference in COMPARISONS
                    for kind, unit in (("error", "mm"), ("deviation", "percent"))]
        table = csv.DictWriter(file, columns, lineterminator="\n")
        table.writeheader()
        table.writerows(found)
    text = "| task | starts | ours - simulation | ours - bench | simulation - bench |\n| --- | --- | --- | --- | --- |\n"
    for task in TASKS:
        own = [row for row in found if row["task"] == task]
        starts = f"{sum(row['nominal'] == 'inserted' for row in own)} of {len(own)}"
        text += f"| {task} | {starts} | {' | '.join(agreement(own, *pair) for pair in COMPARISONS)} |\n"
    (folder / "accuracy.md").write_text(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
