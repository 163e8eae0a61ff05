#!/usr/bin/env python3
"""Measures the gain of the loop of study, print, measurement and identification in hidden cells.

A hidden cell is a robot in MuJoCo whose parameters are drawn by its seed (finger_opt.robot.SimulatedRobot). In each
cell, six procedures (ways a to f) choose a finger as a lab would. Then the true windows of the chosen fingers and of
twelve fixed ones are searched. Every result is a line of FOLDER/CELL/found.jsonl; the same call continues there.

    scripts/loop.py FOLDER usb:1 ket8:1 ...        runs cells
    scripts/loop.py FOLDER --table                 prints the results

Needs the Python package with the extra mujoco.
"""

from __future__ import annotations

import argparse
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import finger_opt as fo
from finger_opt._rehearsal import Rehearsal
from finger_opt.robot import SimulatedRobot, measure_window

#: Density, %, and direction, degrees, of the medium finger (way a).
MEDIUM = (20.0, 20.0)
#: Prints of ways c and d.
PRINTS = 4
#: Stride, resolution and largest distance of the search for an end of a true window, mm.
STRIDE_MM, RESOLUTION_MM, FARTHEST_MM = 0.5, 0.1, 12.0
#: Budget of a study of finger and strategy, which would take hours without a budget.
EVALUATIONS = 80
#: Parameters of the space codesign that a lab sets without another print.
STRATEGY = ("task.strategy.tilt_deg", "task.strategy.phase.touch.preload_mm", "task.strategy.phase.side.move_mm.y",
            "task.grip.force_n", "task.strategy.phase.assembly.speed_mm_per_s")


def fixed() -> list[tuple[float, float]]:
    """Returns twelve fingers of a Sobol set over 10 to 30 % and 0 to 40 degrees."""
    return [(10.0 + round(20.0 * x), round(40.0 * y)) for x, y in sobol(12)]


def sobol(count: int) -> Iterator[tuple[float, float]]:
    """Yields the first points of the two-dimensional Sobol sequence, without 0 (Bratley and Fox 1988)."""
    first, second = [1 << (31 - i) for i in range(32)], [1 << 31]
    for i in range(1, 32):
        second.append(second[i - 1] ^ (second[i - 1] >> 1))
    x = y = 0
    for n in range(count):
        bit = (~n & (n + 1)).bit_length() - 1
        x, y = x ^ first[bit], y ^ second[bit]
        yield x / 2**32, y / 2**32


class Cell:
    """Hidden cell and the results so far."""

    def __init__(self, root: Path, task: str, seed: int) -> None:
        self.task, self.seed, self.path = task, seed, root / f"{task}-{seed}"
        self.path.mkdir(parents=True, exist_ok=True)
        self.file = self.path / "found.jsonl"
        lines = self.file.read_text(encoding="utf-8").splitlines() if self.file.exists() else []
        self.found: dict[str, Any] = {line["key"]: line for line in map(json.loads, lines)}

    def once(self, key: str, find: Callable[[], Any]) -> Any:
        """Returns the stored result of a key; computes and stores it if missing, with its processor time."""
        if key not in self.found:
            began = time.process_time()
            value = find()
            line = {"key": key, "value": value, "cpu_s": round(time.process_time() - began, 1)}
            with self.file.open("a", encoding="utf-8") as file:
                file.write(json.dumps(line) + "\n")
            self.found[key] = line
            print(f"{self.path.name} {key}: {value} ({line['cpu_s']} s)", flush=True)
        return self.found[key]["value"]

    # Work of the lab.

    def taught_mm(self, finger: list[float], strategy: dict[str, float]) -> float | None:
        """Returns the inserting start nearest to that of the task, in steps of 1 mm, as a person would teach it."""
        def find() -> float | None:
            robot = self.truth(finger, strategy)
            near = sorted(range(-8, 9), key=lambda at: (abs(at), -at))
            return next((float(at) for at in near if robot.insert(at, None, exact=True).inserted), None)

        return self.once(f"taught {finger} {strategy}", find)

    def window_mm(self, finger: list[float], strategy: dict[str, float] | None = None) -> float:
        """Returns the width of the true window, searched from the taught start; 0 if no start inserts."""
        strategy = strategy or {}
        taught = self.taught_mm(finger, strategy)

        def find() -> list[float]:
            if taught is None:
                return [0.0, 0.0]
            robot = self.truth(finger, strategy)
            return [end(lambda at: robot.insert(at, None, exact=True).inserted, taught, sign) for sign in (-1, 1)]

        low, high = self.once(f"window {finger} {strategy}", find)
        return round(high - low, 2)

    def truth(self, finger: list[float], strategy: dict[str, float]) -> Rehearsal:
        """Returns the robot of the cell, with this finger and strategy."""
        return Rehearsal(with_strategy(self.task, strategy), *finger, None, self.seed)

    def measure(self, folder: Path, finger: list[float], probe: bool) -> int:
        """Measures a finger as a lab does, into a folder; returns the number of attempts."""
        taught = self.taught_mm(finger, {})
        bench = folder / "bench.csv"
        folder.mkdir(exist_ok=True)

        def find() -> int:
            if taught is None:
                add_not_measurable(bench, self.task, finger)
                return 17
            robot = SimulatedRobot(self.task, *finger, "mujoco", seed=self.seed, taught_mm=taught)
            # Other jobs may run at the same time.
            robot.timeout_s = 3600.0  # type: ignore[attr-defined]
            found = measure_window(robot, task=self.task, density=finger[0], direction=finger[1], out=bench, probe=probe)
            return found.attempts

        return self.once(f"measured {folder.name} {finger}", find)

    # Procedures.

    def run(self, nominal: list[float], ways: str) -> None:
        """Follows these ways, then searches the windows of all fingers; ``nominal`` is the finger of way b."""
        named = [list(MEDIUM), nominal]
        if "e" in ways:
            found = nominal_strategy(self.path.parent, self.task)
            self.window_mm(infill(found), strategy(found))
        for finger, moves in self.by_identification(ways):
            self.window_mm(finger, moves)
            named.append(finger)
        if "c" in ways:
            named += self.by_measurement()
        if "t" in ways:
            for finger, moves in self.by_truth():
                self.window_mm(finger, moves)
                named.append(finger)
        for finger in [*named, *map(list, fixed())]:
            self.window_mm(finger)

    def by_measurement(self) -> list[list[float]]:
        """Follows way c: prints chosen by ``next`` from measured ranges only; returns the fingers."""
        folder, prints = self.path / "c", []
        for i in range(PRINTS):
            finger = self.advised(folder, f"c print {i + 1}")
            if finger is None:
                break
            self.measure(folder, finger, probe=False)
            prints.append(finger)
        return prints

    def by_identification(self, ways: str) -> list[tuple[list[float], dict[str, float]]]:
        """Follows ways d, e and f: logs of two fingers, an identified cell, a study; f measures one more finger.

        Returns the fingers with their strategies.
        """
        folder, chosen = self.path / "d", []
        self.two_windows(folder)
        if not (folder / "runs.csv").exists() or not self.identified(folder, "cell"):
            return []
        for cell in ("cell", "again") if "f" in ways else ("cell",):
            if cell == "again":
                self.measure(folder, chosen[0][0], probe=False)
                if not self.identified(folder, cell):
                    break
            for way, space in (("d", "infill"), ("e", str(strategy_space(self.path.parent)))):
                if way in ways:
                    found = self.once(f"{cell} {way}", lambda space=space: self.study(cell, space))
                    chosen.append((infill(found), strategy(found)))
        return chosen

    def by_truth(self) -> list[tuple[list[float], dict[str, float]]]:
        """Follows ways d and e in the drawn cell itself; returns the fingers with their strategies.

        Without an error of identification, what is left to a wider window is the model's.
        """
        from finger_opt import _native

        (self.path / "truth.toml").write_text(_native.drawn_cell(self.seed)[0], encoding="utf-8")
        spaces = {"d": "infill", "e": str(strategy_space(self.path.parent))}
        found = [self.once(f"truth {way}", lambda space=space: self.study("truth", space)) for way, space in spaces.items()]
        return [(infill(one), strategy(one)) for one in found]

    def two_windows(self, folder: Path) -> None:
        """Measures the first prints; replaces those that insert from no start by prints of ``next``, up to PRINTS."""
        left = first_prints(self.path.parent, self.task)
        for printed in range(PRINTS):
            if not left:
                left = [self.advised(folder, f"d print {printed + 1}")]
            if left[0] is None:
                break
            finger = left.pop(0)
            self.measure(folder, finger, probe=True)
            windows = sum(self.taught_mm(one, {}) is not None for one in self.measured(folder))
            if windows >= 2:
                break

    def measured(self, folder: Path) -> list[list[float]]:
        """Returns the fingers measured into a folder."""
        start = f"measured {folder.name} "
        return [json.loads(key.removeprefix(start)) for key in self.found if key.startswith(start)]

    def advised(self, folder: Path, key: str) -> list[float] | None:
        """Returns the finger that ``next`` advises after the measurements in a folder; None to stop."""
        def find() -> list[float] | None:
            folder.mkdir(exist_ok=True)
            advice = fo.next_print(folder / "bench.csv", self.task, cache=self.path.parent / "cache")
            return None if advice.stop or not advice.next else infill(advice.next[0].values)

        return self.once(key, find)

    def identified(self, folder: Path, name: str) -> bool:
        """Identifies the cell from the logs in a folder and writes NAME.toml; returns whether this succeeded."""
        def find() -> dict[str, float] | None:
            try:
                cell = fo.identify(self.task, folder / "runs.csv", self.path / f"{name}.toml")
            except (fo.InputError, fo.StudyError) as error:
                print(f"{self.path.name} {name}: {error}", file=sys.stderr)
                return None
            return {one.name: one.value for one in cell.unknowns}

        return self.once(f"identified {name}", find) is not None

    def study(self, cell: str, space: str) -> dict[str, float]:
        """Returns the values of the best finger in the identified cell, from a taught start as in the lab."""
        budget = None if space == "infill" else EVALUATIONS
        study = fo.Study.create(self.task, space=space, cell=self.path / f"{cell}.toml", start="taught", budget=budget,
                                out=self.path / f"study-{cell}-{Path(space).stem}", no_levers=True, no_map=True)
        found = study.run(progress=False).answer.finger
        return found or dict(zip(("infill_density_percent", "infill_direction_deg"), MEDIUM))


def end(inserts: Callable[[float], bool], start: float, sign: int) -> float:
    """Returns the end of a window, mm: the last start that inserts before two neighbouring starts fail.

    Searches in strides, then by bisection.
    """
    last = at = start
    while abs(at - start) < FARTHEST_MM and at - last <= STRIDE_MM and last - at <= STRIDE_MM:
        at += sign * STRIDE_MM
        if inserts(at):
            last = at
    low, high = 0, round(STRIDE_MM / RESOLUTION_MM)
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if inserts(last + sign * middle * RESOLUTION_MM) else (low, middle)
    return round(last + sign * low * RESOLUTION_MM, 2)


def infill(values: dict[str, float]) -> list[float]:
    """Returns density, %, and direction, degrees."""
    return [values["infill_density_percent"], values["infill_direction_deg"]]


def strategy(values: dict[str, float]) -> dict[str, float]:
    """Returns the values of the parameters in STRATEGY."""
    return {key: values[key] for key in STRATEGY if key in values}


def with_strategy(name: str, strategy: dict[str, float]) -> fo.Task:
    """Returns the task with this strategy."""
    task = fo.Task.from_toml(name)
    for key, value in strategy.items():
        *path, last = key.split(".")[1:]
        outer, at = None, task
        for part in path:
            outer, at = at, at[part]
        if last in ("x", "y", "z") and outer is not None:
            # A vector cannot be set by component.
            move = list(at)
            move["xyz".index(last)] = value
            outer[path[-1]] = move
        else:
            at[last] = value
    return task


def strategy_space(folder: Path) -> Path:
    """Writes the space codesign without the remote centre, which cannot be set independently in a print."""
    from finger_opt import _native

    rows = json.loads(_native.space("codesign"))
    keys = ("infill_density_percent", "infill_direction_deg", *STRATEGY)
    text = 'name = "strategy"\ndescription = "infill and what a lab sets on its robot"\n'
    for row in rows:
        if row["name"] in keys:
            text += (f'\n[[parameter]]\nkey = "{row["name"]}"\nlow = {row["low"]}\nhigh = {row["high"]}\n'
                     f'step = {row["step"]}\nsource = "codesign"\n')
    path = folder / "strategy.toml"
    path.write_text(text, encoding="utf-8")
    return path


def add_not_measurable(bench: Path, task: str, finger: list[float]) -> None:
    """Adds a finger that inserts from no start to the measurements."""
    subprocess.run([sys.executable, "-m", "finger_opt", "measure", "add", bench, "--task", task, "--density",
                    f"{finger[0]:g}", "--direction", f"{finger[1]:g}", "--not-measurable"], check=True,
                   stdout=subprocess.DEVNULL)


def nominal_best(root: Path, task: str) -> list[float]:
    """Returns the finger of way b: the best of a study in the shipped cell."""
    def find() -> list[float]:
        study = fo.Study.create(task, out=root / f"nominal-{task}", no_levers=True, no_map=True)
        return infill(study.run(progress=False).answer.finger or {})

    return cached(root / f"nominal-{task}.json", find)


def nominal_strategy(root: Path, task: str) -> dict[str, float]:
    """Returns the best finger and strategy of a study in the shipped cell."""
    def find() -> dict[str, float]:
        study = fo.Study.create(task, space=strategy_space(root), start="taught", budget=EVALUATIONS,
                                out=root / f"nominal-strategy-{task}", no_levers=True, no_map=True)
        return dict(study.run(progress=False).answer.finger or {})

    return cached(root / f"nominal-strategy-{task}.json", find)


def first_prints(root: Path, task: str) -> list[list[float]]:
    """Returns the two fingers that ``next`` advises before any measurement, the same for every cell."""
    def find() -> list[list[float]]:
        advice = fo.next_print(root / "none.csv", task, count=2, cache=root / "cache")
        return [infill(one.values) for one in advice.next]

    return cached(root / f"first-{task}.json", find)


def cached(file: Path, find: Callable[[], Any]) -> Any:
    """Returns the content of a JSON file; computes and writes it if missing."""
    if not file.exists():
        file.write_text(json.dumps(find()), encoding="utf-8")
    return json.loads(file.read_text(encoding="utf-8"))


def widths_by_way(folder: Path, cell: Path) -> dict[str, float | None] | None:
    """Returns the true width of each way's finger, mm, ``None`` if not followed; ``None`` for an incomplete cell."""
    task, seed = cell.name.rsplit("-", 1)
    found = Cell(folder, task, int(seed)).found
    widths = {key.removeprefix("window "): round(one["value"][1] - one["value"][0], 2)
              for key, one in found.items() if key.startswith("window ")}

    def width(finger: list[float] | None, chosen: dict[str, float] | None = None) -> float | None:
        return None if finger is None else widths.get(f"{finger} {chosen or {}}")

    def value(key: str) -> Any:
        return found.get(key, {}).get("value")

    def of_study(key: str) -> float | None:
        """Returns the width of a study's finger; of the medium finger if no cell was identified."""
        if value("identified cell") is None:
            return width(list(MEDIUM))
        return width(infill(value(key)), strategy(value(key))) if value(key) else None

    def of_nominal() -> float | None:
        file = folder / f"nominal-strategy-{task}.json"
        both = json.loads(file.read_text(encoding="utf-8")) if file.exists() else None
        return width(infill(both), strategy(both)) if both else None

    if None in [width(list(one)) for one in fixed()]:
        return None
    prints = [value(f"c print {i + 1}") for i in range(PRINTS)]
    return {"a": width(list(MEDIUM)), "b": width(nominal_best(folder, task)),
            "b+e": of_nominal(),
            "c": max((width(one) or 0.0 for one in prints if one), default=None),
            "d": of_study("cell d"), "e": of_study("cell e"), "f": of_study("again d"), "f+e": of_study("again e"),
            "best shipped": max(width for key, width in widths.items() if key.endswith("{}")),
            "best": max(widths.values())}


def table(folder: Path) -> None:
    """Prints the gain of each way over the medium finger with the shipped strategy, and its share of the best gain."""
    cells = {path.name: widths_by_way(folder, path) for path in sorted(folder.glob("*-[0-9]*")) if path.is_dir()}
    done = {name: widths for name, widths in cells.items() if widths}
    ways = ("a", "b", "b+e", "c", "d", "e", "f", "f+e", "best shipped", "best")
    print("| cell | " + " | ".join(f"{way}, mm" for way in ways) + " |\n| --- |" + " --- |" * len(ways))
    for name, widths in done.items():
        print(f"| {name} | " + " | ".join("" if widths[way] is None else f"{widths[way]:.1f}" for way in ways) + " |")
    for way in ways[1:]:
        best = "best" if "e" in way else "best shipped"
        pairs = [(mm[way] - mm["a"], mm[best] - mm["a"]) for mm in done.values() if mm[way] is not None]
        gains, shares = [gain for gain, _ in pairs], [100.0 * gain / most for gain, most in pairs if most > 0.0]
        if len(gains) > 1 and len(shares) > 1:
            low, middle, high = statistics.quantiles(gains, n=4)
            print(f"{way}: {middle:+.1f} mm ({low:+.1f} to {high:+.1f}), "
                  f"{statistics.median(shares):.0f} % of the best gain; "
                  f"worse than a by more than 0.3 mm in {sum(gain < -0.3 for gain in gains)} of {len(gains)} cells")
    left = sorted(set(cells) - set(done))
    if left:
        print(f"incomplete: {', '.join(left)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("cells", nargs="*", metavar="TASK:SEED")
    parser.add_argument("--ways", default="cdef", help="ways in addition to a and b [default: cdef]; e also runs b+e, "
                        "the finger and strategy from the shipped cell; the best width is that of the ways followed")
    parser.add_argument("--table", action="store_true")
    arguments = parser.parse_args()
    arguments.folder = arguments.folder.resolve()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    for cell in arguments.cells:
        task, seed = cell.rsplit(":", 1)
        Cell(arguments.folder, task, int(seed)).run(nominal_best(arguments.folder, task), arguments.ways)
    if arguments.table:
        table(arguments.folder)


if __name__ == "__main__":
    main()
