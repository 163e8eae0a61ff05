#!/usr/bin/env python3
"""Tests `task import` on third-party plug and socket files, one folder per pair.

    scripts/pairs.py FOLDER [--out RESULT.txt]

FOLDER/NAME holds `plug.*` and `socket.*`, or `assembly.*` with both mated (STL, OBJ, STEP). Each pair is imported
without other options, then tuned (`task tune`) if its window with any of three fingers (10 % at 0 degrees, 20 % at 10
degrees, 30 % at 0 degrees) extends less than 0.3 mm to either side of the start. STEP needs the Python package
(FINGER_OPT_PYTHON names its interpreter).
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

PROGRAM = Path(__file__).parents[1] / "target/release/optimize"
#: Density, %, and direction, degrees.
FINGERS = ((10, 0), (20, 10), (30, 0))
#: Least distance of the ends of a window from the start, mm.
LEAST_MM = 0.3
#: Time limit of a command, s.
LIMIT_S = 600


def run(*words: str) -> tuple[dict, str]:
    """Runs a command; returns its JSON and, if it fails, its error lines."""
    try:
        done = subprocess.run([str(PROGRAM), *words, "--json"], capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return {}, f"no result within {LIMIT_S} s"
    errors = [line for line in done.stderr.splitlines() if line.startswith("error")]
    found = json.loads(done.stdout) if done.stdout.lstrip().startswith("{") else {}
    return found, "" if found else " ".join(errors)[:200]


def windows(task: Path) -> list[tuple[float, float]]:
    """Returns the windows of the three fingers, mm."""
    found = []
    for density, direction in FINGERS:
        window, _ = run("evaluate", "--task", str(task), "--density", str(density), "--direction", str(direction))
        found.append((window.get("negative_mm") or 0.0, window.get("positive_mm") or 0.0))
    return found


def wide(found: list[tuple[float, float]]) -> bool:
    """Returns whether all windows extend at least LEAST_MM to both sides."""
    return all(low <= -LEAST_MM and high >= LEAST_MM for low, high in found)


def report(folder: Path, scratch: Path) -> str:
    """Imports a pair and, if necessary, tunes it; returns a summary."""
    files = [next(folder.glob(f"{part}.*"), None) for part in ("assembly", "plug", "socket")]
    assembly, plug, socket = map(str, files)
    words = [assembly] if files[0] else ["--plug", plug, "--socket", socket]
    task, began = scratch / f"pair{folder.name}.toml", time.monotonic()
    found, error = run("task", "import", *words, "--out", str(task))
    lines = [f"{folder.name}  {Path(words[-1]).suffix[1:]}: "]
    if not found:
        return lines[0] + error
    topics = ("mate", "through", "handle", "symmetry", "poses")
    findings = [line for line in found["found"] if line.startswith(topics)]
    lines[0] += f"{found['parts']} parts, {found['check']['nominal']['outcome']}; " + "; ".join(findings)
    left_out = sum(body["parts"] for body in found["left_out"])
    if left_out:
        deepest = max(body["depth_mm"] for body in found["left_out"])
        lines.append(f"{left_out} parts that overlap by up to {deepest:.2f} mm are left out")
    ends, how = windows(task), "as imported"
    if not wide(ends):
        tuned, error = run("task", "tune", str(task))
        how = f"tuned: {tuned['by']['what']}" if tuned else f"not tuned: {error}"
        ends = windows(task)
    shown = ", ".join(f"{low:.1f} .. +{high:.1f}" for low, high in ends)
    verdict = "wide enough" if wide(ends) else "TOO NARROW"
    lines.append(f"windows {shown} mm ({how}): {verdict}, {time.monotonic() - began:.0f} s")
    return "\n    ".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    pairs = sorted(folder for folder in arguments.folder.iterdir()
                   if [*folder.glob("plug.*"), *folder.glob("assembly.*")])
    with tempfile.TemporaryDirectory() as scratch:
        for folder in pairs:
            text = report(folder, Path(scratch))
            print(text, flush=True)
            if arguments.out:
                with open(arguments.out, "a", encoding="utf-8") as file:
                    file.write(text + "\n")


if __name__ == "__main__":
    main()
