#!/usr/bin/env python3
"""What the import makes of plug and socket files drawn by others, one folder for each pair.

    scripts/pairs.py FOLDER [--out RESULT.txt]

FOLDER/NAME holds `plug.*` and `socket.*`, or `assembly.*` with both mated (STL, OBJ, STEP). Each pair is imported by
its file names alone, then tuned (`task tune`) if its windows are less than 0.3 mm wide to either side with the fingers
of 10 %, 0 degrees, 20 %, 10 degrees and 30 %, 0 degrees. STEP needs the Python package (FINGER_OPT_PYTHON names its
interpreter).
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
#: Least distance of a window's ends from the start, mm.
LEAST_MM = 0.3
#: Longest time of a command, s.
LIMIT_S = 600


def run(*words: str) -> tuple[dict, str]:
    """The JSON that a command prints and, if it fails, its last line."""
    try:
        done = subprocess.run([str(PROGRAM), *words, "--json"], capture_output=True, text=True, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return {}, f"not ended within {LIMIT_S} s"
    errors = [line for line in done.stderr.splitlines() if line.startswith("error")]
    found = json.loads(done.stdout) if done.stdout.lstrip().startswith("{") else {}
    return found, "" if found else " ".join(errors)[:200]


def windows(task: Path) -> list[tuple[float, float]]:
    """Windows of the three fingers, mm."""
    found = []
    for density, direction in FINGERS:
        of, _ = run("evaluate", "--task", str(task), "--density", str(density), "--direction", str(direction))
        found.append((of.get("negative_mm") or 0.0, of.get("positive_mm") or 0.0))
    return found


def wide(found: list[tuple[float, float]]) -> bool:
    return all(low <= -LEAST_MM and high >= LEAST_MM for low, high in found)


def told(folder: Path, scratch: Path) -> str:
    """What came of a pair."""
    files = [next(folder.glob(f"{part}.*"), None) for part in ("assembly", "plug", "socket")]
    assembly, plug, socket = map(str, files)
    words = [assembly] if files[0] else ["--plug", plug, "--socket", socket]
    task, began = scratch / f"pair{folder.name}.toml", time.monotonic()
    found, error = run("task", "import", *words, "--out", str(task))
    lines = [f"{folder.name}  {Path(words[-1]).suffix[1:]}: "]
    if not found:
        return lines[0] + error
    mate = [why for why in found["found"] if why.startswith(("mate", "through", "handle", "symmetry", "poses"))]
    lines[0] += f"{found['parts']} parts, {found['check']['nominal']['outcome']}; " + "; ".join(mate)
    left = sum(one["parts"] for one in found["left_out"])
    if left:
        deepest = max(one["depth_mm"] for one in found["left_out"])
        lines.append(f"{left} parts that overlap by up to {deepest:.2f} mm are left out")
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
    given = parser.parse_args()
    pairs = sorted(folder for folder in given.folder.iterdir() if [*folder.glob("plug.*"), *folder.glob("assembly.*")])
    with tempfile.TemporaryDirectory() as scratch:
        for folder in pairs:
            text = told(folder, Path(scratch))
            print(text, flush=True)
            if given.out:
                with open(given.out, "a", encoding="utf-8") as file:
                    file.write(text + "\n")


if __name__ == "__main__":
    main()
