"""Evaluates many fingers in parallel."""

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

#: One or several numbers.
Several = Union[float, Sequence[float], NDArray[Any]]
#: Columns by name.
Columns = dict[str, NDArray[Any]]
#: Number of rows that are measured and written at a time, and largest number in a part for an executor.
CHUNK, PART = 2000, 64
#: Local executors, which get single rows, so that an interruption takes effect soon.
LOCAL = (ProcessPoolExecutor, ThreadPoolExecutor)
#: Largest number of parts per worker that may be ahead of the first unfinished part.
MAX_AHEAD = 16
#: Integer columns; a failure class is 1 to 4, -1 if the simulation diverged, or missing without a failure.
INTEGERS = ("failure_negative", "failure_positive", "trials")
#: First columns of the table; the others follow in alphabetical order.
FIRST = ("task", "infill_density_percent", "infill_direction_deg", "range_mm", "negative_mm", "positive_mm",
         "failure_negative", "failure_positive", "peak_force_n", "slip_mm", "nominal")
#: Designs, as a column for each parameter.
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
    """Evaluates the windows of many fingers in parallel; returns a table with a row for each.

    >>> import finger_opt as fo
    >>> table = fo.sweep("usb", density=[10, 20], direction=[0, 10], no_cache=True)
    >>> list(table["infill_density_percent"])
    [10.0, 10.0, 20.0, 20.0]

    Args:
        task: One or several tasks; a row for each.
        density: One or several infill densities, percent.
        direction: One or several infill directions, degrees.
        set: Further parameters by key, each with one or several numbers.
        grid: Whether to evaluate all combinations, the last parameter varying fastest; otherwise the lists are
            combined element by element.
        out: Parquet file to which rows are written as they arrive, so that they may exceed the memory; the returned
            table then has the same columns, but no rows.
        executor: ``concurrent.futures.Executor`` that evaluates the rows, without the cache.
        workers: Number of parts submitted at a time; by default the number of the executor's workers.
        walk: Whether to step outward to the first failure.
        threads: Number of threads; it does not affect the results.
        cache: Folder of evaluations shared with studies; by default ``results/.cache``.
        no_cache: Whether to evaluate every finger anew and save nothing.

    Other parameters and errors are those of :func:`evaluate`. Ctrl-C interrupts the sweep; evaluations in the cache
    are kept.
    """
    settings = given(locals(), "task", "density", "direction", "set", "grid", "out", "executor", "workers")
    for name in ("density", "direction"):
        if name in (set or {}):
            raise wrong("set", f"{name} is a separate argument; give it there")
    rows = _rows({"density": density, "direction": direction, **(set or {})}, grid)
    # Imported here, so that a missing package is reported before the first evaluation.
    from ._frame import pandas

    frames, tasks = pandas(), listed(task)
    if not tasks:
        raise wrong("task", "is empty; give at least one task")
    if out is not None and not os.path.isdir(os.path.dirname(os.path.abspath(out))):
        raise wrong("out", f"the folder {os.path.dirname(os.path.abspath(out))} does not exist")
    suffixed(out, ".parquet")
    chunks: Iterator[Columns]
    if executor is None:
        sweeps = [_native.Sweep(keywords({"task": sources(name), **settings})) for name in tasks]
        chunks = (chunk for one in sweeps for chunk in _measured(one, rows))
    else:
        if not callable(getattr(executor, "submit", None)):
            raise wrong("executor", f"{type(executor).__name__} has no method submit; give an Executor")
        if workers is not None and workers < 1:
            raise wrong("workers", f"is {workers}; it must be at least 1")
        # Workers may be on other machines, without this cache.
        settings |= {"threads": 1, "cache": None, "no_cache": True}
        requests = [keywords({"task": sources(name), **settings}) for name in tasks]
        chunks = _distributed(executor, workers or workers_of(executor), requests, rows)
    parts = _written(chunks, out) if out is not None else [_frame(chunk) for chunk in chunks]
    table: DataFrame = frames.concat(parts, ignore_index=True)
    return table


def _rows(given: Mapping[str, Several], grid: bool) -> Rows:
    """Returns the designs, a column for each parameter; raises InputError for values that cannot be combined."""
    columns: Columns = {}
    for name, numbers in given.items():
        try:
            values = np.atleast_1d(np.asarray(numbers, dtype=float))
        except (TypeError, ValueError, OverflowError):
            values = np.empty(0)
        if isinstance(numbers, str) or values.ndim != 1 or not len(values) or not np.isfinite(values).all():
            raise wrong(name, "has to be a number or a list of numbers, not empty, all finite")
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
    """Returns the rows with their windows, in order, in chunks."""
    for at in range(0, len(rows["density"]), CHUNK):
        numbers, texts = measuring.measure({name: values[at : at + CHUNK] for name, values in rows.items()}, stop)
        columns: Columns = {name: np.asarray(column, dtype=object) for name, column in texts.items()}
        columns |= {name: np.frombuffer(column, dtype="<f8") for name, column in numbers.items()}
        # The wall time varies between runs.
        yield {name: columns[name] for name in sorted(columns, key=_column_order) if name != "wall_s"}


def _column_order(name: str) -> tuple[int, str]:
    """Returns the sort key of a column: the important columns come first."""
    return (FIRST.index(name) if name in FIRST else len(FIRST), name)


class Part:
    """Callable submitted to an executor; ``stop`` cancels it if it runs in this process."""

    def __init__(self) -> None:
        self.stop = _native.Stop()
        # Dask names its tasks by this attribute.
        self.__name__ = "sweep"

    def __call__(self, request: str, rows: Rows) -> list[Columns]:
        """Evaluates rows with the settings of a request, as JSON."""
        return list(_measured(_native.Sweep(request), rows, self.stop))

    def __reduce__(self) -> tuple[type[Part], tuple[()]]:
        # In another process the copy has its own stop flag.
        return Part, ()


def _distributed(
    executor: Executor | Any, workers: int, requests: Iterable[str], rows: Rows
) -> Iterator[Columns]:
    """Returns the rows with their windows, in order; an executor evaluates up to ``workers`` parts at a time."""
    count = len(rows["density"])
    # At least about four parts per worker.
    size = 1 if isinstance(executor, LOCAL) else max(1, min(PART, -(-count // (4 * workers))))
    parts = [(request, at) for request in requests for at in range(0, count, size)]
    part = Part()
    running: dict[Future[list[Columns]], int] = {}
    ended: dict[int, list[Columns]] = {}
    begun = returned = 0
    try:
        while returned < len(parts):
            # Few at a time, since not every executor can cancel submitted parts.
            while begun < len(parts) and len(running) < workers and begun - returned < MAX_AHEAD * workers:
                request, at = parts[begun]
                columns = {name: values[at : at + size] for name, values in rows.items()}
                running[executor.submit(part, request, columns)] = begun
                begun += 1
            done, _ = wait(running, timeout=LOOK, return_when=FIRST_COMPLETED)
            for future in done:
                ended[running.pop(future)] = future.result()
            while returned in ended:
                yield from ended.pop(returned)
                returned += 1
    except KeyboardInterrupt:
        raise _native.Interrupted("interrupted") from None
    finally:
        part.stop.set()
        for future in running:
            future.cancel()


def _frame(chunk: Columns) -> DataFrame:
    """Converts a chunk to a DataFrame with nullable integers."""
    from ._frame import pandas

    integers = {name: "Int64" for name in INTEGERS if name in chunk}
    frame: DataFrame = pandas().DataFrame(chunk).astype(integers)
    return frame


def _written(chunks: Iterator[Columns], file: StrPath) -> list[DataFrame]:
    """Writes the rows to a Parquet file as they arrive; returns a table of the columns without rows."""
    from ._frame import pyarrow

    arrow, writer = pyarrow(), None
    empty: list[DataFrame] = []
    # Renamed when it is complete.
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
