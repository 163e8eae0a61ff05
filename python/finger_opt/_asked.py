"""The options of a study. Written by scripts/generate.py."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, TypeVar

from ._call import checked
from ._task import Given, sources
from ._words import Aggregate, Engine, FingerModel, Objective, OptimizerName, RobotName, SpaceName, Start, StrPath

S = TypeVar("S", bound="Asked")


class Asked:
    """Base class of requests that are made with the options of ``optimize``."""

    @classmethod
    def asked(cls: type[S], words: Mapping[str, Any]) -> S:
        """Returns the request with these options."""
        raise NotImplementedError

    @classmethod
    @checked
    def create(
        cls: type[S],
        task: Given | Iterable[Given],
        *,
        space: SpaceName | StrPath = "infill",
        robot: RobotName | StrPath | None = None,
        cell: StrPath | None = None,
        stiffness_data: StrPath | None = None,
        engine: Engine = "direct",
        finger_model: FingerModel | None = None,
        finger: StrPath = "finray9",
        start: Start | None = None,
        budget: int | None = None,
        polish: int = 0,
        indifference_mm: float = 0.3,
        optimizer: OptimizerName = "gp",
        objective: Objective | Sequence[Objective] = "range",
        constraint: str | Sequence[str] = (),
        uncertainty: StrPath | None = None,
        measurements: StrPath | None = None,
        priors: StrPath | None = None,
        aggregate: Aggregate | None = None,
        weights: Sequence[float] = (),
        seed: int = 0,
        batch: int | None = None,
        async_: bool = False,
        out: StrPath | None = None,
        threads: int | None = None,
        cache: StrPath | None = None,
        no_cache: bool = False,
        no_confirm: bool = False,
        no_levers: bool = False,
        no_map: bool = False,
        accept_changed: bool = False,
        simulations: int | None = None,
        samples: int | None = None,
    ) -> S:
        """Find the finger that tolerates the largest shift of the start, as ``optimize study`` does.

        Running the same command again continues the study. The name may be left out.

        Args:
            task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file; several separated by
                commas.
            space: Search space: infill, codesign, finger, or the path of a space file.
            robot: see `optimize robots`, or the path of a robot file [default: servo].
            cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
            stiffness_data: Your own stiffness measurements in place of the shipped ones.
            engine: Contact engine.
            finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
                computed for a space with parameters of the printed finger].
            finger: Finger file for finger_model computed: finray9, or the path of a file.
            start: How the nominal start is chosen [default: as in the task file].
            budget: Total number of evaluations; to continue, run the same command with a larger one [default:
                until no design is expected to gain 0.3 mm, at most 500; 200 for other optimizers and
                objectives].
            polish: Up to N further evaluations by Nelder-Mead from the best design; the budget of such a study
                cannot be raised.
            indifference_mm: Smallest relevant difference of ranges, mm: designs that lose less count as ties.
            optimizer: Optimizer.
            objective: Measure to optimize; two or three, separated by commas, give a Pareto front.
            constraint: Constraint, for example 'peak-force<=30' or 'success-rate>=0.9'.
            uncertainty: Errors for success-rate and robust-range: typical, or the path of a file [default:
                typical].
            measurements: Measurements from the bench: published, or the path of a file. The study then
                recommends the finger that is predicted to be the best on the bench, from simulations and
                measurements.
            priors: Priors of the parameters that were not measured, for measurements: bench, or the path of a
                file [default: bench].
            aggregate: Aggregation over several tasks [default: min].
            weights: Weights of the tasks, separated by commas, for aggregate weighted.
            seed: Seed; the same seed gives the same study.
            batch: Number of designs per batch; part of the study, unlike threads [default: unchanged if the
                study continues; otherwise 4, or with executor the number of its workers].
            async_: Propose a new design after each result, so that no worker waits for the slowest of a batch;
                the journal then depends on the order of the results.
            out: Folder of the study [default: results/<task>-<optimizer>-seed<seed>, extended by further
                settings].
            threads: Threads [default: one per processor]; changes no result.
            cache: Folder of evaluations that studies share; safe to delete [default: results/.cache].
            no_cache: Measure every design again and store nothing.
            no_confirm: Skip the confirmation of the best designs (windows measured step by step and repeated at
                their ends).
            no_levers: Skip the one-at-a-time sensitivity analysis of the recommended finger (levers).
            no_map: Skip the maps of outcomes over two errors of the start.
            accept_changed: Continue a study of another program version, engine setting or input file in a new
                segment; the best design is then taken from that segment.
            simulations: Simulations per task for the emulator of a bench prediction; one in eight measures its
                error [default: 200, or as in the study].
            samples: Samples of the posterior of a bench prediction [default: 300, or as in the study].

        Raises:
            InputError: A value or file is invalid; :class:`TaskError` if it is the task.
            StudyError: The command fails at run time or cannot write a file.
            Interrupted: Ctrl-C.
        """
        return cls.asked({
            "task": sources(task), "space": space, "robot": robot, "cell": cell, "stiffness_data": stiffness_data,
            "engine": engine, "finger_model": finger_model, "finger": finger, "start": start, "budget": budget,
            "polish": polish, "indifference_mm": indifference_mm, "optimizer": optimizer, "objective": objective,
            "constraint": constraint, "uncertainty": uncertainty, "measurements": measurements, "priors": priors,
            "aggregate": aggregate, "weights": weights, "seed": seed, "batch": batch, "async": async_, "out": out,
            "threads": threads, "cache": cache, "no_cache": no_cache, "no_confirm": no_confirm, "no_levers": no_levers,
            "no_map": no_map, "accept_changed": accept_changed, "simulations": simulations, "samples": samples,
        })
