"""Tables of CSV that people edit: lines that begin with ``#`` are comments, and each cell ends in its line."""

from __future__ import annotations

import csv
from pathlib import Path

from ._call import misplaced


def rows(path: Path, text: bytes) -> list[list[str]]:
    """Returns the cells of each line that has some, the header first.

    Raises :class:`InputError` for a line with an unclosed quotation mark: what stands below would be a part of it.
    """
    lines = text.decode("utf-8-sig", "replace").replace("\r\n", "\n").replace("\r", "\n").split("\n")
    found: list[list[str]] = []
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.startswith("#"):
            continue
        # A cell that is still open takes in the second line.
        cells, *below = csv.reader([f"{line}\n", "below"])
        if not below:
            problem = "a quoted cell runs over the end of the line; close its quotation mark there"
            raise misplaced(path, number, None, problem)
        found.append([cell.strip() for cell in cells])
    return found
