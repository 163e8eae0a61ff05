#!/usr/bin/env python3
"""Measures the accuracy of `finger_opt.robot.measure_window` on 20 synthetic robots; prints a Markdown table.

Each end is drawn 0.5 to 5 mm from the taught start; the insertion probability is a logistic function, 0.6 mm wide from
90 to 10 %. Every fourth window has a gap of 0.3 mm, at least 0.5 mm from the start and from the end, in which every
insertion fails. The method (priors, lapse, odds of a gap) was tuned on the seeds 1000 to 1399; the table is for the
seeds 101 to 120.

    python scripts/measure_window.py [FIRST_SEED] [COUNT] [WIDTH_MM]
"""

import math
import statistics
import sys
import tempfile
from pathlib import Path

import numpy as np
from finger_opt.robot import Attempt, measure_window


class Synthetic:
    """Robot with a window of known ends, mm."""

    def __init__(self, seed: int, width_mm: float) -> None:
        self.rng = np.random.default_rng([29, seed])
        self.ends = self.rng.uniform(0.5, 5.0, 2) * (-1.0, 1.0)
        self.scale_mm = width_mm / (2.0 * math.log(9.0))
        self.gap = self.draw_gap() if seed % 4 == 0 else None

    def draw_gap(self) -> tuple[float, float]:
        """Draws a gap (low, high), mm."""
        side = int(self.rng.random() >= 0.5)
        # The other side, if this one has too little space.
        side = side if abs(self.ends[side]) >= 1.5 else 1 - side
        near = self.rng.uniform(0.5, max(0.51, abs(self.ends[side]) - 0.8))
        return (near, near + 0.3) if side else (-near - 0.3, -near)

    def insert(self, offset_mm: float, log: Path | None = None) -> Attempt:
        low, high = self.ends
        inside = 1.0 / (1.0 + math.exp((low - offset_mm) / self.scale_mm))
        inside /= 1.0 + math.exp((offset_mm - high) / self.scale_mm)
        inserted = bool(self.rng.random() < inside)
        if self.gap and self.gap[0] <= offset_mm <= self.gap[1]:
            inserted = False
        return Attempt(inserted, None if inserted else 3, 12.5 if inserted else 5.0, 30.0)


def main() -> None:
    defaults = ("101", "20", "0.6")
    first, count, width = [*sys.argv[1:], *defaults[len(sys.argv) - 1 :]]
    first, count, width_mm = int(first), int(count), float(width)
    errors, attempts, covered, gaps, met = [], [], 0, 0, 0
    print("| seed | ends mm | measured mm | 95 % intervals mm | gap mm | attempts |\n| --- | --- | --- | --- | --- | --- |")
    for seed in range(first, first + count):
        robot = Synthetic(seed, width_mm)
        with tempfile.TemporaryDirectory() as folder:
            found = measure_window(robot, task="usb", density=20, direction=10, out=Path(folder) / "bench.csv")
        measured = (found.negative_mm, found.positive_mm)
        intervals = (found.negative_interval_mm, found.positive_interval_mm)
        errors += [abs(mm - end) for mm, end in zip(measured, robot.ends, strict=True)]
        covered += sum(low <= end <= high for (low, high), end in zip(intervals, robot.ends, strict=True))
        attempts.append(found.attempts)
        gap = ""
        if robot.gap:
            gaps, met = gaps + 1, met + bool(found.gaps)
            gap = f"{robot.gap[0]:.2f} to {robot.gap[1]:.2f}, " + ("met" if found.gaps else "not met")
        elif found.gaps:
            gap = "none, but said"
        ends = ", ".join(f"{end:.2f}" for end in robot.ends)
        spans = "; ".join(f"{low:.2f} to {high:.2f}" for low, high in intervals)
        print(f"| {seed} | {ends} | {measured[0]:.2f}, {measured[1]:.2f} | {spans} | {gap} | {found.attempts} |")
    print(f"\nwithin 0.2 mm: {sum(error <= 0.2 for error in errors)} of {len(errors)}; largest error {max(errors):.2f} mm; "
          f"in the 95 % interval: {covered}; "
          f"attempts: median {statistics.median(attempts):g}, at most {max(attempts)}; gaps met: {met} of {gaps}")


if __name__ == "__main__":
    main()
