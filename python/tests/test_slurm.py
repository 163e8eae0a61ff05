"""Slurm with one node on this machine: munged, slurmctld and slurmd, without systemd or cgroups."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import tempfile
import time
from pathlib import Path

import pytest

import finger_opt as fo
from test_study import journal

pytest.importorskip("submitit", reason="the extra slurm is not installed")
pytestmark = pytest.mark.slurm

DAEMONS = ("munged", "slurmctld", "slurmd")
#: How long Slurm may take to have a node that is idle, s.
PATIENCE_S = 30

CONFIGURATION = """\
ClusterName=one
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort=16817
SlurmdPort=16818
SlurmUser=root
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
ReturnToService=2
# Four jobs at a time, whatever the machine has.
SlurmdParameters=config_overrides
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName={host} NodeAddr=127.0.0.1 CPUs=4 State=UNKNOWN
PartitionName=short Nodes=ALL Default=YES State=UP
"""


def configure(folder: Path) -> None:
    (folder / "state").mkdir()
    (folder / "spool").mkdir()
    host = socket.gethostname().split(".")[0]
    (folder / "slurm.conf").write_text(CONFIGURATION.format(host=host, folder=folder))
    # Plugins look for it, though nothing uses cgroups.
    (folder / "cgroup.conf").write_text("CgroupAutomount=no\n")
    key = folder / "munge.key"
    key.write_bytes(os.urandom(128))
    key.chmod(0o600)


def start(folder: Path) -> list[subprocess.Popen]:
    munge = [f"--{what}={folder}/munge.{end}" for what, end in [
        ("key-file", "key"), ("socket", "socket"), ("pid-file", "pid"), ("log-file", "log"),
        ("seed-file", "seed")]]
    commands = [["munged", "--foreground", "--force", *munge], ["slurmctld", "-D"], ["slurmd", "-D"]]
    running = []
    for command in commands:
        with open(folder / f"{command[0]}.out", "wb") as log:
            running.append(subprocess.Popen(command, stdout=log, stderr=log))
        time.sleep(1)
    return running


def ready(folder: Path) -> str | None:
    """Waits for an idle node; says why there is none."""
    said = ""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        done = subprocess.run(["sinfo", "-h", "-o", "%T"], capture_output=True, text=True)
        said = done.stdout + done.stderr
        if done.stdout.strip() == "idle":
            return None
        time.sleep(0.5)
    logs = [(folder / f"{name}.out").read_text(errors="replace")[-600:] for name in DAEMONS]
    return f"no node is idle after {PATIENCE_S} s: {said}\n" + "\n".join(logs)


@pytest.fixture(scope="module")
def slurm():
    missing = [name for name in (*DAEMONS, "sbatch", "srun") if shutil.which(name) is None]
    if missing:
        pytest.skip(f"{', '.join(missing)}: missing; scripts/tools.sh slurm-wlm munge")
    if os.getuid() != 0:
        pytest.skip("slurmd and munged of a test need root")
    folder = Path(tempfile.mkdtemp(prefix="slurm"))
    configure(folder)
    before = os.environ.get("SLURM_CONF")
    os.environ["SLURM_CONF"] = str(folder / "slurm.conf")
    running = start(folder)
    try:
        why_not = ready(folder)
        if why_not is not None:
            pytest.skip(f"Slurm does not start here: {why_not}")
        yield folder
    finally:
        for process in reversed(running):
            process.terminate()
            process.wait()
        shutil.rmtree(folder, ignore_errors=True)
        if before is None:
            del os.environ["SLURM_CONF"]
        else:
            os.environ["SLURM_CONF"] = before


def settings(fake):
    return {"seed": 4, "batch": 4, "no_cache": True, "no_confirm": True, **fake}


def test_slurm_gives_the_journal_of_one_machine(slurm, tmp_path, fake):
    from finger_opt.executors import SlurmExecutor

    fo.Study.create("rj45", budget=8, out=tmp_path / "alone", **settings(fake)).run(progress=False)
    executor = SlurmExecutor(folder=str(tmp_path / "jobs"), workers=4, partition="short")
    study = fo.Study.create("rj45", budget=8, out=tmp_path / "slurm", **settings(fake))
    study.run(executor, progress=False)
    executor.shutdown()
    assert journal(tmp_path / "slurm") == journal(tmp_path / "alone")


def test_the_command_hands_a_study_to_slurm(slurm, command, tmp_path, fake):
    code, out, errors = command(
        "--task", "rj45", "--budget", "2", "--engine", "fake", "--no-cache", "--no-confirm",
        "--quiet", "--out", "s", "--executor", "slurm:2", cwd=tmp_path,
    )
    assert code == 0, errors
    assert "next          optimize next" in out
    assert fo.load_study(tmp_path / "s").config["batch"] == 2


def test_a_killed_job_is_noticed_without_accounts(slurm, tmp_path, monkeypatch):
    from finger_opt import executors

    monkeypatch.setattr(executors, "ASK", 2.0)
    executor = executors.SlurmExecutor(folder=str(tmp_path / "jobs"), workers=2, partition="short")
    killed = executor.submit(time.sleep, 600)
    other = executor.submit(time.sleep, 8)
    time.sleep(2)
    job = executor._jobs[killed].job_id
    subprocess.run(["scancel", "--signal=KILL", "--full", job], check=True)
    assert f"Slurm job {job} ended without a result" in str(killed.exception(timeout=60))
    assert other.result(timeout=60) is None
    executor.shutdown()
