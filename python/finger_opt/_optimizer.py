"""The optimizers, for anything that can be measured."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Mapping, Sequence
from numbers import Integral
from typing import Any, Literal, TypeGuard, cast

import numpy as np

from . import _native
from ._call import checked, number, shown, wrong
from ._json import dumps, word
from ._words import OptimizerName, SpaceName, StrPath


class Point(dict[str, float]):
    """A point that an optimizer asks for: values by name; ``id`` counts from 0."""

    id: int

    def __init__(self, id: int, values: Mapping[str, float]) -> None:
        super().__init__(values)
        self.id = id


def _by_name(space: object) -> TypeGuard[Mapping[str, Sequence[float]]]:
    return isinstance(space, Mapping)


def _by_parameter(point: object) -> TypeGuard[Mapping[object, object]]:
    return isinstance(point, Mapping)


def _told(point: object, value: float | None) -> dict[str, Any]:
    """The result of a point: one that was asked, its id, or the values of another."""
    if isinstance(point, Point):
        return {"id": point.id, "value": value}
    if isinstance(point, Integral) and not isinstance(point, bool) and int(point) >= 0:
        return {"id": int(point), "value": value}
    if not _by_parameter(point):
        raise wrong("points", f"{shown(point)}; accepted: points that were asked, their ids, or a dict of values by parameter")
    values: dict[str, float] = {}
    for name, one in point.items():
        found = number(one)
        if found is None:
            raise wrong("points", f"`{name}` is {shown(one)}; accepted: a finite number")
        values[str(name)] = found
    return {"values": values, "value": value}


def _value(value: object) -> float | None:
    found = number(value)
    if found is None and value is not None:
        raise wrong("values", f"{shown(value)}; accepted: a finite number, or None for a failed evaluation")
    return found


class Optimizer:
    """Optimizer by ask and tell, as ``optimize ask-tell``.

    ``space`` gives each parameter its bounds, and its step if it has one:
    ``{"x": (-5, 5), "n": (1, 9, 2)}``; a list of dicts with ``name``, ``low``, ``high`` and
    ``step``; or the name or path of a space file (``"infill"``). ``optimizer`` is ``gp``, ``cma-es``, ``sobol``, ``grid`` or ``random``.
    The same seed and values give the same points. An optimizer can be pickled: it is restored by
    repeating its calls.

    >>> optimizer = Optimizer({"x": (-5, 5)}, "gp", seed=1, direction="minimize")
    >>> for _ in range(3):
    ...     points = optimizer.ask(2)
    ...     told = optimizer.tell(points, [point["x"] ** 2 for point in points])
    >>> sorted(optimizer.best)
    ['id', 'value', 'values']
    """

    @checked
    def __init__(
        self,
        space: SpaceName | StrPath | Mapping[str, Sequence[float]] | Iterable[Mapping[str, Any]],
        optimizer: OptimizerName = "gp",
        seed: int = 0,
        *,
        direction: Literal["maximize", "minimize"] = "maximize",
        batch: int | None = None,
    ) -> None:
        if isinstance(space, (str, os.PathLike)):
            parameters = json.loads(_native.space(word(space)))
        elif _by_name(space):
            keys = ("low", "high", "step")
            for name, bounds in space.items():
                known = isinstance(bounds, (Sequence, np.ndarray)) and [number(bound) for bound in bounds]
                if not known or len(known) not in (2, 3) or None in known:
                    raise wrong(str(name), "has to be (low, high) or (low, high, step), each a finite number")
            parameters = [{"name": str(name), **dict(zip(keys, bounds))} for name, bounds in space.items()]
        else:
            several: list[Any] = list(space)
            if not all(isinstance(parameter, Mapping) for parameter in several):
                raise wrong("space", "has to be a mapping of names to bounds, or a list of mappings with name, low, high")
            parameters = [dict(parameter) for parameter in several]
        header = {
            "parameters": parameters,
            "optimizer": optimizer,
            "seed": seed,
            "direction": direction,
            "batch": batch,
        }
        self._start()
        self._say(header)

    def _start(self) -> None:
        #: Best result so far: ``id`` (``None`` for a known result), ``values``, ``value``; ``None`` before the first one.
        self.best: dict[str, Any] | None = None
        #: Why nothing more can be asked, if so.
        self.stop: str | None = None
        self._session = _native.Session()
        self._lines: list[str] = []

    def __getstate__(self) -> list[str]:
        return self._lines

    def __setstate__(self, lines: Iterable[str]) -> None:
        self._start()
        for line in lines:
            self._send(line)

    @checked
    def ask(self, n: int = 1) -> list[Point]:
        """Up to ``n`` new points, no point twice; none once the space is exhausted."""
        asked = self._say({"ask": n})["asked"]
        return [Point(one["id"], one["values"]) for one in asked]

    def tell(
        self,
        points: Point | int | Mapping[str, float] | Iterable[Point | int | Mapping[str, float]],
        values: float | None | Iterable[float | None],
    ) -> None:
        """Adds results, in any order; ``None`` is a failed evaluation.

        ``points`` are points that were asked, or their ids. A dict of values by parameter
        (``{"x": 0.5, "n": 3}``) is a known result of a point that was never asked.
        """
        given: Any = points
        numbers: Any = values
        if isinstance(points, (Mapping, int, Integral)):
            given, numbers = [points], [values]
        for name, several in (("points", given), ("values", numbers)):
            if not isinstance(several, Iterable) or isinstance(several, (str, bytes, Mapping)):
                raise wrong(name, f"is {shown(cast('object', several))}; accepted: as many points as values")
        given, numbers = list(given), [_value(value) for value in numbers]
        told = [_told(point, value) for point, value in zip(given, numbers)]
        if len(given) != len(numbers):
            raise wrong("values", f"{len(numbers)} values for {len(given)} points")
        self._say({"tell": told})

    def _say(self, line: Mapping[str, Any]) -> dict[str, Any]:
        return self._send(dumps(line))

    def _send(self, line: str) -> dict[str, Any]:
        answer = self._session.answer(line)
        self._lines.append(line)
        found: dict[str, Any] = json.loads(answer) if answer is not None else {}
        if "told" in found:
            self.best, self.stop = found["best"], found["stop"]
        return found
