"""``python -m finger_opt``: the command ``optimize``."""

import sys

from ._shell import main

if __name__ == "__main__":
    sys.exit(main())
