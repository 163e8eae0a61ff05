"""STEP files as triangles, by Open Cascade (the extra ``step``)."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._native import InputError

Floats = NDArray[np.float64]

#: What installs the reader.
INSTALL = "pip install 'finger_opt[step]'"
#: Largest angle between neighbouring facets, rad. It rules radii under 0.13 mm alone, of which a connector has
#: many: the tolerance rules all others.
ANGLE_RAD = 0.8
#: Triangles of a product above which it is meshed more coarsely: what a body has more is reduced after reading.
MANY_TRIANGLES = 60_000
#: How much coarser than asked for, one after the other.
COARSER = (1, 3, 9)
#: Time for reading and meshing a file, s.
LIMIT_S = 60.0
#: Largest file, bytes.
LARGEST_FILE = 200 << 20
#: Most bodies that a message names.
MOST_NAMED = 12
#: Meshes a file, in a process of its own: what breaks Open Cascade or takes too long does not harm this one.
READER = """
import pathlib, sys, cascadio
given, glb, tolerance, angle = sys.argv[1:]
data = cascadio.load(pathlib.Path(given).read_bytes(), tol_linear=float(tolerance), tol_angular=float(angle))
pathlib.Path(glb).write_bytes(data)
"""
#: Names that mean nothing: labels of references, and the numbers of occurrences in assemblies.
NAMELESS = re.compile(r"=>\[|NAUO\d+$")


@dataclass(frozen=True)
class Body:
    """A body of a STEP file where its assembly places it."""

    #: Its own name, which no other body of the file has.
    name: str
    #: All that it may be called by: its own name, its product and the assemblies that it is in.
    names: frozenset[str]
    #: Corners, mm, shape (n, 3, 3), counter-clockwise from outside.
    triangles: Floats


def is_step(path: str | os.PathLike[str]) -> bool:
    """Whether a file is STEP, by its name or its content."""
    if Path(path).suffix.lower() in (".step", ".stp"):
        return True
    try:
        with open(path, "rb") as file:
            return b"ISO-10303-21" in file.read(1024)
    except OSError:
        return False


def read(path: str | os.PathLike[str], tolerance_mm: float) -> list[Body]:
    """The bodies of a STEP file, meshed within ``tolerance_mm``, in mm whatever its unit.

    A product of more than ``MANY_TRIANGLES``, as a thread has, is meshed more coarsely, with a warning.
    """
    if not 1e-4 <= tolerance_mm <= 1:
        raise InputError(f"tolerance_mm: {tolerance_mm} is not between 0.0001 and 1 mm")
    until = time.monotonic() + LIMIT_S
    products: dict[int, Body] = {}
    for scale in COARSER:
        last = scale == COARSER[-1]
        left = until - time.monotonic()
        glb = _mesh(path, scale * tolerance_mm, left if last else left / 2)
        if glb is None:
            continue
        found = _products(glb)
        for place, product in enumerate(found):
            count = len(product.triangles)
            if place in products or (count > MANY_TRIANGLES and not last):
                continue
            products[place] = product
            if scale > 1:
                warnings.warn(
                    f"{path}: `{product.name}` is meshed within {scale * tolerance_mm:g} mm, {count} triangles: "
                    "threads, knurls or text make too many else; better leave them out of the model",
                    stacklevel=3,
                )
        if len(products) == len(found):
            break
    else:
        raise InputError(
            f"{path}: is not meshed within {LIMIT_S:g} s; leave threads, knurls and text out of the model, or "
            "export STL"
        )
    bodies = [piece for place in sorted(products) for piece in _pieces(products[place])]
    if not bodies:
        raise InputError(f"{path}: holds no solid; export the bodies as solids, not as curves")
    return _numbered(bodies)


def listed(bodies: list[Body]) -> str:
    """Names and sizes of bodies, for messages."""
    sizes = [np.ptp(body.triangles.reshape(-1, 3), axis=0) for body in bodies[:MOST_NAMED]]
    named = [
        f"`{body.name}` ({' x '.join(f'{side:.1f}' for side in size)} mm)" for body, size in zip(bodies, sizes)
    ]
    more = len(bodies) - len(named)
    return ", ".join(named) + (f" and {more} more" if more else "")


def obj(bodies: list[Body]) -> str:
    """OBJ in mm with an object for each body, called as the body."""
    lines: list[str] = []
    count = 0
    for body in bodies:
        points, corners = np.unique(body.triangles.reshape(-1, 3), axis=0, return_inverse=True)
        lines.append(f"o {' '.join(body.name.split())}\n")
        lines.extend("v {:.6f} {:.6f} {:.6f}\n".format(*point) for point in points)
        lines.extend("f {} {} {}\n".format(*face) for face in corners.reshape(-1, 3) + 1 + count)
        count += len(points)
    return "".join(lines)


def write(bodies: list[Body], path: Path) -> Path:
    """Writes bodies as OBJ; gives its path."""
    path.write_text(obj(bodies), encoding="utf-8")
    return path


def _mesh(path: str | os.PathLike[str], tolerance_mm: float, limit_s: float) -> bytes | None:
    """GLB of a STEP file, read by another process; none after the limit."""
    try:
        if os.path.getsize(path) > LARGEST_FILE:
            raise InputError(f"{path}: has more than {LARGEST_FILE >> 20} MiB")
        open(path, "rb").close()
    except OSError as error:
        raise InputError(f"{path}: cannot read the STEP file: {error.strerror}") from None
    with tempfile.TemporaryDirectory() as folder:
        glb = Path(folder, "mesh.glb")
        words = [sys.executable, "-c", READER, os.fspath(path), str(glb), str(tolerance_mm), str(ANGLE_RAD)]
        try:
            done = subprocess.run(words, capture_output=True, text=True, errors="replace", timeout=limit_s)
        except subprocess.TimeoutExpired:
            return None
        if done.returncode == 0 and glb.stat().st_size:
            return glb.read_bytes()
    said = done.stderr + done.stdout
    if "No module named 'cascadio'" in said:
        raise ImportError(f"{path} is a STEP file, which Open Cascade reads: {INSTALL}", name="cascadio")
    last = said.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
    syntax = re.search(r"Line \d+: [^*\n]*", said)
    why = syntax.group().strip() if syntax else last[0]
    raise InputError(f"{path}: is no whole STEP file that Open Cascade can read: {plain(why)}")


def plain(text: str) -> str:
    """What another program said, without the colours and cursor moves that it meant for a terminal."""
    text = re.sub(r"\x1b\[[0-9;?]*[ -/]*[@-~]", "", text)
    return "".join(letter if letter.isprintable() else " " for letter in text).strip()


def _products(glb: bytes) -> list[Body]:
    """All that has a mesh in a GLB, where it is placed."""
    length = int.from_bytes(glb[12:16], "little")
    scene: dict[str, Any] = json.loads(glb[20:20 + length])
    data = glb[28 + length:]
    kinds: dict[int, type[Any]] = {5121: np.uint8, 5123: np.uint16, 5125: np.uint32, 5126: np.float32}

    def numbers(accessor: dict[str, Any]) -> NDArray[Any]:
        view = scene["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        count = accessor["count"] * {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        return np.frombuffer(data, kinds[accessor["componentType"]], count, start)

    def triangles(mesh: dict[str, Any]) -> Floats:
        corners = [np.empty((0, 3))]
        for one in mesh.get("primitives", []):
            # 4 are triangles; curves are something else.
            if one.get("mode", 4) == 4:
                points = numbers(scene["accessors"][one["attributes"]["POSITION"]]).reshape(-1, 3)
                corners.append(points[numbers(scene["accessors"][one["indices"]])].astype(float))
        return np.concatenate(corners)

    found: list[Body] = []

    def visit(node: dict[str, Any], above: list[str], place: Floats) -> None:
        if node.keys() & {"translation", "rotation", "scale"}:
            raise InputError("this version of cascadio places parts in an unknown way: pip install cascadio==0.1.1")
        own_place: Floats = np.reshape(node.get("matrix", np.eye(4)), (4, 4), order="F")
        place = place @ own_place
        mesh: dict[str, Any] = scene["meshes"][node["mesh"]] if "mesh" in node else {}
        own: list[str] = [name for name in (mesh.get("name"), node.get("name")) if name and not NAMELESS.match(name)]
        names = [*above, *own]
        if mesh:
            # The file is in m.
            placed = 1e3 * (triangles(mesh) @ np.transpose(place[:3, :3]) + place[:3, 3])
            found.append(Body(own[-1] if own else "body", frozenset(names), placed.reshape(-1, 3, 3)))
        for child in node.get("children", []):
            visit(scene["nodes"][child], names, place)

    for root in scene["scenes"][scene.get("scene", 0)].get("nodes", []):
        visit(scene["nodes"][root], [], np.eye(4))
    return found


def _pieces(product: Body) -> list[Body]:
    """The bodies of a product: what shares no corner."""
    triangles = product.triangles
    if not len(triangles):
        return []
    _, corners = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
    faces = corners.reshape(-1, 3)
    label: NDArray[np.intp] = np.arange(int(faces.max()) + 1, dtype=np.intp)
    while True:
        before = np.copy(label)
        for corner in np.transpose(faces):
            np.minimum.at(label, corner, before[faces].min(axis=1))
        label = label[label]
        if np.array_equal(label, before):
            break
    of_face = label[faces[:, 0]]
    return [Body(product.name, product.names, triangles[of_face == one]) for one in np.unique(of_face)]


def _numbered(bodies: list[Body]) -> list[Body]:
    """The bodies, those of one name with a number behind it."""
    many = Counter(body.name for body in bodies)
    seen: Counter[str] = Counter()
    numbered: list[Body] = []
    for body in bodies:
        seen[body.name] += 1
        name = f"{body.name} {seen[body.name]}" if many[body.name] > 1 else body.name
        numbered.append(Body(name, body.names | {name}, body.triangles))
    return numbered
