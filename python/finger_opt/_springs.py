"""Stiffness: model fitted to measurements, and mechanics of a printed finger."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, overload

import numpy as np

from . import _native
from ._call import called, checked, without
from ._evaluation import Springs
from ._plot import axes as axes_of
from ._result import DRAWN, PICTURE, Result
from ._words import StrPath

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Drawing


@dataclass(frozen=True, repr=False)
class Fit(Result):
    """Model of the stiffness along one axis, with its leave-one-out errors."""

    axis: str
    model: str
    loo_rmse_n_per_mm: float
    loo_mean_absolute_percent: float
    loo_standardised_rms: float
    used: bool


@dataclass(frozen=True, repr=False)
class Used(Result):
    """Chosen model along one axis.

    ``sd_widening`` is the factor by which its standard deviations were widened to match the leave-one-out errors.
    """

    model: str
    parameters: str
    sd_widening: float


@dataclass(frozen=True, repr=False)
class StiffnessModel(Result):
    """Models of the stiffness fitted to the measured designs; ``used`` by axis."""

    designs: int
    models: tuple[Fit, ...]
    used: dict[str, Used]
    #: File of the measurements, ``None`` for the shipped ones, and file of the measured finger.
    stiffness_data: str | None = field(default=None, metadata=DRAWN)
    finger: str = field(default="finray9", metadata=DRAWN)
    #: Drawing of the measurements and the fitted models.
    svg: str = field(default="", repr=False, metadata=PICTURE)

    def plot(self, ax: Drawing | None = None) -> Drawing:
        """Draws the stiffness in the compliance direction over density and direction; returns the axes."""
        return _contours(self, ax)

    def _repr_html_(self) -> str:
        return self.svg


def _contours(found: StiffnessModel, ax: Drawing | None) -> Drawing:
    """Draws the stiffness in the compliance direction over density and direction; returns the axes."""
    axes = axes_of(ax, height=4.2)
    infill: list[dict[str, float]] = json.loads(_native.space("infill"))
    density, direction = (np.linspace(axis["low"], axis["high"], 21) for axis in infill)
    values = np.array([
        [
            stiffness(float(x), float(y), stiffness_data=found.stiffness_data, finger=found.finger).compliance_n_per_mm
            for x in density
        ]
        for y in direction
    ])
    filled = axes.contourf(density, direction, values, levels=14, cmap="viridis")
    axes.figure.colorbar(filled, ax=axes, label="stiffness in the compliance direction, N/mm")
    axes.set(xlabel="infill density, percent", ylabel="infill direction, degrees",
             title=f"fitted to {found.designs} designs")
    return axes


@overload
def stiffness(
    *, stiffness_data: StrPath | None = None, finger: StrPath = "finray9", svg: StrPath | None = None
) -> StiffnessModel: ...
@overload
def stiffness(
    density: float, direction: float, *, stiffness_data: StrPath | None = None, finger: StrPath = "finray9"
) -> Springs: ...
@checked
def stiffness(
    density: float | None = None,
    direction: float | None = None,
    *,
    stiffness_data: StrPath | None = None,
    finger: StrPath = "finray9",
    svg: StrPath | None = None,
) -> StiffnessModel | Springs:
    """Predicts the stiffness for an infill, or returns the fitted models without one, as ``optimize stiffness``.

    >>> import finger_opt as fo
    >>> fo.stiffness(20, 10).inside_hull
    True

    Args:
        density: Infill density, percent.
        direction: Infill direction, degrees.
        stiffness_data: CSV file of your own measurements, in place of the shipped ones.
        finger: Finger file of the measured finger.
        svg: Write a drawing of all designs to this file; only without an infill.

    Raises:
        InputError: Invalid value or file.
    """
    if density is None and direction is None:
        model = called("stiffness", {"stiffness_data": stiffness_data, "finger": finger, "svg": svg}, StiffnessModel)
        data = None if stiffness_data is None else str(stiffness_data)
        return replace(model, stiffness_data=data, finger=str(finger))
    without("an infill", "the drawing is of all designs", svg=svg)
    words = {"density": density, "direction": direction, "stiffness_data": stiffness_data, "finger": finger}
    return called("stiffness", words, Springs)


@dataclass(frozen=True, repr=False)
class Pad(Result):
    """In-plane stiffness at the pad: y towards the part, z up, rotation about x."""

    compliance_n_per_mm: float
    assembly_n_per_mm: float
    tilting_nm_per_rad: float
    #: Position of the centre of compliance: below the middle of the pad, and in front of it towards the part.
    centre_below_pad_mm: float
    centre_from_pad_mm: float
    #: Correlation of the compliances in y and z, -1 to 1.
    coupling_yz: float
    #: (3, 3), for y, z and the rotation at the middle of the pad: N/mm; N/rad for the coupling; N mm/rad.
    stiffness_matrix: tuple[tuple[float, ...], ...]


@dataclass(frozen=True, repr=False)
class Across(Result):
    """Out-of-plane stiffness of the finger: along its depth, and about y and z."""

    depth_n_per_mm: float
    about_y_nm_per_rad: float
    about_z_nm_per_rad: float


@dataclass(frozen=True, repr=False)
class Finger(Result):
    """Mechanics of a printed finger, computed from its ribs; notebooks draw it at rest and under a force on its pad."""

    finger: str
    infill_density_percent: float
    infill_direction_deg: float
    phase_mm: float
    area_mm2: float
    mass_g: float
    #: Stiffness predicted by the model fitted to measurements; ``None`` if the model does not apply.
    measured_model: Springs | None
    pad: Pad
    pad_and_roof: Pad
    across: Across
    svg: str = field(default="", repr=False, metadata=PICTURE)

    def _repr_html_(self) -> str:
        return self.svg
