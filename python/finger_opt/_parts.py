"""Tasks from meshes and STEP files of one's own plug and socket."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterable
from pathlib import Path

from . import _native, _step
from ._measure import Record
from ._native import InputError

_Path = str | os.PathLike[str]


class Imported(Record):
    """A task that was imported: ``out`` (its file), ``plug_parts``, ``socket_parts``, ``clearance_mm``,
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
    leave_out: Iterable[str] = (),
    like: _Path | None = None,
    tolerance_mm: float = 0.01,
    resolution: int | None = None,
    engine: str | None = None,
) -> Imported:
    """Writes a task file, ``out``, from STL, OBJ or STEP files of a plug and its socket.

    Works as ``optimize task import``, whose words these are: ``unit`` (``"mm"``, ``"in"``, ``"m"``),
    ``insert_along`` (``"-z"``), ``jaws`` (``"y"``), ``like`` (another task), ``resolution`` (voxels).
    One file with both needs ``plug_body``: the plug's name, that of a body, a part or an assembly.

    STEP (``.step``, ``.stp``) needs Open Cascade: ``pip install 'finger_opt[step]'``. Its unit and the
    places of its parts are those of the file; facets keep within ``tolerance_mm`` of the surface; bodies
    that are called as in ``leave_out`` are left out, a thread for example.
    """
    files = [Path(plug)] if socket is None else [Path(plug), Path(socket)]
    if socket is not None and plug_body is not None:
        raise InputError("plug_body: goes with one file that holds both plug and socket")
    unneeded = [leave_out] if isinstance(leave_out, str) else list(leave_out)
    steps = [file for file in files if _step.is_step(file)]
    if steps and unit not in (None, "mm"):
        raise InputError(f"unit: {steps[0]} says its unit itself, and is read in mm")
    if unneeded and len(steps) < len(files):
        raise InputError("leave_out: goes with STEP files")
    names: tuple[str, str] | None = None
    with tempfile.TemporaryDirectory() as folder:
        if steps:
            unit = "mm"
            names = (str(files[0]), str(files[-1]))
            bodies = {file: _bodies(file, tolerance_mm, unneeded) for file in steps}
            if socket is None:
                plug_bodies, socket_bodies = _parted(files[0], bodies[files[0]], plug_body)
                sides = [plug_bodies, socket_bodies]
                plug_body = None
            else:
                sides = [bodies.get(file) for file in files]
            meshes = [Path(folder, name) for name in ("plug.obj", "socket.obj")]
            for side, (found, mesh) in enumerate(zip(sides, meshes)):
                if found is None:
                    meshes[side] = files[side]
                else:
                    _step.write(found, mesh)
            files = meshes
        found = _native.import_parts(
            *map(str, files), out=out, unit=unit, insert_along=insert_along, jaws=jaws, plug_body=plug_body,
            like=like, resolution=resolution, engine=engine, names=names,
        )
    return Imported(json.loads(found))
