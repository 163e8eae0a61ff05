"""The command ``optimize`` of the wheel, which runs the command line in this interpreter."""

from __future__ import annotations

import os
import signal
import sys

from . import _native


def main() -> int:
    """Runs ``optimize`` with the arguments of this process; returns the exit code."""
    # The command line handles Ctrl-C itself; Python's handler would wait until the command has ended.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    open_streams()
    os.environ.setdefault("FINGER_OPT_PYTHON", sys.executable)
    return _native.main(["optimize", *sys.argv[1:]])


def open_streams() -> None:
    """Opens closed standard streams on the null device.

    Otherwise, the next opened file gets the descriptor of the stream, and messages are written to that file.
    """
    for descriptor in range(3):
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
