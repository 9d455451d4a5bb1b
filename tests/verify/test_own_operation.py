"""`properties_of` for operations of one's own, right and wrong, and adapters for layers."""

import inspect

import numpy as np
import pytest
from failing_properties import failing
from own_operations import OWN_OPERATIONS
from written_otherwise import conv1d_by_fft

from numpy_cae import ops, verify
from numpy_cae.verify.grading.report import holds
from numpy_cae.verify.operations.counterexample import failing_case
from numpy_cae.verify.operations.operation_catalogue import CATALOGUE
from numpy_cae.verify.operations.trial import try_property

SHAPES = {
    "linear": {"x": "... channels", "w": "channels features", "b": "features"},
    "max_pool": {"x": "batch 2*frames channels"},
}


@pytest.mark.parametrize("name", SHAPES)
def test_right_operations_hold_without_and_with_a_definition(name):
    f = getattr(ops, name)
    for definition in (None, f):
        stated = verify.properties_of(f, SHAPES[name], definition)
        assert ("value" in [prop.name for prop in stated]) == (definition is not None)
        part = slice(definition is None, None, 4)
        assert failing(f, SHAPES[name], part, definition=definition) == []


each_operation = pytest.mark.parametrize(
    "operation", OWN_OPERATIONS, ids=lambda own: own.function.__name__
)


@each_operation
def test_an_operation_of_ones_own_holds_once_it_is_fixed(operation):
    assert failing(operation.version(fixed=True), operation.shapes, slice(0, None, 5)) == []


@each_operation
def test_a_wrong_operation_of_ones_own_fails_in_its_property(operation):
    f = operation.version(fixed=False)
    stated = {prop.name: prop for prop in verify.properties_of(f, operation.shapes)}
    assert failing_case(stated[operation.failing], f) is not None


def test_an_array_that_is_returned_again_is_named():
    (operation,) = (own for own in OWN_OPERATIONS if own.failing == "independence")
    f = operation.version(fixed=False)
    independence = verify.properties_of(f, operation.shapes)[-1]
    assert try_property(independence, f).mistake == operation.mistake


def normalised(x, gain, epsilon=1e-5):
    centred = x - x.mean(axis=-1, keepdims=True)
    deviation = np.sqrt(np.mean(centred**2, axis=-1, keepdims=True) + epsilon)
    n = centred / deviation

    def pullback(dy):
        dn = dy * gain
        along = n * np.mean(dn * n, axis=-1, keepdims=True)
        dgain = np.sum(dy * n, axis=tuple(range(x.ndim - 1)))
        return (dn - dn.mean(axis=-1, keepdims=True) - along) / deviation, dgain

    return gain * n, pullback


def by_buffer(x, w):
    buffer = np.empty(x.shape, np.float32)
    buffer[...] = x
    return buffer @ w, lambda dy: (dy @ w.T, buffer.astype(x.dtype).T @ dy)


def to_buffers(x, w):
    return (x @ w).astype("f4").astype("f8"), lambda dy: ((dy @ w.T).astype("f4") + 0 * x, x.T @ dy)


def first_column(x):
    return x[:, :1] + 0, lambda dy: np.pad(dy, ((0, 0), (0, x.shape[1] - 1)))


def single(f):
    """A layer that computes in float32 only."""

    def layer(*arrays):
        value, pullback = f(*(array.astype(np.float32) for array in arrays))
        return value, lambda dy: pullback(dy.astype(np.float32))

    return layer


LAYER = {"x": "... channels", "gain": "channels"}
SINGLE = {"dtypes": ["float32"]}


@pytest.mark.parametrize(
    ("f", "shapes", "options"),
    [
        (normalised, LAYER, {"sizes": {"channels": (4, 8, 16)}}),
        (lambda x, gain: normalised(x, gain, 1e-8), LAYER, {"sizes": {"channels": (2, 3, 4)}}),
        (by_buffer, {"x": "n c", "w": "c d"}, {"skip": ["dtype"]}),
        (to_buffers, {"x": "n c", "w": "c d"}, {"skip": ["dtype"]}),
        (ops.sigmoid, {"x": "batch channels"}, {"values": {"x": (-1000, 1000)}}),
        (single(normalised), LAYER, SINGLE),
        (single(ops.max_pool), {"x": "batch 2*frames channels"}, SINGLE),
        (first_column, {"x": "n in + out"}, {}),
    ],
)
@pytest.mark.parametrize(
    ("seed", "part"),
    [
        (0, slice(0, None, 4)),
        pytest.param(0, slice(None), marks=pytest.mark.thorough),
        pytest.param(1, slice(None), marks=pytest.mark.thorough),
    ],
)
def test_a_right_layer_is_right_with_any_seed(f, shapes, options, seed, part):
    assert failing(f, shapes, part, seed=seed, **options) == []


def test_cases_do_not_depend_on_the_name():
    functions = (normalised, lambda *arrays: normalised(*arrays))
    named, unnamed = (verify.properties_of(f, LAYER)[0].cases() for f in functions)
    assert named == unnamed != verify.properties_of(normalised, LAYER, seed=1)[0].cases()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_value_that_is_not_finite_fails_and_says_so(value):
    f = lambda x: (np.full_like(x, value), lambda dy: 0 * dy)  # noqa: E731
    everything_else = ["strides", "dtype", "purity", "independence"]
    assert failing(f, {"x": "n"}) == ["gradient for x", "ties", *everything_else]
    with pytest.raises(AssertionError, match=rf"the value is {value} at index \(0,\): it has to"):
        verify.check_gradients(f, np.ones(2))
    of_a = lambda a, b: (a * b, lambda dy: (np.nan * a, dy * a))  # noqa: E731
    assert "gradient for b" not in failing(of_a, {"a": "n", "b": "n"})


def test_what_the_caller_draws_is_never_altered():
    def chosen(x, rows, ids):
        assert (np.sort(rows)[:, :-1] == 0).all() and (rows.max(axis=1) == 1).all()
        assert ids.dtype == int
        return x * rows + ids, lambda dy: dy * rows

    def one_hot(rng, shape):
        return np.eye(shape[1])[rng.integers(shape[1], size=shape[0])]

    values = {"rows": one_hot, "ids": lambda rng, shape: rng.integers(9, size=shape)}
    shapes = {"x": "n c", "rows": "n c", "ids": "n c"}
    assert failing(chosen, shapes, values=values, differentiable=["x"], skip=["dtype"]) == []
    assert "dtype" in failing(chosen, shapes, values=values, differentiable=["x"])


class Dense:
    """A layer that draws its weights, and updates them in `backward` with a rate of 1."""

    def __init__(self):
        self.params = {"w": np.random.randn(3, 2)}  # noqa: NPY002

    def forward(self, x, training=False):
        self.x = x
        self.mask = np.random.rand(*x.shape) > 0.5 if training else 1  # noqa: NPY002
        return (x * self.mask) @ self.params["w"]

    def backward(self, dy):
        dx = dy @ self.params["w"].T * self.mask
        self.params["w"] = self.params["w"] - (self.x * self.mask).T @ dy
        return dx


def test_adapters_keep_the_random_numbers_and_use_an_object_twice():
    def dense(x, w, make=Dense):
        forward = lambda layer, x: layer.forward(x, training=True)  # noqa: E731
        return verify.of_layer(make, x, weights={"params.w": w}, forward=forward)

    shapes = {"x": "n c", "w": "c d"}
    every_third = slice(0, None, 3)
    assert failing(dense, shapes, every_third, skip=["dtype"]) == []

    class Stale(Dense):
        def forward(self, x, training=False):
            self.count = getattr(self, "count", 0) + 1
            return super().forward(x, training) * self.count

    stale = lambda x, w: dense(x, w, Stale)  # noqa: E731
    outcome = try_property(verify.properties_of(stale, shapes)[0], stale)
    assert "used a second time, the layer returns another value" in outcome.problem
    backward = lambda dy, cache: (dy @ cache[1].T, cache[0].T @ dy)  # noqa: E731
    cached = verify.of_cache(lambda x, w: (x @ w, (x, w)), backward)
    assert failing(cached, shapes, every_third) == []


def test_the_call_that_a_report_prints_returns_the_example():
    @verify.operation_test(shapes={"x": "rows columns"}, sizes={"rows": (33,), "columns": (8,)})
    def test_layer(x):
        return 2 * x, lambda dy: 3 * dy

    printed = try_property(test_layer.operation_test[0], test_layer).counterexample.splitlines()[-1]
    example = eval(printed, {"example": verify.example, "test_layer": test_layer})
    assert example.arguments["x"].shape == (33, 8)


def test_the_line_of_an_error_is_that_of_the_layers_own_file(tmp_path):
    space = {}
    source = "def forward(x):\n    return x.wrong\n"
    exec(compile(source, str(tmp_path / "layer.py"), "exec"), space)
    f = lambda x: (space["forward"](x), None)  # noqa: E731
    outcome = try_property(verify.properties_of(f, {"x": "n"})[0], f)
    assert outcome.crashed and outcome.problem.endswith("(layer.py, line 2)")


def test_a_fourier_transform_that_wraps_around_is_found():
    source = inspect.getsource(conv1d_by_fft).removeprefix('@right("conv1d")\n')
    assert "frames + 2 * taps" in source
    space = {"np": np}
    exec(source.replace("frames + 2 * taps", "1 << frames.bit_length()"), space)
    assert not holds(CATALOGUE["conv1d"], space["conv1d_by_fft"])


@pytest.mark.parametrize(
    ("shapes", "options", "problem"),
    [
        ({"x": "batch classes"}, {"sizes": {"taps": (1, 3)}}, "shapes has no taps, only x"),
        ({"x": "batch classes"}, {"skip": ["shape"]}, "list of properties has no shape, only grad"),
        ({"x": "batch values"}, {}, "x has the size 'values'; a size is a name"),
        ({"x": "batch 2/classes"}, {}, "x has the size '2/classes'; a size is a name"),
    ],
)
def test_what_cannot_be_read_is_refused(shapes, options, problem):
    with pytest.raises(ValueError, match=f"tanh: {problem}|tanh: the {problem}"):
        verify.properties_of(ops.tanh, shapes, **options)


def test_a_gradient_that_is_not_finite_fails_in_every_property():
    f = lambda x: (2 * x, lambda dy: np.nan * dy)  # noqa: E731
    stated = verify.properties_of(f, {"x": "n"})
    assert failing(f, {"x": "n"}) == [prop.name for prop in stated]


def normalise(x):
    """Each row divided by its length, whose gradient for float32 has a factor of float64."""
    count = np.prod(x.shape[-1:])
    size = np.sqrt((x * x).mean(axis=-1, keepdims=True) + np.float32(1))
    y = x / size

    def pullback(dy):
        return np.float64(1) * (dy - y * (y * dy).sum(axis=-1, keepdims=True) / count) / size

    return y, pullback


def test_results_of_float64_have_the_tolerance_of_the_float32_that_went_in():
    assert failing(normalise, {"x": "batch channels"}, dtypes=("float32",)) == []


def noisy(size):
    """Twice x, with a gradient that differs from call to call, as that of an iterative solver."""
    rng = np.random.default_rng(0)
    return lambda x: (2 * x, lambda dy: 2 * dy * (1 + size * rng.uniform(-1, 1)))


def test_repeated_results_may_differ_by_the_nondeterminism_that_is_stated():
    assert "linearity" in failing(noisy(1e-8), {"x": "n"})
    assert failing(noisy(1e-8), {"x": "n"}, nondeterminism=1e-6) == []
    assert "linearity" in failing(noisy(1e-4), {"x": "n"}, nondeterminism=1e-6)


def test_properties_are_tried_on_as_many_cases_as_are_stated():
    stated = verify.properties_of(noisy(0), {"x": "n"}, cases=3)
    assert {len(prop.cases()) for prop in stated} == {3}
    with pytest.raises(ValueError, match="cases is 0, expected at least 1"):
        verify.properties_of(noisy(0), {"x": "n"}, cases=0)


def product_with(of_pullback):
    """A matrix product, whose pullback for x uses a function of the matrix."""
    return lambda a, x: (a @ x, lambda dy: (np.outer(dy, x), of_pullback(a) @ dy))


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_the_dot_test_is_a_property_of_a_linear_operator(dtype):
    shapes = {"a": "rows rows", "x": "rows"}
    options = {"linear": True, "dtypes": (dtype,)}
    stated = verify.properties_of(product_with(np.transpose), shapes, **options)
    names = [prop.name for prop in stated]
    assert "adjoint in a" in names and "adjoint in x" in names
    assert failing(product_with(np.transpose), shapes, **options) == []
    assert "adjoint in x" in failing(product_with(np.array), shapes, **options)


def weighted(x, gain):
    rows = tuple(range(x.ndim - 1))
    return x * gain, lambda dy: (dy * gain, np.sum(dy * x, axis=rows))


WEIGHTED = {"x": "... channels", "gain": "channels"}


def test_only_the_properties_that_are_named_are_returned():
    stated = verify.properties_of(weighted, WEIGHTED, only=["purity", "gradient for gain"])
    assert [prop.name for prop in stated] == ["gradient for gain", "purity"]


def test_a_property_in_only_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="has no gradient for w"):
        verify.properties_of(weighted, WEIGHTED, only=["gradient for w"])


def test_empty_arrays_and_arrays_without_axes_are_drawn():
    empty = ["channels", "..."]
    names = ["empty in channels", "without axes"]
    assert failing(weighted, WEIGHTED, empty=empty, only=names) == []


def test_a_mean_over_nothing_is_found():
    def mean(x):
        return np.mean(x, axis=0), lambda dy: np.broadcast_to(dy / len(x), x.shape)

    shapes = {"x": "batch channels"}
    with np.errstate(invalid="ignore"), pytest.warns(RuntimeWarning):
        assert failing(mean, shapes, empty=["batch"]) == ["empty in batch"]


def test_an_operation_that_needs_an_axis_is_found():
    def first(x):
        return x[:1], lambda dy: np.concatenate([dy, np.zeros_like(x[1:])])

    assert failing(first, {"x": "..."}, empty=["..."]) == ["without axes"]


def test_a_size_in_empty_that_does_not_exist_is_refused():
    with pytest.raises(ValueError, match="shapes has no batch"):
        verify.properties_of(weighted, {"x": "rows", "gain": "rows"}, empty=["batch"])
