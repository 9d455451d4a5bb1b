"""The variants of the paper's network: equal weights give equal gradients, and both are checked."""

import numpy as np
import pytest

from numpy_cae.experiments.ablation.variant import (
    average_autoencoder,
    average_pool,
    untied_autoencoder,
)
from numpy_cae.fast import accelerate
from numpy_cae.verify import check_gradients

TINY = {"features": 3, "filters": (2, 3), "taps": 3, "dtype": np.float64}


def drawn(model, seed=0):
    """Windows, their corruption and masks; the biases are drawn too."""
    rng = np.random.default_rng(seed)
    for layer in model.layers:
        for array in layer.parameters.values():
            array[...] = rng.normal(scale=0.4, size=array.shape)
    x = rng.normal(scale=0.5, size=(2, 8, 3))
    first = [rng.random((2, 8 >> (k + 1), n)) < 0.5 for k, n in enumerate(TINY["filters"])]
    return x, x * (rng.random(x.shape) > 0.1), first


@pytest.mark.parametrize(("unpooling", "layer"), [("random", None), ("even", 0)])
@pytest.mark.parametrize("kind", [average_autoencoder, untied_autoencoder])
def test_its_gradients_are_those_of_differences(kind, layer, unpooling):
    model = kind(**TINY)
    assert accelerate(model) is model
    x, corrupted, first = drawn(model, seed=3)
    used = model.layers if layer is None else [model.layers[layer]]
    masks = first[: len(used)] if unpooling == "random" else None
    names = [(each, name) for each in used for name in each.parameters]

    def f(*arrays):
        for (each, name), array in zip(names, arrays, strict=True):
            setattr(each, name, array)
        loss, gradients = model.loss_and_gradients(x, corrupted, 0.3, masks, layer)
        flat = [array for own in gradients for array in own]
        return loss, lambda d: tuple(d * array for array in flat)

    check_gradients(f, *(getattr(each, name) for each, name in names))


def test_average_pool_is_the_mean_of_each_pair():
    x = np.random.default_rng(0).normal(size=(2, 6, 3))
    y, _ = average_pool(x)
    np.testing.assert_allclose(y, (x[:, ::2] + x[:, 1::2]) / 2)
    check_gradients(average_pool, x)
    with pytest.raises(ValueError, match="an even number of frames"):
        average_pool(x[:, :5])
