"""Creates tasks from meshes and STEP files of your own plug and socket."""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from . import _step
from ._call import called, checked
from ._connector import Step, TaskCheck
from ._native import InputError
from ._result import Result
from ._step import Body
from ._task import Task
from ._words import Engine, RobotName, StrPath

#: Direction of insertion along an axis of the file.
Along = Literal["x", "-x", "y", "-y", "z", "-z"]


@dataclass(frozen=True, repr=False)
class LeftOut(Result):
    """Parts that overlap the other half in the mated pose, for example unloaded contact springs; in the task frame."""

    body: Literal["plug", "socket"]
    #: Whether their faces were cut back, as for a press fit; otherwise the parts were left out.
    cut_back: bool
    parts: int
    #: Depth of the deepest overlap, mm.
    depth_mm: float
    #: Bounding box: lower and upper corner, mm.
    from_mm: tuple[float, float, float]
    to_mm: tuple[float, float, float]


@dataclass(frozen=True, repr=False)
class MatedPose(Result):
    """Pose in which the plug can be mated."""

    insert_along: str
    #: Depth of the plug's tip below the socket's edge, mm.
    depth_mm: float
    #: Angle between this pose and the first, degrees.
    turn_deg: float
    #: Place of the origin of the plug's file, in the file of the socket, mm.
    origin_mm: tuple[float, float, float]


@dataclass(frozen=True, repr=False)
class Imported(Result):
    """Imported task, with the fields of ``optimize task import --json``."""

    #: Path of the task file.
    out: str
    parts: int
    plug_parts: int
    socket_parts: int
    unit: str
    insert_along: str
    jaws: str
    #: Mated poses that were found, the best first; ``pose`` takes one.
    poses: tuple[MatedPose, ...]
    #: Settings that were derived from the shapes, with reasons.
    found: tuple[str, ...]
    clearance_mm: float
    clearance_x_mm: float
    clearance_y_mm: float
    #: Play in rotation about the axis of insertion, both directions together, and its arc at the inserted corner
    #: farthest from it, such as that of a key; None if the plug turns freely.
    clearance_about_z_deg: float | None
    clearance_about_z_mm: float | None
    #: Size of the body that the fingers hold, mm: width between the jaws, height, length.
    body_mm: tuple[float, float, float]
    #: Whether the faces of a mesh pointed inward and were flipped.
    plug_was_inward: bool
    socket_was_inward: bool
    #: Parts that overlap in the mated pose and were left out or cut back.
    left_out: tuple[LeftOut, ...]
    #: Strategy that was found, if the nominal start did not insert.
    tuned: Step | None
    #: Check of the written file, with its nominal start.
    check: TaskCheck

    @property
    def task(self) -> Task:
        """Task read from the written file."""
        return Task.from_toml(self.out)


@checked
def import_parts(
    plug: StrPath | None = None,
    socket: StrPath | None = None,
    *,
    assembly: StrPath | None = None,
    out: StrPath | None = None,
    unit: Literal["mm", "cm", "in", "m"] | None = None,
    insert_along: Along | None = None,
    pose: int | None = None,
    jaws: Literal["x", "y", "z"] | None = None,
    plug_body: str | Iterable[str] | None = None,
    socket_body: str | Iterable[str] | None = None,
    leave_out: str | Iterable[str] = (),
    like: StrPath | None = None,
    resolution: int | None = None,
    body: tuple[float, float, float] | None = None,
    depth_mm: float | None = None,
    tolerance_mm: float = 0.01,
    robot: RobotName | StrPath = "servo",
    engine: Engine = "direct",
) -> Imported:
    """Writes a task file from STL, OBJ or STEP files of a plug and its socket, like ``optimize task import``.

    STEP (``.step``, ``.stp``) needs Open Cascade: ``pip install 'finger-opt[step]'``. A STEP file defines
    units and poses of its parts.

    Args:
        plug: File of the plug, or of both.
        socket: File of the socket.
        assembly: File of both in their mated pose, instead of ``plug`` and ``socket``; the plug is the part
            that can be withdrawn.
        out: Task file to write; by default the plug's name with ``.toml``.
        unit: Unit of the files; by default derived from the shapes.
        insert_along: Direction of insertion in the socket's file; by default derived from the shapes.
        pose: Pose to take, by its number from 1, if several are possible.
        jaws: Axis of the socket's file along which the jaws close; by default derived from the shapes.
        plug_body: Bodies, parts or assemblies that form the plug; in a file of both, the rest is the socket.
        socket_body: The same for the socket.
        leave_out: Bodies of a STEP file to leave out, for example pins or a thread.
        like: Task from which grip force, friction, fingers, limits and strategy are copied.
        resolution: Deprecated, without effect: parts are exact within 0.02 mm.
        body: Handle for a plug without faces to grip: width between the jaws, height, length, mm.
        depth_mm: Depth to be reached in a through hole, mm.
        tolerance_mm: Largest deviation of facets from the surfaces of a STEP file, mm.
        robot: Robot: see ``fo.robots()``, or the path of a robot file.
        engine: Contact engine.

    Raises:
        InputError: A file cannot be used, or its shapes do not define a task.
        Interrupted: The import was cancelled by Ctrl-C.
    """
    if resolution is not None:
        warnings.warn("import_parts: resolution has no effect; leave it out", DeprecationWarning, stacklevel=3)
    if not 1e-4 <= tolerance_mm <= 1:
        raise InputError(f"tolerance_mm: {tolerance_mm} mm is out of range; it must be within 0.0001 to 1 mm")
    if (plug is None) == (assembly is None) or (socket is not None and assembly is not None):
        raise InputError("plug: give plug and socket, or assembly")
    files = [Path(file) for file in (assembly, plug, socket) if file is not None]
    steps = [file for file in files if _step.is_step(file)]
    excluded, *names = (
        [given] if isinstance(given, str) else list(given or ()) for given in (leave_out, plug_body, socket_body)
    )
    if excluded and len(steps) < len(files):
        raise InputError("leave_out: needs STEP files")
    if steps:
        if unit not in (None, "mm"):
            raise InputError(f"unit: {steps[0]} is a STEP file, which contains its unit; omit unit")
        unit = "mm"
    bodies = _without(excluded, {file: _step.read(file, tolerance_mm) for file in steps})
    sides: list[list[Body] | Path] = [*files]
    if steps and len(files) == 1:
        both = bodies[files[0]]
        if any(names):
            sides = [_selected(files[0], both, *pair) for pair in (names, names[::-1])]
        elif assembly is None:
            available = _step.listed(both)
            raise InputError(f"plug_body: must name the plug in {plug}, or give socket; available: {available}")
        else:
            sides = [both]
    elif steps:
        sides = [_selected(file, bodies[file], own) if file in steps else file for file, own in zip(files, names)]
    # In a STEP file, the given names of products and assemblies stand for these bodies.
    body_names = [
        [' '.join(body.name.split()) for body in side] if isinstance(side, list) else own
        for side, own in zip(sides, names)
    ]
    settings: dict[str, Any] = {
        "plug_body": None if files[0] in steps else names[0],
        "socket_body": None if files[-1] in steps else names[1],
        "unit": unit, "insert_along": insert_along, "pose": pose, "jaws": jaws, "like": like, "robot": robot,
        "engine": engine, "body": body, "depth_mm": depth_mm,
        "names": (str(files[0]), str(files[-1])),
    }
    with tempfile.TemporaryDirectory() as folder:
        if assembly is not None and len(sides) == 2:
            settings |= {"plug_body": body_names[0], "socket_body": body_names[1]}
            sides = [[body for side in sides if isinstance(side, list) for body in side]]
        meshes = [
            _step.write(side, Path(folder, f"{place}.obj")) if isinstance(side, list) else side
            for place, side in enumerate(sides)
        ]
        places = ("assembly",) if assembly is not None else ("plug", "socket")
        settings |= {**dict(zip(places, meshes)), "out": out or Path(files[0].stem + ".toml")}
        return called("task import", settings, Imported)


def _without(excluded: list[str], bodies: dict[Path, list[Body]]) -> dict[Path, list[Body]]:
    """Returns the bodies of each file without the excluded ones; raises InputError if none is left."""
    everything = sum(bodies.values(), list[Body]())
    for name in excluded:
        if not any(name in body.names for body in everything):
            raise InputError(f"leave_out: unknown body `{name}`; available: {_step.listed(everything)}")
    left = {file: [body for body in group if body.names.isdisjoint(excluded)] for file, group in bodies.items()}
    for file, group in left.items():
        if not group:
            raise InputError(f"leave_out: leaves nothing of {file}; available: {_step.listed(bodies[file])}")
    return left


def _selected(file: Path, bodies: list[Body], names: list[str], others: list[str] | None = None) -> list[Body]:
    """Returns the bodies with these names; without names, all except the others."""
    for name in names:
        if not any(name in body.names for body in bodies):
            raise InputError(f"{file}: has no body `{name}`; available: {_step.listed(bodies)}")
    without = set(others or ())
    selected = [
        body for body in bodies
        if (not body.names.isdisjoint(names) if names else body.names.isdisjoint(without))
    ]
    if not selected:
        raise InputError(f"{file}: has no body except `{'`, `'.join(without)}`; available: {_step.listed(bodies)}")
    return selected
