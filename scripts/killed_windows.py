#!/usr/bin/env python3
"""Kills `measure_window` at random times: scripts/killed_windows.py KILLS FOLDER

Each window is restarted until it is complete. Its line of the table and its attempts must equal those of an
uninterrupted window, with no attempt duplicated or lost. Needs the package, built with the feature `fake-engine`.
"""
import random
import subprocess
import sys
import time
from pathlib import Path

CODE = """
import sys, time
from finger_opt.robot import SimulatedRobot, measure_window
class Slow(SimulatedRobot):
    def insert(self, offset_mm, log=None):
        time.sleep(0.01)
        return super().insert(offset_mm, log)
print("ready", flush=True)
measure_window(Slow("usb", 20, 10, engine="fake"), out=sys.argv[1], task="usb", density=20, direction=10)
"""


def attempts(folder):
    """Returns the lines of the attempts files except those about a stop."""
    lines = []
    for file in sorted(folder.glob("bench-*.jsonl")):
        lines += [line for line in file.read_text().splitlines() if "stopped" not in line]
    return lines


def start(folder):
    """Starts a process that measures into this folder; returns once the package is imported."""
    folder.mkdir(parents=True, exist_ok=True)
    process = subprocess.Popen(
        [sys.executable, "-c", CODE, folder / "bench.csv"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    return process


def finish(process, folder):
    """Waits for a process; returns its table and its number of attempts. Exits if the process failed."""
    _, error = process.communicate()
    if process.returncode != 0:
        sys.exit(f"killed_windows: {folder}: {error}")
    return (folder / "bench.csv").read_text(), len(attempts(folder))


def main():
    kills, folder = int(sys.argv[1]), Path(sys.argv[2])
    process, clock = start(folder / "whole"), time.monotonic()
    reference = finish(process, folder / "whole")
    duration_s, rng, killed, windows = time.monotonic() - clock, random.Random(1), 0, 0
    while killed < kills:
        window = folder / str(windows)
        for _ in range(5):
            process = start(window)
            time.sleep(rng.random() * duration_s)
            killed += process.poll() is None
            process.kill()
            process.communicate()
        if finish(start(window), window) != reference:
            sys.exit(f"killed_windows: {window} differs from {folder / 'whole'}")
        windows += 1
    print(f"windows       {killed} kills of {windows} windows: the same line, {reference[1]} attempts each")


main()
