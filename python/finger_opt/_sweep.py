"""Many fingers at once."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._call import checked, given, keywords, wrong
from ._result import suffixed
from ._run import LOOK, workers_of
from ._task import Given, listed, sources
from ._words import Engine, FingerModel, RobotName, SpaceName, Start, StrPath

if TYPE_CHECKING:
    from pandas import DataFrame

#: A number or several.
Several = Union[float, Sequence[float], NDArray[Any]]
#: Columns by name.
Columns = dict[str, NDArray[Any]]
#: Rows that are measured, and written, at a time; those of one piece of work for workers elsewhere.
CHUNK, PART = 2000, 64
#: Executors of this machine: they get row by row, so that there is little to wait for when it is interrupted.
LOCAL = (ProcessPoolExecutor, ThreadPoolExecutor)
#: Pieces of work of each worker that may have ended before an earlier one.
AHEAD = 16
#: What is counted, so no fraction: a class of 1 to 4, -1 for a simulation that diverged, none where none is met.
COUNTED = ("failure_negative", "failure_positive", "trials")
#: The first columns; the rest follows by name.
FIRST = ("task", "infill_density_percent", "infill_direction_deg", "range_mm", "negative_mm", "positive_mm",
         "failure_negative", "failure_positive", "peak_force_n", "slip_mm", "nominal")
#: Designs: a column for each number.
Rows = dict[str, list[float]]


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
) -> DataFrame:
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
    words = given(locals(), "task", "density", "direction", "set", "grid", "out", "executor", "workers")
    for name in ("density", "direction"):
        if name in (set or {}):
            raise wrong("set", f"{name} has a parameter of its own")
    rows = _rows({"density": density, "direction": direction, **(set or {})}, grid)
    # What is missing is said before anything is measured.
    from ._frame import pandas

    frames, tasks = pandas(), listed(task)
    if not tasks:
        raise wrong("task", "has to name one at least")
    if out is not None and not os.path.isdir(os.path.dirname(os.path.abspath(out))):
        raise wrong("out", f"there is no folder {os.path.dirname(os.path.abspath(out))}")
    suffixed(out, ".parquet")
    chunks: Iterator[Columns]
    if executor is None:
        measuring = [_native.Sweep(keywords({"task": sources(one), **words})) for one in tasks]
        chunks = (chunk for one in measuring for chunk in _measured(one, rows))
    else:
        if not callable(getattr(executor, "submit", None)):
            raise wrong("executor", f"has to have a method submit, which {type(executor).__name__} has not")
        if workers is not None and workers < 1:
            raise wrong("workers", f"is {workers}; has to be at least 1")
        # The cache is of this machine.
        alone = [{"task": sources(one), **words, "threads": 1, "cache": None, "no_cache": True} for one in tasks]
        chunks = _handed_out(executor, workers or workers_of(executor), [keywords(one) for one in alone], rows)
    found = _written(chunks, out) if out is not None else [_frame(chunk) for chunk in chunks]
    table: DataFrame = frames.concat(found, ignore_index=True)
    return table


def _rows(given: Mapping[str, Several], grid: bool) -> Rows:
    """The designs, a column for each number."""
    columns: Columns = {}
    for name, several in given.items():
        try:
            values = np.atleast_1d(np.asarray(several, dtype=float))
        except (TypeError, ValueError, OverflowError):
            values = np.empty(0)
        if isinstance(several, str) or values.ndim != 1 or not len(values) or not np.isfinite(values).all():
            raise wrong(name, "has to be a number or a list of numbers, all finite, at least one")
        columns[name] = values
    if grid:
        meshed = np.meshgrid(*columns.values(), indexing="ij")
        return {name: values.ravel().tolist() for name, values in zip(columns, meshed, strict=True)}
    length = max(len(values) for values in columns.values())
    for name, values in columns.items():
        if len(values) not in (1, length):
            raise wrong(name, f"has {len(values)} values where others have {length}; give one or all")
    return {name: np.broadcast_to(values, length).tolist() for name, values in columns.items()}


def _measured(measuring: _native.Sweep, rows: Rows, stop: _native.Stop | None = None) -> Iterator[Columns]:
    """The rows with their windows, in their order."""
    for at in range(0, len(rows["density"]), CHUNK):
        numbers, texts = measuring.measure({name: values[at : at + CHUNK] for name, values in rows.items()}, stop)
        found: Columns = {name: np.asarray(column, dtype=object) for name, column in texts.items()}
        found |= {name: np.frombuffer(column, dtype="<f8") for name, column in numbers.items()}
        # The clock is no result.
        yield {name: found[name] for name in sorted(found, key=_place) if name != "wall_s"}


def _place(name: str) -> tuple[int, str]:
    """What a reader looks for stands first."""
    return (FIRST.index(name) if name in FIRST else len(FIRST), name)


class Part:
    """The unit of work of an executor, which the end of the sweep ends in this process, too."""

    def __init__(self) -> None:
        self.stop = _native.Stop()
        # Dask names tasks by it.
        self.__name__ = "sweep"

    def __call__(self, words: str, rows: Rows) -> list[Columns]:
        return list(_measured(_native.Sweep(words), rows, self.stop))

    def __reduce__(self) -> tuple[type[Part], tuple[()]]:
        # Another process knows nothing of the sweep.
        return Part, ()


def _handed_out(
    executor: Executor | Any, workers: int, tasks: Iterable[str], rows: Rows
) -> Iterator[Columns]:
    """The same, measured elsewhere; no more pieces of work are out than there are workers."""
    count = len(rows["density"])
    # So that every worker has some.
    size = 1 if isinstance(executor, LOCAL) else max(1, min(PART, -(-count // (4 * workers))))
    parts = [(task, at) for task in tasks for at in range(0, count, size)]
    part = Part()
    running: dict[Future[list[Columns]], int] = {}
    ended: dict[int, list[Columns]] = {}
    begun = given = 0
    try:
        while given < len(parts):
            # What is out cannot be taken back from every executor.
            while begun < len(parts) and len(running) < workers and begun - given < AHEAD * workers:
                task, at = parts[begun]
                columns = {name: values[at : at + size] for name, values in rows.items()}
                running[executor.submit(part, task, columns)] = begun
                begun += 1
            done, _ = wait(running, timeout=LOOK, return_when=FIRST_COMPLETED)
            for future in done:
                ended[running.pop(future)] = future.result()
            while given in ended:
                yield from ended.pop(given)
                given += 1
    except KeyboardInterrupt:
        raise _native.Interrupted("interrupted") from None
    finally:
        part.stop.set()
        for future in running:
            future.cancel()


def _frame(chunk: Columns) -> DataFrame:
    from ._frame import pandas

    counted = {name: "Int64" for name in COUNTED if name in chunk}
    frame: DataFrame = pandas().DataFrame(chunk).astype(counted)
    return frame


def _written(chunks: Iterator[Columns], file: StrPath) -> list[DataFrame]:
    """Writes the rows as they come; gives the columns without rows."""
    from ._frame import pyarrow

    arrow, writer = pyarrow(), None
    empty: list[DataFrame] = []
    # Under its name once it is whole.
    partial = f"{os.fspath(file)}.part"
    try:
        for chunk in chunks:
            table = arrow.Table.from_pandas(_frame(chunk), preserve_index=False)
            if writer is None:
                writer = arrow.parquet.ParquetWriter(partial, table.schema)
                empty = [_frame(chunk).iloc[:0]]
            writer.write_table(table)
    finally:
        if writer is not None:
            writer.close()
    os.replace(partial, file)
    return empty
