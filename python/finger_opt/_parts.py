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
    leave_out: str | Iterable[str] = (),
    like: _Path | None = None,
    tolerance_mm: float = 0.01,
    engine: str | None = None,
) -> Imported:
    """Writes a task file, ``out``, from STL, OBJ or STEP files of a plug and its socket.

    ``unit`` (``"mm"``, ``"in"``, ``"m"``), ``insert_along`` (``"-z"``), ``jaws`` (``"y"``) and ``like`` (a task)
    are the words of ``optimize task import``. If ``plug`` holds both, ``plug_body`` names the plug: a body, a
    part or an assembly of parts; all else is the socket.

    STEP (``.step``, ``.stp``) needs Open Cascade: ``pip install 'finger_opt[step]'``. Units and the places of
    parts are those of the file. Facets keep within ``tolerance_mm`` of the surface. What is called as in
    ``leave_out`` is left out: pins, a thread.
    """
    files = [Path(file) for file in (plug, socket) if file is not None]
    steps = [file for file in files if _step.is_step(file)]
    names = [str(file) for file in files]
    unneeded = [leave_out] if isinstance(leave_out, str) else list(leave_out)
    if plug_body is not None and socket is not None:
        raise InputError("plug_body: goes with one file of both plug and socket")
    if unneeded and len(steps) < len(files):
        raise InputError("leave_out: goes with STEP files")
    if steps:
        if unit not in (None, "mm"):
            raise InputError(f"unit: {steps[0]} is STEP, which names its unit, and is taken in mm")
        unit = "mm"
    bodies = {file: _step.read(file, tolerance_mm) for file in steps}
    for name in unneeded:
        if not any(name in body.names for found in bodies.values() for body in found):
            raise InputError(f"leave_out: no body is called `{name}`; there are {_step.listed(sum(bodies.values(), []))}")
    for file, found in bodies.items():
        bodies[file] = [body for body in found if body.names.isdisjoint(unneeded)]
        if not bodies[file]:
            raise InputError(f"leave_out: leaves nothing of {file}, which has {_step.listed(found)}")
    sides: list[list[Body] | Path] = [bodies.get(file, file) for file in files]
    if steps and socket is None:
        sides = [*_apart(files[0], bodies[files[0]], plug_body)]
        names = [f"{plug} ({plug_body})", f"{plug} (without {plug_body})"]
        plug_body = None
    with tempfile.TemporaryDirectory() as folder:
        meshes = [
            _step.write(side, Path(folder, f"{place}.obj")) if isinstance(side, list) else side
            for place, side in enumerate(sides)
        ]
        settings = {
            "unit": unit, "insert_along": insert_along, "jaws": jaws, "plug_body": plug_body, "like": like,
            "engine": engine,
        }
        given = {name: value for name, value in settings.items() if value is not None}
        measured = _native.import_parts(meshes[0], meshes[1] if len(meshes) > 1 else None, out, names=names, **given)
    return Imported(json.loads(measured))


def _apart(file: Path, bodies: list[Body], plug_body: str | None) -> tuple[list[Body], list[Body]]:
    """The bodies of the plug, and all others."""
    sides = [[body for body in bodies if (plug_body in body.names) == is_plug] for is_plug in (True, False)]
    if not all(sides):
        wrong = "is missing" if plug_body is None else f"`{plug_body}` is none or all of it"
        raise InputError(
            f"plug_body: {wrong}; with one file it names the plug, and all else is the socket. {file} has "
            f"{_step.listed(bodies)}"
        )
    return sides[0], sides[1]
