"""Answer of a study: finger to print, expected range, and evidence."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from ._result import DRAWN, REST, Result


@dataclass(frozen=True, repr=False)
class Measured(Result):
    """A similar finger that was measured on a robot; ``values`` by key."""

    task: str
    values: dict[str, float]
    range_mm: float | None


@dataclass(frozen=True, repr=False)
class Trust(Result):
    """Evidence for the answer: calibrated on measurements, similar fingers published, or simulated only."""

    level: Literal["calibrated", "published", "simulated"]
    label: str
    reason: str
    #: Number of measured fingers, and their mean leave-one-out error, percent; only if ``level`` is ``calibrated``.
    measured: int | None = None
    loo_mean_deviation_percent: float | None = None
    #: Similar measured fingers; only if ``level`` is ``published``.
    nearest_measured: tuple[Measured, ...] = ()
    #: Lowest and highest error on the shipped tasks, percent; only if ``level`` is ``simulated``.
    error_percent_on_shipped_tasks: tuple[float, float] | None = None


@dataclass(frozen=True, repr=False)
class ComparedFinger(Result):
    """Finger with a simulated and a measured range."""

    values: dict[str, float]
    simulated_range_mm: float
    measured_range_mm: float


@dataclass(frozen=True, repr=False)
class RankCorrelation(Result):
    """Spearman's rank correlation of the simulated and measured ranges of ``designs`` published fingers.

    ``best`` is the one with the largest measured range; ``source`` describes the simulation.
    """

    task: str
    spearman: float
    designs: int
    source: str
    best: ComparedFinger


@dataclass(frozen=True, repr=False)
class StartAdvice(Result):
    """Window around the taught start, mm; ``advice`` if the start should be taught elsewhere.

    ``to_middle_mm`` is the shift of the start to the middle of the window.
    """

    negative_mm: float
    positive_mm: float
    one_sided: bool
    to_middle_mm: float
    advice: str | None


@dataclass(frozen=True, repr=False)
class Safe(Result):
    """Safe choice among tied designs: a measured one, otherwise the one with the least force.

    ``loss_mm`` is the difference of its range from that of the recommended design.
    """

    values: dict[str, float]
    evaluation: int
    measured_range_mm: float | None
    peak_force_n: float | None
    loss_mm: float | None


@dataclass(frozen=True, repr=False)
class AsGood(Result):
    """Ties: designs within ``within_mm`` of the recommended one, ``designs`` in number ``of`` all evaluated."""

    within_mm: float
    #: The ties and what others lose, in words.
    sentence: str
    designs: int
    of: int
    #: Share of the space that is nearer to a tie than to any other evaluated design, 0 to 1.
    share_of_space: float | None
    evaluations: tuple[int, ...]
    #: Smallest and largest value by key.
    spread: dict[str, tuple[float, ...]]
    safe: Safe | None


@dataclass(frozen=True, repr=False)
class ExcessForce(Result):
    """Contact force above or close to a limit."""

    task: str
    peak_force_n: float
    #: Limit of the connector (``of_connector``), otherwise the stop force of the robot.
    limit_n: float
    of_connector: bool
    warning: str


@dataclass(frozen=True, repr=False)
class LeftOut(Result):
    """Best design, whose contact force exceeds ``limit_n``; a tied one is recommended in its place."""

    values: dict[str, float]
    evaluation: int
    peak_force_n: float
    limit_n: float
    sentence: str


@dataclass(frozen=True, repr=False)
class NextStep(Result):
    """Recommended next command, and the reason."""

    command: str
    why: str


@dataclass(frozen=True, repr=False)
class BestMeasured(Result):
    """Finger with the largest measured range, of ``fingers`` in number; ``range_mm`` may be ``at_least`` its range."""

    values: dict[str, float]
    range_mm: float
    at_least: bool
    fingers: int


@dataclass(frozen=True, repr=False)
class Answer(Result):
    """Recommended action, as ``answer`` of ``--json``.

    ``verdict`` is ``print`` (print ``finger``), ``any`` (print any of the ties), ``simulated`` (``finger`` is the best in
    simulation, or ties; no measurement supports it), ``measured_before`` (use a finger that was measured), ``choose``
    (choose from a Pareto front), ``nothing_inserts``, ``none_feasible``, ``robot_stops`` (in most insertions, or before
    any) or ``not_repeatable`` (repeats fail at the nominal start).
    """

    verdict: Literal["print", "any", "simulated", "measured_before", "choose", "nothing_inserts", "none_feasible",
                     "robot_stops", "not_repeatable"]
    headline: str
    expectation: str
    #: The best measured finger: of your measurements or, if they do not support ``finger``, of the published ones.
    use_now: BestMeasured | None
    #: Values of the finger by key.
    finger: dict[str, float] | None
    force: ExcessForce | None
    left_out: LeftOut | None
    trust: Trust
    rank_correlations: tuple[RankCorrelation, ...]
    start: StartAdvice | None
    as_good: AsGood | None
    next: NextStep
    #: HTML summary of the study.
    card: str = field(default="", repr=False, metadata=DRAWN)

    def _repr_html_(self) -> str:
        return self.card


@dataclass(frozen=True, repr=False)
class OnBench(Result):
    """Predicted range on the bench, with its 80 % interval from ``low_mm`` to ``high_mm``.

    ``probability_best`` is the probability that the finger is the best of the space, 0 to 1.
    """

    range_mm: float
    low_mm: float
    high_mm: float
    probability_best: float
    failure_negative: int | None
    failure_positive: int | None


@dataclass(frozen=True, repr=False)
class Recommended(Result):
    """The recommended design: ``values`` by key; all repeats insert in the *firm* window.

    With several objectives: the first design of the Pareto front, with its ``objectives`` by key.
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
    #: Prediction for the bench; only with ``measurements``.
    bench: OnBench | None = None
    #: Further keys of ``--json``, for example the result with stiffnesses computed from the ribs.
    rest: dict[str, object] = field(default_factory=dict[str, object], metadata=REST, repr=False)
