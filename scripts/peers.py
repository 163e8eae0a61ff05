#!/usr/bin/env python3
"""Compares our optimizers with others on test functions and recorded landscapes.

    python3 -m venv venv
    venv/bin/pip install cma==4.5.0 optuna==5.0.0 botorch==0.18.1 torch==2.15.0 scipy==1.17.1
    venv/bin/python scripts/peers.py run pycma --csv pycma.csv
    venv/bin/python scripts/peers.py run tpe gpsampler botorch --csv peers.csv \\
        --landscape results/reference/landscapes/{usb,ket8,ket12,rj45}.csv
    venv/bin/python scripts/peers.py run gp cma-es --csv ours.csv \\
        --landscape results/reference/landscapes/{usb,ket8,ket12,rj45}.csv
    venv/bin/python scripts/peers.py ratios results/reference/optimizers/ours.csv pycma.csv peers.csv

`run` prints one line per problem and method, and appends every run to the CSV (with the columns
of `ours.csv`); `ratios` prints Markdown. Ours need the package finger_opt, pycma needs neither
optuna nor torch, tpe needs no torch.
"""
import argparse
import csv
import itertools
import os
import random
import statistics
import time
import warnings
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Callable

os.environ.setdefault("OMP_NUM_THREADS", "1")
warnings.filterwarnings("ignore")
import numpy as np

PINNED = {"cma": "4.5.0", "optuna": "5.0.0", "botorch": "0.18.1"}
# Levels per axis of a test function.
LEVELS = 1001
# Largest number of evaluations, and target.
CMA_LIMIT, CMA_TARGET = 1_000_000, 1e-8
# Largest number of evaluations, and accepted difference from the best range.
LANDSCAPE_LIMIT, SHORTFALL_MM = 100, 0.1


def sphere(x):
    return float(np.sum(np.square(x)))


def rosenbrock(x):
    x = np.asarray(x)
    return float(np.sum(100 * (x[1:] - x[:-1] ** 2) ** 2 + (1 - x[:-1]) ** 2))


def ellipsoid(x):
    n = len(x)
    return float(np.sum(1e6 ** (np.arange(n) / (n - 1)) * np.square(x)))


def rastrigin(x):
    x = np.asarray(x)
    return float(np.sum(x**2 + 10 - 10 * np.cos(2 * np.pi * x)))


def branin(u):
    x, y = 15 * u[0] - 5, 15 * u[1]
    a = y - 5.1 / (4 * np.pi**2) * x * x + 5 / np.pi * x - 6
    return float(a * a + 10 * (1 - 1 / (8 * np.pi)) * np.cos(x) + 10)


ALPHA = np.array([1.0, 1.2, 3.0, 3.2])
A = np.array([[10, 3, 17, 3.5, 1.7, 8], [0.05, 10, 17, 0.1, 8, 14],
              [3, 3.5, 1.7, 10, 17, 8], [17, 8, 0.05, 10, 0.1, 14]])
P = np.array([[0.1312, 0.1696, 0.5569, 0.0124, 0.8283, 0.5886],
              [0.2329, 0.4135, 0.8307, 0.3736, 0.1004, 0.9991],
              [0.2348, 0.1451, 0.3522, 0.2883, 0.3047, 0.6650],
              [0.4047, 0.8828, 0.8732, 0.5743, 0.1091, 0.0381]])


def hartmann6(u):
    return float(-np.sum(ALPHA * np.exp(-np.sum(A * (np.asarray(u) - P) ** 2, axis=1))))


UNBOUNDED = {"sphere": sphere, "rosenbrock": rosenbrock,
             "ellipsoid": ellipsoid, "rastrigin": rastrigin}


@dataclass
class Problem:
    """Function to maximise on an integer grid, up to a target."""

    name: str
    levels: list
    value: Callable
    target: float
    limit: int

    def unit(self, point):
        return [k / (n - 1) for k, n in zip(point, self.levels)]


def functions():
    """Returns the test functions on the unit cube."""
    def problem(name, function, dimension, minimum, regret, limit):
        levels = [LEVELS] * dimension
        value = lambda point: -function([k / (LEVELS - 1) for k in point])
        return Problem(name, levels, value, -minimum - regret, limit)

    return [problem("branin to 1 %", branin, 2, 0.397887, 3.0773, 200),
            problem("branin to 0.004", branin, 2, 0.397887, 0.00397887, 200),
            problem("hartmann6 to 1 %", hartmann6, 6, -3.32237, 0.0332237, 60)]


def landscape(file):
    """Returns the problem of a recorded landscape: the range, mm, over the design."""
    lines = [line for line in Path(file).read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.reader(lines))
    axes = rows[0].index("range_mm")
    at = lambda row: tuple(float(cell) for cell in row[:axes])
    steps = [sorted({at(row)[axis] for row in rows[1:]}) for axis in range(axes)]
    values = {tuple(s.index(v) for s, v in zip(steps, at(row))): float(row[axes]) for row in rows[1:]}
    return Problem(f"{Path(file).stem} landscape", [len(s) for s in steps], values.__getitem__,
                   max(values.values()) - SHORTFALL_MM - 1e-9, LANDSCAPE_LIMIT)


def our_run(method, problem, seed):
    """Returns the number of evaluations to the target, or None."""
    from finger_opt import Optimizer

    names = [f"x{i}" for i in range(len(problem.levels))]
    space = {name: (0, n - 1, 1) for name, n in zip(names, problem.levels)}
    optimizer = Optimizer(space, method, seed)
    for evaluation in range(1, problem.limit + 1):
        points = optimizer.ask(1)
        if not points:
            return None
        value = problem.value(tuple(int(points[0][name]) for name in names))
        if value >= problem.target:
            return evaluation
        optimizer.tell(points, [value])
    return None


def optuna_run(make, problem, seed):
    """Returns the number of evaluations to the target, or None."""
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(direction="maximize", sampler=make(optuna.samplers, seed))
    for evaluation in range(1, problem.limit + 1):
        trial = study.ask()
        point = tuple(trial.suggest_int(f"x{i}", 0, n - 1) for i, n in enumerate(problem.levels))
        value = problem.value(point)
        if value >= problem.target:
            return evaluation
        study.tell(trial, value)
    return None


def botorch_run(problem, seed):
    """Returns the number of evaluations to the target, or None.

    Uses SingleTaskGP and LogExpectedImprovement with their defaults, after a Sobol start. On a
    small grid the acquisition function is maximised over all points not evaluated yet; otherwise
    over the cube, and the best local maximum whose grid point is new is used.
    """
    import torch
    from botorch.acquisition import LogExpectedImprovement
    from botorch.fit import fit_gpytorch_mll
    from botorch.models import SingleTaskGP
    from botorch.optim import optimize_acqf, optimize_acqf_discrete
    from gpytorch.mlls import ExactMarginalLogLikelihood

    torch.set_num_threads(1)
    torch.manual_seed(seed)
    d = len(problem.levels)
    top = torch.tensor(problem.levels, dtype=torch.double) - 1
    start = torch.quasirandom.SobolEngine(d, scramble=True, seed=seed).draw(max(5, 2 * d))
    initial = [tuple(int(v) for v in row) for row in torch.round(start.double() * top)]
    small = np.prod(problem.levels) <= 20_000
    grid = [tuple(p) for p in itertools.product(*map(range, problem.levels))] if small else []
    bounds = torch.tensor([[0.0] * d, [1.0] * d], dtype=torch.double)
    points, values = [], []
    for evaluation in range(1, problem.limit + 1):
        if initial:
            point = initial.pop(0)
        else:
            x = torch.tensor(points, dtype=torch.double) / top
            y = torch.tensor(values, dtype=torch.double).unsqueeze(-1)
            model = SingleTaskGP(x, y)
            fit_gpytorch_mll(ExactMarginalLogLikelihood(model.likelihood, model))
            acquisition = LogExpectedImprovement(model, best_f=y.max())
            if small:
                evaluated = set(points)
                unseen = torch.tensor([p for p in grid if p not in evaluated], dtype=torch.double) / top
                found, _ = optimize_acqf_discrete(acquisition, q=1, choices=unseen)
            else:
                found, acquired = optimize_acqf(acquisition, bounds, q=1, num_restarts=10,
                                               raw_samples=512, return_best_only=False)
                ranked = found.reshape(-1, d)[acquired.reshape(-1).argsort(descending=True)]
                new = [row for row in ranked
                       if tuple(int(v) for v in torch.round(row * top)) not in set(points)]
                found = (new or [ranked[0]])[0]
            point = tuple(int(v) for v in torch.round(found.reshape(-1) * top))
        value = problem.value(point)
        if value >= problem.target:
            return evaluation
        points.append(point)
        values.append(value)
    return None


OURS = ["gp", "cma-es", "random", "sobol", "grid"]
GRID_METHODS = {
    **{method: lambda p, s, method=method: our_run(method, p, s) for method in OURS},
    "tpe": lambda p, s: optuna_run(lambda samplers, seed: samplers.TPESampler(seed=seed), p, s),
    "gpsampler": lambda p, s: optuna_run(
        lambda samplers, seed: samplers.GPSampler(seed=seed, deterministic_objective=True), p, s),
    "botorch": botorch_run,
}


class Reached(Exception):
    """Raised once the target is reached."""


def pycma_run(f, n, seed):
    """Returns the number of evaluations to the target, or None."""
    import cma

    count = 0

    def counted(x):
        nonlocal count
        count += 1
        value = f(x)
        if value < CMA_TARGET:
            raise Reached
        return value

    # pycma adds 1 to its seed at each restart: with consecutive seeds, the second run of one
    # seed would equal the first run of the next.
    first = 1 + 1000 * seed
    np.random.seed(first)
    start = lambda: np.random.uniform(-4, 4, n)
    options = {"verbose": -9, "seed": first, "maxfevals": CMA_LIMIT}
    try:
        cma.fmin2(counted, start, 2, options, restarts=9, bipop=True)
    except Reached:
        return count
    return None


def work(methods, problems):
    """Yields the names of problem and method, and the function that runs a seed."""
    if "pycma" in methods:
        for (name, f), n in itertools.product(UNBOUNDED.items(), (2, 5)):
            yield f"{name} {n}-D to 1e-8", "pycma", lambda s, f=f, n=n: pycma_run(f, n, s)
    for problem, method in itertools.product(problems, methods):
        if method in GRID_METHODS:
            run = GRID_METHODS[method]
            yield problem.name, method, lambda s, run=run, problem=problem: run(problem, s)


def run(arguments):
    """Runs the methods on the problems and appends the results to the CSV."""
    packages = {"pycma": "cma", "tpe": "optuna", "gpsampler": "optuna", "botorch": "botorch"}
    for package in {packages[method] for method in arguments.methods if method in packages}:
        found = version(package)
        assert found == PINNED[package], f"{package} {PINNED[package]} is required, not {found}"
    problems = functions() + [landscape(file) for file in arguments.landscape]
    with open(arguments.csv, "a", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        if file.tell() == 0:
            out.writerow(["problem", "method", "seed", "evaluations"])
            file.flush()
        for name, method, of_seed in work(arguments.methods, problems):
            if arguments.only and arguments.only not in name:
                continue
            begun = time.process_time()
            runs = [of_seed(seed) for seed in range(arguments.seeds)]
            out.writerows([name, method, s, "" if r is None else r] for s, r in enumerate(runs))
            file.flush()
            done = sum(r is not None for r in runs)
            print(f"{name}, {method}: {done}/{len(runs)}, median {median(runs)}, "
                  f"{time.process_time() - begun:.0f} s of processor time", flush=True)


def median(runs):
    """Returns the upper median; a failed run is worse than all others."""
    return sorted(float("inf") if r is None else r for r in runs)[len(runs) // 2]


def mean(runs):
    """Returns the mean; infinite if a run failed."""
    return float("inf") if None in runs else statistics.fmean(runs)


def interval(ours, theirs, statistic):
    """Returns the 95 % interval of the ratio of the statistic, by 2000 bootstrap samples of both sets of runs."""
    rng = random.Random(0)
    ratios = sorted(ratio(statistic(rng.choices(ours, k=len(ours))), statistic(rng.choices(theirs, k=len(theirs))))
                    for _ in range(2000))
    return ratios[50], ratios[1949]


def ratio(ours, theirs):
    if theirs == float("inf"):
        return 0.0 if ours < theirs else float("nan")
    return ours / theirs


def ratios(arguments):
    """Prints a Markdown table of our results against the best peer."""
    runs = {}
    for name in arguments.csv:
        with open(name, newline="") as file:
            for row in csv.DictReader(file):
                evaluations = int(row["evaluations"]) if row["evaluations"] else None
                runs.setdefault(row["problem"], {}).setdefault(row["method"], []).append(evaluations)
    show = lambda v: "-" if v == float("inf") else f"{v:.0f}"
    print("| problem | ours | peers, best first | ours / best peer (95 % interval) |")
    print("| --- | --- | --- | --- |")
    for problem, methods in runs.items():
        ours_name, statistic = ("cma-es", mean) if "pycma" in methods else ("gp", median)
        peers = {m: r for m, r in methods.items() if m == "pycma" or m in GRID_METHODS and m not in OURS}
        if not peers or ours_name not in methods:
            continue
        reached = lambda r: "" if None not in r else f" ({sum(v is not None for v in r)}/{len(r)})"
        text = lambda m, r: f"{m} {show(statistic(r))}{reached(r)}"
        ours = methods[ours_name]
        best_first = sorted(peers.items(), key=lambda p: (statistic(p[1]), p[1].count(None) / len(p[1])))
        best = best_first[0][1]
        low, high = interval(ours, best, statistic)
        print(f"| {problem} | {text(ours_name, ours)} | "
              f"{', '.join(text(m, r) for m, r in best_first)} | "
              f"{ratio(statistic(ours), statistic(best)):.2f} ({low:.2f} to {high:.2f}) |")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    commands = parser.add_subparsers(required=True)
    command = commands.add_parser("run")
    command.add_argument("methods", nargs="+", choices=["pycma", *GRID_METHODS])
    command.add_argument("--csv", required=True)
    command.add_argument("--seeds", type=int, default=20)
    command.add_argument("--landscape", nargs="*", default=[])
    command.add_argument("--only", help="only problems whose name contains this text")
    command.set_defaults(run=run)
    command = commands.add_parser("ratios")
    command.add_argument("csv", nargs="+")
    command.set_defaults(run=ratios)
    arguments = parser.parse_args()
    arguments.run(arguments)
