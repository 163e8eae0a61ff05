"""``python -m finger_opt``: the command ``optimize``."""

import sys

from ._shell import main

sys.exit(main())
