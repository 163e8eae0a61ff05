"""Locks on open files, between processes and between threads of one machine."""

from __future__ import annotations

import sys
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt

    #: Offset of the locked byte: far beyond the data, since this lock also blocks reading.
    _BYTE = 1 << 40

    def _lock(file: BinaryIO, wait: bool) -> None:
        file.seek(_BYTE)
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: BinaryIO, wait: bool) -> None:
        fcntl.flock(file, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)


def locked(file: BinaryIO, wait: bool) -> bool:
    """Locks a file until it is closed; returns False if it is locked elsewhere and ``wait`` is False."""
    try:
        _lock(file, wait)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        # The file system has no locks: continue, which is safe for a single process.
        pass
    return True
