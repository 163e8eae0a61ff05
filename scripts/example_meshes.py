#!/usr/bin/env python3
"""Regenerates the meshes in examples/meshes/, each a single closed surface as exported by a CAD program.

With a folder as argument, writes the test parts for `task import` to that folder instead.
Needs `pip install trimesh==5.2.0 manifold3d numpy`. Lengths in mm.
"""

import random
import sys
from pathlib import Path

import manifold3d as m
import numpy as np
import trimesh

FOLDER = Path(__file__).parent.parent / "examples" / "meshes"


def box(x, y, z):
    """Returns a box with the bounds (low, high) on each axis."""
    size = [x[1] - x[0], y[1] - y[0], z[1] - z[0]]
    return m.Manifold.cube(size).translate([x[0], y[0], z[0]])


def extruded(outline, z, scale=(1.0, 1.0)):
    """Returns a prism with this outline between the heights z (low, high)."""
    section = m.CrossSection([outline])
    return section.extrude(z[1] - z[0], scale_top=scale).translate([0, 0, z[0]])


def write(name, solid, folder=FOLDER, unit=1.0, turn=(0, 0, 0)):
    """Writes an STL file; `unit` is its length unit in mm, `turn` a rotation in degrees."""
    mesh = solid.rotate(turn).scale([1.0 / unit] * 3).to_mesh()
    points, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts)
    trimesh.Trimesh(points, faces, process=False).export(folder / name)


def usb():
    """Writes plug and socket of the shipped task usb."""
    taper = m.Manifold.hull_points(
        [[x, y, z] for x in (-3.8, 3.7) for y, z in
         [(-7.75, 32.2), (7.75, 32.2), (5.38, 36.2), (-5.38, 36.2)]])
    boss = m.Manifold.cylinder(7.4, 3.55, 3.55, 24).translate([0, 0, 43.3])
    plug = sum(
        [box((-3.8, 3.7), (-7.73, 7.77), (12.57, 32.2)), taper,
         box((-3.8, 3.7), (-5.39, 5.39), (36.2, 39.96)),
         box((-3.8, 3.7), (-6.2, 6.2), (39.96, 43.31)), boss],
        box((-2.29, 2.19), (-6.0, 6.0), (0, 12.57)))
    socket = box((-7.96, 7.99), (-8.99, 9.01), (-29, 0)) \
        - box((-3.76, 3.79), (-7.49, 7.51), (-15, 1))
    write("usb-plug.stl", plug)
    write("usb-socket.stl", socket)


def keyed_outline(grow):
    """Returns the outline (x, y) of a keyed plug, 9 x 4 mm with bevelled corners and a rib at +x, offset by `grow`."""
    x, y, bevel = 2.0 + grow, 4.5 + grow, 0.8
    rib, out = 0.75 + grow, 0.8
    return [(-x + bevel, -y), (x - bevel, -y), (x, -y + bevel), (x, -rib), (x + out, -rib),
            (x + out, rib), (x, rib), (x, y - bevel), (x - bevel, y), (-x + bevel, y),
            (-x, y - bevel), (-x, -y + bevel)]


def example():
    """Writes a keyed plug with a body, and its socket with a lead-in chamfer 0.4 mm deep."""
    body = box((-4, 4), (-6, 6), (8, 26))
    write("keyed-plug.stl", extruded(keyed_outline(0.0), (0, 8)) + body)
    pocket = extruded(keyed_outline(0.1), (-8.5, 1))
    lead = m.Manifold.hull_points([[x, y, z] for grow, z in ((0.15, -0.4), (0.55, 0.0))
                                   for x in (-2.0 - grow, 2.0 + grow)
                                   for y in (-4.5 - grow, 4.5 + grow)])
    write("keyed-socket.stl", box((-8, 9), (-10, 10), (-11, 0)) - pocket - lead)


def rectangle(x, y):
    return m.CrossSection.square((x, y), True)


def d_shape():
    """Returns a circle, 9 mm in diameter, with a flat at -x."""
    return m.CrossSection.circle(4.5, 32) - rectangle(4, 20).translate((-5.2, 0))


def peg_with_key():
    """Returns a circle, 8 mm in diameter, with a key 2 mm wide that protrudes by 1 mm at +x."""
    return m.CrossSection.circle(4, 32) + rectangle(2, 2).translate((4, 0))


def oval():
    """Returns an oval, 10 mm long in y, with semicircular ends 4 mm in diameter."""
    return m.CrossSection.batch_hull([m.CrossSection.circle(2, 32).translate((0, y)) for y in (-3, 3)])


def keyed_square():
    return rectangle(7, 7) + rectangle(1.6, 2).translate((3.5, 1.5))


def trapezoid():
    """Returns a D-sub trapezoid: 9 and 8 mm wide in y, 5 mm high in x."""
    return m.CrossSection([[(-2.5, -4.0), (2.5, -4.5), (2.5, 4.5), (-2.5, 4.0)]])


def pair(folder, name, section, clearance, chamfer, depth=8.0, body=(8, 12, 18), flange=0.0, **form):
    """Writes a plug with this section below a body (x, y, z), and its socket with a chamfer."""
    x, y, length = body
    plug = section.extrude(depth) + box((-x / 2, x / 2), (-y / 2, y / 2), (depth, depth + length))
    if flange:
        x, y = x + 4, y + 4
        plug += box((-x / 2, x / 2), (-y / 2, y / 2), (depth, depth + flange))
    # A mitred offset keeps the corners, so the clearance is the same on all sides.
    grown = lambda by: section.offset(by, m.JoinType.Miter, 2.0)
    left, low, right, high = section.bounds()
    block = box((left - 5, right + 5), (low - 5, high + 5), (-depth - 3, 0))
    hole = grown(clearance / 2).extrude(depth + 2).translate([0, 0, -depth - 0.5])
    if chamfer:
        rim = lambda by, z: grown(by).extrude(0.001).translate([0, 0, z])
        hole += m.Manifold.batch_hull([rim(clearance / 2, -chamfer), rim(clearance / 2 + chamfer, 0)])
    write(f"{name}-plug.stl", plug, folder, **form)
    write(f"{name}-socket.stl", block - hole, folder, **form)


def parts(folder):
    """Writes the test parts for the import."""
    pair(folder, "d-shape", d_shape(), 0.1, 0.5, body=(10, 12, 18), flange=1.5)
    pair(folder, "peg-key", peg_with_key(), 0.15, 0.5, body=(12, 12, 18))
    pair(folder, "peg-key-inch", peg_with_key(), 0.15, 0.5, body=(12, 12, 18), unit=25.4, turn=(0, -90, 0))
    pair(folder, "oval", oval(), 0.1, 0.4, body=(8, 14, 18))
    pair(folder, "keyed-square", keyed_square(), 0.15, 0.4, body=(11, 11, 16))
    pair(folder, "d-sub", trapezoid(), 0.12, 0.3, body=(9, 13, 18))
    rng = random.Random(28)
    for number in range(1, 13):
        x, y, depth = rng.uniform(2.5, 9), rng.uniform(5, 14), rng.uniform(5, 12)
        section = [rectangle(x, y), m.CrossSection.circle(y / 2, 32)][number % 4 == 0]
        clearance, chamfer = rng.uniform(0.05, 0.3), rng.choice([0, rng.uniform(0.2, 0.8)])
        width = max(x, y) if number % 4 == 0 else x
        body = (width + rng.uniform(2, 6), y + rng.uniform(2, 6), rng.uniform(12, 22))
        pair(folder, f"random-{number:02}", section, clearance, chamfer, depth, body)


if len(sys.argv) > 1:
    Path(sys.argv[1]).mkdir(parents=True, exist_ok=True)
    parts(Path(sys.argv[1]))
else:
    FOLDER.mkdir(parents=True, exist_ok=True)
    usb()
    example()
