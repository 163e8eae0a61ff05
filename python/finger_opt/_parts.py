"""Tasks from meshes and STEP files of one's own plug and socket."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Union

from . import _native, _step
from ._measure import Record
from ._native import InputError
from ._step import Body

_Path = Union[str, "os.PathLike[str]"]


class Imported(Record):
    """A task from parts: ``out`` (its file), ``plug_parts``, ``socket_parts``, ``clearance_mm``, ``warning``,
    ``check`` (what is wrong with it, and how its nominal start ends), as ``optimize task import --json``."""


def import_parts(
    plug: _Path,
    socket: _Path | None = None,
    *,
    out: _Path,
    unit: str | None = None,
    insert_along: str | None = None,
    jaws: str | None = None,
    plug_body: str | None = None,
    socket_body: str | None = None,
    leave_out: str | Iterable[str] = (),
    like: _Path | None = None,
    tolerance_mm: float = 0.01,
    engine: str | None = None,
) -> Imported:
    """Writes a task file, ``out``, from STL, OBJ or STEP files of a plug and its socket.

    ``unit`` (``"mm"``, ``"in"``, ``"m"``), ``insert_along`` (``"-z"``), ``jaws`` (``"y"``) and ``like`` (a task)
    are the words of ``optimize task import``. ``plug_body`` and ``socket_body`` name a body, a part or an
    assembly of their file; if ``plug`` holds both, what one of them leaves is the other.

    STEP (``.step``, ``.stp``) needs Open Cascade: ``pip install 'finger_opt[step]'``. Units and the places of
    parts are those of the file. Facets keep within ``tolerance_mm`` of the surface. What is called as in
    ``leave_out`` is left out: pins, a thread.
    """
    files = [Path(file) for file in (plug, socket) if file is not None]
    steps = [file for file in files if _step.is_step(file)]
    unneeded = [leave_out] if isinstance(leave_out, str) else list(leave_out)
    if unneeded and len(steps) < len(files):
        raise InputError("leave_out: goes with STEP files")
    if steps:
        if unit not in (None, "mm"):
            raise InputError(f"unit: {steps[0]} is STEP, which names its unit, and is taken in mm")
        unit = "mm"
    bodies = _without(unneeded, {file: _step.read(file, tolerance_mm) for file in steps})
    sides: list[list[Body] | Path] = [*files]
    if steps and len(files) == 1:
        if plug_body is None and socket_body is None:
            raise InputError(
                f"plug_body: has to name the plug in {plug}, or give socket; it has {_step.listed(bodies[files[0]])}"
            )
        both = bodies[files[0]]
        sides = [_called(files[0], both, *names) for names in [(plug_body, socket_body), (socket_body, plug_body)]]
    elif steps:
        names = [plug_body, socket_body]
        sides = [_called(file, bodies[file], name) if file in steps else file for file, name in zip(files, names)]
    settings = {
        "plug_body": None if files[0] in steps else plug_body,
        "socket_body": None if files[-1] in steps else socket_body,
        "unit": unit, "insert_along": insert_along, "jaws": jaws, "like": like, "engine": engine,
        "names": (str(files[0]), str(files[-1])),
    }
    with tempfile.TemporaryDirectory() as folder:
        meshes = [
            _step.write(side, Path(folder, f"{place}.obj")) if isinstance(side, list) else side
            for place, side in enumerate(sides)
        ]
        given = {name: value for name, value in settings.items() if value is not None}
        measured = _native.import_parts(meshes[0], meshes[1] if len(meshes) > 1 else None, out, **given)
    return Imported(json.loads(measured))


def _without(unneeded: list[str], bodies: dict[Path, list[Body]]) -> dict[Path, list[Body]]:
    """The bodies of each file without those that are not needed."""
    for name in unneeded:
        if not any(name in body.names for found in bodies.values() for body in found):
            raise InputError(f"leave_out: no body is called `{name}`; there are {_step.listed(sum(bodies.values(), []))}")
    left = {file: [body for body in found if body.names.isdisjoint(unneeded)] for file, found in bodies.items()}
    for file, found in left.items():
        if not found:
            raise InputError(f"leave_out: leaves nothing of {file}, which has {_step.listed(bodies[file])}")
    return left


def _called(file: Path, bodies: list[Body], name: str | None, other: str | None = None) -> list[Body]:
    """The bodies of that name; without a name all but those of the other name."""
    found = [body for body in bodies if (name in body.names if name is not None else other not in body.names)]
    if not found:
        wanted = f"nothing but `{other}`" if name is None else f"no body `{name}`"
        raise InputError(f"{file}: has {wanted}; it has {_step.listed(bodies)}")
    return found
