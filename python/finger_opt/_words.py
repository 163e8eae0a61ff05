"""The words and types that calls share."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Literal, Union

#: A name of a file, or a path of any kind.
StrPath = Union[str, os.PathLike[str]]
#: Shipped tasks.
TaskName = Literal["ket8", "ket12", "rj45", "usb", "rj45_latch", "usb_a"]
#: Shipped search spaces.
SpaceName = Literal["infill", "codesign", "finger"]
#: Shipped robots.
RobotName = Literal["rigid", "servo", "ur5e", "ur5e_position"]
#: Contact engines; ``fake``, a closed formula, is there only in a wheel built for tests.
Engine = Literal["direct", "rapier", "fake"]
#: Where springs come from that nobody measured.
FingerModel = Literal["paper", "computed"]
#: What becomes of the nominal start.
Start = Literal["given", "taught"]
#: Search methods.
OptimizerName = Literal["gp", "cma-es", "random", "sobol", "grid"]
#: What is optimized.
Objective = Literal["range", "centred-range", "success-rate", "robust-range", "peak-force", "slip"]
#: What is made of the values of several tasks.
Aggregate = Literal["min", "mean", "weighted"]
#: The errors over which a capture map is traced.
Axes = Literal["y,x", "y,yaw", "y,tilt"]
#: How an insertion ends.
Outcome = Literal["inserted", "failed", "diverged"]
#: Numbers of task and finger by their keys: ``{"task.strategy.tilt_deg": 8}``.
Numbers = Mapping[str, float]
#: What ends a window: a failure class, 1 to 4, or a simulation that diverged.
End = Union[int, Literal["diverged"]]
