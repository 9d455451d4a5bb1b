"""The ablation: rows differ in what they are named after, and the claims count the seeds."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.cli import main
from numpy_cae.experiments import ablation
from numpy_cae.experiments.ablation import (
    HALF_REMOVED,
    MEASURES,
    RECONSTRUCTION,
    Evaluation,
    Row,
    ablation_result,
    all_rows,
    measure_rows,
)
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import DivergedError, Schedule


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
    evaluation = Evaluation(labelled)
    lines: list[str] = []
    rows = [replace(row, filters=(1,)) for row in all_rows(0, 1)[:2]]
    measure_rows(evaluation, rows, 2, lines.append)
    assert len(lines) == 2 * len(rows)
    for row in rows:
        assert np.isfinite(row.values(HALF_REMOVED)).all()
        assert np.ptp(row.values(HALF_REMOVED)) > 0  # the seeds differ
    unchanged = evaluation.measure(lambda x: x, 0)
    assert 0 == unchanged[RECONSTRUCTION] < unchanged[HALF_REMOVED]

    def diverges(*args, **kwargs):
        raise DivergedError("layer 1", "the loss is nan", "w1", "nothing was saved", "lower it")

    monkeypatch.setattr(ablation, "train_autoencoder", diverges)
    measure_rows(evaluation, rows[:1], 1)
    assert rows[0].measured[2:] == [None]


def with_errors(name, *errors):
    """A row with these errors of repair; None for a seed that diverged."""
    measured = [e and dict.fromkeys(MEASURES, 1.0) | {HALF_REMOVED: e} for e in errors]
    return Row(name, (1,), Schedule(), measured)


def test_a_claim_is_confirmed_if_every_seed_agrees():
    names = [row.name for row in all_rows()][1:]
    rows = [with_errors("paper", 1.0, 2.0)] + [with_errors(name, 1.5, 2.5) for name in names]
    rows[1] = with_errors(names[0], 1.5, 1.9)  # one layer: better for one seed
    rows[2] = with_errors(names[1], 1.5, None)  # two layers: diverged once
    rows[3] = with_errors(names[2], 0.5, 1.5)  # even unpooling: better for both
    result = ablation_result(rows, "sample")
    assert [claim.confirmed for claim in result.claims][:4] == [False, True, False, True]
    text = result.text()
    figures = [claim.figures for claim in result.claims]
    assert "in 1 of 2 seeds" in figures[0] and "in 2 of 2 seeds" in figures[1]
    assert "in 0 of 2 seeds" in figures[2] and "repair by -33%" in figures[2]
    assert "1.50 (1 diverged)" in text and "1.50 ± 0.71" in text and "by +33%" in figures[3]
    assert len(result.png()) > 10_000
    rows[1] = with_errors(names[0], None, None)
    (one_layer, *_) = ablation_result(rows, "sample").claims
    assert one_layer.confirmed and "against diverged" in one_layer.figures


def test_the_command_names_what_it_needs(tmp_path, capsys):
    assert main(["report", "--ablation", "--data", str(tmp_path)]) == 2
    assert "--test" in capsys.readouterr().err
    assert main(["report", "-o", str(tmp_path)]) == 2
    assert "give --data (only --ablation" in capsys.readouterr().err
