"""Parameters of a cell identified from the robot's logs."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from ._drawn import framed
from ._result import PICTURE, Result
from ._words import Outcome


@dataclass(frozen=True, repr=False)
class Remark(Result):
    """Anomaly in a log, with its lines; a ``serious`` one makes the result unreliable."""

    log: str
    lines: tuple[int, int] | None
    text: str
    serious: bool


@dataclass(frozen=True, repr=False)
class Flange(Result):
    """Model of the robot along one axis: spring, damper and mass with a delay.

    ``explained`` is the share of the motion that the model explains, 0 to 1.
    """

    stiffness_n_per_mm: float
    stiffness_sd_n_per_mm: float
    damping_n_s_per_m: float
    mass_kg: float
    delay_s: float
    explained: float


@dataclass(frozen=True, repr=False)
class Slide(Result):
    """One slide of a probe: tangential over normal force; it does not count if the ratio keeps ``rising``."""

    tangential_over_normal: float
    rising: bool


@dataclass(frozen=True, repr=False)
class Probe(Result):
    """Coefficient of friction from the log of a probe, with its standard deviation."""

    log: str
    friction: float | None
    friction_sd: float | None
    slides: tuple[Slide, ...]


@dataclass(frozen=True, repr=False)
class Unknown(Result):
    """Parameter of the cell: prior interval (``prior_low`` to ``prior_high``) and estimate (``value``, ``sd``)."""

    name: str
    #: Key that the value changes, and how: replaced, multiplied by it, or shifted by it.
    sets: str
    as_: str
    prior_low: float
    prior_high: float
    value: float
    sd: float | None
    #: Origin of the value: ``formula``, ``fit``, ``prior`` (not determined by these logs) or ``files`` (not fitted).
    from_: Literal["formula", "fit", "prior", "files"]
    source: str
    #: Remaining share of the standard deviation of the prior: expected, and actual.
    expected_share_of_prior_sd: float | None
    share_of_prior_sd: float | None
    #: Attempt that would determine the parameter, if these logs do not.
    advice: str | None


@dataclass(frozen=True, repr=False)
class Replayed(Result):
    """Attempt simulated along its commanded path: outcomes before and after the fit."""

    log: str
    offset_mm: float
    outcome_before: Outcome
    outcome_after: Outcome


@dataclass(frozen=True, repr=False)
class Misfit(Result):
    """Root mean square difference between a simulated and a measured force component, in standard deviations,
    before and after the fit."""

    phase: Literal["search", "push"]
    axis: Literal["fx", "fy", "fz"]
    before: float
    after: float


@dataclass(frozen=True, repr=False)
class Validation(Result):
    """Attempt held out from the fit: actual and predicted outcome, and misfit of its force, in standard deviations.

    ``misfit_fitted`` is the misfit of the fitted attempts.
    """

    log: str
    offset_mm: float
    outcome: Outcome
    outcome_predicted: Outcome
    misfit: float
    misfit_fitted: float


@dataclass(frozen=True, repr=False)
class Cell(Result):
    """Cell identified from the robot's logs."""

    task: str
    remarks: tuple[Remark, ...]
    #: Model of the robot by axis.
    robot: dict[str, Flange]
    preload_mm: float | None
    preload_sd_mm: float | None
    probes: tuple[Probe, ...]
    unknowns: tuple[Unknown, ...]
    #: Misfit before each round of the fit and after the last, in standard deviations.
    misfit: tuple[float, ...]
    #: Share of the data that enough simulations reach to be compared, 0 to 1.
    compared_share: float
    phases: tuple[Misfit, ...]
    attempts: tuple[Replayed, ...]
    #: ``None`` if all attempts were fitted; at most five per finger are.
    validation: Validation | None
    #: HTML page with the measured and simulated curves.
    page: str = field(repr=False, metadata=PICTURE)

    def _repr_html_(self) -> str:
        return framed(self.page)
