"""Table of the Python functions whose properties do not follow from the options of their commands."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Call:
    """Properties of a Python function that do not follow from the options of its command."""

    name: str
    #: Module and class of the result.
    result: str = "_result.Found"
    #: Positional parameters, in order.
    positional: tuple[str, ...] = ()
    #: Parameter names by option.
    names: dict[str, str] = field(default_factory=dict)
    #: Python types by option.
    types: dict[str, str] = field(default_factory=dict)
    #: Defaults of the hidden options that are parameters.
    hidden: dict[str, str] = field(default_factory=dict)
    #: Options whose default is not shown and not passed.
    unset: tuple[str, ...] = ()
    #: Values of the hidden options that are always passed.
    always: dict[str, str] = field(default_factory=dict)
    #: Type and expression of the return value, if it is not the result itself.
    returns: tuple[str, str] | None = None
    #: Python code that checks combinations of arguments.
    checks: str = ""
    #: Doctest: expression and output.
    example: str = ""


TASKS = "Given | Iterable[Given]"
INFILL = ("density", "direction")
SUBJECT = ("task", *INFILL)
CALLS = {
    "evaluate": Call(
        "evaluate", "_evaluation.Evaluation", SUBJECT, unset=("seed",), always={"no_ribs": "True"},
        example="fo.evaluate(\"usb\", density=20, direction=10).range_mm\n7.2",
    ),
    "trial": Call(
        "trial", "_trial.Trial", (*SUBJECT, "offset_mm"),
        hidden={"every_s": "0.001", "film": ""},
        checks="""\
if probe:
    if log is None:
        raise wrong("probe", "needs log, the file to write")
    without("probe", "a probe is not an insertion", repeat=repeat, svg=svg, record=record, plot=plot, film=film)""",
        example="found = fo.trial(\"usb\", density=20, direction=10, offset_mm=0.5)\n"
        ">>> found.outcome, found.series.force_n.shape[1]\n('inserted', 3)",
    ),
    "map": Call("capture_map", "_map.CaptureMap", SUBJECT),
    "levers": Call("levers", "_map.Levers", SUBJECT),
    "sensitivity": Call("sensitivity", "_study.Sensitivity", ("task",)),
    "finger": Call(
        "finger", "_springs.Finger", INFILL, example="4 < fo.finger(20, 20).mass_g < 6\nTrue"
    ),
    "compare": Call("compare", "_study.Comparison", names={"dirs": "studies"}),
    "calibrate": Call("calibrate", "_calibration.Calibration", ("measurements", "task"), types={"task": TASKS}),
    "next": Call("next_print", "_calibration.Advice", ("measurements", "task"), types={"task": TASKS}),
    "identify": Call("identify", "_identify.Cell", ("task", "runs", "out")),
    "tasks": Call(
        "tasks", "_lists.Tasks", example="[task.name for task in fo.tasks().tasks]\n['ket8', 'ket12', 'rj45', 'usb', 'rj45_latch', 'usb_a']"
    ),
    "config": Call("config"),
    "robots": Call("robots", "_lists.Robots"),
    "measure sheet": Call(
        "measuring_sheet", positional=("task", "fingers", "out"), names={"finger": "fingers"},
        types={"task": "TaskName | StrPath"}, returns=("None", ""),
    ),
    "export finger": Call(
        "export_finger", "_export.Files", names={"dir": "study"}, returns=("tuple[Path, ...]", ".paths"),
        checks="""\
if study is not None:
    without("study", "its best design is exported", density=density, direction=direction)""",
    ),
    "export mjcf": Call("export_mjcf", "_export.Files", SUBJECT, returns=("Path", ".paths[0]")),
    "task new": Call(
        "new_task", "_connector.NewTask", types={"name": "str"},
        checks="""\
if plug is not None:
    without("plug", "give only one of them", round=round)
if plug is None and round is None and pins is None:
    without("no plug", "clearance and body require plug, round or pins", clearance=clearance, body=body)""",
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
#: Commands implemented by hand in Python, and their counterparts.
BY_HAND = {
    "ask-tell": "Optimizer", "completions": "a script for a shell", "man": "help()", "measure add": "Measurements.add",
    "measure check": "Measurements.check", "report": "Study.report", "stiffness": "stiffness",
    "task import": "import_parts", "task show": "Task.from_toml",
}
