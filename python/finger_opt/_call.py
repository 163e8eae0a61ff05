"""Checks of arguments, and calls of the commands in the library."""

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
#: Options that name a picture file to write.
PICTURES = ("svg", "plot")


def checked(call: Callable[P, R]) -> Callable[P, R]:
    """Wraps a function to check its arguments: TypeError for wrong keywords and types, InputError for wrong values."""
    signature = inspect.signature(call)
    hints: dict[str, Any] = {}

    @functools.wraps(call)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        for name in kwargs:
            if name not in signature.parameters:
                suggestion = _suggestion(name, signature)
                raise TypeError(f"{call.__name__}() got an unexpected keyword argument '{name}'{suggestion}")
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
            _rename_options(error, signature)
            raise

    return wrapper


def _rename_options(error: InputError, signature: inspect.Signature) -> None:
    """Replaces options of the command line in the text of an error by the names of the parameters."""
    renamed: list[str] = []

    def parameter(match: re.Match[str]) -> str:
        option = match[1].replace("-", "_")
        name = next((name for name in (option, f"{option}_", f"{option}s") if name in signature.parameters), None)
        renamed.extend([] if name is None else [name])
        return match[0] if name is None else name

    text = re.sub(r"(?<![\w-])--([a-z][a-z-]*)", parameter, str(error))
    if renamed:
        error.args = (text,)
        error.key = renamed[0] if error.key is None or f"{error.key}s" == renamed[0] else error.key


def without(key: str, reason: str, **others: object) -> None:
    """Raises InputError for the first of these arguments that is set, since ``key`` excludes them."""
    for name, value in others.items():
        if value is not None and value is not False:
            raise wrong(name, f"cannot be given with {key}: {reason}")


def called(command: str, words: Mapping[str, Any], kind: type[T]) -> T:
    """Runs a command of ``optimize`` with these options; returns its result."""
    for name in PICTURES:
        suffixed(words.get(name), ".svg")
    text, picture = run(command, keywords(words))
    output = json.loads(text)
    return kind.from_json(output if is_table(output) else {"text": output}, picture)


def keywords(words: Mapping[str, Any]) -> str:
    """Returns the options as JSON for the library, without those that are None or False."""
    return dumps({name: word(value) for name, value in words.items() if value is not None and value is not False})


def given(words: Mapping[str, Any], *without: str) -> dict[str, Any]:
    """Returns the arguments of a call, its ``locals()``, without these."""
    return {name: value for name, value in words.items() if name not in {"self", "cls", *without}}


def wrong(key: str, problem: str) -> InputError:
    """Returns the error of a wrong value."""
    error = InputError(f"{key}: {problem}")
    error.key = key
    return error


def misplaced(file: str | os.PathLike[str], line: int | None, key: str | None, problem: str) -> InputError:
    """Returns the error of a wrong value in a file."""
    parts = (os.fspath(file), None if line is None else f"line {line}", key, problem)
    error = InputError(": ".join(part for part in parts if part is not None))
    error.file, error.line, error.key = os.fspath(file), line, key
    return error


def shown(value: object) -> str:
    """Returns a value as text for a message, at most 60 characters of its repr."""
    try:
        text = repr(value)
    except Exception:
        text = f"a {type(value).__name__}"
    return text if len(text) <= 60 else f"{text[:57]}..."


def number(value: object) -> float | None:
    """Converts a number of any type (NumPy, Decimal, Fraction) to a float; None if it is not a finite number."""
    if is_numpy(value):
        # An array with several elements becomes a list, which is rejected below.
        value = value.tolist()
    if not isinstance(value, (Real, Decimal)) or isinstance(value, bool):
        return None
    try:
        converted = float(value)
    except Exception:
        # Too large for a float, or a class of the caller that fails.
        return None
    return converted if math.isfinite(converted) else None


def _hints(call: Callable[..., Any]) -> dict[str, Any]:
    """Returns the types of the parameters; the return type may be from a module that is not imported."""

    def parameters() -> None: ...

    parameters.__annotations__ = {name: hint for name, hint in call.__annotations__.items() if name != "return"}
    return get_type_hints(parameters, call.__globals__)


def _suggestion(name: str, signature: inspect.Signature) -> str:
    """Returns the most similar keyword, or all keywords, as the end of a message."""
    names = [known for known in signature.parameters if known not in ("self", "cls")]
    near = difflib.get_close_matches(name, names, 1)
    return f"; did you mean `{near[0]}`?" if near else f"; available: {', '.join(names)}"


def _check(name: str, value: object, hint: Any) -> None:
    """Checks an argument against its type hint; raises TypeError for a wrong type, InputError for a wrong value."""
    if not _fits(value, hint):
        advice = "; fo.sweep takes several" if name in ("density", "direction") and _is_collection(value) else ""
        raise TypeError(f"{name}: has to be {' or '.join(_described(hint))}, not {_type_name(value)}{advice}")
    _check_size(name, value)
    if isinstance(value, (str, os.PathLike)):
        _check_text(name, cast(Any, value), path=hint is not str)
    choices = _choices(hint)
    if isinstance(value, str) and choices and value not in choices:
        near = difflib.get_close_matches(value, choices, 1)
        meant = f"; did you mean `{near[0]}`?" if near else ""
        available = ", ".join(choice for choice in choices if choice != "fake")
        raise wrong(name, f"unknown value `{value}`; available: {available}{meant}")


def _check_size(name: str, value: object) -> None:
    """Raises InputError for whole numbers too large for a float, also inside mappings, lists and tuples."""
    if isinstance(value, Integral):
        try:
            float(value)
        except OverflowError:
            raise wrong(name, f"is {shown(value)}; its absolute value must be 1e308 or less") from None
    elif isinstance(value, Mapping):
        for key, item in cast("Mapping[object, object]", value).items():
            _check_size(str(key), item)
    elif isinstance(value, (list, tuple)):
        for item in cast("Sequence[object]", value):
            _check_size(name, item)


def _check_text(name: str, value: str | os.PathLike[Any], path: bool) -> None:
    """Raises InputError for text with a NUL character or lone surrogates, and for paths of bytes."""
    try:
        text = os.fspath(value)
    except Exception:
        # A class of the caller that fails.
        text = b""
    if not isinstance(text, str):
        raise wrong(name, "must be a path of text, not of bytes")
    if "\0" in text:
        raise wrong(name, "contains a NUL character, which is not allowed")
    if not path and not text.isascii() and any("\ud800" <= letter <= "\udfff" for letter in text):
        raise wrong(name, "must be text that can be encoded as UTF-8")


def _type_name(value: object) -> str:
    """Returns the type of a value, or the length of a tuple, for a message."""
    return f"{len(value)}" if is_tuple(value) else type(value).__name__


def _choices(hint: Any) -> tuple[str, ...]:
    """Returns the values of a Literal, also of an optional one; none for other types."""
    if get_origin(hint) in (Union, types.UnionType):
        rest = [member for member in get_args(hint) if member is not type(None)]
        return _choices(rest[0]) if len(rest) == 1 else ()
    return get_args(hint) if get_origin(hint) is Literal else ()


def _is_collection(value: object) -> TypeGuard[Collection[object]]:
    return isinstance(value, (list, tuple, np.ndarray))


def _fits(value: object, hint: Any) -> bool:
    """Returns whether a value has the type of a hint; for a Literal, whether it is text."""
    origin, args = plain(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return any(_fits(value, member) for member in args)
    if origin is Literal:
        return isinstance(value, str)
    if hint is bool:
        return isinstance(value, (bool, np.bool_))
    if hint in (float, int):
        number = isinstance(value, Real if hint is float else Integral)
        return number and not isinstance(value, (bool, np.bool_))
    if origin is tuple:
        if not _is_collection(value) or getattr(value, "ndim", 1) == 0:
            return False
        length_fits = args[-1] is Ellipsis or len(value) == len(args)
        return length_fits and all(_fits(item, args[0]) for item in value)
    kind = origin if isinstance(origin, type) else hint
    if hint is Any or not isinstance(kind, type) or getattr(kind, "_is_protocol", False):
        return True
    # Text and 0-d arrays have the interface of a sequence, but count as one value.
    single = isinstance(value, str) or getattr(value, "ndim", 1) == 0
    return isinstance(value, kind) and not (single and kind in (Iterable, Sequence))


def _described(hint: Any) -> list[str]:
    """Returns the accepted types of a hint, for a message."""
    origin, args = plain(hint), get_args(hint)
    if origin in (Union, types.UnionType):
        return list(dict.fromkeys(name for member in args for name in _described(member)))
    if origin is Literal:
        return [", ".join(repr(choice) for choice in args)]
    if origin is tuple and args[-1] is not Ellipsis:
        return [f"{len(args)} numbers"]
    names = {float: "a number", int: "a whole number", bool: "True or False", str: "text", os.PathLike: "a path",
             type(None): "None"}
    if origin is not None and origin is not os.PathLike:
        return ["a mapping" if issubclass(origin, Mapping) else "a sequence"]
    return [names.get(origin or hint, getattr(hint, "__name__", str(hint)))]
