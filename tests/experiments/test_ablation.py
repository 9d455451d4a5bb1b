"""The ablation: rows differ in what they say, the table is measured, verdicts are counted."""

import json

import numpy as np
import pytest

from numpy_cae.cli import main
from numpy_cae.experiments.ablation import ablation as room
from numpy_cae.experiments.ablation.ablation import ablation
from numpy_cae.experiments.ablation.baselines import BASELINES, LINEAR
from numpy_cae.experiments.ablation.choices import (
    AVERAGE,
    DEPTH,
    LATENT,
    UNTIED,
    choices,
    doubling,
    parameters_of,
)
from numpy_cae.experiments.ablation.evaluation import Evaluation, Measured
from numpy_cae.experiments.ablation.result import Ablation, Row
from numpy_cae.experiments.ablation.variant import VariantAutoencoder
from numpy_cae.training import DivergedError

TINY = choices(1, 0, 1)


@pytest.fixture(scope="module")
def evaluation(labelled):
    return Evaluation(labelled)


def test_equal_means_equal():
    paper, *others = choices(32)
    assert len({each.name for each in others}) == len(others)
    rng = np.random.default_rng(0)
    for each in (paper, *others[:4]):
        assert sum(a.size for x in each.network(rng).layers for a in x.parameters.values()) == (
            each.parameters
        )
        assert each.network(rng).encode(np.zeros((1, 160, 63), np.float32)).size == each.latent
    for each in others:
        if each.group != DEPTH:
            assert each.latent == paper.latent
        elif LATENT in each.name:
            assert each.latent == paper.latent
            assert each.parameters < 0.5 * paper.parameters
        else:
            assert each.parameters == pytest.approx(paper.parameters, rel=0.01)
        assert isinstance(each.network(rng), VariantAutoencoder) == (each.name in (UNTIED, AVERAGE))
    untied = next(each for each in others if each.name == UNTIED)
    assert untied.parameters == 2 * paper.parameters == 2 * parameters_of(doubling(32, 3))


def test_every_row_is_measured_and_kept(evaluation, tmp_path, monkeypatch):
    kept, said = tmp_path / "kept.json", []
    few = [TINY[0], next(each for each in TINY if each.name == UNTIED)]
    found = ablation(evaluation, few, seeds=2, kept=kept, say=said.append)
    assert len(said) == 2 * len(found.rows) == len(json.loads(kept.read_text()))
    for row in found.rows:
        assert np.isfinite(row.of("half_zeroed")).all()
        assert np.ptp(row.of("half_zeroed")) > 0  # the seeds differ
        assert np.isfinite(row.of("units")).all() == (row.group != BASELINES)
    nothing = found.row("doing nothing")
    assert nothing.of("reconstruction") == pytest.approx(0, abs=1e-6)
    assert found.row(LINEAR).of("half_zeroed").mean() < nothing.of("half_zeroed").mean()

    def never(*args):
        raise AssertionError("measured again")

    monkeypatch.setattr(room, "train_autoencoder", never)
    again = ablation(evaluation, few, seeds=2, kept=kept)
    assert [row.cell("content") for row in again.rows] == [
        row.cell("content") for row in found.rows
    ]

    def diverges(*args, **kwargs):
        raise DivergedError("layer 1", "w1", "gone", "a lower rate")

    monkeypatch.setattr(room, "train_autoencoder", diverges)
    assert ablation(evaluation, few[:1], seeds=1).rows[0].measured == [None]


def told(name, *errors):
    """A row of which only repair matters."""
    measured = [
        e and Measured(**dict.fromkeys(Measured.__dataclass_fields__, 1.0) | {"half_zeroed": e})
        for e in errors
    ]
    return Row("group", name, measured=measured)


def test_a_claim_holds_where_every_seed_says_so(tmp_path):
    names = [each.name for each in choices()][1:] + [LINEAR]
    rows = [told("paper", 1.0, 2.0)] + [told(name, 1.5, 2.5) for name in names]
    rows[1] = told(names[0], 1.5, 1.9)  # depth 1 at equal latent size: better in one seed
    rows[2] = told(names[1], 1.5, None)  # depth 2 there: diverged once
    rows[3] = told(names[2], 0.5, 1.5)  # depth 1 at equal parameters: better in both
    result = Ablation(rows, "sample")
    assert [finding.held for finding in result.findings()][:4] == [False, True, False, True]
    assert "neither surely better nor worse than one and better than two" in result.on_depth()
    assert "worse than one and better than two" in result.on_depth()
    assert "1.50 (1 diverged)" in result.text()
    assert "1.50 ± 0.71" in result.text()
    assert "(+33%)" in result.on_the_rest()
    result.save_picture(tmp_path / "picture.png")
    assert (tmp_path / "picture.png").stat().st_size > 10_000


def test_the_command_says_what_it_needs(tmp_path, capsys):
    assert main(["report", "--ablation", "--data", str(tmp_path)]) == 2
    assert "--test" in capsys.readouterr().err
    assert main(["report", "-o", str(tmp_path)]) == 2
    assert "needs --data, --model, or --ablation" in capsys.readouterr().err
