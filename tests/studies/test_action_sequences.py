"""The study of jang2018 on tiny networks: that they measure what they state."""

from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_take
from numpy_cae.evaluation import angle_distance, tables
from numpy_cae.evaluation.tables import BY_PCA, HELD, MEAN, NETWORK, SQUARED
from numpy_cae.mocap import angles_of
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.training import SequenceSchedule
from numpy_cae.verify import check_property, properties_of
from studies import sequence_choices, sequences
from studies.jang2018 import actions, behaviours, samples, training
from studies.jang2018.behaviours import ACTS, count_behaviours
from studies.jang2018.mmd import maximum_mean_discrepancy
from studies.jang2018.samples import FITTED, PRINCIPAL, PRIOR, REAL, TRAINING, sample_clips
from studies.sequence_choices import AS_PAPER, NO_INPUT, NoInput, SameOrder, TrueFrames
from studies.shared.result import png
from studies.shared.trained import Trainer

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


def test_a_study_that_is_kept_is_not_trained_again(studies, tmp_path, monkeypatch):
    arguments = (Trainer(tmp_path / "new"), studies[0].action, SHORT)
    study = training.learn_study(*arguments, **SIZES)
    monkeypatch.delattr(training, "train_study")
    again = training.learn_study(*arguments, **SIZES)
    assert again.squared_error() == study.squared_error() == studies[0].squared_error()
    for name, values in studies[0].curve.items():
        np.testing.assert_array_equal(again.curve[name], values)


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
    monkeypatch.setattr(samples, "SHOWN_IN_PAPER", 6)
    monkeypatch.setattr(behaviours, "CLIPS", 4)
    result = samples.samples(studies)
    for action in ("walking", "waiting"):
        assert result.tables[0].value(f"{action}: {TRAINING}", "near") == pytest.approx(1)
    keys = [claim.key for claim in result.claims]
    assert keys == ["samples_natural", "samples_vary", "behaviours_reconstructed"]


def test_the_regulariser_with_and_without(studies, monkeypatch):
    monkeypatch.setattr(samples, "REPEATS", 1)
    monkeypatch.setattr(samples, "SAMPLES", 20)
    monkeypatch.setattr(samples, "CLIPS", 200)
    action = studies[0].action
    free = training.train_study(action, replace(SHORT, weight=0.0), **SIZES)
    assert len(free.curve["steps"]) == 0 < len(studies[0].curve["steps"])
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


def test_an_act_has_its_own_behaviour(studies, monkeypatch):
    monkeypatch.setattr(behaviours, "CLIPS", 4)
    waiting = studies[1].manifold
    known = replace(studies[1], manifold=replace(waiting, frames=50))
    for act, label in ACTS.items():
        clips = [behaviours._clip(act, np.random.default_rng(n), 50) for n in range(6)]
        counts = count_behaviours(known, waiting.normalise(np.array(clips)), 0)
        assert counts.most_common(1)[0][0] == label


def test_samples_of_principal_components_have_as_many_dimensions_as_z(studies):
    clips = sample_clips(studies[0], PRINCIPAL, 30, 0).reshape(30, -1)
    latent = studies[0].manifold.network.latent
    assert np.linalg.matrix_rank(clips - clips.mean(axis=0), tol=1e-2) <= latent


def test_true_frames_have_the_loss_of_the_decoder_on_a_clip_it_predicts(studies):
    """Where the decoder's own frames are the true ones, both ways have one loss."""
    network = studies[0].manifold.network
    model = SequentialAutoencoder(network.features, network.hidden, network.latent)
    z = np.random.default_rng(0).normal(size=(3, 4)).astype(np.float32)
    x = model.decode(z, 10)
    forced = TrueFrames(model)
    forced.encode_with_pullback = lambda clips: (z, lambda dz: dict.fromkeys(model.weights, 0.0))
    losses, gradients = forced.loss_and_gradients(x, z, np.eye(4, dtype=np.float32), 0.0)
    assert losses.reconstruction < 1e-10
    assert list(gradients) == list(model.weights)


def test_a_decoder_without_input_does_not_depend_on_its_frames():
    model = NoInput(SequentialAutoencoder(features=5, hidden=6, latent=2))
    z = np.zeros((1, 2), np.float32)
    before = model.decode(z, 4)
    model.weights["frame_b"] += 1
    np.testing.assert_allclose(model.decode(z, 4), before + 1, rtol=1e-5)


def test_the_same_order_reads_the_last_frame_first():
    model = SequentialAutoencoder(features=5, hidden=6, latent=2)
    x = np.random.default_rng(0).normal(size=(2, 7, 5)).astype(np.float32)
    np.testing.assert_allclose(SameOrder(model).encode(x), model.encode(x[:, ::-1]), atol=1e-6)


def test_choices_of_the_sequential_network_are_compared():
    result = sequence_choices.run(seeds=1, steps=10, minutes=0.2, names=("walking",))
    (table,) = result.tables
    assert table.value(AS_PAPER, "walking") != table.value(NO_INPUT, "walking")
    assert [claim.key for claim in result.claims] == ["target_reversed", "guess_fed_back"]


@pytest.mark.parametrize(("first", "is_natural"), [(0.6, True), (0.8, False)])
def test_the_regulariser_has_to_help_each_action(first, is_natural):
    told = {samples.SLICED: [first, 0.6], samples.MMD: [0.9, 0.9], samples.NONE: [0.7, 0.8]}
    claim = samples._claim_of_regulariser(told)
    assert claim.fulfilled is is_natural and not claim.fulfilled_by
