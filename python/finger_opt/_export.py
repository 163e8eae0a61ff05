"""Files for the printer and for MuJoCo."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Literal

from . import _native
from ._call import checked, given, without
from ._study import Study
from ._task import Given, sources
from ._words import FingerModel, Numbers, RobotName, SpaceName, Start, StrPath

#: What a finger is written as.
Format = Literal["stl", "3mf", "svg", "dxf", "sheet", "cura", "prusaslicer"]


@checked
def export_finger(
    study: Study | StrPath | None = None,
    *,
    format: Format,
    out: StrPath,
    density: float | None = None,
    direction: float | None = None,
    finger: StrPath | None = None,
    phase_mm: float | None = None,
) -> tuple[Path, ...]:
    """Writes a finger for the printer, as ``optimize export finger`` does: the best of a study, or of an infill.

    Args:
        study: A study, or its folder: its best design.
        format: ``stl``, ``3mf``, ``svg`` and ``dxf`` have every rib; ``sheet`` is a page to print by; settings
            for slicers have the outline beside them.
        out: File to write.
        density: Infill density, percent, in place of a study.
        direction: Infill direction, degrees.
        finger: ``finray9``, or a finger file; the study's unless given.
        phase_mm: Where the first rib lies, mm.

    Returns:
        The files that were written.

    Raises:
        InputError: A value or a file that cannot be used.
    """
    if study is not None:
        without("study", "its best design is exported", density=density, direction=direction)
    words = given(locals(), "study")
    folder = study.path if isinstance(study, Study) else study
    found = json.loads(_native.export_finger(**words, **({} if folder is None else {"dir": folder})))
    return tuple(Path(file) for file in (found["out"], *found["beside"]))


@checked
def export_mjcf(
    task: Given,
    density: float | None = None,
    direction: float | None = None,
    *,
    out: StrPath,
    stiffness_compliance: float | None = None,
    stiffness_assembly: float | None = None,
    set: Numbers | None = None,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
) -> Path:
    """Writes the scene of a trial as MJCF, the model format of MuJoCo and its viewer, as ``optimize export mjcf``.

    ``out`` is the file. The rest, and what is raised, is as for :func:`evaluate`.
    """
    return Path(json.loads(_native.export_mjcf(sources(task), **given(locals(), "task")))["out"])
