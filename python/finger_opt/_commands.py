"""The commands of ``optimize`` as functions. Written by scripts/generate.py."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

from ._calibration import Advice, Calibration
from ._call import called, checked, without, wrong
from ._connector import NewTask, TaskCheck, Tuned
from ._evaluation import Evaluation
from ._export import Files
from ._identify import Cell
from ._lists import Robots, Tasks
from ._map import CaptureMap, Levers
from ._result import Found
from ._springs import Finger
from ._study import Comparison, Sensitivity, Study
from ._task import Given, sources
from ._trial import Trial
from ._words import Axes, Engine, FingerModel, Numbers, RobotName, SpaceName, Start, StrPath, TaskName

__all__ = [
    "calibrate", "capture_map", "check_task", "compare", "config", "evaluate", "export_finger", "export_mjcf",
    "finger", "identify", "levers", "load_study", "measuring_sheet", "new_task", "next_print", "robots",
    "sensitivity", "tasks", "trial", "tune_task",
]
#: Functions and summaries missing from the docstring of the package.
_FURTHER = """"""


@checked
def load_study(
    folder: StrPath,
    *,
    threads: int | None = None,
    cache: StrPath | None = None,
    no_cache: bool = False,
    no_confirm: bool = False,
    no_levers: bool = False,
    no_map: bool = False,
    accept_changed: bool = False,
    simulations: int | None = None,
    samples: int | None = None,
) -> Study:
    """Continue a study after an interruption or a crash, as ``optimize resume`` does.

    Args:
        folder: Folder of the study.
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
    return Study.resumed(folder, {
        "threads": threads, "cache": cache, "no_cache": no_cache, "no_confirm": no_confirm, "no_levers": no_levers,
        "no_map": no_map, "accept_changed": accept_changed, "simulations": simulations, "samples": samples,
    })


@checked
def evaluate(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
    walk: bool = False,
    uncertainty: StrPath | None = None,
    seed: int | None = None,
    repeat: int | None = None,
    measurements: StrPath | None = None,
) -> Evaluation:
    """Simulate the tolerance window of one finger, as ``optimize evaluate`` does.

    >>> import finger_opt as fo
    >>> fo.evaluate("usb", density=20, direction=10).range_mm
    7.2

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        density: Infill density, percent.
        direction: Infill direction, degrees.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        stiffness_compliance: Stiffness in the compliance direction, N/mm: bypasses the surrogate.
        stiffness_assembly: Stiffness in the direction of assembly, N/mm: bypasses the surrogate.
        set: A number of the task or the finger, as in spaces/codesign.toml.
        walk: Search step by step to the first failure: finds gaps narrower than 0.5 mm in three times the
            trials.
        uncertainty: Also compute success rate and robust range under these errors: typical, or the path of
            a file.
        seed: Seed of the drawn errors; the same draws as in a study with this seed.
        repeat: Repeat N times with friction varied within 10 %, start within 0.02 mm, half the step in
            every other one, and a cell's numbers drawn.
        measurements: Also print the finger's measured ranges from this file: published, or a path.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("evaluate", {
        "task": sources(task), "density": density, "direction": direction, "space": space, "robot": robot,
        "cell": cell, "stiffness_data": stiffness_data, "engine": engine, "finger_model": finger_model,
        "finger": finger, "start": start, "stiffness_compliance": stiffness_compliance,
        "stiffness_assembly": stiffness_assembly, "set": set, "walk": walk, "uncertainty": uncertainty, "seed": seed,
        "repeat": repeat, "measurements": measurements, "no_ribs": True,
    }, Evaluation)


@checked
def trial(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    offset_mm: float = 0.0,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
    repeat: int | None = None,
    record: StrPath | None = None,
    plot: StrPath | None = None,
    log: StrPath | None = None,
    probe: bool = False,
    svg: StrPath | None = None,
    every_s: float = 0.001,
    film: bool = False,
) -> Trial:
    """Simulate one insertion, as ``optimize trial`` does.

    >>> import finger_opt as fo
    >>> found = fo.trial("usb", density=20, direction=10, offset_mm=0.5)
    >>> found.outcome, found.series.force_n.shape[1]
    ('inserted', 3)

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        density: Infill density, percent.
        direction: Infill direction, degrees.
        offset_mm: Shift of the start along y, mm.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        stiffness_compliance: Stiffness in the compliance direction, N/mm: bypasses the surrogate.
        stiffness_assembly: Stiffness in the direction of assembly, N/mm: bypasses the surrogate.
        set: A number of the task or the finger, as in spaces/codesign.toml.
        repeat: Repeat N times with friction varied within 10 %, start within 0.02 mm, half the step in
            every other one, and a cell's numbers drawn.
        record: Record the trial: a page that plays it.
        plot: Draw force against depth.
        log: Write force and pose at 500 Hz, as a robot logs them, from the start of the search.
        probe: Slide the part on a flat plate instead of inserting it: 8 mm along y and back at 5 N, for
            `identify`.
        svg: Draw plug, fingertips and socket at the end of each phase.
        every_s: Simulated time between two samples of the time series in the JSON, s.
        film: Include the page that plays the trial in the result.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    if probe:
        if log is None:
            raise wrong("probe", "needs log, the file to write")
        without("probe", "a probe is not an insertion", repeat=repeat, svg=svg, record=record, plot=plot, film=film)
    return called("trial", {
        "task": sources(task), "density": density, "direction": direction, "offset_mm": offset_mm, "space": space,
        "robot": robot, "cell": cell, "stiffness_data": stiffness_data, "engine": engine,
        "finger_model": finger_model, "finger": finger, "start": start, "stiffness_compliance": stiffness_compliance,
        "stiffness_assembly": stiffness_assembly, "set": set, "repeat": repeat, "record": record, "plot": plot,
        "log": log, "probe": probe, "svg": svg, "every_s": every_s, "film": film,
    }, Trial)


@checked
def capture_map(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
    axes: Axes = "y,x",
    svg: StrPath | None = None,
) -> CaptureMap:
    """Trace the capture map of one finger, as ``optimize map`` does.

    The tolerance window is its section along y without a second error. At most 300 trials are simulated;
    points between two equal outcomes are filled in.

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        density: Infill density, percent.
        direction: Infill direction, degrees.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        stiffness_compliance: Stiffness in the compliance direction, N/mm: bypasses the surrogate.
        stiffness_assembly: Stiffness in the direction of assembly, N/mm: bypasses the surrogate.
        set: A number of the task or the finger, as in spaces/codesign.toml.
        axes: The two errors of the start, mm or degrees.
        svg: Draw the map.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("map", {
        "task": sources(task), "density": density, "direction": direction, "space": space, "robot": robot,
        "cell": cell, "stiffness_data": stiffness_data, "engine": engine, "finger_model": finger_model,
        "finger": finger, "start": start, "stiffness_compliance": stiffness_compliance,
        "stiffness_assembly": stiffness_assembly, "set": set, "axes": axes, "svg": svg,
    }, CaptureMap)


@checked
def finger(
    density: float,
    direction: float,
    *,
    finger: StrPath = "finray9",
    phase_mm: float | None = None,
    set: Numbers | None = None,
    svg: StrPath | None = None,
) -> Finger:
    """Compute the stiffness of a printed finger from its ribs, as ``optimize finger`` does.

    Plane stress on the exact profile, with the modulus of the finger file and without measured corrections:
    stiffness at the middle of the pad. Trials and studies use it with finger_model computed.

    >>> import finger_opt as fo
    >>> 4 < fo.finger(20, 20).mass_g < 6
    True

    Args:
        density: Infill density, percent.
        direction: Infill direction, degrees.
        finger: finray9, or the path of a finger file.
        phase_mm: Position of the first rib, mm [default: that of the finger file].
        set: A number of the finger file, for example finger.skin.thickness_mm=0.8.
        svg: Draw the finger at rest and under the force of a grasp on its pad.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("finger", {
        "density": density, "direction": direction, "finger": finger, "phase_mm": phase_mm, "set": set, "svg": svg,
    }, Finger)


@checked
def compare(
    studies: Iterable[StrPath],
    *,
    svg: StrPath | None = None,
) -> Comparison:
    """Compare optimizers over studies of the same task and objective, as ``optimize compare`` does.

    Args:
        studies: Folders of the studies; several seeds of an optimizer give median and quartiles.
        svg: Draw the best value so far of each optimizer.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("compare", {"dirs": studies, "svg": svg}, Comparison)


@checked
def sensitivity(
    task: Given,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    uncertainty: StrPath = "typical",
    samples: int = 64,
    seed: int = 0,
    svg: StrPath | None = None,
) -> Sensitivity:
    """Rank the inputs by their share of the variance: design, task, cell, as ``optimize sensitivity`` does.

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        uncertainty: Errors of the cell to vary as well: typical, none, or the path of a file.
        samples: Rows of the sample; the number of evaluations is this times (inputs + 2).
        seed: Seed of the sample.
        svg: Write a chart of the shares.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("sensitivity", {
        "task": sources(task), "space": space, "robot": robot, "cell": cell, "stiffness_data": stiffness_data,
        "engine": engine, "finger_model": finger_model, "finger": finger, "start": start, "uncertainty": uncertainty,
        "samples": samples, "seed": seed, "svg": svg,
    }, Sensitivity)


@checked
def levers(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
    svg: StrPath | None = None,
) -> Levers:
    """Compare the infill with other ways to widen the window: tilt, strokes, grip, friction, robot, as ``optimize levers`` does.

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        density: Infill density, percent.
        direction: Infill direction, degrees.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        stiffness_compliance: Stiffness in the compliance direction, N/mm: bypasses the surrogate.
        stiffness_assembly: Stiffness in the direction of assembly, N/mm: bypasses the surrogate.
        set: A number of the task or the finger, as in spaces/codesign.toml.
        svg: Draw the ranges at both ends of each lever.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("levers", {
        "task": sources(task), "density": density, "direction": direction, "space": space, "robot": robot,
        "cell": cell, "stiffness_data": stiffness_data, "engine": engine, "finger_model": finger_model,
        "finger": finger, "start": start, "stiffness_compliance": stiffness_compliance,
        "stiffness_assembly": stiffness_assembly, "set": set, "svg": svg,
    }, Levers)


@checked
def calibrate(
    measurements: StrPath = "bench.csv",
    task: Given | Iterable[Given] | None | None = None,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    priors: StrPath = "bench",
    simulations: int | None = None,
    samples: int | None = None,
    seed: int = 0,
    cache: StrPath | None = None,
    no_cache: bool = False,
    out: StrPath | None = None,
) -> Calibration:
    """Predict the range of every finger on the bench: from simulations and a few measurements, as ``optimize calibrate`` does.

    Simulates the task with drawn values of the parameters that were not measured (friction, preload, robot,
    finger), compares with the measurements, models the discrepancy as a Gaussian process over the
    stiffness, and reports the accuracy: each measured finger is predicted without its measurement.

    Args:
        measurements: Bench measurements: published, or the path of a file.
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file; several separated by
            commas [default: that of the measurements, if they are of one].
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        priors: Priors of the parameters that were not measured: bench, or the path of a file.
        simulations: Simulations per task for the emulator of a bench prediction; one in eight measures its
            error [default: 200, or as in the study].
        samples: Samples of the posterior of a bench prediction [default: 300, or as in the study].
        seed: Seed; the same seed gives the same answer.
        cache: Folder of simulations shared with studies; safe to delete [default: results/.cache].
        no_cache: Simulate again and store nothing.
        out: Folder for the tables.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("calibrate", {
        "measurements": measurements, "task": sources(task), "space": space, "robot": robot, "cell": cell,
        "stiffness_data": stiffness_data, "engine": engine, "finger_model": finger_model, "finger": finger,
        "start": start, "priors": priors, "simulations": simulations, "samples": samples, "seed": seed,
        "cache": cache, "no_cache": no_cache, "out": out,
    }, Calibration)


@checked
def identify(
    task: Given,
    runs: StrPath,
    out: StrPath | None = None,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    frame: StrPath | None = None,
    report: StrPath | None = None,
    priors: StrPath = "bench",
    seed: int = 0,
) -> Cell:
    """Identify the parameters of a cell from the robot's logs: friction, stiffness, preload, pads, edges, as ``optimize identify`` does.

    The attempts are simulated along their commanded paths. Some parameters follow from force and pose by
    formulas, others are fitted to the curves; parameters that the logs do not determine are listed and
    unchanged.

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        runs: Table of the logs: log, infill_density_percent, infill_direction_deg, offset_mm, outcome.
        out: Write the cell, for cell, priors and uncertainty.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        frame: Task's frame in the robot's base: origin_mm, axis_angle_rad (as a pendant shows them),
            force_sign = 1 or -1, tool_mass_kg; optional: upright_axis_angle_rad of the TCP,
            gravity_compensated = false.
        report: Write a page with the curves, measured and simulated, and the table of numbers.
        priors: Priors of the parameters: bench, or the path of a file.
        seed: Seed of the fit.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("identify", {
        "task": sources(task), "runs": runs, "out": out, "space": space, "robot": robot, "cell": cell,
        "stiffness_data": stiffness_data, "engine": engine, "finger_model": finger_model, "finger": finger,
        "start": start, "frame": frame, "report": report, "priors": priors, "seed": seed,
    }, Cell)


@checked
def next_print(
    measurements: StrPath = "bench.csv",
    task: Given | Iterable[Given] | None | None = None,
    *,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    count: int = 1,
    among: Literal["space", "published"] = "space",
    print_cost_mm: float = 0.1,
    priors: StrPath = "bench",
    simulations: int | None = None,
    samples: int | None = None,
    seed: int = 0,
    cache: StrPath | None = None,
    no_cache: bool = False,
) -> Advice:
    """Recommend the finger to print next, or to stop printing, as ``optimize next`` does.

    It is the finger whose measurement is expected to improve the final choice most, by simulation and
    measurements: because it may be the best, or because it decides between others. In a space that varies
    the task as well (codesign) it is a finger with a strategy; another strategy for a printed finger needs
    no new print. The file of measurements may be empty; bench.csv and that of finger-opt.toml may be
    missing.

    Args:
        measurements: Bench measurements: published, or the path of a file.
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file [default: that of the
            measurements, if they are of one].
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        engine: Contact engine.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        count: Number of fingers to print at a time.
        among: Fingers that may be printed.
        print_cost_mm: Smallest expected gain of the chosen finger's range that is worth a print and its
            measurement, mm.
        priors: Priors of the parameters that were not measured: bench, or the path of a file.
        simulations: Simulations per task for the emulator of a bench prediction; one in eight measures its
            error [default: 200, or as in the study].
        samples: Samples of the posterior of a bench prediction [default: 300, or as in the study].
        seed: Seed; the same seed gives the same answer.
        cache: Folder of simulations shared with studies; safe to delete [default: results/.cache].
        no_cache: Simulate again and store nothing.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("next", {
        "measurements": measurements, "task": sources(task), "space": space, "robot": robot, "cell": cell,
        "stiffness_data": stiffness_data, "engine": engine, "finger_model": finger_model, "finger": finger,
        "start": start, "count": count, "among": among, "print_cost_mm": print_cost_mm, "priors": priors,
        "simulations": simulations, "samples": samples, "seed": seed, "cache": cache, "no_cache": no_cache,
    }, Advice)


@checked
def measuring_sheet(
    task: TaskName | StrPath,
    fingers: Sequence[tuple[float, float]],
    out: StrPath,
) -> None:
    """Write a printable sheet for measuring windows by hand, as ``optimize measure sheet`` does.

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        fingers: Infill density, percent, and direction, degrees, of a finger.
        out: File to write.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    called("measure sheet", {"task": task, "finger": fingers, "out": out}, Found)


@checked
def export_mjcf(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    *,
    out: StrPath,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
) -> Path:
    """Export the scene of a trial as MJCF, the model format of MuJoCo and its viewer, as ``optimize export mjcf`` does.

    The part stands at its pick-up place and the jaws are open. In the viewer the sliders move the robot's
    command and close the jaws. MuJoCo is not needed for the export.

    Args:
        task: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        density: Infill density, percent.
        direction: Infill direction, degrees.
        out: File to write.
        space: Search space: infill, codesign, finger, or the path of a space file.
        robot: see `optimize robots`, or the path of a robot file [default: servo].
        cell: Your own cell: robot, friction and more, as `optimize identify` writes it.
        stiffness_data: Your own stiffness measurements in place of the shipped ones.
        finger_model: Source of a finger's remote centre and unmeasured stiffnesses [default: paper;
            computed for a space with parameters of the printed finger].
        finger: Finger file for finger_model computed: finray9, or the path of a file.
        start: How the nominal start is chosen [default: as in the task file].
        stiffness_compliance: Stiffness in the compliance direction, N/mm: bypasses the surrogate.
        stiffness_assembly: Stiffness in the direction of assembly, N/mm: bypasses the surrogate.
        set: A number of the task or the finger, as in spaces/codesign.toml.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("export mjcf", {
        "task": sources(task), "density": density, "direction": direction, "out": out, "space": space, "robot": robot,
        "cell": cell, "stiffness_data": stiffness_data, "finger_model": finger_model, "finger": finger,
        "start": start, "stiffness_compliance": stiffness_compliance, "stiffness_assembly": stiffness_assembly,
        "set": set,
    }, Files).paths[0]


@checked
def export_finger(
    study: StrPath | None = None,
    *,
    out: StrPath,
    density: float | None = None,
    direction: float | None = None,
    finger: StrPath | None = None,
    phase_mm: float | None = None,
    format: Literal["stl", "3mf", "dxf", "sheet", "prusaslicer-3mf", "orcaslicer-3mf"] | None = None,
) -> tuple[Path, ...]:
    """Export a finger for the printer: the best of a study, or one with a given infill, as ``optimize export finger`` does.

    The two fingers of a gripper are identical. STL, 3MF and DXF contain every rib; in the projects for
    slicers, the slicer fills the outline with its own ribs.

    Args:
        study: Folder of a study: its recommended design.
        out: File to write.
        density: Infill density, percent.
        direction: Infill direction, degrees.
        finger: finray9, or the path of a finger file [default: the study's, or finray9].
        phase_mm: Position of the first rib, mm [default: as in the finger file].
        format: File format [default: by the extension of FILE].

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    if study is not None:
        without("study", "its best design is exported", density=density, direction=direction)
    return called("export finger", {
        "dir": study, "out": out, "density": density, "direction": direction, "finger": finger, "phase_mm": phase_mm,
        "format": format,
    }, Files).paths


@checked
def config() -> Found:
    """Print the settings of finger-opt.toml in this folder or above, as ``optimize config`` does.

    The file sets task, robot, cell, measurements, space and threads for all commands in its folder and
    below. Options take precedence over it; no_config ignores it. Seed and budget belong to one study and
    cannot be set there.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("config", {}, Found)


@checked
def robots() -> Robots:
    """List the shipped robots with the cells that they represent, and an example of a robot file, as ``optimize robots`` does.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("robots", {}, Robots)


@checked
def tasks() -> Tasks:
    """List tasks, spaces and uncertainties, as ``optimize tasks`` does.

    >>> import finger_opt as fo
    >>> [task.name for task in fo.tasks().tasks]
    ['ket8', 'ket12', 'rj45', 'usb', 'rj45_latch', 'usb_a']

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("tasks", {}, Tasks)


@checked
def new_task(
    name: str,
    *,
    plug: tuple[float, float, float] | None = None,
    round: tuple[float, float] | None = None,
    pins: tuple[int, int] | None = None,
    pitch_mm: float | None = None,
    pin_mm: float | None = None,
    pin_length_mm: float | None = None,
    clearance: float | None = None,
    key: tuple[float, float] | None = None,
    chamfer_mm: float | None = None,
    body: tuple[float, float, float] | None = None,
    like: StrPath | None = None,
    out: StrPath | None = None,
    robot: RobotName | StrPath = "servo",
    engine: Engine = "direct",
) -> NewTask:
    """Create a commented task file from a few dimensions, or from another task, as ``optimize task new`` does.

    With plug, round or pins, start, tilt, strokes and success depth are derived from the geometry; with
    like as well, friction and grasp force are those of that task. With like alone the file is a copy of
    that task.

    Args:
        name: Name of the task: letters, digits, - and _.
        plug: width (y, between the jaws) x height (x) x length, mm.
        round: Cylindrical plug: diameter x length, mm.
        pins: Plug of square pins: rows (y, between the jaws) x columns (x); each has its own hole.
        pitch_mm: Distance from pin to pin, mm [default: 2.54].
        pin_mm: Side of a pin, mm [default: 0.64].
        pin_length_mm: Length of a pin, mm [default: 6].
        clearance: Clearance, mm: opening minus plug in x and y, both sides together.
        key: Key of a cylindrical plug, on its side across the jaws (+x): width x height beyond the
            cylinder, mm.
        chamfer_mm: Chamfer of 45 degrees at the opening of a plug with flat sides, mm.
        body: Body that the fingers hold, above the plug: width x height x length, mm [default: the plug
            itself; for pins their block, 20 mm long].
        like: Task to start from: ket8, ket12, rj45, usb, rj45_latch, usb_a, or the path of a task file.
        out: File to write [default: NAME.toml].
        robot: see `optimize robots`, or the path of a robot file.
        engine: Contact engine.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    if plug is not None:
        without("plug", "give only one of them", round=round)
    if plug is None and round is None and pins is None:
        without("no plug", "clearance and body require plug, round or pins", clearance=clearance, body=body)
    return called("task new", {
        "name": name, "plug": plug, "round": round, "pins": pins, "pitch_mm": pitch_mm, "pin_mm": pin_mm,
        "pin_length_mm": pin_length_mm, "clearance": clearance, "key": key, "chamfer_mm": chamfer_mm, "body": body,
        "like": like, "out": out, "robot": robot, "engine": engine,
    }, NewTask)


@checked
def check_task(
    task: Given,
    *,
    svg: StrPath | None = None,
    robot: RobotName | StrPath = "servo",
    engine: Engine = "direct",
) -> TaskCheck:
    """Check a task file, draw it and simulate its nominal start, as ``optimize task check`` does.

    Exit code 0 if there is no problem and the plug inserts, 2 otherwise.

    >>> import finger_opt as fo
    >>> fo.check_task("usb").inserts
    True

    Args:
        task: Task file, or the name of a shipped task.
        svg: Draw plug, socket, clearances, fingertips and search path.
        robot: see `optimize robots`, or the path of a robot file.
        engine: Contact engine.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("task check", {"file": sources(task), "svg": svg, "robot": robot, "engine": engine}, TaskCheck)


@checked
def tune_task(
    task: TaskName | StrPath,
    *,
    robot: RobotName | StrPath = "servo",
    engine: Engine = "direct",
    budget: int = 150,
    seed: int = 0,
    max_force_n: float | None = None,
    max_speed_mm_per_s: float | None = None,
    out: StrPath | None = None,
    dry_run: bool = False,
    svg: StrPath | None = None,
) -> Tuned:
    """Find a start and a strategy that insert a connector, before fingers are compared, as ``optimize task tune`` does.

    First the start is taught with a medium finger; then the strategies of the shipped tasks are tried,
    scaled to this opening; then tilt, strokes, preload and push speed are optimized for the smallest range
    of a soft, a medium and a stiff finger. Exit code 1 if nothing inserts. Ctrl-C or SIGTERM writes the
    best strategy so far.

    Args:
        task: Task file, which is rewritten; or the name of a shipped task, with out.
        robot: see `optimize robots`, or the path of a robot file.
        engine: Contact engine.
        budget: Largest number of windows to measure, at least 60; start, shipped strategies and final
            checks are not shortened.
        seed: Seed of the search.
        max_force_n: Largest peak force in the trials that insert, N [default: limits.force_n of the task,
            or the robot's stop force].
        max_speed_mm_per_s: Largest speed of a phase, mm/s [default: limits.speed_mm_per_s of the task].
        out: Write this new file instead of FILE.
        dry_run: Write no task file.
        svg: Draw the search before and after.

    Raises:
        InputError: A value or file is invalid; :class:`TaskError` if it is the task.
        StudyError: The command fails at run time or cannot write a file.
        Interrupted: Ctrl-C.
    """
    return called("task tune", {
        "file": task, "robot": robot, "engine": engine, "budget": budget, "seed": seed, "max_force_n": max_force_n,
        "max_speed_mm_per_s": max_speed_mm_per_s, "out": out, "dry_run": dry_run, "svg": svg,
    }, Tuned)
