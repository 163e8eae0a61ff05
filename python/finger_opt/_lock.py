"""Locks on open files, between the processes of a machine and the threads of one."""

from __future__ import annotations

import sys
from typing import BinaryIO

if sys.platform == "win32":
    import msvcrt

    #: The byte that is locked: where nobody reads, since this lock keeps readers out.
    _BYTE = 1 << 40

    def _lock(file: BinaryIO, wait: bool) -> None:
        file.seek(_BYTE)
        msvcrt.locking(file.fileno(), msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: BinaryIO, wait: bool) -> None:
        fcntl.flock(file, fcntl.LOCK_EX if wait else fcntl.LOCK_EX | fcntl.LOCK_NB)


def locked(file: BinaryIO, wait: bool) -> bool:
    """Locks a file until it is closed; returns False if another has it and is not to be waited for."""
    try:
        _lock(file, wait)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        # A file system without locks: a lone process works there as well.
        pass
    return True
