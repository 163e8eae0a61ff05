"""The answer of a study: which finger to print, what to expect, how far to trust it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from ._result import DRAWN, REST, Result


@dataclass(frozen=True, repr=False)
class Measured(Result):
    """A finger like it that was measured on a robot."""

    task: str
    values: dict[str, float]
    range_mm: float | None


@dataclass(frozen=True, repr=False)
class Trust(Result):
    """How far the answer is to be trusted: calibrated on measurements, with published ones at hand, or simulated."""

    level: Literal["calibrated", "published", "simulated"]
    label: str
    reason: str
    #: Of a calibrated answer: fingers measured, and the error for those left out, percent.
    measured: int | None = None
    loo_mean_deviation_percent: float | None = None
    nearest_measured: tuple[Measured, ...] = ()
    error_percent_on_shipped_tasks: tuple[float, float] | None = None


@dataclass(frozen=True, repr=False)
class StartAdvice(Result):
    """The window about the taught start, mm, and whether to teach it elsewhere."""

    negative_mm: float
    positive_mm: float
    one_sided: bool
    to_middle_mm: float
    advice: str | None


@dataclass(frozen=True, repr=False)
class Safe(Result):
    """The finger of the set that was measured, else that with the least force; ``loss_mm``: what it loses."""

    values: dict[str, float]
    evaluation: int
    measured_range_mm: float | None
    peak_force_n: float | None
    loss_mm: float | None


@dataclass(frozen=True, repr=False)
class AsGood(Result):
    """The designs that lose less than a bench can tell."""

    within_mm: float
    designs: int
    of: int
    share_of_space: float | None
    evaluations: tuple[int, ...]
    #: From, to, by key.
    spread: dict[str, tuple[float, ...]]
    safe: Safe | None


@dataclass(frozen=True, repr=False)
class ExcessForce(Result):
    """A contact force that the connector or the robot does not withstand, or only just."""

    task: str
    peak_force_n: float
    #: That of the connector, or the stop force of the robot.
    limit_n: float
    of_connector: bool
    warning: str


@dataclass(frozen=True, repr=False)
class NextStep(Result):
    """A command to go on with, and why."""

    command: str
    why: str


@dataclass(frozen=True, repr=False)
class Answer(Result):
    """What to do, as ``answer`` of ``--json``.

    ``verdict``: ``print`` the ``finger``; ``any`` will do; one ``measured_before``; ``choose`` of a front;
    ``nothing_inserts``; ``none_feasible``.
    """

    verdict: Literal["print", "any", "measured_before", "choose", "nothing_inserts", "none_feasible"]
    headline: str
    expectation: str
    #: Its values by key.
    finger: dict[str, float] | None
    force: ExcessForce | None
    trust: Trust
    start: StartAdvice | None
    as_good: AsGood | None
    next: NextStep
    #: The card of the study's page.
    card: str = field(default="", repr=False, metadata=DRAWN)

    def _repr_html_(self) -> str:
        return self.card


@dataclass(frozen=True, repr=False)
class OnBench(Result):
    """What the finger is expected to do on the bench: 80 % of such ranges lie between low and high."""

    range_mm: float
    low_mm: float
    high_mm: float
    probability_best: float
    failure_negative: int | None
    failure_positive: int | None


@dataclass(frozen=True, repr=False)
class Recommended(Result):
    """The recommended design: ``values`` by key; the *firm* window is that which inserts in all repeats.

    Of several objectives it is the first of the front, with its ``objectives`` by key.
    """

    values: dict[str, float]
    evaluation: int | None
    range_mm: float | None = None
    negative_mm: float | None = None
    positive_mm: float | None = None
    firm_range_mm: float | None = None
    firm_negative_mm: float | None = None
    firm_positive_mm: float | None = None
    peak_force_n: float | None = None
    objectives: dict[str, float] | None = None
    tasks: tuple[str, ...] | None = None
    #: With ``measurements``.
    bench: OnBench | None = None
    #: What springs computed from its ribs make of it, and whatever else ``--json`` has.
    rest: dict[str, object] = field(default_factory=dict[str, object], metadata=REST, repr=False)
