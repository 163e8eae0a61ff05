"""Gymnasium environment of an insertion, for learning a search strategy.

>>> from finger_opt.gym import InsertionEnv                             # doctest: +SKIP
>>> env = InsertionEnv("usb", density=20, direction=10)                 # doctest: +SKIP
>>> observation, info = env.reset(seed=1)                               # doctest: +SKIP
>>> observation, reward, terminated, truncated, info = env.step([0, 0, -20])  # doctest: +SKIP
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._call import checked, given, keywords
from ._task import Given, sources
from ._words import Engine, FingerModel, Numbers, RobotName, SpaceName, Start, StrPath

try:
    import gymnasium
except ImportError:
    raise ImportError("finger_opt.gym needs gymnasium: pip install 'finger-opt[gym]'") from None

#: Duration of an action, s of simulated time.
CONTROL_S = 0.001
#: Penalty per second of simulated time.
TIME_COST = 1.0
#: Reward of an insertion, and penalty of a failure.
END = 10.0

#: Positions of the observation and of the info values in a state.
OBSERVED, TIP, TILT, SLIP, DISTANCE = slice(1, 10), slice(10, 13), 13, 14, 15

#: Observations and actions.
Floats = NDArray[np.float32]


class InsertionEnv(gymnasium.Env[Floats, Floats]):
    """Environment in which a gripper inserts a part into a socket whose position is uncertain.

    An episode begins where the search of a trial begins: the part is grasped, tilted and brought
    to the start. Actions replace the task's strategy, which :func:`finger_opt.trial` executes.

    **Action**: velocity of the commanded TCP along x, y, z, mm/s, each within ``speed_mm_per_s``;
    shape (3,). It lasts 1 ms (two steps of the engine ``direct``). The robot follows with the
    dynamics of its model.

    **Observation**, shape (9,), available to a robot with a wrist sensor: position of the TCP, mm,
    relative to the centre of the opening without the shift; rotation of the flange, degrees; force of the
    socket on the plug, N, low-pass filtered with 5 ms; each along x, y, z.

    **Shift**: the shift of the start along y, mm, is drawn in each episode from ``offset_mm`` (from, to), or
    set by ``reset(options={"offset_mm": 0.5})``. It is not observed.

    **Reward**: decrease of the distance, mm, from the plug's tip to its seat (the position of the tip where the
    part counts as inserted), minus 1 per second of simulated time; plus 10 for an insertion; minus 10 for a lost
    part, a force above the robot's limit or a diverged simulation.

    **End**: terminated when the part has been seated and held for 30 ms, or on such a failure;
    truncated after ``time_limit_s`` of simulated time.

    ``info`` contains values that a robot cannot observe: ``tip_mm``, ``tilt_deg``, ``slip_mm``,
    ``distance_mm`` to the seat, ``offset_mm``, ``time_s``, and ``outcome`` and ``failure`` (class
    1 to 4) as of a trial, ``None`` during the episode.

    Task, finger and the other parameters are those of :func:`finger_opt.trial`.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    @checked
    def __init__(
        self,
        task: Given = "usb",
        density: float | None = None,
        direction: float | None = None,
        *,
        offset_mm: tuple[float, float] = (-1.0, 1.0),
        speed_mm_per_s: float = 100.0,
        time_limit_s: float = 2.0,
        stiffness_compliance: float | None = None,
        stiffness_assembly: float | None = None,
        set: Numbers | None = None,
        space: SpaceName | StrPath = "infill",
        robot: RobotName | StrPath | None = None,
        cell: StrPath | None = None,
        stiffness_data: StrPath | None = None,
        engine: Engine = "direct",
        finger_model: FingerModel | None = None,
        finger: StrPath = "finray9",
        start: Start | None = None,
    ) -> None:
        settings = given(locals(), "task", "offset_mm", "speed_mm_per_s", "time_limit_s", "__class__")
        if not -1000.0 <= offset_mm[0] <= offset_mm[1] <= 1000.0:
            raise _native.InputError("offset_mm: must be (from, to), mm, ascending, within -1000 to 1000")
        if not (0.0 < speed_mm_per_s < float("inf") and 0.0 < time_limit_s < float("inf")):
            raise _native.InputError("speed_mm_per_s, time_limit_s: must be above 0 and finite")
        self._insertion = _native.Insertion(keywords({"task": sources(task), **settings}))
        self._offsets, self._limit_s = offset_mm, time_limit_s
        self._offset, self._distance, self._ended = 0.0, 0.0, True
        self._speed = float(speed_mm_per_s)
        bound = np.full(3, speed_mm_per_s, dtype=np.float32)
        self.action_space: gymnasium.spaces.Space[Floats] = gymnasium.spaces.Box(-bound, bound)
        self.observation_space: gymnasium.spaces.Space[Floats] = gymnasium.spaces.Box(
            -np.inf, np.inf, (9,), dtype=np.float32
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, dict[str, Any]]:
        """Begins an episode; the shift, mm, is drawn or ``options["offset_mm"]``. Returns observation and info."""
        super().reset(seed=seed)
        drawn = self.np_random.uniform(*self._offsets)
        self._offset = float((options or {}).get("offset_mm", drawn))
        observation, info = self._observation(self._insertion.start(self._offset))
        self._distance, self._ended = info["distance_mm"], info["outcome"] is not None
        return observation, info

    def step(
        self, action: NDArray[np.floating[Any]] | Sequence[float]
    ) -> tuple[Floats, float, bool, bool, dict[str, Any]]:
        """Commands a velocity, mm/s, shape (3,), for 1 ms.

        Raises :class:`InputError` if the episode has ended or the action is invalid.
        """
        if self._ended:
            raise _native.InputError("step: no episode is running; call reset()")
        velocity = np.clip(np.asarray(action, dtype=np.float64), -self._speed, self._speed)
        if velocity.shape != (3,):
            raise _native.InputError(f"step: an action must have shape (3,), not {velocity.shape}")
        observation, info = self._observation(self._insertion.step(velocity.tolist()))
        outcome, distance = info["outcome"], info["distance_mm"]
        terminated = outcome is not None
        truncated = not terminated and info["time_s"] > self._limit_s - 0.5 * CONTROL_S
        reward = self._distance - distance - TIME_COST * CONTROL_S
        if outcome == "diverged":
            # The position of a diverged simulation is meaningless.
            reward = -TIME_COST * CONTROL_S
        if terminated:
            reward += END if outcome == "inserted" else -END
        self._distance, self._ended = distance, terminated or truncated
        return observation, reward, terminated, truncated, info

    def _observation(
        self, state: tuple[list[float], str | None, int | None]
    ) -> tuple[Floats, dict[str, Any]]:
        """Converts a state of the simulation to observation and info."""
        numbers, outcome, failure = state
        info = {
            "time_s": numbers[0],
            "tip_mm": numbers[TIP],
            "tilt_deg": numbers[TILT],
            "slip_mm": numbers[SLIP],
            "distance_mm": numbers[DISTANCE],
            "offset_mm": self._offset,
            "outcome": outcome,
            "failure": failure,
        }
        return np.array(numbers[OBSERVED], dtype=np.float32), info
