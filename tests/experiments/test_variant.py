"""The variants of the paper's network: one equals it, and all gradients are those of differences."""

import numpy as np
import pytest

from numpy_cae import ops
from numpy_cae.experiments.ablation.average_pool import average_pool
from numpy_cae.experiments.ablation.variant import VariantAutoencoder
from numpy_cae.models import ConvAutoencoder
from numpy_cae.verify import check_gradients

TINY = {"features": 3, "filters": (2, 3), "taps": 3, "dtype": np.float64}


def drawn(model, seed=0):
    """Windows, their corruption and masks; the biases drawn too, lest one be forgotten unseen."""
    rng = np.random.default_rng(seed)
    for layer in model.layers:
        for array in layer.parameters.values():
            array[...] = rng.normal(scale=0.4, size=array.shape)
    x = rng.normal(scale=0.5, size=(2, 8, 3))
    first = [rng.random((2, 8 >> (k + 1), n)) < 0.5 for k, n in enumerate(TINY["filters"])]
    return x, x * (rng.random(x.shape) > 0.1), first


def test_with_the_maximum_and_tied_weights_it_is_the_papers_network():
    paper = ConvAutoencoder(**TINY, rng=np.random.default_rng(1))
    variant = VariantAutoencoder(**TINY, rng=np.random.default_rng(1))
    for one, other in zip(paper.layers, variant.layers, strict=True):
        np.testing.assert_array_equal(one.w, other.w)  # the same first weights
    x, corrupted, first = drawn(paper)
    drawn(variant)
    np.testing.assert_allclose(variant.project(x), paper.project(x))
    for masks in (first, None):
        loss, gradients = paper.loss_and_gradients(x, corrupted, 0.3, masks)
        found, own = variant.loss_and_gradients(x, corrupted, 0.3, masks)
        assert found == pytest.approx(loss, rel=1e-12)
        for both in zip(gradients, own, strict=True):
            for a, b in zip(*both, strict=True):
                np.testing.assert_allclose(a, b, atol=1e-12)


def test_untied_gradients_add_up_to_the_tied_ones_where_the_filters_are_the_same():
    tied = VariantAutoencoder(**TINY, pool=average_pool)
    untied = VariantAutoencoder(**TINY, pool=average_pool, tied=False)
    x, corrupted, _ = drawn(tied)
    for one, other in zip(tied.layers, untied.layers, strict=True):
        other.w[...], other.b[...], other.c[...] = one.w, one.b, one.b
        other.v[...], _ = ops.transpose_filters(one.w)
    loss, of_tied = tied.loss_and_gradients(x, corrupted, 0.3)
    again, of_untied = untied.loss_and_gradients(x, corrupted, 0.3)
    assert again == pytest.approx(loss, rel=1e-12)
    for (dw, db), (du, dc, dv, de) in zip(of_tied, of_untied, strict=True):
        np.testing.assert_allclose(dw, du + ops.transpose_filters(dv)[0], atol=1e-12)
        np.testing.assert_allclose(db, dc + de, atol=1e-12)


@pytest.mark.parametrize("unpooling", ["random", "even"])
@pytest.mark.parametrize("layer", [None, 0])
@pytest.mark.parametrize("pool", [ops.max_pool, average_pool])
@pytest.mark.parametrize("tied", [True, False])
def test_its_gradients_are_those_of_differences(tied, pool, layer, unpooling):
    model = VariantAutoencoder(**TINY, tied=tied, pool=pool)
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
