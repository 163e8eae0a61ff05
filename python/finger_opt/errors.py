"""Exceptions of the package; ``file``, ``key`` and ``line`` are the place of the problem, if known."""

from ._native import (
    InputError as InputError, Interrupted as Interrupted, Refused as Refused, StudyError as StudyError,
    TaskError as TaskError,
)

for _error in (InputError, Interrupted, Refused, StudyError, TaskError):
    _error.__module__ = __name__
