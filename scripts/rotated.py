#!/usr/bin/env python3
"""Compares `cma-es` with pycma on rotated functions in 3 and 6 dimensions within -5..5.

    pip install cma==4.5.0
    python scripts/rotated.py target/release/optimize 40            # seeds; a table in Markdown
    python scripts/rotated.py target/release/optimize 40 sphere cigar

Each seed has its own rotation, minimum in -2..2 and start in -4..4, the same for both optimizers; the
initial step size is 3. Counts the evaluations until 1e-8, at most 300 000; both restart by BIPOP.
"""
import itertools
import json
import random
import statistics
import subprocess
import sys
import warnings

import numpy as np

warnings.filterwarnings("ignore")
import cma

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "optimize"
LIMIT, TARGET, STEP = 300_000, 1e-8, 3.0


def rosenbrock(y):
    z = y + 1
    return np.sum(100 * (z[1:] - z[:-1] ** 2) ** 2 + (1 - z[:-1]) ** 2)


FUNCTIONS = {
    "sphere": lambda y: np.sum(y**2),
    "ellipsoid": lambda y: np.sum(1e6 ** (np.arange(len(y)) / (len(y) - 1)) * y**2),
    "cigar": lambda y: y[0] ** 2 + 1e6 * np.sum(y[1:] ** 2),
    "rosenbrock": rosenbrock,
    "rastrigin": lambda y: np.sum(y**2 + 10 - 10 * np.cos(2 * np.pi * y)),
}


class Reached(Exception):
    """Raised at the target, with the number of evaluations."""


def problem(name, n, seed):
    """Returns the objective, which raises Reached at the target, and the start."""
    rng = np.random.default_rng([seed, n])
    rotation, _ = np.linalg.qr(rng.normal(size=(n, n)))
    minimum, start = rng.uniform(-2, 2, n), rng.uniform(-4, 4, n)
    counter = itertools.count(1)

    def value(x):
        evaluation = next(counter)
        found = float(FUNCTIONS[name](rotation @ (np.asarray(x) - minimum)))
        if found < TARGET:
            raise Reached(evaluation)
        return found

    return value, start


def run_ours(name, n, seed):
    """Runs `cma-es` until Reached or the limit."""
    value, start = problem(name, n, seed)
    keys = [f"x{i}" for i in range(n)]
    parameters = [{"name": key, "low": -5, "high": 5} for key in keys]
    first = {"parameters": parameters, "optimizer": "cma-es", "seed": seed, "direction": "minimize"}
    initial = {"values": dict(zip(keys, start)), "value": problem(name, n, seed)[0](start)}
    command = [PROGRAM, "ask-tell"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as program:

        def send(line, has_reply=True):
            program.stdin.write(json.dumps(line) + "\n")
            program.stdin.flush()
            return json.loads(program.stdout.readline()) if has_reply else None

        send(first, has_reply=False)
        # The optimizer starts at the given point; its initial step size is 0.3 of the range: 3.
        send({"tell": [initial]})
        for _ in range(LIMIT):
            point = send({"ask": 1})["asked"][0]
            send({"tell": [{"id": point["id"], "value": value(list(point["values"].values()))}]})


def run_pycma(name, n, seed):
    """Runs pycma until Reached or the limit."""
    value, start = problem(name, n, seed)
    # pycma adds 1 to its seed at each restart.
    first = 1 + 1000 * seed
    rng, starts = np.random.default_rng(first), iter([start])
    options = {"verbose": -9, "seed": first, "bounds": [-5, 5], "maxfevals": LIMIT}
    cma.fmin2(value, lambda: next(starts, rng.uniform(-5, 5, n)), STEP, options, restarts=9, bipop=True)


def evaluations(run, name, n, seeds):
    """Returns the number of evaluations of each seed that reached the target."""
    found = []
    for seed in range(seeds):
        try:
            run(name, n, seed)
        except Reached as reached:
            found.append(reached.args[0])
    return found


def interval(a, b):
    """Returns the 95 % interval of the ratio of means, by 1000 bootstrap samples."""
    rng = random.Random(0)
    mean = lambda runs: statistics.fmean(rng.choices(runs, k=len(runs)))
    ratios = sorted(mean(a) / mean(b) for _ in range(1000))
    return ratios[25], ratios[974]


def main(seeds, names):
    print("| function | ours: mean (median) | pycma: mean (median) | ratio of means |")
    print("| --- | --- | --- | --- |")
    for name, n in itertools.product(names or FUNCTIONS, (3, 6)):
        a, b = (evaluations(run, name, n, seeds) for run in (run_ours, run_pycma))
        text = [f"{statistics.fmean(r):.0f} ({statistics.median(r):.0f}), {len(r)}/{seeds}" for r in (a, b)]
        low, high = interval(a, b)
        ratio = statistics.fmean(a) / statistics.fmean(b)
        print(f"| {name} {n}-D | {' | '.join(text)} | {ratio:.2f} ({low:.2f} to {high:.2f}) |", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[2]), sys.argv[3:])
