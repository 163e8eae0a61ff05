"""Hand-edited CSV tables: lines that begin with ``#`` are comments, and cells do not span lines."""

from __future__ import annotations

import csv
from pathlib import Path

from ._call import misplaced


def rows(path: Path, text: bytes) -> list[list[str]]:
    """Returns the cells of each line that is neither empty nor a comment, the header first.

    Raises :class:`InputError` for an unclosed quotation mark, which would include the following lines in the cell.
    """
    lines = text.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    found: list[list[str]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.startswith("#"):
            continue
        # The second line becomes part of a cell that is still open.
        cells, *below = csv.reader([f"{line}\n", "below"])
        if not below:
            problem = "a quoted cell is not closed at the end of the line; add the quotation mark"
            raise misplaced(path, number, None, problem)
        found.append([cell.strip() for cell in cells])
    return found
