#!/usr/bin/env python3
"""Checks that Optuna and its dashboard read the journal of a study unmodified.

    python3 -m venv venv && venv/bin/pip install optuna==5.0.0 optuna-dashboard==0.21.0
    venv/bin/python scripts/check_optuna.py results/usb-gp-seed0

Compares the study from `optuna.load_study`, and the dashboard's responses on the loopback
interface, with the lines of the journal. Exits with an error at the first difference.
The journal is not changed.
"""
import json
import socket
import subprocess
import sys
import time
import urllib.request
from importlib.metadata import version
from pathlib import Path

import optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

PINNED = {"optuna": "5.0.0", "optuna-dashboard": "0.21.0"}
# Timeout of the dashboard, s.
DASHBOARD_S = 60
# Codes in a journal: the direction, and the states by index.
MAXIMIZE = 2
STATES = ["Running", "Complete", "Pruned", "Fail", "Waiting"]


def check_best(study, directions, trials):
    """Checks that Optuna's best trials are the Pareto front of the feasible trials."""
    feasible = [line for line in trials if line["values"] is not None
            and all(c <= 0 for c in line["system_attrs"].get("constraints", []))]
    objectives = [[v if d == MAXIMIZE else -v for v, d in zip(line["values"], directions)] for line in feasible]
    dominated = lambda a: any(all(x >= y for x, y in zip(b, a)) and b != a for b in objectives)
    front = {line["evaluation"] for line, objective in zip(feasible, objectives) if not dominated(objective)}
    assert {trial.number for trial in study.best_trials} == front


def check_library(path, create, attributes, trials):
    """Checks the study loaded by Optuna against the lines of the journal; returns the number of complete trials."""
    storage = JournalStorage(JournalFileBackend(str(path)))
    study = optuna.load_study(study_name=create["study_name"], storage=storage)
    assert [int(direction) for direction in study.directions] == create["directions"]
    assert study.user_attrs == attributes["user_attr"]
    assert len(study.trials) == len(trials), (len(study.trials), len(trials))
    for ours, theirs in zip(trials, study.trials):
        assert theirs.number == ours["evaluation"]
        assert int(theirs.state) == ours["state"]
        assert theirs.params == ours["params"]
        assert theirs.values == ours["values"], (theirs.values, ours["values"])
        assert theirs.user_attrs == ours["user_attrs"]
        assert theirs.datetime_complete >= theirs.datetime_start
        for key, value in theirs.params.items():
            assert theirs.distributions[key]._contains(value), (key, value)
        constraints = ours["system_attrs"].get("constraints", [])
        assert list(theirs.constraints.values()) == constraints, (theirs.constraints, constraints)
    check_best(study, create["directions"], trials)
    return sum(trial.state == optuna.trial.TrialState.COMPLETE for trial in study.trials)


def get(port, path):
    """Returns the JSON response of the dashboard."""
    with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=DASHBOARD_S) as response:
        return json.load(response)


def wait_for(port, server):
    """Returns the list of studies as soon as the dashboard responds."""
    end = time.monotonic() + DASHBOARD_S
    while time.monotonic() < end:
        assert server.poll() is None, "the dashboard exited"
        try:
            return get(port, "/api/studies")
        except OSError:
            time.sleep(0.2)
    raise TimeoutError(f"no response from the dashboard within {DASHBOARD_S} s")


def check_dashboard(path, create, trials):
    """Checks the trials shown by the dashboard against the lines of the journal."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [str(Path(sys.executable).with_name("optuna-dashboard")), str(path)]
    command += ["--host", "127.0.0.1", "--port", str(port)]
    server = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        studies = wait_for(port, server)["study_summaries"]
        assert [study["study_name"] for study in studies] == [create["study_name"]]
        shown = get(port, f"/api/studies/{studies[0]['study_id']}?after=0")["trials"]
    finally:
        server.terminate()
        server.wait()
    assert len(shown) == len(trials), (len(shown), len(trials))
    for ours, theirs in zip(trials, shown):
        assert theirs["number"] == ours["evaluation"]
        assert theirs["state"] == STATES[ours["state"]], theirs["state"]
        assert theirs.get("values") == ours["values"], (theirs.get("values"), ours["values"])
        params = {p["name"]: p["param_internal_value"] for p in theirs["params"]}
        assert params == ours["params"], (params, ours["params"])


def main(folder):
    for package, pinned in PINNED.items():
        assert version(package) == pinned, f"{package} {pinned} is required, not {version(package)}"
    path = Path(folder) / "journal.jsonl"
    before = path.read_bytes()
    lines = [json.loads(line) for line in before.splitlines()]
    create, attributes, trials = lines[0], lines[1], lines[2:]
    complete = check_library(path, create, attributes, trials)
    print(f"optuna reads {path}: {len(trials)} trials, {complete} complete")
    check_dashboard(path, create, trials)
    print(f"optuna-dashboard shows {path}: {len(trials)} trials")
    assert path.read_bytes() == before, "the journal was changed"


if __name__ == "__main__":
    main(*sys.argv[1:])
