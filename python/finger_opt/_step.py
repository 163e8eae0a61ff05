"""Reads STEP files as triangle meshes through Open Cascade (the extra ``step``)."""

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

#: Command that installs the reader.
INSTALL = "pip install cascadio"
#: Largest angle between neighbouring facets, rad. It limits the facets only at radii below 0.13 mm, of which a
#: connector has many; elsewhere the tolerance is stricter.
ANGLE_RAD = 0.8
#: Number of triangles above which a product is meshed more coarsely; bodies with more are reduced after reading.
MAX_TRIANGLES = 60_000
#: Factors on the tolerance, tried in this order.
TOLERANCE_FACTORS = (1, 3, 9)
#: Time limit for reading and meshing a file, s.
LIMIT_S = 60.0
#: Largest file, bytes.
MAX_FILE_BYTES = 200 << 20
#: Largest number of bodies listed in a message.
MAX_LISTED = 12
#: Program that meshes a file in a separate process, so that a crash or timeout of Open Cascade is contained.
READER = """
import pathlib, sys, cascadio
given, glb, tolerance, angle = sys.argv[1:]
data = cascadio.load(pathlib.Path(given).read_bytes(), tol_linear=float(tolerance), tol_angular=float(angle))
pathlib.Path(glb).write_bytes(data)
"""
#: Generated names: labels of references, and numbers of occurrences in assemblies.
GENERATED = re.compile(r"=>\[|NAUO\d+$")


@dataclass(frozen=True)
class Body:
    """Body of a STEP file, in the coordinates of the whole file."""

    #: Unique name within the file.
    name: str
    #: Names that refer to the body: its own, and those of its product and the assemblies that contain it.
    names: frozenset[str]
    #: Corners of the triangles, mm, shape (n, 3, 3), counter-clockwise from outside.
    triangles: Floats


def is_step(path: str | os.PathLike[str]) -> bool:
    """Returns whether a file is STEP, by its name or its content."""
    if Path(path).suffix.lower() in (".step", ".stp"):
        return True
    try:
        with open(path, "rb") as file:
            return b"ISO-10303-21" in file.read(1024)
    except OSError:
        return False


def read(path: str | os.PathLike[str], tolerance_mm: float) -> list[Body]:
    """Returns the bodies of a STEP file, meshed within ``tolerance_mm`` and converted to mm.

    A product with more than ``MAX_TRIANGLES``, for example a thread, is meshed more coarsely, with a warning.
    Raises InputError for a file that cannot be read or meshed.
    """
    deadline = time.monotonic() + LIMIT_S
    products: dict[int, Body] = {}
    for scale in TOLERANCE_FACTORS:
        last = scale == TOLERANCE_FACTORS[-1]
        left = deadline - time.monotonic()
        glb = _mesh(path, scale * tolerance_mm, left if last else left / 2)
        if glb is None:
            continue
        meshed = _products(glb)
        for place, product in enumerate(meshed):
            count = len(product.triangles)
            if place in products or (count > MAX_TRIANGLES and not last):
                continue
            products[place] = product
            if scale > 1:
                warnings.warn(
                    f"{path}: `{product.name}` is meshed within {scale * tolerance_mm:g} mm only ({count} triangles), "
                    "since it has too many details; remove threads, knurls and text from the model",
                    stacklevel=3,
                )
        if len(products) == len(meshed):
            break
    else:
        raise InputError(
            f"{path}: meshing took longer than {LIMIT_S:g} s; remove threads, knurls and text from the model, or "
            "export STL"
        )
    bodies = [piece for place in sorted(products) for piece in _pieces(products[place])]
    if not bodies:
        raise InputError(f"{path}: contains no solid; export the bodies as solids, not as curves")
    return _numbered(bodies)


def listed(bodies: list[Body]) -> str:
    """Returns names and sizes of bodies, mm, for messages."""
    sizes = [np.ptp(body.triangles.reshape(-1, 3), axis=0) for body in bodies[:MAX_LISTED]]
    named = [
        f"`{body.name}` ({' x '.join(f'{side:.1f}' for side in size)} mm)" for body, size in zip(bodies, sizes)
    ]
    more = len(bodies) - len(named)
    return ", ".join(named) + (f" and {more} more" if more else "")


def obj(bodies: list[Body]) -> str:
    """Returns bodies as OBJ text in mm, with a named object for each body."""
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
    """Writes bodies as OBJ; returns the path."""
    path.write_text(obj(bodies), encoding="utf-8")
    return path


def _mesh(path: str | os.PathLike[str], tolerance_mm: float, limit_s: float) -> bytes | None:
    """Returns a STEP file as GLB, meshed in a separate process; None after ``limit_s`` seconds."""
    try:
        if os.path.getsize(path) > MAX_FILE_BYTES:
            raise InputError(f"{path}: is larger than {MAX_FILE_BYTES >> 20} MiB")
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
    output = done.stderr + done.stdout
    if "No module named 'cascadio'" in output:
        raise ImportError(f"{path} is a STEP file, which needs Open Cascade: {INSTALL}", name="cascadio")
    last = output.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
    syntax = re.search(r"Line \d+: [^*\n]*", output)
    why = syntax.group().strip() if syntax else last[0]
    raise InputError(f"{path}: is not a whole STEP file that Open Cascade can read: {plain(why)}")


def plain(text: str) -> str:
    """Removes terminal control sequences and unprintable characters from the output of another program."""
    text = re.sub(r"\x1b\[[0-9;?]*[ -/]*[@-~]", "", text)
    return "".join(letter if letter.isprintable() else " " for letter in text).strip()


def _products(glb: bytes) -> list[Body]:
    """Returns the products with a mesh in a GLB, each in the coordinates of the whole file, mm."""
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
        for primitive in mesh.get("primitives", []):
            # Mode 4 is triangles; curves have other modes.
            if primitive.get("mode", 4) == 4:
                points = numbers(scene["accessors"][primitive["attributes"]["POSITION"]]).reshape(-1, 3)
                corners.append(points[numbers(scene["accessors"][primitive["indices"]])].astype(float))
        return np.concatenate(corners)

    products: list[Body] = []

    def visit(node: dict[str, Any], above: list[str], place: Floats) -> None:
        if node.keys() & {"translation", "rotation", "scale"}:
            raise InputError("this version of cascadio places parts in an unsupported way: pip install cascadio==0.1.1")
        own_place: Floats = np.reshape(node.get("matrix", np.eye(4)), (4, 4), order="F")
        place = place @ own_place
        mesh: dict[str, Any] = scene["meshes"][node["mesh"]] if "mesh" in node else {}
        own: list[str] = [name for name in (mesh.get("name"), node.get("name")) if name and not GENERATED.match(name)]
        names = [*above, *own]
        if mesh:
            # GLB is in m.
            placed = 1e3 * (triangles(mesh) @ np.transpose(place[:3, :3]) + place[:3, 3])
            products.append(Body(own[-1] if own else "body", frozenset(names), placed.reshape(-1, 3, 3)))
        for child in node.get("children", []):
            visit(scene["nodes"][child], names, place)

    for root in scene["scenes"][scene.get("scene", 0)].get("nodes", []):
        visit(scene["nodes"][root], [], np.eye(4))
    return products


def _pieces(product: Body) -> list[Body]:
    """Splits a product into its connected bodies, which share no corner."""
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
    return [Body(product.name, product.names, triangles[of_face == body]) for body in np.unique(of_face)]


def _numbered(bodies: list[Body]) -> list[Body]:
    """Returns the bodies with unique names: a number is appended to repeated names."""
    counts = Counter(body.name for body in bodies)
    seen: Counter[str] = Counter()
    numbered: list[Body] = []
    for body in bodies:
        seen[body.name] += 1
        name = f"{body.name} {seen[body.name]}" if counts[body.name] > 1 else body.name
        numbered.append(Body(name, body.names | {name}, body.triangles))
    return numbered
