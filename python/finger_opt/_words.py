"""Types and accepted words of parameters that several functions share."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Literal, Union

#: Shipped name, or path of a file or folder.
StrPath = Union[str, os.PathLike[str]]
#: Shipped tasks.
TaskName = Literal["ket8", "ket12", "rj45", "usb", "rj45_latch", "usb_a"]
#: Shipped search spaces.
SpaceName = Literal["infill", "codesign", "finger"]
#: Shipped robots.
RobotName = Literal["rigid", "servo", "ur5e", "ur5e_position"]
#: Contact engines; ``fake``, a closed formula, exists only in builds for tests.
Engine = Literal["direct", "rapier", "fake"]
#: Source of the remote centre and of unmeasured stiffnesses of a finger.
FingerModel = Literal["paper", "computed"]
#: How the nominal start is chosen.
Start = Literal["given", "taught"]
#: Search methods.
OptimizerName = Literal["gp", "cma-es", "random", "sobol", "grid"]
#: Measures to optimize.
Objective = Literal["range", "centred-range", "success-rate", "robust-range", "peak-force", "slip"]
#: Aggregations over several tasks.
Aggregate = Literal["min", "mean", "weighted"]
#: Start errors over which a capture map is traced.
Axes = Literal["y,x", "y,yaw", "y,tilt"]
#: Outcomes of an insertion.
Outcome = Literal["inserted", "failed", "diverged"]
#: Numbers of task and finger by key: ``{"task.strategy.tilt_deg": 8}``.
Numbers = Mapping[str, float]
#: Outcome at an end of a window: a failure class, 1 to 4, or a diverged simulation.
End = Union[int, Literal["diverged"]]
