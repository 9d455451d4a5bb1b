"""The ablation: rows differ in what they are named after, and the claims count the seeds."""

import numpy as np
import pytest

from numpy_cae.cli import main
from numpy_cae.experiments.ablation import ablation
from numpy_cae.experiments.ablation.ablation import Row, ablation_result, measure_rows
from numpy_cae.experiments.ablation.choices import (
    AVERAGE,
    LATENT,
    PARAMETERS,
    UNTIED,
    choices,
    doubling,
    parameters_of,
)
from numpy_cae.experiments.ablation.evaluation import LINEAR, MEASURES, NOTHING, Evaluation
from numpy_cae.training import DivergedError


def test_equal_sizes_are_equal_and_every_row_trains_its_own_network():
    paper, *others = choices(32)
    assert len({each.name for each in others}) == len(others)
    rng = np.random.default_rng(0)
    for each in (paper, *others):
        network = each.network(rng)
        sizes = [a.size for layer in network.layers for a in layer.parameters.values()]
        assert sum(sizes) == each.parameters
        assert network.encode(np.zeros((1, 160, 63), np.float32)).size == each.latent
        fast = type(network).__name__.startswith("Fast")
        assert fast == (each.name not in (UNTIED, AVERAGE))
    for each in others:
        if PARAMETERS in each.name:
            assert each.parameters == pytest.approx(paper.parameters, rel=0.01)
        else:
            assert each.latent == paper.latent
            assert LATENT not in each.name or each.parameters < 0.5 * paper.parameters
    untied = next(each for each in others if each.name == UNTIED)
    assert untied.parameters == 2 * paper.parameters == 2 * parameters_of(doubling(32, 3))


def test_every_row_is_measured_from_every_seed(labelled, monkeypatch):
    evaluation = Evaluation(labelled)
    lines: list[str] = []
    few = [each for n, each in enumerate(choices(1, 0, 1)) if n == 0 or each.name == UNTIED]
    rows = measure_rows(evaluation, few, 2, lines.append)
    assert len(lines) == 2 * len(rows)
    for row in rows:
        assert np.isfinite(row.values("half_zeroed")).all()
        assert np.ptp(row.values("half_zeroed")) > 0  # the seeds differ
        assert np.isfinite(row.values("units")).all() == (row.parameters is not None)
    named = {row.name: row for row in rows}
    assert named[NOTHING].values("reconstruction") == pytest.approx(0, abs=1e-6)
    errors = [named[name].values("half_zeroed").mean() for name in (LINEAR, NOTHING)]
    assert errors[0] < errors[1]

    def diverges(*args, **kwargs):
        raise DivergedError("layer 1", "the loss is nan", "w1", "nothing was saved", "lower it")

    monkeypatch.setattr(ablation, "train_autoencoder", diverges)
    assert measure_rows(evaluation, few[:1], 1)[0].measured == [None]


def with_errors(name, *errors):
    """A row with these errors of repair; None for a seed that diverged."""
    measured = [e and dict.fromkeys(MEASURES, 1.0) | {"half_zeroed": e} for e in errors]
    return Row(name, measured=measured)


def test_a_claim_holds_if_every_seed_agrees():
    names = [each.name for each in choices()][1:] + [LINEAR]
    rows = [with_errors("paper", 1.0, 2.0)] + [with_errors(name, 1.5, 2.5) for name in names]
    rows[1] = with_errors(names[0], 1.5, 1.9)  # depth 1, equal latent size: better for one seed
    rows[2] = with_errors(names[1], 1.5, None)  # depth 2, the same: diverged once
    rows[3] = with_errors(names[2], 0.5, 1.5)  # depth 1, equal parameters: better for both
    result = ablation_result(rows, "sample")
    assert [claim.held for claim in result.claims][:4] == [False, True, False, True]
    text = result.text()
    figures = [claim.figures for claim in result.claims]
    assert "in 1 of 2 seeds" in figures[0] and "in 2 of 2 seeds" in figures[1]
    assert "in 0 of 2 seeds" in figures[2] and "repair by -33%" in figures[2]
    assert "1.50 (1 diverged)" in text and "1.50 ± 0.71" in text and "by +33%" in figures[3]
    assert len(result.png()) > 10_000
    rows[1] = with_errors(names[0], None, None)
    (depth_1, *_) = ablation_result(rows, "sample").claims
    assert depth_1.held and "against diverged" in depth_1.figures


def test_the_command_names_what_it_needs(tmp_path, capsys):
    assert main(["report", "--ablation", "--data", str(tmp_path)]) == 2
    assert "--test" in capsys.readouterr().err
    assert main(["report", "-o", str(tmp_path)]) == 2
    assert "give --data (only --ablation" in capsys.readouterr().err
