"""A failing gradient check names the likely mistake from the numbers alone, without the zoo."""

import numpy as np
import pytest

from numpy_cae import ops
from numpy_cae.verify import check_gradients
from numpy_cae.verify.case import Case
from numpy_cae.verify.operation import OPERATIONS
from numpy_cae.verify.zoo import BUGS

SIZES = {
    "batch": 3,
    "frames": 6,
    "channels": 2,
    "filters": 2,
    "taps": 5,
    "features": 2,
    "axes": 2,
    "hidden": 2,
    "points": 5,
    "dimensions": 2,
    "directions": 3,
}

BY_NAME = {bug.name: bug for bug in BUGS}


def report_on(bug, sizes=SIZES):
    operation = OPERATIONS[bug.operation]
    case = Case(tuple((name, sizes[name]) for name in operation.sizes), seed=4)
    arguments = operation.arguments(case)
    names = operation.differentiated

    def f(*inputs):
        replaced = {**arguments, **dict(zip(names, inputs, strict=True))}
        return bug.implementation(*(np.copy(a) for a in replaced.values()))

    with pytest.raises(AssertionError) as failure:
        check_gradients(f, *(arguments[name] for name in names), names=names)
    return str(failure.value)


@pytest.mark.parametrize(
    ("name", "mistake"),
    [
        ("squared_sign_lost", "Likely mistake: the sign"),
        ("squared_without_two", "a factor of 2 too little"),
        ("even_pullback_without_half", "a factor of 2 too much"),
        ("squared_without_count", "a factor of N = 36, the number of entries"),
        ("squared_ignores_upstream", "the upstream number is not used"),
        ("conv_bias_averaged", "a factor of 3, the length of the batch (a mean for a sum"),
        ("gru_weights_averaged", "a factor of 6, the length of time (a mean for a sum"),
        ("linear_bias_averaged", "a factor of 18, the windows times the frames"),
        ("sliced_not_over_directions", "a constant factor, 3, that should be 1"),
        ("filters_pullback_not_exchanged", "a transpose of the last two axes"),
        ("filters_pullback_not_flipped", "the taps are in reverse"),
        ("conv_filters_reversed", "the taps are in reverse"),
        ("conv_without_flip", "the filters are not flipped in time"),
        ("conv_middle_tap_only", "a missing sum over taps: only tap 2 counts"),
        ("conv_gradient_shifted", "off by one in the padding"),
        ("conv_bias_not_over_windows", "a missing sum over the batch: only index 2 of it counts"),
        ("conv_filters_of_last_window", "a missing sum over the batch: only index 2"),
        ("conv_bias_not_over_frames", "a missing sum over time"),
        ("linear_bias_not_over_frames", "a missing sum over time"),
        ("linear_weights_of_last_row", "a missing sum over the batch"),
        ("gru_weights_overwritten", "a missing sum over time, or what is carried along it"),
        ("gru_forgets_the_future", "a missing sum over time, or what is carried along it"),
        ("gru_last_output_only", "a missing sum over time: only index 5 of it counts"),
        ("gru_first_state_dropped", "the gradient of the first state is dropped: h0"),
        ("gru_frames_reversed", "the frames are in reverse"),
        ("gru_skips_a_step", "only frame 0 of 6 is wrong: one time step is left out"),
        (
            "step_without_reset_derivative",
            "a gate's derivative is missing or wrong: only the reset",
        ),
        ("step_without_update_derivative", "a gate's derivative is missing or wrong: only the upd"),
        ("step_biases_alike", "a gate's derivative is missing or wrong: only the new"),
        ("step_gates_exchanged", "the gates reset and update are exchanged"),
        ("step_without_reset_path", "the path through the reset gate is missing"),
        ("one_dimension: sliced_not_scattered_back", "the right numbers in the wrong order"),
        ("pool_gradient_to_loser", "the right numbers in the wrong order"),
        ("tanh_without_derivative", "the upstream gradient is passed on as it is"),
        ("conv_in_float32", "computed in float32"),
    ],
)
def test_the_pattern_shows_the_mistake(name, mistake):
    sizes = {**SIZES, "dimensions": 1, "directions": 1} if "one_dimension" in name else SIZES
    assert mistake in report_on(BY_NAME[name.removeprefix("one_dimension: ")], sizes)


def test_a_transposed_shape():
    def transposed(w):
        return w * 2, lambda dy: 2 * dy.T

    with pytest.raises(AssertionError, match=r"shape \(3, 2\).*\n.*a transpose"):
        check_gradients(transposed, np.ones((2, 3)))


def test_a_gradient_that_was_never_computed():
    with pytest.raises(AssertionError, match=r"is None.*\n.*never computed"):
        check_gradients(lambda w: (w * 2, lambda dy: None), np.ones((2, 3)))


def test_a_gradient_that_is_not_finite():
    def f(x):
        return x * 2, lambda dy: np.where(x > 1, np.nan, 2 * dy)

    with pytest.raises(AssertionError, match=r"for x is nan at index \(1,\)"):
        check_gradients(f, np.array([0.5, 2.0]))


def test_an_altered_argument_is_named():
    def f(x, w):
        y, pullback = ops.linear(x, w, np.zeros(2))

        def altering(dy):
            dx, dw, _ = pullback(dy)
            w[...] = 0
            return dx, dw

        return y, altering

    with pytest.raises(AssertionError, match="w was altered"):
        check_gradients(f, np.ones((4, 3)), np.ones((3, 2)))


def test_the_wrong_number_of_gradients():
    with pytest.raises(AssertionError, match=r"returns 3 .* expected 1"):
        check_gradients(lambda x: ops.linear(x, np.ones((3, 2)), np.ones(2)), np.ones((4, 3)))
