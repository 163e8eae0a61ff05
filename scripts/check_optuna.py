"""Checks that Optuna itself reads one of our journals as it is.

    python3 -m venv /tmp/optuna && /tmp/optuna/bin/pip install optuna==5.0.0
    /tmp/optuna/bin/python scripts/check_optuna.py results/usb-gp-seed0

Compares what Optuna loads with the lines of the journal, and exits with 1 at
the first difference.
"""

import json
import sys
from pathlib import Path

import optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

PINNED = "5.0.0"


def main(folder: str) -> None:
    assert optuna.__version__ == PINNED, f"made for optuna {PINNED}, not {optuna.__version__}"
    path = Path(folder) / "journal.jsonl"
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    create, attributes, trials = lines[0], lines[1], lines[2:]

    storage = JournalStorage(JournalFileBackend(str(path)))
    study = optuna.load_study(study_name=create["study_name"], storage=storage)
    assert study.directions == [optuna.study.StudyDirection.MAXIMIZE]
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

    values = [line["values"][0] for line in trials if line["values"]]
    if values:
        assert study.best_value == max(values)
    # A sampler of Optuna's can go on from here: it accepts the trials as history.
    completed = sum(trial.state == optuna.trial.TrialState.COMPLETE for trial in study.trials)
    best = study.best_trial if values else None
    print(f"optuna {PINNED} reads {path}: {len(trials)} trials, {completed} complete, best {best and best.value} at {best and best.params}")


if __name__ == "__main__":
    main(*sys.argv[1:])
