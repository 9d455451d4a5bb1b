"""Completion by several methods: what is left out, how they are weighed, and what is returned."""

import numpy as np
import pytest

from numpy_cae.manifold import weighted_completion
from numpy_cae.manifold.probabilistic_pca import ProbabilisticPCA
from numpy_cae.manifold.weighted_completion import (
    CLASSES,
    LEFT_OUT,
    MOST_TRIALS,
    NEAR,
    OTHER_CLASSES,
    TRIAL_COLUMNS,
    TRIAL_VALUES,
    candidates_of,
    classify,
    complete_weighted,
    leave_out,
    leave_out_columns,
    minimise_on_simplex,
    refine,
    weigh,
)
from numpy_cae.training import Windows


def project_nothing(x, _averaged):
    """A projection that is the mean pose."""
    return np.zeros_like(x)


def draw_motion(frames=90):
    """Eight columns that are mixtures of three sines, (frames, 8)."""
    sines = np.sin(np.arange(frames)[:, None] / [5.0, 8.0, 13.0] + [0.0, 1.0, 2.0])
    return sines @ np.random.default_rng(7).normal(size=(3, 8))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_known_values_and_the_dtype_are_those_given(dtype):
    x = draw_motion().astype(dtype)
    known = np.random.default_rng(0).random(x.shape) < 0.4
    completed = complete_weighted(x, known, project_nothing)
    assert completed.dtype == dtype
    np.testing.assert_array_equal(completed[known], x[known])


def test_a_known_motion_is_returned_as_a_copy():
    x = draw_motion()
    completed = complete_weighted(x, np.ones(x.shape, bool), project_nothing)
    np.testing.assert_array_equal(completed, x)
    assert not np.shares_memory(completed, x)


@pytest.mark.parametrize("frames", [1, 2, 90])
@pytest.mark.parametrize("known_values", [0, 1])
def test_few_known_values_give_finite_numbers(frames, known_values):
    x = draw_motion(frames)
    known = np.zeros(x.shape, bool)
    known[: min(known_values, frames), 3] = True
    completed = complete_weighted(x, known, project_nothing)
    assert np.isfinite(completed).all()
    np.testing.assert_array_equal(completed[known], x[known])


def test_a_column_without_a_known_value_is_not_the_mean_pose_where_the_network_knows_better():
    x = draw_motion()
    known = np.random.default_rng(0).random(x.shape) < 0.7
    known[:, 5] = False
    completed = complete_weighted(x, known, lambda values, _: np.broadcast_to(x, values.shape))
    assert np.abs(completed - x)[:, 5].max() < 0.2 * np.abs(x[:, 5]).max()


@pytest.mark.parametrize("share", [0.2, 0.5])
def test_a_network_that_knows_nothing_costs_little(share):
    """Beside the best candidate, which is then the second."""
    x = draw_motion(600)
    known = np.random.default_rng(0).random(x.shape) < share
    candidates = candidates_of(np.where(known, x, 0.0), known, project_nothing)
    errors = np.sqrt(np.mean((candidates - x)[:, ~known] ** 2, axis=1))
    completed = complete_weighted(x, known, project_nothing)
    assert np.sqrt(np.mean((completed - x)[~known] ** 2)) < 1.2 * errors[1]
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize(("frames", "trials"), [(60, MOST_TRIALS), (3000, 1)])
def test_a_short_motion_has_more_trials(frames, trials, monkeypatch):
    drawn = []

    def count(*arguments):
        drawn.append(leave_out(*arguments))
        return drawn[-1]

    monkeypatch.setattr(weighted_completion, "leave_out", count)
    x = draw_motion(frames)
    known = np.random.default_rng(0).random(x.shape) < 0.5
    complete_weighted(x, known, None)
    assert len(drawn) == trials
    assert (np.count_nonzero(drawn) >= TRIAL_VALUES) == (trials < MOST_TRIALS)


def test_a_column_without_a_known_value_is_not_refined():
    x = draw_motion()
    known = np.random.default_rng(0).random(x.shape) < 0.5
    known[:, 5] = False
    start = np.where(known, x, 0.1)
    refined = refine(np.where(known, x, 0.0), known, start, np.where(known, 0.0, 0.5))
    np.testing.assert_array_equal(refined[:, 5], start[:, 5])
    np.testing.assert_array_equal(refined[known], x[known])
    assert np.abs(refined - x)[:, :5].mean() < 0.5 * np.abs(start - x)[:, :5].mean()


def test_what_the_principal_components_miss_is_added():
    """At every second value known, of motions that the components leave half of."""
    frames = draw_motion(400)
    windows = Windows(frames[:300], np.arange(0, 261, 40), 40)
    context = ProbabilisticPCA.fit(windows, np.ones(300, bool))
    half = ProbabilisticPCA(context.mean, 0.1 * context.axes, 10.0)
    known = np.random.default_rng(0).random((100, 8)) < 0.5
    x = np.where(known, frames[300:], 0.0)
    candidates = candidates_of(x, known, None, half)[2:4]
    for estimate, candidate in zip(half.estimate(x, known), candidates, strict=True):
        np.testing.assert_array_equal(candidate[known], x[known])
        off = np.abs(candidate - frames[300:])[~known].mean()
        assert off < 0.2 * np.abs(estimate - frames[300:])[~known].mean()


def test_about_a_tenth_of_single_values_is_left_out():
    known = np.random.default_rng(0).random((300, 20)) < 0.5
    known[:, :2] = True
    known[:, 2] = False
    left_out = leave_out(known, np.random.default_rng(1))
    assert not left_out[~known].any()
    assert not left_out[:, :3].any()
    share = left_out.sum() / known[:, 3:].sum()
    assert share == pytest.approx(LEFT_OUT, abs=0.02)


def test_holes_of_a_joint_are_left_out_in_all_of_its_columns():
    known = np.ones((200, 6), bool)
    for start in (20, 80, 140):
        known[start : start + 15, 3:] = False
    left_out = leave_out(known, np.random.default_rng(0))
    assert not left_out[:, :3].any()
    assert left_out[:, 3].any()
    for column in (4, 5):
        np.testing.assert_array_equal(left_out[:, column], left_out[:, 3])


def test_at_least_half_of_the_known_values_of_a_column_remain():
    known = np.zeros((100, 4), bool)
    known[:20, :2] = True
    known[::2, 2:] = True
    for seed in range(20):
        left_out = leave_out(known, np.random.default_rng(seed))
        assert np.all(left_out.sum(axis=0) <= known.sum(axis=0) / 2)


def test_weights_are_those_of_least_squares_by_trying_all():
    rng = np.random.default_rng(0)
    errors = rng.normal(size=(3, 50)) * [[1.0], [0.7], [2.0]]
    products = errors @ errors.T
    best = minimise_on_simplex(products)
    steps = np.linspace(0, 1, 101)
    first, second = np.meshgrid(steps, steps)
    inside = first + second <= 1 + 1e-9
    tried = np.stack([first[inside], second[inside], 1 - first[inside] - second[inside]])
    costs = np.einsum("in,ij,jn->n", tried, products, tried)
    assert best @ products @ best <= costs.min() + 1e-9
    np.testing.assert_allclose(best.sum(), 1)
    assert np.all(best >= 0)


def test_the_curve_counts_only_near_known_values():
    errors = np.array([[0.1], [1.0], [2.0]]) * np.random.default_rng(0).normal(size=(3, 500))
    weights = weigh(errors, np.full(500, NEAR))
    near = classify(np.array(NEAR))
    assert np.all(weights[0, : near + 1] > 0.9)
    assert not weights[0, near + 1 :].any()
    np.testing.assert_allclose(weights.sum(axis=0), 1)


def test_classes_of_distances():
    assert classify(np.array([1, 2, 3, 4, 5, 8, 9, 10**6])).tolist() == [0, 1, 2, 2, 3, 3, 4, 4]
    assert len(CLASSES) == 4


def test_values_of_other_classes_count_less_where_a_class_has_many(monkeypatch):
    """Candidate 1 is right near known values, candidate 2 far from them."""
    rng = np.random.default_rng(0)
    errors = rng.normal(size=(3, 4000))
    distances = np.repeat([1, 20], 2000)
    errors[1, :2000] *= 0.01
    errors[2, 2000:] *= 0.01
    weights = weigh(errors, distances)
    assert weights[1, 0] > 0.9
    assert weights[2, 4] > 0.9
    monkeypatch.setattr(weighted_completion, "OTHER_CLASSES", 1000 * OTHER_CLASSES)
    assert weigh(errors, distances)[1, 0] < 0.7


@pytest.mark.parametrize("missing", [0, 3, 12, 40, 63])
def test_columns_are_left_out_as_those_without_values_are_missing(missing):
    has_values = np.ones(63, bool)
    has_values[20 : 20 + missing] = False
    left_out = leave_out_columns(has_values, np.random.default_rng(0))
    assert not np.any(left_out & ~has_values)
    count = np.count_nonzero(left_out)
    assert count <= np.count_nonzero(has_values) / 2
    if missing in (3, 12):
        assert count >= TRIAL_COLUMNS
    if missing == 0:
        assert count == 0


def test_a_column_without_values_is_from_the_candidate_that_knows_the_other_columns():
    """A network that knows nothing, and a context of motions like this one."""
    frames = np.tile(draw_motion(400), (1, 8))
    frames += 0.01 * np.random.default_rng(1).normal(size=frames.shape)
    windows = Windows(frames[:300], np.arange(0, 261, 40), 40)
    context = ProbabilisticPCA.fit(windows, np.ones(300, bool))
    known = np.ones((100, frames.shape[1]), bool)
    known[:, 5:8] = False
    completed = complete_weighted(frames[300:], known, project_nothing, context)
    off = (completed - frames[300:])[:, 5:8]
    assert np.sqrt(np.mean(off**2)) < 0.1 * frames[:, 5:8].std()
