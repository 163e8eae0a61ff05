"""STEP files for tests: bodies of flat triangles, as parts of an assembly where they are placed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

#: Products, contexts and units of a file; what stands in braces is filled in.
HEADER = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','',(''),(''),'','','');
FILE_SCHEMA(('{schema}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('');
#2=PRODUCT_CONTEXT('',#1,'mechanical');
#3=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#4=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#5=LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#4);
#6=(CONVERSION_BASED_UNIT('INCH',#5)LENGTH_UNIT()NAMED_UNIT(#7));
#7=DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#8=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#9=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#10=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#{unit},#8,#9))REPRESENTATION_CONTEXT('',''));
#11=CARTESIAN_POINT('',(0.,0.,0.));
#12=DIRECTION('',(0.,0.,1.));
#13=DIRECTION('',(1.,0.,0.));
#14=AXIS2_PLACEMENT_3D('',#11,#12,#13);
"""
SCHEMAS = {
    "AP214": "AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }",
    "AP242": "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
}
MM_PER_UNIT = {"mm": 1.0, "in": 25.4}


def stl(path: Path) -> np.ndarray:
    """Triangles of a binary STL, shape (n, 3, 3)."""
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    return np.frombuffer(path.read_bytes()[84:], record)["corners"].astype(float)


class _Lines:
    def __init__(self, unit: str) -> None:
        self.lines: list[str] = []
        self.unit = unit

    def add(self, text: str) -> str:
        self.lines.append(f"#{20 + len(self.lines)}={text};")
        return f"#{19 + len(self.lines)}"

    def triple(self, kind: str, values: Sequence[float]) -> str:
        return self.add(f"{kind}('',({','.join(f'{float(value):.9E}' for value in values)}))")

    def product(self, name: str) -> str:
        product = self.add(f"PRODUCT('{name}','{name}','',(#2))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        return self.add(f"PRODUCT_DEFINITION('','',{formation},#3)")

    def shaped(self, definition: str, kind: str, items: list[str]) -> str:
        shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        representation = self.add(f"{kind}('',({','.join(items)}),#10)")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({shape},{representation})")
        return representation

    def solid(self, triangles: np.ndarray) -> str:
        points, corners = np.unique(triangles.reshape(-1, 3), axis=0, return_inverse=True)
        names = [self.triple("CARTESIAN_POINT", point / MM_PER_UNIT[self.unit]) for point in points]
        faces = []
        for face in corners.reshape(-1, 3):
            first, second, third = points[face]
            along = (second - first) / np.linalg.norm(second - first)
            normal = np.cross(along, third - first)
            axes = [self.triple("DIRECTION", one) for one in (normal / np.linalg.norm(normal), along)]
            place = self.add(f"AXIS2_PLACEMENT_3D('',{names[face[0]]},{axes[0]},{axes[1]})")
            plane = self.add(f"PLANE('',{place})")
            loop = self.add(f"POLY_LOOP('',({','.join(names[corner] for corner in face)}))")
            bound = self.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
            faces.append(self.add(f"FACE_SURFACE('',({bound}),{plane},.T.)"))
        shell = self.add(f"CLOSED_SHELL('',({','.join(faces)}))")
        return self.add(f"FACETED_BREP('',{shell})")


def write(
    path: Path,
    parts: dict[str, tuple[np.ndarray, Sequence[float]]],
    unit: str = "mm",
    schema: str = "AP214",
) -> Path:
    """Writes an assembly of parts: their triangles, mm, and where each is placed, mm."""
    lines = _Lines(unit)
    assembly = lines.product("assembly")
    whole = lines.shaped(assembly, "SHAPE_REPRESENTATION", ["#14"])
    for name, (triangles, place) in parts.items():
        part = lines.product(name)
        own = lines.shaped(part, "FACETED_BREP_SHAPE_REPRESENTATION", ["#14", lines.solid(triangles)])
        point = lines.triple("CARTESIAN_POINT", np.asarray(place) / MM_PER_UNIT[unit])
        axes = lines.add(f"AXIS2_PLACEMENT_3D('',{point},#12,#13)")
        use = lines.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('1','NAUO1','',{assembly},{part},$)")
        moved = lines.add(f"ITEM_DEFINED_TRANSFORMATION('','',#14,{axes})")
        related = lines.add(
            f"(REPRESENTATION_RELATIONSHIP('','',{own},{whole})"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({moved})SHAPE_REPRESENTATION_RELATIONSHIP())"
        )
        shape = lines.add(f"PRODUCT_DEFINITION_SHAPE('','',{use})")
        lines.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({related},{shape})")
    header = HEADER.format(schema=SCHEMAS[schema], unit=4 if unit == "mm" else 6)
    path.write_text(header + "\n".join(lines.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n")
    return path
