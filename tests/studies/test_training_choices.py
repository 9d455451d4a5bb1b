"""Studies that train small networks: that they compare what they say."""

import numpy as np
import pytest

from numpy_cae import ops
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder, ConvLayer
from numpy_cae.training import recipe
from numpy_cae.verify import check_gradients
from studies import scaling
from studies.shared.judging import seeds_below
from studies.shared.small_networks import EvenlyUnpooled
from studies.training_choices import (
    ALPHA_OF_NORMS,
    STAGES,
    FirstLayer,
    MeanPooled,
    _compare_layers,
    mean_pooled,
    plain,
    shortened,
)


def test_alpha_of_norms_has_the_gradients_of_norms():
    """The loss of means is the paper's, divided by the number of values of the input."""
    rng = np.random.default_rng(0)
    x = rng.normal(size=(160, 63))
    y = rng.normal(size=(80, 64))
    sums = np.sum(x**2) + 0.01 * np.sum(np.abs(y))
    squared, _ = ops.mean_squared_error(x, np.zeros_like(x))
    absolute, _ = ops.mean_absolute(y)
    assert squared + ALPHA_OF_NORMS * absolute == pytest.approx(sums / x.size)


def test_evenly_unpooled_layers_do_not_use_the_mask():
    model = ConvAutoencoder(features=5, filters=(6,), taps=3)
    x = np.random.default_rng(0).normal(size=(2, 16, 5)).astype(np.float32)
    mask = [np.random.default_rng(1).random((2, 8, 6)) < 0.5]
    even, _ = EvenlyUnpooled(accelerate(model)).loss_and_gradients(x, x, first=mask, layer=0)
    expected, _ = model.loss_and_gradients(x, x, layer=0)
    assert even == pytest.approx(expected, rel=1e-5)


def test_the_mean_of_pairs_has_the_right_gradient():
    def encode(x, w, b):
        return MeanPooled(w, b, 0.9).encode_with_pullback(x)

    rng = np.random.default_rng(0)
    x = rng.normal(size=(2, 8, 2))
    check_gradients(encode, x, rng.normal(size=(3, 2, 4)), rng.normal(size=4))


def test_engines_share_the_weights():
    model = accelerate(ConvAutoencoder(features=5, filters=(6,), taps=3))
    for engine in (plain, mean_pooled):
        assert engine(model).layers[0].w is model.layers[0].w
    assert type(plain(model).layers[0]) is ConvLayer


def test_a_shortened_schedule_trains_no_layer_that_was_not_trained():
    assert shortened(recipe("fast"), 2).layer.epochs == 0
    assert shortened(recipe("paper"), 2).layer.epochs == 2


def test_seeds_that_differ_do_not_decide():
    assert seeds_below([1, 2], [3, 4]) is True
    assert seeds_below([1, 5], [3, 4]) is None


def test_epochs_of_fine_tuning_follow_from_the_minutes():
    layers = [scaling.PAPER_MINUTES[f"layer {n}"] for n in (1, 2, 3)]
    epoch = sum(layers) / 25
    assert round(scaling.PAPER_MINUTES["fine tuning"] / epoch) == scaling.FINE_TUNING_EPOCHS


def test_each_stage_of_the_training_is_timed():
    seconds = scaling.time_steps(8)
    assert set(seconds) == set(scaling.PAPER_MINUTES)


def test_layers_are_compared_number_by_number_and_seed_by_seed():
    sparse = [FirstLayer(0.1, 8.0, 5.0), FirstLayer(0.2, 9.0, 5.0)]
    free = [FirstLayer(0.3, 8.5, 5.0), FirstLayer(0.3, 8.5, 6.0)]
    assert _compare_layers(sparse, free) == (True, None, None)


def test_features_are_measured_before_and_after_fine_tuning(result_of):
    claims = result_of("training_choices").claims
    for key in ("sparsity_independent", "sparsity_local"):
        assert [claim.of for claim in claims if claim.key == key] == list(STAGES)
