"""Studies: the journal is that of the command line, whoever measures."""

from __future__ import annotations

import os
import random
import re
import subprocess
import sys
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import pytest

import finger_opt as fo
from finger_opt import _native

BUDGET = 22


def journal(folder) -> str:
    """A journal without what differs between two runs."""
    text = (Path(folder) / "journal.jsonl").read_text()
    return "".join(re.sub(r',"datetime_start".*', "", line) + "\n" for line in text.splitlines())


@pytest.fixture
def create(tmp_path, fake):
    def make(name, **settings):
        settings = {"budget": BUDGET, "seed": 4, "batch": 4, "no_cache": True, **fake, **settings}
        return fo.Study.create("rj45", out=tmp_path / name, **settings)

    return make


@pytest.fixture
def expected(create, command, tmp_path, fake):
    """The journal of the command line."""
    code, _, errors = command(
        "--task", "rj45", "--budget", str(BUDGET), "--seed", "4", "--engine", "fake", "--quiet",
        "--batch", "4", "--no-cache", "--out", str(tmp_path / "expected"),
    )
    assert code == 0, errors
    return journal(tmp_path / "expected")


def test_without_a_budget_it_settles_whoever_measures(create):
    here = create("here", budget=None)
    assert not here.settled
    here.run(progress=False)
    assert here.settled and 28 <= len(here) < 500
    with ThreadPoolExecutor(3) as threads:
        there = create("there", budget=None).run(threads, progress=False)
    assert there.settled and journal(there.path) == journal(here.path) and there.best == here.best
    answer = here.answer
    assert answer.finger and answer.headline and answer.trust.level == "published"
    assert here.best.evaluation in answer.as_good.evaluations
    # It is settled, so nothing more is measured; with a budget it goes on.
    assert len(there.run(progress=False)) == len(here)
    more = create("there", budget=len(here) + 4).run(progress=False)
    assert not more.settled and len(more) == len(here) + 4


class Shuffled(Executor):
    """Does its work in another order, some of it twice, and loses some."""

    def __init__(self, seed, lose=0.0):
        self.random = random.Random(seed)
        self.pool = ThreadPoolExecutor(3)
        self.lose = lose
        self._max_workers = 3

    def submit(self, fn, /, *args):
        return self.pool.submit(self.work, fn, *args)

    def work(self, fn, *args):
        import time

        time.sleep(self.random.random() * 0.01)
        if self.random.random() < self.lose:
            raise ConnectionError("the worker has gone")
        first = fn(*args)
        assert without_times(fn(*args)) == without_times(first), "pure: safe to run twice"
        return first


def without_times(result: bytes) -> bytes:
    return re.sub(rb',"datetime_start".*', b"", result)


def test_every_executor_gives_the_journal_of_one_machine(create, expected):
    create("none").run(progress=False)
    with ProcessPoolExecutor(2) as processes:
        create("processes").run(processes, progress=False)
    create("shuffled").run(Shuffled(1), progress=False)
    create("lossy").run(Shuffled(2, lose=0.3), progress=False)
    for name in ("none", "processes", "shuffled", "lossy"):
        assert journal(create(name).path) == expected, name


def test_a_study_as_python_sees_it(create, tmp_path):
    study = create("seen")
    assert "not started" in study._repr_html_()
    assert study.config["seed"] == 4, "written at once"
    with pytest.raises(fo.InputError, match="another configuration"):
        create("seen", seed=5)
    assert (study.best, study.answer, len(study)) == (None, None, 0)
    with pytest.raises(ValueError, match="no design is recommended yet"):
        study.best_params
    told = []
    assert study.run(progress=False, callbacks=[lambda same, done: told.append((same is study, done))]) is study
    assert told[-1] == (True, BUDGET) and told == sorted(told)
    assert study.best_params == study.best.values
    assert study.best_value == study.to_dataframe()["range_mm"][study.best.evaluation]
    assert len(repr(study.answer)) < 2000
    frame = study.to_dataframe()
    assert len(frame) == len(study) == BUDGET
    assert frame["range_mm"].max() == study.best.range_mm
    row = frame.loc[study.best.evaluation]
    assert row["infill_density_percent"] == study.best.values["infill_density_percent"]
    assert "rj45 with gp" in study._repr_html_()
    assert (study.config["batch"], study.config["seed"]) == (4, 4)
    for file in ("report.html", "evaluations.csv", "study.toml"):
        assert (tmp_path / "seen" / file).exists()
    # A home path has no place in what others may see.
    assert str(tmp_path) not in (tmp_path / "seen" / "journal.jsonl").read_text()


def test_a_study_goes_on_and_a_loaded_one_too(create, expected, tmp_path):
    create("raised", budget=9).run(progress=False)
    create("raised").run(Shuffled(3), progress=False)
    assert journal(tmp_path / "raised") == expected
    loaded = fo.load_study(tmp_path / "raised")
    assert len(loaded.run(progress=False)) == BUDGET
    with pytest.raises(fo.InputError, match="not a study"):
        fo.load_study(tmp_path / "nothing")
    with pytest.raises(fo.InputError, match="seed: the study has 4"):
        create("raised", seed=5)


def test_the_batch_is_the_number_of_workers_and_is_kept(create, tmp_path):
    study = create("workers", batch=None, budget=5)
    assert study.config["batch"] == 4, "until it is run"
    study.run(Shuffled(1), progress=False)
    assert study.config["batch"] == 3
    create("workers", batch=None).run(progress=False)
    assert fo.load_study(study.path).config["batch"] == 3
    alone = create("alone", batch=None, budget=3).run(progress=False)
    assert alone.config["batch"] == 4


class Nobody(Executor):
    """Is not to be asked for anything."""

    def submit(self, fn, /, *args):
        raise AssertionError("work was given out")


def test_what_the_cache_knows_is_not_given_out(create, expected, tmp_path):
    kept = {"no_cache": False, "cache": tmp_path / "cache"}
    first = create("first", **kept).run(Shuffled(1), progress=False)
    second = create("second", **kept).run(Nobody(), progress=False)
    assert journal(first.path) == journal(second.path) == expected
    assert '"cached":[true]' in (tmp_path / "second" / "journal.jsonl").read_text()
    with pytest.raises(fo.StudyError, match="work was given out"):
        create("anew").run(Nobody(), progress=False)


def test_words_are_checked_before_anything_is_written(create, tmp_path):
    with pytest.raises(fo.InputError, match="optimizer: unknown value `bayes`; available: gp, cma-es"):
        create("wrong", optimizer="bayes")
    with pytest.raises(fo.InputError, match="async_: cma-es"):
        create("wrong", optimizer="cma-es", async_=True)
    with pytest.raises(TypeError, match="unexpected keyword argument 'executor'"):
        create("wrong", executor="slurm")
    with pytest.raises(TypeError, match="unexpected keyword argument 'budget'"):
        fo.load_study(tmp_path, budget=4)
    assert not (tmp_path / "wrong").exists()


def test_several_tasks_objectives_and_a_task_of_ones_own(tmp_path, fake):
    mine = fo.Task.from_toml("usb")
    mine.name = "mine"
    study = fo.Study.create([mine, "rj45"], budget=8, out=tmp_path / "front", no_cache=True,
                            objective=["range", "peak-force"], constraint=["success-rate>=0.1"],
                            **fake)
    study.run(Shuffled(1), progress=False)
    assert study.config["tasks"] == ["mine", "rj45"]
    assert study.best is not None


def jobs(study):
    """A study that is open, and its first batch."""
    open_study = study._open(None)
    work, _ = open_study.next()
    return open_study, work


def test_results_that_come_twice_count_once(create, expected):
    study = create("twice")
    open_study, work = jobs(study)
    while work:
        for proposal, job in reversed(work):
            result = fo.perform(job)
            assert open_study.take(proposal, result)
            assert not open_study.take(proposal, result)
        work, _ = open_study.next()
    open_study.close()
    assert journal(study.path) == expected


def resealed(result: bytes, change) -> bytes:
    """The result with its contents changed and a check that fits again."""
    import hashlib
    import json

    content, rest = result.decode().rsplit(',"check":"', 1)
    fields = change(json.loads(content + "}"))
    content = json.dumps(fields, separators=(",", ":"), ensure_ascii=False)[:-1]
    check = hashlib.sha256(content.encode()).hexdigest()[:16]
    return f'{content},"check":"{check}{rest[16:]}'.encode()


def changed(**new):
    def change(fields):
        for path, value in new.items():
            *way, last = path.split("__")
            at = fields
            for key in way:
                at = at[int(key) if key.isdigit() else key]
            at[last] = value
        return fields

    return change


POISON = {
    "another work": (changed(work_sha256="0" * 64), "belongs to other work"),
    "a field more": (changed(home="/home/me"), "unknown field"),
}


@pytest.mark.parametrize("kind", POISON)
def test_damaged_results_are_refused_and_change_nothing(create, kind):
    change, word = POISON[kind]
    study = create("poisoned")
    open_study, work = jobs(study)
    proposal, job = work[0]
    good = fo.perform(job)
    assert resealed(good, lambda fields: fields) == good
    with pytest.raises(_native.Refused, match=word):
        open_study.take(proposal, resealed(good, change))
    with pytest.raises(_native.Refused, match="do not match the checksum `check`"):
        open_study.take(proposal, good.replace(b'"trials":', b'"trials":1'))
    with pytest.raises(_native.Refused):
        open_study.take(proposal, fo.perform(work[1][1]))
    assert open_study.take(proposal, good)
    open_study.close()
    assert len(study) == 1


class Poisoner(Shuffled):
    def work(self, fn, *args):
        return super().work(fn, *args).replace(b'"trials":', b'"trials":1')


def test_a_study_of_damaged_results_stops(create):
    study = create("poisoner")
    with pytest.raises(fo.StudyError, match="(?s)Refused.*continue with: optimize resume"):
        study.run(Poisoner(1), progress=False, retries=2)
    assert len(study) == 0


class Silent(Shuffled):
    """Its first results are no bytes."""

    def __init__(self, seed, results):
        super().__init__(seed)
        self.results = list(results)

    def work(self, fn, *args):
        return self.results.pop() if self.results else super().work(fn, *args)


def test_results_that_are_no_bytes_are_refused_and_the_work_is_done_again(create, expected):
    create("silent").run(Silent(1, [None, "done", 7, bytearray(b"{}")]), progress=False)
    assert journal(create("silent").path) == expected
    study = create("dumb")
    with pytest.raises(fo.StudyError, match="(?s)lost 3 times.*Refused.*NoneType.*continue with: optimize resume"):
        study.run(Silent(1, [None] * 1000), progress=False, retries=2)
    assert len(study) == 0


def test_a_worker_of_other_sources_refuses_by_name(create):
    _, work = jobs(create("sources"))
    job = bytes(work[0][1])
    # Other sources of a study's course measure the same; other sources of the simulation do not.
    fo.perform(resealed_work(job, _native.source_sha256(), "f" * 64))
    simulation = re.search(r'"simulation_sha256":"([0-9a-f]{64})"', job.decode())[1]
    foreign = resealed_work(job, simulation, "f" * 64)
    with pytest.raises(fo.InputError, match=rf"(?s)worker .*:{os.getpid()} .*simulation_sha256"):
        fo.perform(foreign)
    with pytest.raises(fo.InputError, match="not a work"):
        fo.perform(b"nonsense")


def resealed_work(job: bytes, old: str, new: str) -> bytes:
    import hashlib

    content = job.decode().rsplit(',"check":"', 1)[0].replace(old, new)
    return f'{content},"check":"{hashlib.sha256(content.encode()).hexdigest()[:16]}"}}\n'.encode()


def test_an_asynchronous_study_repeats_from_its_journal(create, command):
    study = create("async", async_=True, budget=9)
    study.run(Shuffled(5), progress=False)
    # Raised twice, by others: asks and tells are repeated from the order of arrival.
    for budget, seed in ((15, 6), (BUDGET, 7)):
        create("async", async_=True, budget=budget).run(Shuffled(seed), progress=False)
    lines = (Path(study.path) / "journal.jsonl").read_text().splitlines()[2:]
    proposals = [int(re.search(r'"proposal":(\d+)', line)[1]) for line in lines]
    assert sorted(proposals) == list(range(BUDGET))
    assert proposals != sorted(proposals)
    before = journal(study.path)
    code, _, errors = command("resume", study.path, "--quiet", "--no-cache")
    assert code == 0, errors
    assert journal(study.path) == before


def test_ctrl_c_leaves_a_journal_that_goes_on(create, expected, tmp_path):
    code = (
        "import finger_opt as fo, os, signal, threading, time\n"
        # A process begun in a shell's background inherits that Ctrl-C is ignored.
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        f"journal = {str(tmp_path / 'stopped' / 'journal.jsonl')!r}\n"
        "def stop():\n"
        "    while not os.path.exists(journal) or open(journal).read().count(chr(10)) < 5:\n"
        "        time.sleep(0.01)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "threading.Thread(target=stop, daemon=True).start()\n"
        f"fo.Study.create('rj45', budget={BUDGET}, seed=4, batch=4, engine='fake', no_cache=True,\n"
        f"                out={str(tmp_path / 'stopped')!r}).run(progress=False)\n"
    )
    slow = {**os.environ, "FINGER_OPT_FAKE_DELAY_US": "10000"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=slow)
    assert "finger_opt.errors.Interrupted" in done.stderr or "KeyboardInterrupt" in done.stderr
    assert "evaluations are safe; continue with: optimize resume" in done.stderr
    fo.load_study(tmp_path / "stopped").run(progress=False)
    assert journal(tmp_path / "stopped") == expected


def test_the_command_hands_a_study_to_an_executor(command, expected, tmp_path, fake):
    words = ["--task", "rj45", "--budget", "9", "--seed", "4", "--batch", "4", "--engine", "fake",
             "--no-cache", "--quiet", "--out", str(tmp_path / "handed"), "--executor"]
    code, out, errors = command(*words, "processes:2")
    assert code == 0, errors
    assert "next          optimize next" in out
    code, out, errors = command("resume", str(tmp_path / "handed"), "--executor", "processes")
    assert code == 0, errors
    assert expected.startswith(journal(tmp_path / "handed"))
    assert command(*words, "cloud")[0] == 2
    other = {**os.environ, "FINGER_OPT_PYTHON": "/bin/false"}
    code, _, errors = command(*words, "processes", env=other)
    assert code == 1 and "pip install './python" in errors
