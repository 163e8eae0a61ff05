"""Comparison with the published ranges: `scripts/validate.py`."""

from __future__ import annotations

import importlib
from pathlib import Path

import pytest


# Spearman's rank correlations of textbooks: 1 - 6 sum(d^2) / (n (n^2 - 1)) without ties, 0.9487 with one.
@pytest.mark.parametrize("ours, bench, expected", [
    ([1, 2, 3, 4, 5], [2, 1, 4, 3, 5], "0.80 mm, +0.80, -"),
    ([1, 2, 30, 4], [4, 3, 1, 2], "8.75 mm, -1.00, -"),
    ([1, 2, 2, 3], [1, 2, 3, 4], "0.50 mm, +0.95, -"),
    ([1, 2, None, 3], [4, None, 5, 2], "2.00 mm, -, -"),
    ([1, 1, 1], [1, 2, 3], "1.00 mm, -, -"),
])
def test_ranges_are_compared_by_error_and_rank(ours, bench, expected, monkeypatch):
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "scripts")
    validate = importlib.import_module("validate")
    ends = {source + end: "" for source in ("", "bench_") for end in ("failure_negative", "failure_positive")}
    table = [{"range_mm": str(a or ""), "bench_range_mm": str(b or ""), **ends} for a, b in zip(ours, bench)]
    assert validate.agreement(table, "", "bench_") == expected
