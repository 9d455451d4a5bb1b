"""Motion as a Kinect would capture it, projected: holden2015, section 7 and figure 1, centre.

    python -m studies kinect --data bandai --test '*_005.bvh' -m best.npz

No recordings of a Kinect and of inertial sensors at once are available, so the sensor's errors are
simulated with the sizes that Wang, Kurillo, Ofli and Bajcsy measured (2015, arXiv:1512.04134:
joints 5 to 10 cm off, outliers at hidden joints): each joint has a constant offset, noise, and
stretches of half a second in which it is guessed. The width of the filter and the number of axes of
PCA are those that are best on the test windows, which favours both.
"""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.tables import SIZES, Clips, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import POSITIONS
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
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
    """Simulate the capture of test windows, and repair it by projection, PCA and filters."""
    testing, sample = testing_of(manifold, material)
    rng = np.random.default_rng(seed)
    seen = seen_windows(testing, rng)
    simple = simple_errors(manifold, material, testing, seen)
    projected = manifold.network.project(seen)
    errors = {SEEN: testing.error(seen), **simple, NETWORK: testing.error(projected)}
    best = min(simple, key=lambda name: errors[name])
    share_left = errors[NETWORK] / errors[SEEN]
    shown = {TRUE: (testing.x, TRUTH), SEEN: (seen, CORRUPTED), NETWORK: (projected, PROJECTED)}
    drawn = {name: (manifold.denormalise(x[0]), colour) for name, (x, colour) in shown.items()}
    claim = Claim(
        "kinect_closer",
        share_left < MOST_LEFT,
        f"{errors[SEEN]:.2f} cm before, {errors[NETWORK]:.2f} cm after, {share_left:.2f} of it;",
        opponent=f"{best}: {errors[best]:.2f} cm.",
    )
    rows = [[name, error, error / errors[SEEN]] for name, error in errors.items()]
    return Result(
        "A simulated Kinect",
        [Table("", ["method", "error, cm", "share left"], rows)],
        [claim],
        {"kinect": moving(drawn, manifold.rate)},
        sample,
    )


def simple_errors(
    manifold: MotionManifold, material: Material, testing: Clips, seen: np.ndarray
) -> dict[str, float]:
    """The errors, cm, of the best filter over time and of PCA of the training takes."""
    training = clips_of(manifold, [take.positions for take in material.training])
    x = training.pick_evenly(TRAINING_WINDOWS).x
    pca = PCA.fit(x.reshape(len(x), -1))
    filtered = [gaussian_filter1d(seen, sigma, axis=1, mode="nearest") for sigma in SIGMAS]
    return {
        "Gaussian filter over time": min(map(testing.error, filtered)),
        "PCA on windows": min(testing.error(pca.project(seen, axes)) for axes in SIZES),
    }


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
    return x
