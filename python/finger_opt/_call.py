"""What every call has in common: its keywords are checked, and those that were given go on to the library."""

from __future__ import annotations

import difflib
import functools
import inspect
import json
import math
import os
import re
import types
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from decimal import Decimal
from numbers import Integral, Real
from typing import Any, Literal, ParamSpec, TypeGuard, TypeVar, Union, cast, get_args, get_origin, get_type_hints

import numpy as np

from ._json import dumps, is_numpy, is_table, is_tuple, word
from ._native import InputError, call as run
from ._result import Result, plain, suffixed

P = ParamSpec("P")
R = TypeVar("R")
T = TypeVar("T", bound=Result)
#: Options that are pictures to write.
PICTURES = ("svg", "plot")


def checked(call: Callable[P, R]) -> Callable[P, R]:
    """Refuses keywords that there are not, with the one that was meant, and values of a wrong type by name."""
    signature = inspect.signature(call)
    hints: dict[str, Any] = {}

    @functools.wraps(call)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in kwargs:
            if name not in signature.parameters:
                raise TypeError(f"{call.__name__}() got an unexpected keyword argument '{name}'{_meant(name, signature)}")
        try:
            given = signature.bind(*args, **kwargs).arguments
        except TypeError as error:
            raise TypeError(f"{call.__name__}() {error}") from None
        if not hints:
            hints.update(_hints(call))
        for name, value in given.items():
            if name not in ("self", "cls"):
                _check(name, value, hints.get(name, Any))
        try:
            return call(*args, **kwargs)
        except InputError as error:
            _in_python(error, signature)
            raise

    return wrapper


def _in_python(error: InputError, signature: inspect.Signature) -> None:
    """Calls what the text names as the command line does by the parameter that it is."""
    named: list[str] = []

    def parameter(found: re.Match[str]) -> str:
        option = found[1].replace("-", "_")
        name = next((name for name in (option, f"{option}_", f"{option}s") if name in signature.parameters), None)
        named.extend([] if name is None else [name])
        return found[0] if name is None else name

    text = re.sub(r"(?<![\w-])--([a-z][a-z-]*)", parameter, str(error))
    if named:
        error.args = (text,)
        error.key = named[0] if error.key is None or f"{error.key}s" == named[0] else error.key


def without(key: str, reason: str, **others: object) -> None:
    """Refuses the first of these words that is given, which ``key`` goes without."""
    for name, value in others.items():
        if value is not None and value is not False:
            raise wrong(name, f"cannot be given with {key}: {reason}")


def called(command: str, words: Mapping[str, Any], kind: type[T]) -> T:
    """Runs a command of ``optimize`` with these options; gives its result."""
    for name in PICTURES:
        suffixed(words.get(name), ".svg")
    text, picture = run(command, keywords(words))
    found = json.loads(text)
    return kind.from_json(found if is_table(found) else {"text": found}, picture)


def keywords(words: Mapping[str, Any]) -> str:
    """Options for the library, without those that say nothing."""
    return dumps({name: word(value) for name, value in words.items() if value is not None and value is not False})


def given(words: Mapping[str, Any], *without: str) -> dict[str, Any]:
    """The words of a call without these."""
    return {name: value for name, value in words.items() if name not in {"self", "cls", *without}}


def wrong(key: str, problem: str) -> InputError:
    """The error of a wrong value."""
    error = InputError(f"{key}: {problem}")
    error.key = key
    return error


def misplaced(file: str | os.PathLike[str], line: int | None, key: str | None, problem: str) -> InputError:
    """The error of a wrong value in a file."""
    parts = (os.fspath(file), None if line is None else f"line {line}", key, problem)
    error = InputError(": ".join(part for part in parts if part is not None))
    error.file, error.line, error.key = os.fspath(file), line, key
    return error


def shown(value: object) -> str:
    """A value in a message: never long, whatever it is."""
    try:
        text = repr(value)
    except Exception:
        text = f"a {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:57]}..."


def number(value: object) -> float | None:
    """The finite number that a value is, also one of NumPy or a fraction; None if it is none."""
    if is_numpy(value):
        # Of an array with several it is a list.
        value = value.tolist()
    if not isinstance(value, (Real, Decimal)) or isinstance(value, bool):
        return None
    try:
        found = float(value)
    except Exception:
        # Larger than any float, or a number of the caller's making.
        return None
    return found if math.isfinite(found) else None


def _hints(call: Callable[..., Any]) -> dict[str, Any]:
    """The types of its parameters. What it gives may be of a module that is not imported."""

    def parameters() -> None: ...

    parameters.__annotations__ = {name: hint for name, hint in call.__annotations__.items() if name != "return"}
    return get_type_hints(parameters, call.__globals__)


def _meant(name: str, signature: inspect.Signature) -> str:
    names = [one for one in signature.parameters if one not in ("self", "cls")]
    near = difflib.get_close_matches(name, names, 1)
    return f"; did you mean `{near[0]}`?" if near else f"; there are {', '.join(names)}"


def _check(name: str, value: object, hint: Any) -> None:
    if not _fits(value, hint):
        more = "; fo.sweep takes several" if name in ("density", "direction") and _several(value) else ""
        raise TypeError(f"{name}: has to be {' or '.join(_named(hint))}, not {_kind(value)}{more}")
    _check_size(name, value)
    if isinstance(value, (str, os.PathLike)):
        _check_text(name, cast(Any, value), path=hint is not str)
    words = _words(hint)
    if isinstance(value, str) and words and value not in words:
        near = difflib.get_close_matches(value, words, 1)
        meant = f"; did you mean `{near[0]}`?" if near else ""
        known = ", ".join(word for word in words if word != "fake")
        raise wrong(name, f"`{value}` is none of {known}{meant}")


def _check_size(name: str, value: object) -> None:
    """Refuses whole numbers that no float holds, by themselves or among several."""
    if isinstance(value, Integral):
        try:
            float(value)
        except OverflowError:
            raise wrong(name, f"is {shown(value)}; has to be a number of size 1e308 or less") from None
    elif isinstance(value, Mapping):
        for key, one in cast("Mapping[object, object]", value).items():
            _check_size(str(key), one)
    elif isinstance(value, (list, tuple)):
        for one in cast("Sequence[object]", value):
            _check_size(name, one)


def _check_text(name: str, value: str | os.PathLike[Any], path: bool) -> None:
    """Refuses what is no text and, as the name of a file, no path."""
    try:
        text = os.fspath(value)
    except Exception:
        # A path of the caller's making.
        text = b""
    if not isinstance(text, str):
        raise wrong(name, "has to be a path of text, not of bytes")
    if "\0" in text:
        raise wrong(name, "has a NUL character, which no name has")
    if not path and not text.isascii() and any("\ud800" <= letter <= "\udfff" for letter in text):
        raise wrong(name, "has to be text that UTF-8 can hold")


def _kind(value: object) -> str:
    """What it is, in words."""
    return f"{len(value)}" if is_tuple(value) else type(value).__name__


def _words(hint: Any) -> tuple[str, ...]:
    """The words, if nothing but these and ``None`` is right."""
    if get_origin(hint) in (Union, types.UnionType):
        rest = [one for one in get_args(hint) if one is not type(None)]
        return _words(rest[0]) if len(rest) == 1 else ()
    return get_args(hint) if get_origin(hint) is Literal else ()


def _several(value: object) -> TypeGuard[Collection[object]]:
    return isinstance(value, (list, tuple, np.ndarray))


def _fits(value: object, hint: Any) -> bool:
    origin, args = plain(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(_fits(value, one) for one in args)
    if origin is Literal:
        return isinstance(value, str)
    if hint is bool:
        return isinstance(value, (bool, np.bool_))
    if hint in (float, int):
        number = isinstance(value, Real if hint is float else Integral)
        return number and not isinstance(value, (bool, np.bool_))
    if origin is tuple:
        if not _several(value) or getattr(value, "ndim", 1) == 0 or (args[-1] is not Ellipsis and len(value) != len(args)):
            return False
        return all(_fits(one, args[0]) for one in value)
    kind = origin if isinstance(origin, type) else hint
    if hint is Any or not isinstance(kind, type) or getattr(kind, "_is_protocol", False):
        return True
    one = isinstance(value, str) or getattr(value, "ndim", 1) == 0
    return isinstance(value, kind) and not (one and kind in _SEVERAL)


#: What text is not, though it has letters one after the other, nor an array of a single number.
_SEVERAL = (Iterable, Sequence)


def _named(hint: Any) -> list[str]:
    """What is right, in words."""
    origin, args = plain(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return list(dict.fromkeys(name for one in args for name in _named(one)))
    if origin is Literal:
        return [", ".join(repr(word) for word in args)]
    if origin is tuple and args[-1] is not Ellipsis:
        return [f"{len(args)} numbers"]
    known = {float: "a number", int: "a whole number", bool: "True or False", str: "text", os.PathLike: "a path",
             type(None): "None"}
    if origin is not None and origin is not os.PathLike:
        return ["a mapping" if issubclass(origin, Mapping) else "several"]
    return [known.get(origin or hint, getattr(hint, "__name__", str(hint)))]
