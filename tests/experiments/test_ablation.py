"""The ablation: rows differ in what they are named after, and the claims count the seeds."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.experiments import ablation
from numpy_cae.experiments.ablation import HALF_REMOVED, MEASURES, all_rows
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import DivergedError


def test_equal_sizes_are_equal_and_every_row_trains_its_own_network():
    paper, *others = all_rows()
    assert len({row.name for row in others}) == len(others) == 9
    for row in (paper, *others):
        layers = ConvAutoencoder(filters=row.filters, taps=ablation.TAPS).layers
        sizes = [a.size for layer in layers for a in layer.parameters.values()]
        assert sum(sizes) == row.parameters == pytest.approx(paper.parameters, rel=0.01)
        same = (row.filters, row.schedule) == (paper.filters, paper.schedule)
        assert same == (row is paper)


def test_every_row_is_measured_from_every_seed(labelled, monkeypatch):
    evaluation = ablation.Evaluation(labelled)
    lines: list[str] = []
    rows = [replace(row, filters=(1,)) for row in all_rows(0, 1)[:2]]
    ablation.measure_rows(evaluation, rows, range(2), lines.append)
    assert len(lines) == 2 * len(rows)
    for row in rows:
        assert np.isfinite(row.values(HALF_REMOVED)).all()
        assert np.ptp(row.values(HALF_REMOVED)) > 0  # the seeds differ
    unchanged = evaluation.measure(lambda x: x, 0)
    assert 0 == unchanged[ablation.RECONSTRUCTION] < unchanged[HALF_REMOVED]

    def diverges(*args, **kwargs):
        raise DivergedError("layer 1", "the loss is nan", "w1", "nothing was saved", "lower it")

    monkeypatch.setattr(ablation, "train_autoencoder", diverges)
    ablation.measure_rows(evaluation, rows[:1], range(1))
    assert rows[0].cell(HALF_REMOVED).endswith("(1 diverged)")


def test_a_claim_is_confirmed_if_every_seed_agrees():
    errors = {
        "one layer": (1.5, 1.9),  # better for one seed
        "two layers": (1.5, np.nan),  # diverged once
        "even": (0.5, 1.5),  # better for both
        "no values": (np.nan, np.nan),
    }
    rows = all_rows()
    for row in rows:
        default = (1.0, 2.0) if row is rows[0] else (1.5, 2.5)
        of_seeds = next((e for name, e in errors.items() if row.name.startswith(name)), default)
        row.measured.extend(dict.fromkeys(MEASURES, 1.0) | {HALF_REMOVED: e} for e in of_seeds)
    result = ablation.ablation_result(rows, "sample")
    confirmed = [claim.confirmed for claim in result.claims]
    assert confirmed == [False, True, False, True, True, True, False]
    text, figures = result.text(), [claim.figures for claim in result.claims]
    assert "in 1 of 2 seeds" in figures[0] and "in 2 of 2 seeds" in figures[1]
    assert "in 0 of 2 seeds" in figures[2] and "against diverged" in figures[3]
    assert "1.50 (1 diverged)" in text and "1.50 ± 0.71" in text
    assert len(result.png()) > 10_000
