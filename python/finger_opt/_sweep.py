"""Many fingers at once."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._call import checked, given
from ._run import LOOK, Performer, workers_of
from ._task import Given, sources
from ._words import Engine, FingerModel, RobotName, SpaceName, Start, StrPath

if TYPE_CHECKING:
    import pandas

#: A number or several.
Several = Union[float, Sequence[float], "NDArray[Any]"]
#: Rows that are measured, and written, at a time.
CHUNK = 2000


@checked
def sweep(
    task: Given | Iterable[Given],
    density: Several,
    direction: Several,
    *,
    set: Mapping[str, Several] | None = None,
    grid: bool = True,
    out: StrPath | None = None,
    executor: Executor | Any | None = None,
    workers: int | None = None,
    walk: bool = False,
    space: SpaceName | StrPath = "infill",
    robot: RobotName | StrPath | None = None,
    cell: StrPath | None = None,
    stiffness_data: StrPath | None = None,
    engine: Engine = "direct",
    finger_model: FingerModel | None = None,
    finger: StrPath = "finray9",
    start: Start | None = None,
    threads: int | None = None,
    cache: StrPath | None = None,
    no_cache: bool = False,
) -> pandas.DataFrame:
    """Measures the windows of many fingers in parallel: lists in, a table out with a row for each.

    >>> import finger_opt as fo
    >>> table = fo.sweep("usb", density=[10, 20], direction=[0, 10], no_cache=True)
    >>> list(table["infill_density_percent"])
    [10.0, 10.0, 20.0, 20.0]

    Args:
        task: One, or several: a row for each.
        density: Infill densities, percent: one or several.
        direction: Infill directions, degrees: one or several.
        set: Further numbers by their keys, each one or several.
        grid: All combinations, the last varying fastest; otherwise rows: the first of each, the second of each.
        out: Write the table to this Parquet file as it comes, in place of giving it, so that it may be larger
            than the memory; the columns are the same, and what is given is then empty.
        executor: Any ``concurrent.futures.Executor``: rows are measured there, without the cache.
        workers: Parts at a time; as many as the executor has unless given.
        walk: Step by step to the first failure.
        threads: Threads, which change no result.
        cache: Folder of evaluations shared with studies; ``results/.cache`` unless given.
        no_cache: Measure every finger anew, and keep nothing.

    The rest, and what is raised, is as for :func:`evaluate`. Ctrl-C ends it; with a cache nothing is lost.
    """
    raise NotImplementedError
