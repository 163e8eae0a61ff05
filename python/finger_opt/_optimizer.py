"""Ask-and-tell interface to the optimizers, for any problem."""

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
    """Point proposed by an optimizer: values by name; ``id`` counts from 0."""

    id: int

    def __init__(self, id: int, values: Mapping[str, float]) -> None:
        super().__init__(values)
        self.id = id


def _by_name(space: object) -> TypeGuard[Mapping[str, Sequence[float]]]:
    return isinstance(space, Mapping)


def _by_parameter(point: object) -> TypeGuard[Mapping[object, object]]:
    return isinstance(point, Mapping)


def _result(point: object, value: float | None) -> dict[str, Any]:
    """Returns a result as JSON fields, by the id of the point, or by its values if they are given.

    Raises :class:`InputError` for an invalid point.
    """
    if isinstance(point, Point):
        return {"id": point.id, "value": value}
    if isinstance(point, Integral) and not isinstance(point, bool) and int(point) >= 0:
        return {"id": int(point), "value": value}
    if not _by_parameter(point):
        raise wrong("points", f"{shown(point)}; accepted: points from ask, their ids, or a dict of values by parameter")
    values: dict[str, float] = {}
    for name, one in point.items():
        found = number(one)
        if found is None:
            raise wrong("points", f"`{name}` is {shown(one)}; accepted: a finite number")
        values[str(name)] = found
    return {"values": values, "value": value}


def _value(value: object) -> float | None:
    """Returns the value of a result as float; raises :class:`InputError` if it is neither finite nor None."""
    found = number(value)
    if found is None and value is not None:
        raise wrong("values", f"{shown(value)}; accepted: a finite number, or None for a failed evaluation")
    return found


class Optimizer:
    """Optimizer with ask and tell, as ``optimize ask-tell``.

    ``space`` is a dict of bounds and optional step by parameter, ``{"x": (-5, 5), "n": (1, 9, 2)}``; a list of dicts
    with ``name``, ``low``, ``high`` and ``step``; or the name or path of a space file (``"infill"``). ``optimizer`` is
    ``gp``, ``cma-es``, ``sobol``, ``grid`` or ``random``. ``batch`` is the number of points per batch. The same seed
    and values give the same points. A pickled optimizer is restored by repeating its calls.

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
                problem = "has to be a mapping of names to bounds, or a list of mappings with name, low, high"
                raise wrong("space", problem)
            parameters = [dict(parameter) for parameter in several]
        header = {
            "parameters": parameters,
            "optimizer": optimizer,
            "seed": seed,
            "direction": direction,
            "batch": batch,
        }
        self._reset()
        self._request(header)

    def _reset(self) -> None:
        #: Best result so far: ``id`` (``None`` for a known result), ``values``, ``value``; ``None`` without results.
        self.best: dict[str, Any] | None = None
        #: Reason why ``ask`` returns no more points; ``None`` as long as it does.
        self.stop: str | None = None
        self._session = _native.Session()
        self._lines: list[str] = []

    def __getstate__(self) -> list[str]:
        return self._lines

    def __setstate__(self, lines: Iterable[str]) -> None:
        self._reset()
        for line in lines:
            self._send(line)

    @checked
    def ask(self, n: int = 1) -> list[Point]:
        """Returns up to ``n`` new points, never the same twice; an empty list once the space is exhausted."""
        asked = self._request({"ask": n})["asked"]
        return [Point(one["id"], one["values"]) for one in asked]

    def tell(
        self,
        points: Point | int | Mapping[str, float] | Iterable[Point | int | Mapping[str, float]],
        values: float | None | Iterable[float | None],
    ) -> None:
        """Adds results, in any order; ``None`` is a failed evaluation.

        ``points`` are points from :meth:`ask`, or their ids. A dict of values by parameter
        (``{"x": 0.5, "n": 3}``) adds a known result of any other point.

        Raises :class:`InputError` for invalid points or values.
        """
        given: Any = points
        numbers: Any = values
        if isinstance(points, (Mapping, int, Integral)):
            given, numbers = [points], [values]
        for name, several in (("points", given), ("values", numbers)):
            if not isinstance(several, Iterable) or isinstance(several, (str, bytes, Mapping)):
                raise wrong(name, f"is {shown(cast('object', several))}; accepted: as many points as values")
        given, numbers = list(given), [_value(value) for value in numbers]
        told = [_result(point, value) for point, value in zip(given, numbers)]
        if len(given) != len(numbers):
            raise wrong("values", f"{len(numbers)} values for {len(given)} points")
        self._request({"tell": told})

    def _request(self, line: Mapping[str, Any]) -> dict[str, Any]:
        return self._send(dumps(line))

    def _send(self, line: str) -> dict[str, Any]:
        answer = self._session.answer(line)
        self._lines.append(line)
        found: dict[str, Any] = json.loads(answer) if answer is not None else {}
        if "told" in found:
            self.best, self.stop = found["best"], found["stop"]
        return found
