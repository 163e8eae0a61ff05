"""Bayesian estimate of the ends of a tolerance window, near which attempts are random."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Log-normal prior of an end's width, the distance over which the probability to insert falls from 90 to 10 %:
#: median, mm, and geometric standard deviation. The prior of the position is uniform, from the taught start to a step
#: beyond the limit.
WIDTH_MM, WIDTH_FACTOR = 0.4, 2.0
#: Lapse rate: share of attempts whose outcome does not depend on the start.
LAPSE = 0.01
#: Prior probability of a gap on one side, and posterior odds above which a run of failures counts as a gap.
GAP_PRIOR, GAP_ODDS = 0.02, 10.0
#: Probability content of the credible intervals.
INTERVAL = 0.95

_WIDTHS_MM: Floats = WIDTH_MM * WIDTH_FACTOR ** np.linspace(-2.5, 2.5, 13, dtype=np.float64)
#: Scale of the logistic function per mm of width.
_SCALE = 1.0 / (2.0 * float(np.log(9.0)))


@dataclass(frozen=True)
class Search:
    """Settings of the search for the ends; lengths in mm."""

    step_mm: float
    resolution_mm: float
    limit_mm: float
    repeats: int


@dataclass(frozen=True)
class Gap:
    """Gap: starts within the window that do not insert, narrower than two steps of the coarse walk.

    ``failed_mm`` are the first and the last start that failed, ``within_mm`` the nearest starts on both sides that
    inserted; ``failure`` is the most frequent failure class, 1 to 4, if known.
    """

    failed_mm: tuple[float, float]
    within_mm: tuple[float, float]
    failure: int | None = None


@dataclass
class Tally:
    """Outcomes of the attempts from one start; ``first`` is whether the first one inserted."""

    first: bool
    inserted: int = 0
    failed: int = 0


@dataclass
class Side:
    """Posterior of one end of the window; lengths are in mm outward from the taught start."""

    search: Search
    sign: int
    #: Starts and whether they inserted, in the order of the attempts.
    tried: Iterable[tuple[float, bool]]
    #: Gaps: runs of starts, ascending.
    gaps: list[list[float]] = field(default_factory=list[list[float]])
    #: Start in or beyond a possible gap that has to be tried again.
    doubtful: float | None = None

    def __post_init__(self) -> None:
        search = self.search
        self.tallies: dict[float, Tally] = {}
        for offset, inserted in self.tried:
            if self.sign * offset >= 0.0:
                tally = self.tallies.setdefault(abs(offset), Tally(inserted))
                tally.inserted += inserted
                tally.failed += not inserted
        spacing = search.resolution_mm / 5.0
        #: Positions of the end, mm.
        self.grid: Floats = np.arange(0.0, search.limit_mm + search.step_mm, spacing, dtype=np.float64)
        widths = np.exp(-0.5 * (np.log(_WIDTHS_MM / WIDTH_MM) / np.log(WIDTH_FACTOR)) ** 2)
        self._prior: Floats = np.log(widths / widths.sum() / len(self.grid))[None, :]
        self._find_gaps()
        left_out = {start for run in self.gaps for start in run}
        log = self._log_posterior(left_out)
        joint = np.exp(log - log.max())
        #: Posterior of position and width, and of the position alone.
        self.joint: Floats = joint / joint.sum()
        self.position: Floats = self.joint.sum(axis=1)

    def _inserts(self, starts: Floats) -> Floats:
        """Returns the probability to insert, shape (starts, positions of the end, widths)."""
        distance = (self.grid[None, :, None] - starts[:, None, None]) / (_SCALE * _WIDTHS_MM)
        inserts: Floats = LAPSE + (1.0 - 2.0 * LAPSE) / (1.0 + np.exp(-np.clip(distance, -50.0, 50.0)))
        return inserts

    def _log_posterior(self, left_out: set[float]) -> Floats:
        """Returns log(prior * likelihood), shape (positions, widths), without the attempts from some starts."""
        kept = {start: tally for start, tally in self.tallies.items() if start not in left_out}
        inserts = self._inserts(np.array(list(kept)))
        inserted = np.array([tally.inserted for tally in kept.values()])[:, None, None]
        failed = np.array([tally.failed for tally in kept.values()])[:, None, None]
        log: Floats = self._prior + (inserted * np.log(inserts) + failed * np.log1p(-inserts)).sum(axis=0)
        return log

    def _find_gaps(self) -> None:
        """Finds the gaps: runs of failures within the window that a single end would hardly cause."""
        for run in self._runs():
            known = {start for gap in self.gaps for start in gap}
            alone, with_gap = self._log_posterior(known), self._log_posterior(known | set(run))
            failures = sum(self.tallies[start].failed for start in run)
            odds = GAP_PRIOR * (1.0 - LAPSE) ** failures * np.exp(_log_sum_exp(with_gap) - _log_sum_exp(alone))
            if odds > GAP_ODDS:
                self.gaps.append(run)
            elif odds > 1.0:
                # Alternate between the possible gap and the nearest start beyond it that inserted.
                beyond = min(start for start, tally in self.tallies.items() if tally.inserted and start > run[-1])
                again = failures > self.tallies[beyond].inserted + self.tallies[beyond].failed
                self.doubtful = beyond if again else run[len(run) // 2]

    def _runs(self) -> list[list[float]]:
        """Returns the runs of neighbouring starts that always failed, with a start beyond them that inserted."""
        runs: list[list[float]] = [[]]
        for start in sorted(self.tallies):
            if self.tallies[start].inserted:
                runs.append([])
            else:
                runs[-1].append(start)
        return [run for run in runs[:-1] if run]

    def walk(self) -> float | None:
        """Returns the next start of the coarse walk outward; None after two failures in a row or at the limit."""
        return self._walked()[0]

    @property
    def open(self) -> bool:
        """Whether the last start of the walk inserted, so that the end lies beyond it."""
        return self._walked()[1] == 0

    def _walked(self) -> tuple[float | None, int]:
        """Returns the next start of the walk, and the number of failures in a row at its end, by first attempts."""
        failed, steps = 0, 0
        while failed < 2:
            steps += 1
            start = round(steps * self.search.step_mm, 6)
            if start > self.search.limit_mm + 1e-9:
                break
            if start not in self.tallies:
                return start, failed
            failed = 0 if self.tallies[start].first else failed + 1
        return None, failed

    @property
    def farthest(self) -> float:
        """Farthest start that inserted, mm."""
        return max((start for start, tally in self.tallies.items() if tally.inserted), default=0.0)

    def quantile(self, share: float) -> float:
        """Returns a quantile of the end's position, mm."""
        return float(np.interp(share, np.cumsum(self.position), self.grid))

    @property
    def deviation(self) -> float:
        """Standard deviation of the end's position, mm."""
        mean = float(self.position @ self.grid)
        return float(np.sqrt(self.position @ (self.grid - mean) ** 2))

    @property
    def settled(self) -> bool:
        """Whether the end is known to the resolution, with enough attempts on both sides of it."""
        middle, step = self.quantile(0.5), self.search.step_mm
        gaps = {start for run in self.gaps for start in run}
        near = {s: t for s, t in self.tallies.items() if abs(s - middle) <= step and s not in gaps}
        inside = sum(tally.inserted for start, tally in near.items() if start <= middle)
        outside = sum(tally.failed for start, tally in near.items() if start >= middle)
        enough = min(inside, outside) >= self.search.repeats
        return self.open or (enough and self.deviation <= self.search.resolution_mm)

    def most_informative(self) -> float:
        """Returns the start, a multiple of the resolution, whose outcome has the largest expected information gain."""
        step, search = self.search.resolution_mm, self.search
        low = max(0, int((self.quantile(0.01) - search.step_mm) / step))
        high = min(self.quantile(0.99) + search.step_mm, search.limit_mm)
        starts: Floats = step * np.arange(low, int(high / step + 1e-9) + 1, dtype=np.float64)
        if not len(starts):
            return search.limit_mm
        given = np.einsum("sbw,bw->sb", self._inserts(starts), self.joint)
        given = given / np.maximum(self.position, 1e-300)
        information = _entropy(given @ self.position) - _entropy(given) @ self.position
        return round(float(starts[np.argmax(information)]), 6)


def _log_sum_exp(log: Floats) -> float:
    """Returns the logarithm of a sum of exponentials."""
    top = log.max()
    return float(top + np.log(np.exp(log - top).sum()))


def _entropy(share: Floats) -> Floats:
    """Returns the entropy of Bernoulli variables, nat."""
    share = np.clip(share, 1e-12, 1.0 - 1e-12)
    return -(share * np.log(share) + (1.0 - share) * np.log1p(-share))


class Window:
    """Posterior of a window and choice of the next start, from ``tried``: starts, mm, and whether they inserted."""

    def __init__(self, search: Search, tried: list[tuple[float, bool]]) -> None:
        self.search = search
        self.start = [inserted for offset, inserted in tried if offset == 0.0]
        self.sides = [Side(search, sign, tried) for sign in (-1, 1)] if self.inserts else []

    @property
    def inserts(self) -> bool:
        """Whether the taught start has inserted."""
        return any(self.start)

    @property
    def start_fails(self) -> bool:
        """Whether the taught start fails more often than it inserts, after ``repeats`` failures."""
        failed = self.start.count(False)
        return failed >= self.search.repeats and failed > self.start.count(True)

    @property
    def middle(self) -> float | None:
        """Middle of the starts that inserted, mm; None if there are none besides the taught one."""
        ends = [side.sign * side.farthest for side in self.sides]
        return sum(ends) / 2.0 if any(ends) else None

    def next(self) -> float | None:
        """Returns the next start, mm; None if both ends are known, or if the taught start does not insert."""
        if not self.inserts:
            return 0.0 if len(self.start) < self.search.repeats else None
        walked = [(side.sign, side.walk()) for side in self.sides]
        doubtful = [(side.sign, side.doubtful) for side in self.sides]
        for sign, start in (*walked, *doubtful):
            if start is not None:
                return sign * start
        unsettled = [side for side in self.sides if not side.settled]
        if not unsettled:
            return None
        side = max(unsettled, key=lambda side: side.deviation)
        # Without the sign of a zero.
        return side.sign * side.most_informative() + 0.0
