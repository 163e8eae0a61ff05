#!/usr/bin/env python3
"""Measures the peers on the functions of examples/optimizer_suite.rs.

    python3 -m venv venv && venv/bin/pip install cma==4.5.0 optuna==5.0.0
    venv/bin/python scripts/peers.py cma [seeds]      # pycma, BIPOP, to 1e-8
    venv/bin/python scripts/peers.py optuna [seeds]   # TPE; GPSampler too if torch is installed

Prints the same Markdown table as the example.
"""
import sys
import warnings

warnings.filterwarnings("ignore")
import numpy as np

CMA_LIMIT = 1_000_000


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


def row(name, runs):
    done = [r for r in runs if r is not None]
    ordered = sorted(float("inf") if r is None else r for r in runs)

    def quantile(q):
        value = ordered[min(len(ordered) * q // 4, len(ordered) - 1)]
        return "-" if value == float("inf") else str(value)

    mean = sum(done) / max(len(done), 1)
    cells = " | ".join(quantile(q) for q in (1, 2, 3, 4))
    print(f"| {name} | {len(done)}/{len(runs)} | {mean:.0f} | {cells} |", flush=True)


def header(title):
    print(f"\n{title}\n")
    print("| function | reached | mean | lower quartile | median | upper quartile | worst |")
    print("| --- | --- | --- | --- | --- | --- | --- |", flush=True)


class Reached(Exception):
    pass


def cma_evaluations(f, n, seed):
    import cma

    count = 0

    def counted(x):
        nonlocal count
        count += 1
        value = f(x)
        if value < 1e-8:
            raise Reached
        return value

    np.random.seed(seed + 1)
    start = lambda: np.random.uniform(-4, 4, n)
    options = {"verbose": -9, "seed": seed + 1, "maxfevals": CMA_LIMIT}
    try:
        cma.fmin2(counted, start, 2, options, restarts=9, bipop=True)
    except Reached:
        return count
    return None


def run_cma(seeds):
    import cma

    header(f"pycma {cma.__version__}, BIPOP, evaluations to 1e-8, start uniform in [-4, 4], sigma 2")
    for f, name in ((sphere, "sphere"), (rosenbrock, "Rosenbrock"),
                    (ellipsoid, "ellipsoid"), (rastrigin, "Rastrigin")):
        for n in (2, 5):
            row(f"{name} {n}-D", [cma_evaluations(f, n, s) for s in range(seeds)])


def optuna_evaluations(sampler, f, n, target, limit):
    import optuna

    study = optuna.create_study(sampler=sampler)
    for evaluation in range(1, limit + 1):
        trial = study.ask()
        u = [trial.suggest_int(f"x{i}", 0, 1000) / 1000 for i in range(n)]
        value = f(u)
        if value < target:
            return evaluation
        study.tell(trial, value)
    return None


def run_optuna(seeds):
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    samplers = {"TPE": lambda s: optuna.samplers.TPESampler(seed=s)}
    try:
        import torch  # noqa: F401  (GPSampler needs it)
        import scipy  # noqa: F401
        samplers["GPSampler"] = lambda s: optuna.samplers.GPSampler(seed=s)
    except ImportError:
        print("GPSampler left out: torch or scipy is not installed", file=sys.stderr)
    header(f"Optuna {optuna.__version__}, 1001 levels per axis, "
           "evaluations to 1 % of the range (limit 200, Hartmann-6 60)")
    for name, f, n, target, limit in (("Branin", branin, 2, 0.397887 + 3.0773, 200),
                               ("Branin to 0.004", branin, 2, 0.397887 + 0.00397887, 200),
                               ("Hartmann-6", hartmann6, 6, -3.32237 + 0.0332237, 60)):
        for sampler, make in samplers.items():
            row(f"{name}, {sampler}",
                [optuna_evaluations(make(s), f, n, target, limit) for s in range(seeds)])


if __name__ == "__main__":
    part = sys.argv[1] if len(sys.argv) > 1 else "cma"
    number = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    {"cma": run_cma, "optuna": run_optuna}[part](number)
