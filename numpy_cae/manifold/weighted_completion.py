"""Completing a motion by several methods, weighed by what each does in known values left out.

The candidates are:

1. the curve of each column by itself, a Gaussian process over time (`motion.gaussian_process`);
2. this curve, refined: the iteration of `manifold.completion`, in which P predicts each value from
   the others of its frame, by the Gaussian of the frames of this motion; then the frames of the
   result given how certain each interpolated value is (`motion.frame_gaussian`);
3. the estimate by principal components of fifteen successive frames of the training takes, with
   their variance σ² (`manifold.probabilistic_pca`), and the curve of its errors at known values;
4. the estimate with the ridge for takes of another source, and the curve of its errors;
5. the estimate with this ridge, refined as candidate 2 is;
6. the completion by the network, which starts from candidate 1, refined as candidate 2 is.

Without a network there is no candidate 6, without principal components no candidates 3 to 5.

In trials, about a tenth of the known values is left out and completed in the same way, until
`TRIAL_VALUES` values have been left out, at most `MOST_TRIALS` times. With e_ik the errors of
candidate k at the values left out, and `CLASSES` of the distance in frames to the nearest known
value, each class has the weights of least squares

    w = argmin Σ_i (Σ_k w_k e_ik)²,    w_k ≥ 0,    Σ_k w_k = 1

and a completed value is Σ_k w_k x_k. Values of other classes count as `OTHER_CLASSES` values more,
scaled to the mean square of the class. The curve by itself is a candidate where the nearest known
value is near, at most `NEAR` frames away.

Values are left out as they are missing: single values, or holes of columns that are unknown in
the same frames, such as those of a joint (`leave_out`). In a column without a known value the
candidates but the curve are weighed in the same way by their errors in other columns, all of whose
values are left out in a second trial (`leave_out_columns`).
"""

from collections.abc import Callable

import numpy as np

from numpy_cae.fast.thread_team import one_blas_thread
from numpy_cae.manifold.completion import complete, interpolate_gaps
from numpy_cae.manifold.probabilistic_pca import ProbabilisticPCA
from numpy_cae.motion.frame_gaussian import condition_frames, predict_from_others
from numpy_cae.motion.gaussian_process import fit_curves, gap_variances
from numpy_cae.motion.masks import distances_to_known, runs

PREDICTIONS = 8
"""At most so many times the values of the frames of candidates 2, 5 and 6 predict one another."""
CLASSES = (1, 2, 4, 8)
"""Upper ends of classes of distances (frames) to the nearest known value; the last one has none."""
MISSED_LENGTH = 5.0
"""The length ℓ (frames) of the curve of candidates 3 and 4, chosen among 2.5 to 40 on takes of
three sources. Those of largest likelihood are shorter, and no better."""
NEAR = 4
"""The curve by itself is a candidate up to this distance, chosen on files of people among 0, 1, 2,
4 and any (docs/lab_book/completion.md)."""
OTHER_CLASSES = 150
"""Chosen on files of people among 20, 50 and 150."""
LEFT_OUT = 0.1
"""The share of the known values that is left out in a trial."""
TRIAL_VALUES = 800
"""There are no more trials once so many values have been left out."""
MOST_TRIALS = 4
"""With 8 trials and 1,600 values errors are 1 to 3% smaller (docs/lab_book/completion.md)."""
LEAST_LEFT_OUT = 20
"""With fewer values left out there are no weights: the last candidate is taken."""
TRIAL_COLUMNS = 18
"""Columns of the trial for columns without a known value, as many as six joints have, chosen among
9, 18 and 30 on takes of Bandai, CMU and `data_synth`: with those of one joint the weights depend on
which it is."""
LEAST_TRIAL_COLUMNS = 6
"""With fewer columns left out there are no weights: the last candidate is taken."""
MOST_MOVES = 12
"""Columns are left out at most so many times, for `TRIAL_COLUMNS`."""
Project = Callable[[np.ndarray, bool], np.ndarray]
"""The projection by the network of windows (1, T, C), averaged over all shifts or not."""


@one_blas_thread()  # for matrices this small two threads wait longer than they compute
def complete_weighted(
    x: np.ndarray,
    known: np.ndarray,
    project: Project | None,
    context: ProbabilisticPCA | None = None,
    seed: int = 0,
) -> np.ndarray:
    """Complete a motion by the weighed mean of the module's candidates.

    Parameters
    ----------
    x : (T, C) array of float
        Normalised, so that zero is the mean pose. Values where they are unknown are ignored, but
        have to be finite.
    known : (T, C) array of bool
    project : Project, optional
        Where None, there is no candidate of a network.
    context : ProbabilisticPCA, optional
        Where None, there are no candidates 3 to 5. Without both arguments the motion is completed
        by what it knows of itself.
    seed : int
        Draws the values that are left out.

    Returns
    -------
    (T, C) array of the dtype of x
        Known values as they are given.
    """
    if known.all():
        return x.copy()
    values = np.where(known, x, 0.0).astype(np.float64)
    candidates = candidates_of(values, known, project, context)
    rng = np.random.default_rng(seed)
    has_values = np.asarray(known.any(axis=0))
    blended = candidates[-1].copy()

    def errors_of(left_out: np.ndarray) -> np.ndarray:
        remaining = known & ~left_out
        trial = candidates_of(np.where(remaining, values, 0.0), remaining, project, context)
        return (trial - values)[:, left_out]

    errors: list[np.ndarray] = []
    distances: list[np.ndarray] = []
    for _ in range(MOST_TRIALS):
        left_out = leave_out(known, rng)
        if left_out.any():
            errors.append(errors_of(left_out))
            distances.append(distances_to_nearest(known & ~left_out)[left_out])
        if sum(map(len, distances)) >= TRIAL_VALUES:
            break
    if sum(map(len, distances)) >= LEAST_LEFT_OUT:
        weights = weigh(np.concatenate(errors, axis=1), np.concatenate(distances))
        of_value = weights[:, classify(distances_to_nearest(known))]
        blended[:, has_values] = np.sum(of_value * candidates, axis=0)[:, has_values]
    columns = leave_out_columns(has_values, rng)
    left_out = known & columns
    if (
        np.count_nonzero(columns) >= LEAST_TRIAL_COLUMNS
        and np.count_nonzero(left_out) >= LEAST_LEFT_OUT
    ):
        weights_of_columns = weigh_columns(errors_of(left_out))
        estimates = np.tensordot(weights_of_columns, candidates[1:], axes=1)
        blended[:, ~has_values] = estimates[:, ~has_values]
    return np.where(known, x, blended).astype(x.dtype)


def candidates_of(
    x: np.ndarray,
    known: np.ndarray,
    project: Project | None,
    context: ProbabilisticPCA | None = None,
) -> np.ndarray:
    """The candidates of the module's text, (6, T, C), or fewer without a network or a context."""
    curves = fit_curves(x, known)
    variances = gap_variances(known, curves.lengths)
    candidates = [curves.values, refine(x, known, curves.values, variances)]
    if context is not None:
        of_training, of_another = context.estimate(x, known)
        candidates.append(add_missed(x, known, of_training))
        candidates.append(add_missed(x, known, of_another))
        candidates.append(refine(x, known, of_another, variances))
    if project is not None:
        by_network = complete(x[None], known[None], project, start=curves.values[None])[0]
        candidates.append(refine(x, known, by_network, variances))
    return np.stack(candidates)


def add_missed(x: np.ndarray, known: np.ndarray, estimate: np.ndarray) -> np.ndarray:
    """An estimate of a motion (T, C), plus the curve of its errors at the known values of x."""
    missed = fit_curves(x - estimate, known, [MISSED_LENGTH]).values
    return np.where(known, x, estimate + missed)


def refine(
    x: np.ndarray, known: np.ndarray, start: np.ndarray, variances: np.ndarray
) -> np.ndarray:
    """A completed motion (T, C), refined by a regression of the values of a frame on one another.

    A column without a known value stays as it is.
    """

    def predict(x_n: np.ndarray, _averaged: bool) -> np.ndarray:
        return predict_from_others(x_n[0])[None]

    predicted = complete(x[None], known[None], predict, interpolate_gaps, start[None], PREDICTIONS)
    refined = condition_frames(predicted[0], known, variances)
    return np.where(known.any(axis=0), refined, start)


def leave_out(known: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A mask (T, C) of known values to leave out, about `LEFT_OUT` of those in incomplete columns.

    In a column with a mask of its own they are single values. In columns that are unknown in the
    same frames, such as those of a joint, they are trial holes (`leave_out_runs`).
    """
    left_out = np.zeros_like(known)
    incomplete = np.flatnonzero(known.any(axis=0) & ~known.all(axis=0))
    patterns, group_of = np.unique(known[:, incomplete], axis=1, return_inverse=True)
    for group, is_known in enumerate(patterns.T):
        columns = incomplete[group_of.ravel() == group]
        if len(columns) == 1:
            frames = is_known & (rng.random(len(known)) < LEFT_OUT)
        else:
            frames = leave_out_runs(is_known, rng)
        left_out[:, columns] = frames[:, None]
    return left_out


def leave_out_runs(is_known: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A mask (N,) of known frames, or columns: the runs of unknown ones, moved to random places.

    They are moved one by one, in random order, until `LEFT_OUT` of the known ones are left out. A
    run that would leave out more than half of them is not moved.
    """
    left_out = np.zeros_like(is_known)
    count = np.count_nonzero(is_known)
    for first, end in rng.permutation(runs(~is_known)):
        start = rng.integers(len(is_known) - (end - first) + 1)
        more = left_out.copy()
        more[start : start + end - first] = is_known[start : start + end - first]
        if np.count_nonzero(more) <= count / 2:
            left_out = more
        if np.count_nonzero(left_out) >= LEFT_OUT * count:
            break
    return left_out


def leave_out_columns(has_values: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A mask (C,) of columns with values to leave out, neighbours as those without values are.

    `leave_out_runs` leaves out columns until there are `TRIAL_COLUMNS`, never more than half.
    """
    left_out = np.zeros_like(has_values)
    for _ in range(MOST_MOVES):
        more = left_out | leave_out_runs(has_values, rng)
        if np.count_nonzero(more) <= np.count_nonzero(has_values) / 2:
            left_out = more
        if np.count_nonzero(left_out) >= TRIAL_COLUMNS:
            break
    return left_out


def distances_to_nearest(known: np.ndarray) -> np.ndarray:
    """From each value (T, C) the frames to the nearest known value of its column."""
    before, after = distances_to_known(known)
    return np.minimum(before, after)


def classify(distances: np.ndarray) -> np.ndarray:
    """The class of each distance, 0 for 1 frame to len(`CLASSES`) for more than the last one."""
    return np.searchsorted(CLASSES, distances)


def weigh(errors: np.ndarray, distances: np.ndarray) -> np.ndarray:
    """The weights (K, classes) of candidates by their errors (K, N) in values left out, at these
    distances (N,) from the nearest known value; the first candidate is the curve by itself."""
    candidates = len(errors)
    all_products = mean_products(errors)
    weights = np.zeros((candidates, len(CLASSES) + 1))
    classes = classify(distances)
    for number in range(len(CLASSES) + 1):
        of_class = errors[:, classes == number]
        products = of_class @ of_class.T
        scale = 1.0
        if np.any(products):
            scale = np.trace(products) / of_class.shape[1] / np.trace(all_products)
        products = products + OTHER_CLASSES * scale * all_products
        first = 0 if number <= classify(np.array(NEAR)) else 1
        weights[first:, number] = minimise_on_simplex(products[first:, first:])
    return weights


def weigh_columns(errors: np.ndarray) -> np.ndarray:
    """The weights (K - 1,) of candidates 2, 3, … for columns without a known value, by the errors
    (K, N) of all candidates in columns that were left out."""
    return minimise_on_simplex(mean_products(errors[1:]))


def mean_products(errors: np.ndarray) -> np.ndarray:
    """The mean products (K, K) of the errors (K, N) of two candidates, positive definite."""
    products = errors @ errors.T / errors.shape[1]
    return products + 1e-12 * (np.trace(products) or 1.0) * np.eye(len(products))


def minimise_on_simplex(products: np.ndarray) -> np.ndarray:
    """w = argmin wᵀ G w with w ≥ 0 and Σ w = 1, of a positive definite G.

    With G = L Lᵀ it is a multiple of the w ≥ 0 for which (Lᵀ w, Σ w) is nearest to (0, 1).
    """
    from scipy.optimize import nnls  # slow to import

    factor = np.linalg.cholesky(products / np.trace(products)).T
    rows = np.vstack([factor, np.ones(len(products))])
    target = np.append(np.zeros(len(products)), 1.0)
    weights, _ = nnls(rows, target)
    return weights / weights.sum()
