"""What a robot's logs say of its cell."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from ._drawn import framed
from ._result import PICTURE, Result
from ._words import Outcome


@dataclass(frozen=True, repr=False)
class Remark(Result):
    """What is odd in a log, at which lines; what is ``serious`` spoils the result."""

    log: str
    lines: tuple[int, int] | None
    text: str
    serious: bool


@dataclass(frozen=True, repr=False)
class Flange(Result):
    """The robot along one axis: a spring, a damper and a mass behind a delay; ``explained`` of its motion."""

    stiffness_n_per_mm: float
    stiffness_sd_n_per_mm: float
    damping_n_s_per_m: float
    mass_kg: float
    delay_s: float
    explained: float


@dataclass(frozen=True, repr=False)
class Slide(Result):
    """A slide of a probe: tangential over normal force; one on which it keeps rising does not count."""

    tangential_over_normal: float
    rising: bool


@dataclass(frozen=True, repr=False)
class Probe(Result):
    """The friction that a probe tells."""

    log: str
    friction: float | None
    friction_sd: float | None
    slides: tuple[Slide, ...]


@dataclass(frozen=True, repr=False)
class Unknown(Result):
    """A number of the cell, before (``prior_low`` to ``prior_high``) and after (``value`` and ``sd``)."""

    name: str
    #: Key that it sets, and how: by itself, as a factor or as an offset.
    sets: str
    as_: str
    prior_low: float
    prior_high: float
    value: float
    sd: float | None
    #: ``formula`` or ``fit``; ``prior``: these logs cannot tell it; ``files``: not fitted.
    from_: Literal["formula", "fit", "prior", "files"]
    source: str
    #: Shares of the prior's deviation that are left: expected, and found.
    expected_share_of_prior_sd: float | None
    share_of_prior_sd: float | None
    #: The attempt that would tell it, if these do not.
    advice: str | None


@dataclass(frozen=True, repr=False)
class Replayed(Result):
    """An attempt that was simulated along its commanded path, before and after the fit."""

    log: str
    offset_mm: float
    outcome_before: Outcome
    outcome_after: Outcome


@dataclass(frozen=True, repr=False)
class Misfit(Result):
    """How far a simulated component of the force is from the measured one, in standard deviations (root mean
    square), before and after the fit."""

    phase: Literal["search", "push"]
    axis: Literal["fx", "fy", "fz"]
    before: float
    after: float


@dataclass(frozen=True, repr=False)
class Validation(Result):
    """An attempt that was not fitted: as it ended, as predicted, and the misfit of its force in standard deviations."""

    log: str
    offset_mm: float
    outcome: Outcome
    outcome_predicted: Outcome
    misfit: float
    misfit_fitted: float


@dataclass(frozen=True, repr=False)
class Cell(Result):
    """What logs say of the cell that they come from."""

    task: str
    remarks: tuple[Remark, ...]
    #: By axis.
    robot: dict[str, Flange]
    preload_mm: float | None
    preload_sd_mm: float | None
    probes: tuple[Probe, ...]
    unknowns: tuple[Unknown, ...]
    misfit: tuple[float, ...]
    compared_share: float
    phases: tuple[Misfit, ...]
    attempts: tuple[Replayed, ...]
    #: ``None`` if all attempts were fitted: at most five of a finger are.
    validation: Validation | None
    #: The page with the curves, measured and simulated.
    page: str = field(repr=False, metadata=PICTURE)

    def _repr_html_(self) -> str:
        return framed(self.page)
