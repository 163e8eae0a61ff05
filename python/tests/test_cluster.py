"""Dask with worker processes on this machine, and what happens when they die."""

from __future__ import annotations

import os
import random
import signal
import threading
import time
from contextlib import suppress
from pathlib import Path

import pytest

import finger_opt as fo
from test_study import journal

# Dead workers are replaced by forks of a process that has everything imported: in a tenth of a second.
os.environ.setdefault("DASK_DISTRIBUTED__WORKER__MULTIPROCESSING_METHOD", "forkserver")
distributed = pytest.importorskip("distributed", reason="the extra dask is not installed")
pytestmark = pytest.mark.dask

#: How many workers are killed.
KILLS = 50


@pytest.fixture(scope="module")
def cluster():
    import dask

    patience = {
        # A worker that dies is not the fault of what it did.
        "distributed.scheduler.allowed-failures": 1000,
        # Nor is it given up if it is dead at the moment when somebody looks.
        "distributed.deploy.lost-worker-timeout": "1h",
    }
    with dask.config.set(patience):
        with distributed.LocalCluster(
            n_workers=4, threads_per_worker=1, processes=True, dashboard_address=None,
            env={"FINGER_OPT_FAKE_DELAY_US": "10000"},
        ) as cluster:
            yield cluster


@pytest.fixture
def client(cluster):
    with distributed.Client(cluster) as client:
        yield client


def create(folder, fake, **settings):
    settings = {"budget": 16, "seed": 4, "batch": 4, "no_cache": True, "no_confirm": True,
                **fake, **settings}
    return fo.Study.create("rj45", out=folder, **settings)


def test_dask_gives_the_journal_of_one_machine(client, tmp_path, fake):
    create(tmp_path / "alone", fake).run(progress=False)
    create(tmp_path / "dask", fake).run(client.get_executor(), progress=False)
    assert journal(tmp_path / "dask") == journal(tmp_path / "alone")
    own = create(tmp_path / "batch", fake, batch=None, budget=4)
    own.run(client.get_executor(), progress=False)
    assert own.config["batch"] == 4


def test_the_command_reaches_a_scheduler(cluster, command, tmp_path, fake):
    words = ["--task", "rj45", "--budget", "8", "--seed", "4", "--engine", "fake", "--quiet",
             "--no-cache", "--no-confirm", "--out", str(tmp_path / "s"), "--executor"]
    code, out, errors = command(*words, cluster.scheduler_address.replace("tcp://", "dask://"))
    assert code == 0, errors
    assert "next          optimize next" in out
    code, _, errors = command(*words, "dask://127.0.0.1:9")
    assert code == 1 and "no scheduler answers" in errors


def busy(cluster, client) -> list[int]:
    """Process ids of the workers that are evaluating now."""
    processing = client.processing()
    nannies = list(cluster.workers.values())
    return [nanny.pid for nanny in nannies if nanny.pid and processing.get(nanny.worker_address)]


def test_fifty_killed_workers_lose_and_change_nothing(cluster, client, tmp_path, fake):
    """Workers die at random while they evaluate, until enough have died."""
    create(tmp_path / "alone", fake, budget=40).run(progress=False)
    expected = journal(tmp_path / "alone")
    chance, ended, killed = random.Random(1), threading.Event(), []

    def kill():
        # No more than that: on a busy machine none would live long enough to end anything.
        while len(killed) < KILLS and not ended.wait(0.3 * chance.random()):
            workers = [worker for worker in busy(cluster, client) if worker not in killed]
            if workers:
                worker = chance.choice(workers)
                # It may have been ended otherwise meanwhile; then it does not count.
                with suppress(ProcessLookupError):
                    os.kill(worker, signal.SIGKILL)
                    killed.append(worker)

    killer = threading.Thread(target=kill, daemon=True)
    killer.start()
    rounds = 0
    try:
        while len(killed) < KILLS:
            name = tmp_path / f"killed-{rounds}"
            create(name, fake, budget=40).run(client.get_executor(), progress=False, retries=100)
            assert journal(name) == expected
            rounds += 1
    finally:
        ended.set()
        killer.join()
    assert len(killed) >= KILLS


def test_a_killed_scheduler_stops_the_study_which_goes_on_elsewhere(tmp_path, fake):
    import subprocess
    import sys

    create(tmp_path / "alone", fake).run(progress=False)
    port = 18786
    slow = {**os.environ, "FINGER_OPT_FAKE_DELAY_US": "20000"}
    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", str(port),
            "--no-dashboard"]
    scheduler = subprocess.Popen(dask, stderr=subprocess.DEVNULL)
    worker = subprocess.Popen(
        [sys.executable, "-m", "distributed.cli.dask_worker", f"tcp://127.0.0.1:{port}",
         "--nthreads", "1", "--no-dashboard", "--no-nanny"],
        stderr=subprocess.DEVNULL, env=slow,
    )
    try:
        # Also how long it looks for a scheduler that has gone, s.
        with distributed.Client(f"tcp://127.0.0.1:{port}", timeout=20) as client:
            client.wait_for_workers(1)
            study = create(tmp_path / "stopped", fake)

            def kill():
                file = Path(study.path) / "journal.jsonl"
                while not file.exists() or file.read_text().count("\n") < 5:
                    time.sleep(0.01)
                scheduler.kill()

            threading.Thread(target=kill, daemon=True).start()
            with pytest.raises(fo.StudyError, match="continue with: optimize resume"):
                study.run(client.get_executor(), progress=False)
    finally:
        for process in (scheduler, worker):
            process.kill()
            process.wait()
    assert 0 < len(study) < 16
    fo.load_study(study.path, no_cache=True).run(progress=False)
    assert journal(study.path) == journal(tmp_path / "alone")
