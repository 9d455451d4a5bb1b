"""Both accelerated networks equal their definitions, with any sizes and number of threads."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from numpy_cae.fast import accelerate, fast_conv_autoencoder, fast_sequential_autoencoder
from numpy_cae.fast.thread_team import thread_team
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.training import unit_directions

BOTH = pytest.mark.parametrize("kind", ["conv", "sequential"])


@pytest.fixture(autouse=True)
def always_use_threads(monkeypatch):
    """Small networks would use one thread; here they use as many as they are given."""
    monkeypatch.setattr(fast_conv_autoencoder, "MIN_MULTIPLICATIONS", 0)
    monkeypatch.setattr(fast_sequential_autoencoder, "MIN_STATES_PER_THREAD", 1)


def drawn_conv(
    seed=0, batch=5, filters=(4, 3), taps=5, length=8, unpooling="random", alpha=0.3, features=3
):
    """A model with biases, and the arguments of its methods."""
    rng = np.random.default_rng(seed)
    model = ConvAutoencoder(features, filters, taps, bound=0.9, rng=rng, dtype=np.float64)
    for layer in model.layers:
        layer.w = rng.normal(scale=0.3, size=layer.w.shape)
        layer.b = rng.normal(scale=0.2, size=layer.b.shape)
    frames = length * model.stride
    x = rng.normal(scale=0.5, size=(batch, frames, features))
    corrupted = x * (rng.random(x.shape) > 0.1)
    first = None
    if unpooling == "random":
        shapes = [(batch, frames >> (k + 1), size) for k, size in enumerate(filters)]
        first = [rng.random(shape) < 0.5 for shape in shapes]
    y = 1.5 * model.encode(x)  # beyond the bound of arctanh as well
    return model, (x, y, corrupted, alpha, first)


def drawn_sequential(
    seed=0,
    batch=5,
    frames=6,
    features=3,
    hidden=9,
    latent=2,
    dtype=np.float64,
    burn_in=1,
    written=4,
    weight=0.3,
):
    """The same of a sequential model."""
    rng = np.random.default_rng(seed)
    model = SequentialAutoencoder(features, hidden, latent, rng, dtype, burn_in)
    for name, array in model.weights.items():
        model.weights[name] = rng.normal(scale=0.5, size=array.shape).astype(dtype)
    x = rng.normal(size=(batch, frames, features)).astype(dtype)
    prior = rng.normal(size=(batch, latent)).astype(dtype)
    return model, (x, prior, unit_directions(5, latent, rng, dtype), written, weight)


def drawn(kind, *arguments, **shapes):
    return (drawn_conv if kind == "conv" else drawn_sequential)(*arguments, **shapes)


def weights(model):
    return model.parameters if isinstance(model, ConvAutoencoder) else model.weights


def results(model, arguments):
    """Everything that the methods of a network return, as a list of arrays."""
    if isinstance(model, ConvAutoencoder):
        x, y, corrupted, alpha, first = arguments
        loss, gradients = model.loss_and_gradients(x, corrupted, alpha, first)
        flat = [array for pair in gradients for array in pair]
        encoded = [model.encode(x), model.encode(x, layers=1)]
        return [*encoded, model.decode(y), model.project(x), loss, *flat]
    x, prior, directions, written, weight = arguments
    losses, gradients = model.loss_and_gradients(x, prior, directions, weight)
    assert list(gradients) == list(model.weights)
    decoded = [model.encode(x), model.decode(prior, written), model.denoise(x)]
    return [*decoded, *losses, *gradients.values()]


def assert_same(expected, values, tolerance=1e-10):
    for a, b in zip(expected, values, strict=True):
        assert np.shape(a) == np.shape(b)
        assert np.asarray(a).dtype == np.asarray(b).dtype
        atol = tolerance * max(1.0, np.max(np.abs(a), initial=0))
        np.testing.assert_allclose(b, a, rtol=0, atol=atol)


COMMON = {"seed": st.integers(0, 2**32 - 1), "batch": st.integers(1, 9)}


@settings(max_examples=60, deadline=None)
@given(
    **COMMON,
    filters=st.lists(st.integers(1, 7), min_size=1, max_size=3).map(tuple),
    taps=st.integers(0, 7).map(lambda half: 2 * half + 1),
    length=st.integers(1, 21),
    unpooling=st.sampled_from(["even", "random"]),
    alpha=st.sampled_from([0.0, 0.3]),
    threads=st.integers(1, 3),
)
def test_the_convolutional_network_equals_its_definition(threads, **shapes):
    model, arguments = drawn_conv(**shapes)
    assert_same(results(model, arguments), results(accelerate(model, threads), arguments))


@settings(max_examples=60, deadline=None)
@given(
    **COMMON,
    frames=st.integers(1, 7),
    features=st.integers(1, 5),
    hidden=st.integers(1, 18),
    latent=st.integers(1, 4),
    dtype=st.sampled_from([np.float64, np.float32]),
    burn_in=st.integers(0, 3),
    written=st.integers(1, 9),
    weight=st.sampled_from([0.0, 0.3]),
    threads=st.integers(1, 3),
)
def test_the_sequential_network_equals_its_definition(threads, dtype, **shapes):
    model, arguments = drawn_sequential(dtype=dtype, **shapes)
    tolerance = 1e-10 if dtype == np.float64 else 1e-4
    expected = results(model, arguments)
    assert_same(expected, results(accelerate(model, threads), arguments), tolerance)


@pytest.mark.parametrize(("batch", "unpooling"), [(1, "even"), (5, "random")])
def test_the_papers_convolutional_network_in_float32(batch, unpooling):
    """In float32, as near to float64 as the definition in float32."""
    model, arguments = drawn_conv(0, batch, (64, 128, 256), 15, 20, unpooling, 0.01, 63)
    for layer in model.layers:  # small enough that arctanh is well conditioned
        layer.w *= 0.05
    exact = results(model, arguments)
    for layer in model.layers:
        layer.w, layer.b = layer.w.astype(np.float32), layer.b.astype(np.float32)
    x, y, corrupted, *remaining = arguments
    single = (*(array.astype(np.float32) for array in (x, y, corrupted)), *remaining)
    direct, quick = results(model, single), results(accelerate(model), single)
    for truth, a, b in zip(exact, direct, quick, strict=True):
        assert np.ndim(b) == 0 or b.dtype == np.float32
        size = np.abs(truth).max()
        assert np.abs(b - truth).max() < max(1e-5 * size, 4 * np.abs(a - truth).max())


def test_the_papers_sequential_network_in_float32():
    """50 frames of 54 values, through states that have been fed back fifty times."""
    model, arguments = drawn_sequential(1, 16, 50, 54, 24, 8, np.float32, 0, 50, 0.1)
    for name in model.weights:
        model.weights[name] *= 0.3
    assert_same(results(model, arguments), results(accelerate(model), arguments), 2e-5)


@BOTH
def test_results_do_not_depend_on_earlier_calls_and_are_not_overwritten(kind):
    model, arguments = drawn(kind, 3)
    before = copy.deepcopy((weights(model), arguments))
    fast = accelerate(model, 2)
    first = results(fast, arguments)
    unchanged = copy.deepcopy(first)
    for drawn_model in (drawn(kind, 4), drawn(kind, 5, batch=2), drawn(kind, 6, batch=5)):
        results(fast, drawn_model[1])
    assert_same(unchanged, first, 0)
    assert_same(unchanged, results(fast, arguments), 0)
    np.testing.assert_equal((weights(model), arguments), before)
    strided = [
        np.asfortranarray(argument[:, ::-1])[:, ::-1]
        if isinstance(argument, np.ndarray)
        else argument
        for argument in arguments
    ]
    assert_same(unchanged, results(fast, strided), 1e-12)


@BOTH
def test_the_accelerated_model_shares_the_arrays_and_can_be_copied_and_pickled(kind):
    model, arguments = drawn(kind)
    fast, name = accelerate(model), "layers" if kind == "conv" else "weights"
    assert isinstance(fast, type(model)) and type(fast) is not type(model)
    assert accelerate(fast) is fast
    assert getattr(fast, name) is getattr(model, name)
    z = fast.encode(arguments[0])
    for twin in (copy.deepcopy(fast), pickle.loads(pickle.dumps(fast))):
        np.testing.assert_array_equal(twin.encode(arguments[0]), z)
        for array in weights(twin).values():
            array *= 2
        np.testing.assert_array_equal(fast.encode(arguments[0]), z)
        assert np.abs(twin.encode(arguments[0]) - z).max() > 1e-3
    both = copy.deepcopy({"model": model, "fast": fast})
    assert getattr(both["fast"], name) is getattr(both["model"], name)


def test_a_subclass_with_its_own_loss_is_not_replaced():
    subclassed = type("Other", (SequentialAutoencoder,), {})(3, 5, 2)
    assert accelerate(subclassed) is subclassed


def test_a_pullback_is_valid_after_other_calls():
    model, (x, dz, *_) = drawn_sequential()
    fast = accelerate(model, 2)
    _, pullback = fast.encode_with_pullback(x)
    results(fast, drawn_sequential(9)[1])
    assert_same(model.encode_with_pullback(x)[1](dz).values(), pullback(dz).values())


@BOTH
def test_several_callers_at_once(kind):
    model, arguments = drawn(kind)
    fast = accelerate(model, 2)
    expected = results(fast, arguments)
    with ThreadPoolExecutor(4) as pool:
        for call in [pool.submit(results, fast, arguments) for _ in range(12)]:
            assert_same(expected, call.result(), 0)


@BOTH
def test_many_windows_go_in_parts_and_none_in_none(monkeypatch, kind):
    model, (x, z, *_) = drawn(kind, batch=11)
    monkeypatch.setattr(fast_conv_autoencoder, "MAX_FRAMES", 3 * 16)
    monkeypatch.setattr("numpy_cae.fast.fast_sequential_autoencoder.MAX_CLIPS", 4)
    fast = accelerate(model, 2)
    for count in (11, 0):
        assert_same([model.encode(x[:count])], [fast.encode(x[:count])])
        assert_same([model.decode(z[:count])], [fast.decode(z[:count])])


def test_no_windows_and_no_frames():
    model, _ = drawn_conv()
    for network in (model, accelerate(model)):
        assert network.encode(np.zeros((2, 0, 3))).shape == (2, 0, 3)
        assert network.decode(np.zeros((0, 2, 3))).shape == (0, 8, 3)
        with pytest.raises(ValueError, match="nothing to compare"):
            network.loss_and_gradients(np.zeros((0, 8, 3)), np.zeros((0, 8, 3)))


CHANGES = [
    "layer.w[-1, -1, -1] += 1e-3",
    "layer.w = np.asfortranarray(-1.1 * layer.w)",
    "layer.w[::-1][:, 0] *= 2; layer.b += 1",
    "layer.w, layer.b = layer.w.astype(np.float32), layer.b.astype(np.float32)",
]


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize(("batch", "changed"), [(1, [0]), (5, [1]), (1, [0, 1])])
def test_any_change_of_weights_between_calls_is_seen(monkeypatch, change, batch, changed):
    monkeypatch.setattr(fast_conv_autoencoder, "MAX_FRAMES", 3 * 16)  # batches of 5 in two parts
    model, (x, y, corrupted, *_) = drawn_conv(0, batch)
    fast = accelerate(model, 2)
    original = [(layer.w, layer.b) for layer in model.layers]
    for step in range(3):
        tolerance = 1e-5 if step == 2 and "float32" in change else 1e-10
        assert_same([model.encode(x)], [fast.encode(x)], tolerance)
        assert_same([model.decode(y)], [fast.decode(y)], tolerance)
        if step == 1:
            fast.loss_and_gradients(x, corrupted)
            for number, layer in enumerate(model.layers):
                if number in changed or "float32" in change:
                    exec(change, {"np": np, "layer": layer})
    for layer, (w, b) in zip(model.layers, original, strict=True):
        layer.w, layer.b = w, b  # back to the arrays of an earlier call
    arguments = (x, y, corrupted, 0.0, None)
    assert_same(results(model, arguments), results(fast, arguments))


def test_a_change_of_the_weights_of_a_gru_is_seen():
    model, arguments = drawn_sequential(7)
    fast = accelerate(model)
    for _ in range(2):
        assert_same(results(model, arguments), results(fast, arguments))
        model.weights["encoder_u"][0, 0] += 0.5
        model.weights["decoder_w"] = -model.weights["decoder_w"]
        fast.weights["frame_b"] = fast.weights["frame_b"] + 1


@pytest.mark.parametrize("batch", [1, 5])
def test_weights_that_were_infinite_cause_no_later_warning(batch):
    model, (x, *_) = drawn_conv(0, batch)
    fast, w = accelerate(model, 2), model.layers[0].w
    model.layers[0].w = np.full_like(w, np.inf)
    with np.errstate(all="ignore"):
        fast.encode(x)
    model.layers[0].w = w
    assert_same([model.encode(x)], [fast.encode(x)])


def test_arguments_are_checked():
    fast = accelerate(drawn_conv()[0])
    with pytest.raises(ValueError, match="expected a multiple of 4 frames"):
        fast.encode(np.zeros((1, 6, 3)))
    with pytest.raises(ValueError, match="y has shape"):
        fast.decode(np.zeros((1, 6, 4)))


def test_a_step_uses_the_threads_that_the_caller_states(monkeypatch):
    sizes = []

    def team_of(size):
        sizes.append(size)
        return thread_team(size)

    monkeypatch.setattr(fast_conv_autoencoder, "thread_team", team_of)
    model, (x, _, corrupted, alpha, first) = drawn_conv()
    accelerate(model, 3).loss_and_gradients(x, corrupted, alpha, first)
    assert set(sizes) == {3}
