"""Studies: seeded runs of one optimizer on one task and space, in a folder."""

from __future__ import annotations

import io
import json
import os
from collections.abc import Iterable
from concurrent.futures import Executor
from typing import TYPE_CHECKING, Any

from . import _native
from ._measure import Record
from ._run import run_open
from ._task import Given, Task, sources

if TYPE_CHECKING:
    import pandas

#: Words that say how a study is run, not what it measures.
SESSION = (
    "threads", "cache", "no_cache", "no_confirm", "no_levers", "no_map", "accept_changed",
    "simulations", "samples",
)


class Study:
    """A study in a folder. Make one with :meth:`create`, open one with :func:`load_study`."""

    def __init__(self, asked: _native.Asked) -> None:
        #: The folder.
        self.path = os.fspath(asked.folder())
        self._asked = asked

    @classmethod
    def create(
        cls,
        task: Given | Iterable[Given],
        *,
        budget: int | None = None,
        seed: int = 0,
        out: str | os.PathLike[str] | None = None,
        **settings: Any,
    ) -> Study:
        """A study of this task (or several), which :meth:`run` begins or continues.

        Without ``budget`` it ends once no design is expected to gain 0.3 mm, after 500 evaluations
        at most (other optimizers than ``gp`` and other objectives than ranges: after 200).
        ``settings`` are the words of ``optimize``: ``optimizer="cma-es"``,
        ``space="codesign"``, ``objective=["range", "peak-force"]``,
        ``constraint="peak-force<=110"``, ``batch=8``, ``async_=True``, ``threads=2`` and so on.
        They are checked here; the folder (``out``, else ``results/<task>-<optimizer>-seed<seed>``)
        is made by :meth:`run`, which knows the number of workers.
        """
        if "executor" in settings:
            raise _native.InputError("executor: is given to run()")
        settings = {"budget": budget, "seed": seed, "out": out, **settings}
        return cls(_native.study(sources(task), **settings))

    def run(
        self,
        executor: Executor | Any | None = None,
        progress: bool = True,
        *,
        workers: int | None = None,
        retries: int = 10,
    ) -> Study:
        """Runs the study until its budget is spent, and writes its report.

        ``executor`` is any ``concurrent.futures.Executor`` (or what has its ``submit``); the
        designs are measured there, ``workers`` at a time (default: as many as it has), and the
        journal is the same as with any other, or none, for the same batch. Without one they are
        measured on the threads of this process.
        ``batch`` is the number of workers unless it was given. A measurement that a worker lost
        or whose result is refused is done again, up to ``retries`` times.
        Ctrl-C stops it; what was measured is safe, and ``run`` again goes on.
        """
        _, unusable = run_open(self._open, executor, progress, workers, retries)
        if unusable is not None:
            raise _native.RunError(unusable)
        return self

    def _open(self, workers: int | None) -> Any:
        return self._asked.open(workers)

    def _begun(self) -> bool:
        return os.path.exists(os.path.join(self.path, "study.toml"))

    def _read(self) -> _native.Recorded:
        return _native.Recorded(self.path)

    @property
    def config(self) -> Record:
        """What was asked for, as ``study.toml`` keeps it."""
        return Record(json.loads(self._read().config()))

    @property
    def best(self) -> Record | None:
        """The recommended design, as ``recommended`` of ``--json``: ``values`` by key,
        ``evaluation`` (its number), ``range_mm``, ``negative_mm``, ``positive_mm``; ``None``
        while there is none. Of several objectives the first of the front."""
        found = json.loads(self._read().best()) if self._begun() else None
        return None if found is None else Record(found)

    @property
    def answer(self) -> Record | None:
        """What to do, as ``answer`` of ``--json``: ``headline``, ``expectation``, ``finger`` (its
        values), ``trust``, ``start``, ``as_good``, ``next``; ``None`` before it has begun."""
        return Record(json.loads(self._read().answer())) if self._begun() else None

    @property
    def settled(self) -> bool:
        """Whether the search has ended because no design is expected to gain
        ``indifference_mm`` (0.3)."""
        return self._begun() and self._read().settled()

    def to_dataframe(self) -> pandas.DataFrame:
        """A row for each evaluation; the columns of ``evaluations.csv``, with their units."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe needs pandas: pip install 'finger-opt[pandas]'") from None
        return pandas.read_csv(io.StringIO(self._read().table()))

    def __len__(self) -> int:
        """Evaluations in the journal."""
        return self._read().length() if self._begun() else 0

    def __bool__(self) -> bool:
        return True

    def _repr_html_(self) -> str:
        if not self._begun():
            return f"<p>a study not begun yet: {self.path}</p>"
        return self._read().card()

    def __repr__(self) -> str:
        return f"<Study {self.path}>"


def load_study(folder: str | os.PathLike[str], **session: Any) -> Study:
    """The study in a folder; its :meth:`~Study.run` continues it.

    ``session`` says how: ``threads``, ``cache``, ``no_cache``, ``no_confirm``, ``no_levers``, ``no_map``,
    ``accept_changed``, and for a study with measurements ``simulations`` and ``samples``.
    """
    unknown = [name for name in session if name not in SESSION]
    if unknown:
        raise _native.InputError(f"{unknown[0]}: a study that is loaded takes {', '.join(SESSION)}")
    _native.Recorded(os.fspath(folder))
    return Study(_native.resume(folder, **session))
