"""Motion as a Kinect would capture it, projected: holden2015, section 7 and figure 1, centre.

    python -m studies kinect --data bandai --test '*_005.bvh' -m best.npz

No recordings of a Kinect and of inertial sensors at once are available, so the sensor's errors are
simulated with the sizes that Wang, Kurillo, Ofli and Bajcsy measured (2015, arXiv:1512.04134:
joints 5 to 10 cm off, outliers at hidden joints): each joint has a constant offset, noise, and
stretches of half a second in which it is guessed. The linear map of 15 frames is fitted to training
windows with the same simulated errors. The width of the filter and the number of axes of PCA are
those that are best on the test windows, which favours both.
"""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.baselines import RIDGE, apply_linear_map, gather_context
from numpy_cae.evaluation.tables import LINEAR, SIZES, Clips, apply_to_real_frames, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import POSITIONS
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.shared.judging import ratio_of_errors, root_mean_square
from studies.shared.material import Material, testing_of
from studies.shared.result import Claim, Result, Table, moving

BIAS = 0.03
"""The standard deviation of a joint's offset along each axis (m)."""
NOISE = 0.01
"""The standard deviation of a joint's noise along each axis (m)."""
GUESS = 0.07
"""The standard deviation of a guess along each axis (m)."""
GUESSES = 1.0
"""The share of joints that are guessed once in a window of 160 frames."""
GUESSED = 15
"""A guess lasts so many frames."""
SIGMAS = (1.0, 2.0, 4.0)
"""Widths of the Gaussian filters over time, frames."""
MOST_LEFT = 2 / 3
"""The result matches the truth far more closely if this share of the error is left."""
TRAINING_WINDOWS = 600
"""PCA is fitted to at most this many windows, evenly spaced."""
SEEN = "seen by the Kinect"
NETWORK = "the network"
TRUE = "truth"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Simulate the capture of test windows, and repair it by projection, PCA, a linear map and
    filters."""
    testing, sample = testing_of(manifold, material)
    rng = np.random.default_rng(seed)
    seen = seen_windows(testing, rng)
    repaired = repair_simply(manifold, material, testing, seen, rng)
    projected = apply_to_real_frames(manifold.network.project, testing.real, seen)
    methods = {SEEN: seen, **repaired, NETWORK: projected}
    squares = {name: testing.squares_by_take(x) for name, x in methods.items()}
    errors = {name: root_mean_square(of_takes) for name, of_takes in squares.items()}
    best = min(repaired, key=lambda name: errors[name])
    share_left = ratio_of_errors(squares[NETWORK], squares[SEEN])
    left_by_best = ratio_of_errors(squares[best], squares[SEEN])
    shown = {TRUE: (testing.x, TRUTH), SEEN: (seen, CORRUPTED), NETWORK: (projected, PROJECTED)}
    drawn = {name: (manifold.denormalise(x[0]), colour) for name, (x, colour) in shown.items()}
    claim = Claim(
        "kinect_closer",
        share_left.at_most(MOST_LEFT),
        f"{errors[SEEN]:.2f} cm before, {errors[NETWORK]:.2f} cm after, {share_left:.2f} of it;",
        opponent=f"{best}: {errors[best]:.2f} cm, {left_by_best:.2f}.",
        fulfilled_by=best if left_by_best.at_most(MOST_LEFT) else "",
    )
    rows = [[name, error, error / errors[SEEN]] for name, error in errors.items()]
    return Result(
        "A simulated Kinect",
        [Table("", ["method", "error, cm", "share left"], rows)],
        [claim],
        {"kinect": moving(drawn, manifold.rate)},
        sample,
    )


def repair_simply(
    manifold: MotionManifold,
    material: Material,
    testing: Clips,
    seen: np.ndarray,
    rng: np.random.Generator,
) -> dict[str, np.ndarray]:
    """Windows repaired by the best filter over time, PCA, and a linear map of 15 frames."""
    training = clips_of(manifold, [take.positions for take in material.training])
    training = training.pick_evenly(TRAINING_WINDOWS)
    pca = PCA.fit(training.x.reshape(len(training), -1))
    filtered = [gaussian_filter1d(seen, sigma, axis=1, mode="nearest") for sigma in SIGMAS]
    projected = [pca.project(seen, axes) for axes in SIZES]
    linear = fit_linear_map(training, seen_windows(training, rng))
    return {
        "Gaussian filter over time": min(filtered, key=testing.error),
        "PCA on windows": min(projected, key=testing.error),
        LINEAR: apply_linear_map(seen, linear),
    }


def fit_linear_map(clips: Clips, seen: np.ndarray) -> np.ndarray:
    """A = (Zᵀ Z + r I)⁻¹ Zᵀ X: the linear map of 15 frames of seen windows to the true frame in
    their middle, by least squares with a small ridge."""
    z = np.concatenate([gather_context(x)[real] for x, real in zip(seen, clips.real, strict=True)])
    squares = z.T.astype(np.float64) @ z
    ridge = RIDGE * np.diag(squares).mean() * np.eye(len(squares))
    return np.linalg.solve(squares + ridge, z.T @ clips.x[clips.real])


def seen_windows(clips: Clips, rng: np.random.Generator) -> np.ndarray:
    """Normalised windows (N, T, 63) with the simulated errors of the sensor; velocity and turn of
    the body are true."""
    windows, frames, _ = clips.x.shape
    off = BIAS * rng.standard_normal((windows, 1, 20, 3))
    off = off + NOISE * rng.standard_normal((windows, frames, 20, 3))
    for window, joint in np.argwhere(rng.random((windows, 20)) < GUESSES):
        first = rng.integers(frames)
        off[window, first : first + GUESSED, joint] += GUESS * rng.standard_normal(3)
    off[:, :, 0] = 0  # the features have the hips in the origin
    x = clips.x.copy()
    x[..., POSITIONS] += off.reshape(windows, frames, -1) * clips.manifold.scale[POSITIONS]
    return x * clips.real[..., None]
