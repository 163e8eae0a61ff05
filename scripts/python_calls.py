"""What the options of the commands do not say of their functions in Python."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Call:
    """What the options of a command do not say of its function."""

    name: str
    #: Module and class of the result.
    result: str = "_result.Found"
    #: Parameters that may be given without their names, in order.
    positional: tuple[str, ...] = ()
    #: Names of parameters by options.
    names: dict[str, str] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)
    #: Hidden options that are parameters, with their defaults.
    more: dict[str, str] = field(default_factory=dict)
    #: Options that say nothing unless they are given, though they have a default.
    unset: tuple[str, ...] = ()
    #: Hidden options that are always given.
    always: dict[str, str] = field(default_factory=dict)
    #: What the function gives, if not the result: its type, and how it is had from the result.
    gives: tuple[str, str] | None = None
    #: What it refuses that the command line would take, or names otherwise.
    refuses: str = ""
    example: str = ""


TASKS = "Given | Iterable[Given]"
INFILL = ("density", "direction")
SUBJECT = ("task", *INFILL)
CALLS = {
    "evaluate": Call(
        "evaluate", "_evaluation.Evaluation", SUBJECT, unset=("seed", "repeat_seed"), always={"no_ribs": "True"},
        example="fo.evaluate(\"usb\", density=20, direction=10).range_mm\n7.2",
    ),
    "trial": Call(
        "trial", "_trial.Trial", (*SUBJECT, "offset_mm"), unset=("repeat_seed",), more={"every_s": "0.001", "film": ""},
        refuses="""\
if probe:
    if log is None:
        raise wrong("probe", "needs log, the file to write")
    without("probe", "it is no insertion", repeat=repeat, svg=svg, record=record, plot=plot, film=film)""",
        example="found = fo.trial(\"usb\", density=20, direction=10, offset_mm=0.5)\n"
        ">>> found.outcome, found.series.force_n.shape[1]\n('inserted', 3)",
    ),
    "map": Call("capture_map", "_map.CaptureMap", SUBJECT),
    "levers": Call("levers", "_map.Levers", SUBJECT),
    "sensitivity": Call(
        "sensitivity", "_study.Sensitivity", ("task",), types={"objective": 'Literal["range", "centred-range"]'}
    ),
    "finger": Call(
        "finger", "_springs.Finger", INFILL, example="4 < fo.finger(20, 20).mass_g < 6\nTrue"
    ),
    "compare": Call("compare", "_study.Comparison", names={"dirs": "studies"}),
    "calibrate": Call("calibrate", "_calibration.Calibration", ("measurements", "task"), types={"task": TASKS}),
    "next": Call("next_print", "_calibration.Advice", ("measurements", "task"), types={"task": TASKS}),
    "identify": Call("identify", "_identify.Cell", ("task", "runs", "out")),
    "tasks": Call(
        "tasks", "_lists.Tasks", example="[task.name for task in fo.tasks().tasks]\n['ket8', 'ket12', 'rj45', 'usb']"
    ),
    "robots": Call("robots", "_lists.Robots"),
    "measure sheet": Call(
        "measuring_sheet", positional=("task", "fingers", "out"), names={"finger": "fingers"},
        types={"task": "TaskName | StrPath"}, gives=("None", ""),
    ),
    "export finger": Call(
        "export_finger", "_export.Files", names={"dir": "study"}, gives=("tuple[Path, ...]", ".paths"),
        refuses="""\
if study is not None:
    without("study", "its best design is exported", density=density, direction=direction)""",
    ),
    "export mjcf": Call("export_mjcf", "_export.Files", SUBJECT, gives=("Path", ".paths[0]")),
    "task new": Call(
        "new_task", "_connector.NewTask", types={"name": "str"},
        refuses="""\
if plug is not None:
    without("plug", "one of them goes in", round=round)
if plug is None and round is None:
    without("no plug", "they go with plug or round", clearance=clearance, body=body)""",
    ),
    "task check": Call(
        "check_task", "_connector.TaskCheck", names={"file": "task"}, types={"file": "Given"},
        example="fo.check_task(\"usb\").inserts\nTrue",
    ),
    "task tune": Call(
        "tune_task", "_connector.Tuned", names={"file": "task"}, types={"file": "TaskName | StrPath"}
    ),
    "study": Call("create", positional=("task",), types={"task": TASKS}),
    "resume": Call("load_study", "_study.Study", names={"dir": "folder"}),
}
#: Commands that are more than a call in Python, and what they are there.
BY_HAND = {
    "ask-tell": "Optimizer", "completions": "a script for a shell", "man": "help()", "measure add": "Measurements.add",
    "measure check": "Measurements.check", "report": "Study.report", "stiffness": "stiffness",
    "task import": "import_parts", "task show": "Task.from_toml",
}
