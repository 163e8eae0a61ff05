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


def _id(point: object) -> int:
    if isinstance(point, Point):
        return point.id
    if isinstance(point, Integral) and not isinstance(point, bool):
        return int(point)
    raise wrong("points", f"{shown(point)} is neither a point that was asked for nor the id of one")


def _value(value: object) -> float | None:
    found = number(value)
    if found is None and value is not None:
        raise wrong("values", f"{shown(value)} is no finite number; give None for a point that failed")
    return found


class Optimizer:
    """Asks for points and is told their values, as ``optimize ask-tell`` does.

    ``space`` gives each parameter its bounds, and its step if it has one:
    ``{"x": (-5, 5), "n": (1, 9, 2)}``; a list of dicts with ``name``, ``low``, ``high`` and
    ``step`` does, too, and the name or path of a space file (``"infill"``). ``optimizer`` is ``gp``, ``cma-es``, ``sobol``, ``grid`` or ``random``.
    The same seed and values give the same points.

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
        #: Best point told so far: ``id``, ``values``, ``value``; ``None`` while there is none.
        self.best: dict[str, Any] | None = None
        #: Why nothing more can be asked, if so.
        self.stop: str | None = None
        self._session = _native.Session()
        self._say(header)

    @checked
    def ask(self, n: int = 1) -> list[Point]:
        """Up to ``n`` new points, no point twice; none once the space is exhausted."""
        asked = self._say({"ask": n})["asked"]
        return [Point(one["id"], one["values"]) for one in asked]

    def tell(
        self, points: Point | int | Iterable[Point | int], values: float | None | Iterable[float | None]
    ) -> None:
        """The values of points (or of their ids), in any order; ``None`` for a failed one."""
        given: Any = points
        numbers: Any = values
        if isinstance(points, (Point, int, Integral)):
            given, numbers = [points], [values]
        for name, several in (("points", given), ("values", numbers)):
            if not isinstance(several, Iterable) or isinstance(several, (str, bytes, Mapping)):
                raise wrong(name, f"is {shown(cast('object', several))}; there have to be as many points as values")
        ids = [_id(point) for point in given]
        told = [_value(value) for value in numbers]
        if len(ids) != len(told):
            raise wrong("values", f"{len(told)} values for {len(ids)} points")
        answer = self._say({"tell": [{"id": i, "value": v} for i, v in zip(ids, told)]})
        self.best, self.stop = answer["best"], answer["stop"]

    def _say(self, line: Mapping[str, Any]) -> dict[str, Any]:
        answer = self._session.answer(dumps(line))
        found: dict[str, Any] = json.loads(answer) if answer is not None else {}
        if "error" in found:
            raise _native.InputError(found["error"])
        return found
