"""Tasks from meshes and STEP files of one's own plug and socket."""

from __future__ import annotations

import tempfile
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
from ._words import Engine, StrPath

#: Where the plug points.
Along = Literal["x", "-x", "y", "-y", "z", "-z"]


@dataclass(frozen=True, repr=False)
class LeftOut(Result):
    """Parts that overlap the other half in the mated pose, as unloaded contact springs do; task frame, plug mated."""

    body: Literal["plug", "socket"]
    #: Whether their faces were cut back, as those of a press fit; else the parts were left out.
    cut_back: bool
    parts: int
    #: Deepest overlap.
    depth_mm: float
    from_mm: tuple[float, float, float]
    to_mm: tuple[float, float, float]


@dataclass(frozen=True, repr=False)
class Imported(Result):
    """A task made of parts, as ``optimize task import --json`` says it."""

    #: Its file.
    out: str
    parts: int
    plug_parts: int
    socket_parts: int
    unit: str
    insert_along: str
    jaws: str
    #: What was found from the shapes, and why.
    found: tuple[str, ...]
    clearance_mm: float
    clearance_x_mm: float
    clearance_y_mm: float
    #: What the fingers hold: width, height, length.
    body_mm: tuple[float, float, float]
    plug_was_inward: bool
    socket_was_inward: bool
    #: What overlaps in the mated pose and was left out of the shapes or cut back.
    left_out: tuple[LeftOut, ...]
    #: The strategy that was found for it, if it needed one.
    tuned: Step | None
    #: What is wrong with it, and how its nominal start ends.
    check: TaskCheck

    @property
    def task(self) -> Task:
        """The task of the file."""
        return Task.from_toml(self.out)


@checked
def import_parts(
    plug: StrPath | None = None,
    socket: StrPath | None = None,
    *,
    assembly: StrPath | None = None,
    out: StrPath | None = None,
    unit: Literal["mm", "in", "m"] | None = None,
    insert_along: Along | None = None,
    jaws: Literal["x", "y", "z"] | None = None,
    plug_body: str | Iterable[str] | None = None,
    socket_body: str | Iterable[str] | None = None,
    leave_out: str | Iterable[str] = (),
    like: StrPath | None = None,
    resolution: int | None = None,
    body: tuple[float, float, float] | None = None,
    depth_mm: float | None = None,
    tolerance_mm: float = 0.01,
    engine: Engine = "direct",
) -> Imported:
    """Writes a task file from STL, OBJ or STEP files of a plug and its socket, as ``optimize task import`` does.

    STEP (``.step``, ``.stp``) needs Open Cascade: ``pip install 'finger-opt[step]'``. Units and the places of
    parts are those of the file.

    Args:
        plug: File of the plug, or of both.
        socket: File of the socket.
        assembly: File of both in their mated pose, in place of ``plug`` and ``socket``; the plug is the part
            that can be withdrawn.
        out: Task file to write; the plug's name with ``.toml`` unless given.
        unit: Unit of the files; found from the shapes unless given.
        insert_along: Where the plug points in its file.
        jaws: Along what the jaws close.
        plug_body: Bodies, parts or assemblies of the file; if it holds both, what they leave is the socket.
        socket_body: The same for the socket.
        leave_out: Bodies of a STEP file to leave out: pins, a thread.
        like: Task whose grip force, friction, fingers, limits and strategy are taken.
        resolution: Without effect: parts are exact within 0.02 mm.
        body: Handle on a plug that has no faces to grip, width between the jaws x height x length, mm.
        depth_mm: Depth to be reached in a through hole.
        tolerance_mm: How far facets may be off the surface of a STEP file, mm.
        engine: Contact engine that tries the nominal start.

    Raises:
        InputError: A file that cannot be used, or shapes of which no task can be made.
        Interrupted: Ctrl-C.
    """
    if (plug is None) == (assembly is None) or (socket is not None and assembly is not None):
        raise InputError("plug: give plug and socket, or assembly")
    files = [Path(file) for file in (assembly, plug, socket) if file is not None]
    steps = [file for file in files if _step.is_step(file)]
    unneeded, *names = ([given] if isinstance(given, str) else list(given or ()) for given in (leave_out, plug_body, socket_body))
    if unneeded and len(steps) < len(files):
        raise InputError("leave_out: goes with STEP files")
    if steps:
        if unit not in (None, "mm"):
            raise InputError(f"unit: {steps[0]} is STEP, which names its unit, and is taken in mm")
        unit = "mm"
    bodies = _without(unneeded, {file: _step.read(file, tolerance_mm) for file in steps})
    sides: list[list[Body] | Path] = [*files]
    if steps and len(files) == 1:
        both = bodies[files[0]]
        if any(names):
            sides = [_called(files[0], both, *of) for of in (names, names[::-1])]
        elif assembly is None:
            raise InputError(f"plug_body: has to name the plug in {plug}, or give socket; it has {_step.listed(both)}")
        else:
            sides = [both]
    elif steps:
        sides = [_called(file, bodies[file], of) if file in steps else file for file, of in zip(files, names)]
    # Names of a STEP file have become those of bodies.
    own = [[' '.join(body.name.split()) for body in side] if isinstance(side, list) else name for side, name in zip(sides, names)]
    settings: dict[str, Any] = {
        "plug_body": None if files[0] in steps else names[0],
        "socket_body": None if files[-1] in steps else names[1],
        "unit": unit, "insert_along": insert_along, "jaws": jaws, "like": like, "engine": engine,
        "resolution": resolution, "body": body, "depth_mm": depth_mm,
        "names": (str(files[0]), str(files[-1])),
    }
    with tempfile.TemporaryDirectory() as folder:
        if assembly is not None and len(sides) == 2:
            settings |= {"plug_body": own[0], "socket_body": own[1]}
            sides = [[body for side in sides if isinstance(side, list) for body in side]]
        meshes = [
            _step.write(side, Path(folder, f"{place}.obj")) if isinstance(side, list) else side
            for place, side in enumerate(sides)
        ]
        places = ("assembly",) if assembly is not None else ("plug", "socket")
        settings |= {**dict(zip(places, meshes)), "out": out or Path(files[0].stem + ".toml")}
        return called("task import", settings, Imported)


def _without(unneeded: list[str], bodies: dict[Path, list[Body]]) -> dict[Path, list[Body]]:
    """The bodies of each file without those that are not needed."""
    for name in unneeded:
        if not any(name in body.names for found in bodies.values() for body in found):
            raise InputError(f"leave_out: no body is called `{name}`; there are {_step.listed(sum(bodies.values(), list[Body]()))}")
    left = {file: [body for body in found if body.names.isdisjoint(unneeded)] for file, found in bodies.items()}
    for file, found in left.items():
        if not found:
            raise InputError(f"leave_out: leaves nothing of {file}, which has {_step.listed(bodies[file])}")
    return left


def _called(file: Path, bodies: list[Body], names: list[str], others: list[str] | None = None) -> list[Body]:
    """The bodies of these names; without names all but those of the others."""
    for name in names:
        if not any(name in body.names for body in bodies):
            raise InputError(f"{file}: has no body `{name}`; it has {_step.listed(bodies)}")
    without = set(others or ())
    found = [body for body in bodies if (not body.names.isdisjoint(names) if names else body.names.isdisjoint(without))]
    if not found:
        raise InputError(f"{file}: has nothing but `{'`, `'.join(without)}`; it has {_step.listed(bodies)}")
    return found
