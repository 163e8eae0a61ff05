"""The command ``optimize`` of the wheel: the same command line, in this interpreter."""

from __future__ import annotations

import os
import signal
import sys

from . import _native


def main() -> int:
    """Runs ``optimize`` with the arguments of this process; gives its exit code."""
    # The command line has its own way to stop: Python's would wait until it has ended.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    open_streams()
    os.environ.setdefault("FINGER_OPT_PYTHON", sys.executable)
    return _native.main(["optimize", *sys.argv[1:]])


def open_streams() -> None:
    """Standard streams that were closed lead nowhere: else the next file has their number, and what is said goes into it."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
