"""What is raised. ``file``, ``key`` and ``line`` say where it is wrong, as far as that is known."""

from ._native import (
    InputError as InputError, Interrupted as Interrupted, Refused as Refused, StudyError as StudyError,
    TaskError as TaskError,
)

for _error in (InputError, Interrupted, Refused, StudyError, TaskError):
    _error.__module__ = __name__
