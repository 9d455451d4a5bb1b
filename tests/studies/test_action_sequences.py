"""The study of jang2018 on tiny networks: that they measure what they state."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.evaluation import angle_distance, tables
from numpy_cae.evaluation.tables import BY_PCA, HELD, MEAN, NETWORK, SQUARED
from numpy_cae.mocap import angles_of
from numpy_cae.training import SequenceSchedule
from numpy_cae.verify import check_property, properties_of
from studies import sequences
from studies.jang2018 import actions, samples, training
from studies.jang2018.mmd import maximum_mean_discrepancy
from studies.jang2018.samples import FITTED, PRIOR, REAL
from studies.shared.result import png

SHORT = SequenceSchedule(epochs=1, steps=2, batch=8, directions=4)
SIZES = {"hidden": 8, "latent": 4, "frames": 20}


@pytest.fixture(scope="module")
def studies():
    trained = []
    for kind in ("walking", "waiting"):
        takes = [angles_of(make_take(kind, seed, 4.0, 25.0).motion) for seed in range(4)]
        action = actions.Action(kind, takes[:2], takes[2:], kind == "walking")
        trained.append(training.train_study(action, SHORT, **SIZES))
    return trained


def test_a_study_measures_before_the_first_step_and_after(studies):
    curve = studies[0].curve
    assert list(curve["steps"]) == [0, 1, 2]
    assert np.isfinite(curve["error"]).all() and (curve["discrepancy"] > 0).all()
    x = studies[0].random_clips(1000, 7, training=False)
    manifold = studies[0].manifold
    x_hat, truth = map(manifold.denormalise, (manifold.network.denoise(x), x))
    error = angle_distance(x_hat, truth)
    assert curve["error"][-1] == pytest.approx(error, rel=0.03)


def test_figure_2_tests_the_trend(studies):
    error = np.linspace(2, 0.2, 20)
    falling = {"steps": np.arange(20), "error": error, "discrepancy": np.geomspace(1, 0.01, 20)}
    flat = falling | {"error": error[np.random.default_rng(0).permutation(20)]}
    both = zip(studies, (falling, flat), strict=True)
    one, other = (replace(each, curve=curve) for each, curve in both)
    result = training.figure_2([one])
    row = "walking: reconstruction error, rad"
    assert result.tables[0].value(row, "first tenth") == np.mean(error[:2])
    assert result.tables[0].value(row, "last tenth") == np.mean(error[-2:])
    assert result.tables[0].value(row, "τ") == pytest.approx(-1)
    assert [claim.fulfilled for claim in result.claims] == [True, True]
    assert [claim.fulfilled for claim in training.figure_2([one, other]).claims] == [False, True]
    assert len(png(result.figures["figure_2"])) > 1000


@pytest.mark.thorough
@pytest.mark.parametrize("source", [FITTED, PRIOR, REAL])
def test_figure_3_draws_samples_of_each_source(studies, source):
    assert len(png(samples.figure_3(studies[0], source=source))) > 10_000


def test_fitted_samples_have_the_covariance_of_encoded_clips(studies):
    z = samples.fitted_latents(studies[0], 4000, 0)
    encoded = studies[0].manifold.network.encode(studies[0].random_clips(1000, 0))
    assert np.allclose(np.cov(z, rowvar=False), np.cov(encoded, rowvar=False), atol=0.05)


def test_reconstruction_beside_simpler_methods(studies, monkeypatch):
    monkeypatch.setattr(tables, "PCA_CLIPS", 400)
    result = sequences.measure_reconstruction(studies[:1])
    errors = {
        method: result.tables[0].value(f"walking: {method}", SQUARED)
        for method in (MEAN, HELD, BY_PCA, NETWORK)
    }
    x = studies[0].held_out()
    assert errors[MEAN] == pytest.approx(np.mean(x.astype(float) ** 2))
    assert errors[HELD] == pytest.approx(np.mean((x - x[:, :1]).astype(float) ** 2), rel=1e-5)
    assert errors[NETWORK] == pytest.approx(studies[0].squared_error())
    assert errors[BY_PCA] < errors[MEAN]
    assert result.claims[0].fulfilled == (errors[NETWORK] < errors[BY_PCA])


def test_samples_are_measured_relative_to_real_clips(studies, monkeypatch):
    monkeypatch.setattr(samples, "SAMPLES", 20)
    result = samples.samples(studies)
    for action in ("walking", "waiting"):
        assert result.tables[0].value(f"{action}: {REAL}", "near") == pytest.approx(1)
    assert len(result.claims) == 1


def test_the_regulariser_with_and_without(studies, monkeypatch):
    monkeypatch.setattr(samples, "REPEATS", 1)
    monkeypatch.setattr(samples, "SAMPLES", 20)
    action = studies[0].action
    free = training.train_study(action, replace(SHORT, weight=0.0), **SIZES)
    assert len(free.curve["steps"]) == 1 < len(studies[0].curve["steps"])
    other = training.train_study(action, replace(SHORT, weight=0.1), mmd=True, **SIZES)
    trained = {samples.SLICED: studies[:1], samples.MMD: [other], samples.NONE: [free]}
    result = samples.regulariser(trained)
    rows = {name: f"{action.name}: {name}" for name in trained}
    errors = {name: result.tables[0].value(row, "mean square") for name, row in rows.items()}
    assert errors == {name: each[0].squared_error() for name, each in trained.items()}
    assert result.claims[1].fulfilled == (errors["sliced Wasserstein"] < errors["none, λ = 0"])
    assert type(other.manifold.network) is type(free.manifold.network)


MMD = properties_of(
    maximum_mean_discrepancy,
    {"z": "count size", "prior": "count size"},
    sizes={"count": (2, 3, 7), "size": (1, 4)},
    differentiable=["z"],
)


@pytest.mark.parametrize("held", MMD, ids=lambda held: held.name)
def test_mmd_has_the_properties_of_an_operation(held):
    check_property(held, maximum_mean_discrepancy)


def test_mmd_is_the_sum_over_pairs():
    z, prior = np.random.default_rng(0).normal(size=(2, 6, 3))

    def mean(a, b, pairs):
        d = [np.sum((a[i] - b[j]) ** 2) for i, j in pairs]
        scales = [2 * 3 * s for s in (0.1, 0.2, 0.5, 1, 2, 5, 10)]
        return np.mean([sum(c / (c + each) for c in scales) for each in d])

    apart = [(i, j) for i in range(6) for j in range(6) if i != j]
    every = [(i, j) for i in range(6) for j in range(6)]
    expected = mean(z, z, apart) + mean(prior, prior, apart) - 2 * mean(z, prior, every)
    assert maximum_mean_discrepancy(z, prior)[0] == pytest.approx(expected)


def test_actions_are_split_by_person_or_by_pattern(data_folder, capsys):
    made = actions.synthetic_action("walking", 0.2, quiet=False)
    assert made.periodic and len(made.training) and len(made.testing)
    assert capsys.readouterr().err == "walking: 2 takes are made\n"
    read = actions.read_action(data_folder / "cmu/expmap/walking", ["walking_5.txt"])
    assert (len(read.training), len(read.testing)) == (4, 1)
