#!/usr/bin/env python3
"""Makes the meshes in examples/meshes/ again, each one closed surface as a CAD program exports it.

Needs `pip install trimesh==5.2.0 manifold3d numpy`. Lengths in mm.
"""

from pathlib import Path

import manifold3d as m
import numpy as np
import trimesh

FOLDER = Path(__file__).parent.parent / "examples" / "meshes"


def box(x, y, z):
    size = [x[1] - x[0], y[1] - y[0], z[1] - z[0]]
    return m.Manifold.cube(size).translate([x[0], y[0], z[0]])


def extruded(outline, z, scale=(1.0, 1.0)):
    section = m.CrossSection([outline])
    return section.extrude(z[1] - z[0], scale_top=scale).translate([0, 0, z[0]])


def write(name, solid):
    mesh = solid.to_mesh()
    points, faces = np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts)
    trimesh.Trimesh(points, faces, process=False).export(FOLDER / name)


def usb():
    """The shipped task's plug and socket."""
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


def keyed(grow):
    """Outline of a keyed plug, 9 x 4 mm with bevelled corners and a rib at +x; x, y."""
    x, y, bevel = 2.0 + grow, 4.5 + grow, 0.8
    rib, out = 0.75 + grow, 0.8
    return [(-x + bevel, -y), (x - bevel, -y), (x, -y + bevel), (x, -rib), (x + out, -rib),
            (x + out, rib), (x, rib), (x, y - bevel), (x - bevel, y), (-x + bevel, y),
            (-x, y - bevel), (-x, -y + bevel)]


def example():
    """A keyed plug with a body, and its socket with a lead-in chamfer 0.4 mm deep."""
    body = box((-4, 4), (-6, 6), (8, 26))
    write("keyed-plug.stl", extruded(keyed(0.0), (0, 8)) + body)
    pocket = extruded(keyed(0.1), (-8.5, 1))
    lead = m.Manifold.hull_points([[x, y, z] for grow, z in ((0.15, -0.4), (0.55, 0.0))
                                   for x in (-2.0 - grow, 2.0 + grow)
                                   for y in (-4.5 - grow, 4.5 + grow)])
    write("keyed-socket.stl", box((-8, 9), (-10, 10), (-11, 0)) - pocket - lead)


FOLDER.mkdir(parents=True, exist_ok=True)
usb()
example()
