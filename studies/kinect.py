"""Motion as a Kinect would capture it, projected: holden2015, section 7 and figure 1, centre.

    python -m studies kinect --data bandai --test '*_005.bvh' -m best.npz

No recordings of a Kinect and of inertial sensors at once are available, so the sensor's errors are
simulated with the sizes that Wang, Kurillo, Ofli and Bajcsy measured (2015, arXiv:1512.04134:
joints 5 to 10 cm off, outliers at hidden joints): each joint has a constant offset, noise, and
stretches of half a second in which it is guessed.
"""

from collections.abc import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.clips import Clips, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import POSITIONS
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.shared.clips import testing_of
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table, moving

BIAS, NOISE, GUESS = 0.03, 0.01, 0.07
"""Standard deviations along each axis of a joint's offset, of its noise and of a guess, m."""
GUESSES, GUESSED = 1.0, 15
"""Guesses of a joint in a window of 160 frames, in the mean, and the frames of each."""
SIGMAS = (1.0, 2.0, 4.0)
"""Widths of the Gaussian filters over time, frames."""
MOST_LEFT = 2 / 3
"""MOST_LEFT: the result matches the truth far more closely if this share of the error is left."""
CHOOSING_EVERY = 5
"""CHOOSING_EVERY: of this many training takes, one is used to choose settings."""
TRAINING_WINDOWS, CHOOSING_WINDOWS = 600, 48
"""TRAINING_WINDOWS, CHOOSING_WINDOWS: at most so many windows, evenly spaced."""
SEEN, NETWORK, TRUE = "seen by the Kinect", "the network", "truth"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Simulate the capture of test windows, and repair it by projection, PCA and filters."""
    testing, sample = testing_of(manifold, material)
    rng = np.random.default_rng(seed)
    simple = _simple_methods(manifold, [take.positions for take in material.training], rng)
    seen = seen_windows(testing, rng)
    repaired = {SEEN: seen} | {name: method(seen) for name, method in simple.items()}
    repaired[NETWORK] = manifold.network.project(seen)
    errors = {name: testing.error(x) for name, x in repaired.items()}
    best = min(simple, key=lambda name: errors[name])
    left = errors[NETWORK] / errors[SEEN]
    shown = {TRUE: (testing.x, TRUTH), SEEN: (seen, CORRUPTED)}
    shown[NETWORK] = repaired[NETWORK], PROJECTED
    drawn = {name: (manifold.denormalise(x[0]), colour) for name, (x, colour) in shown.items()}
    claim = Claim(
        "kinect_closer",
        left < MOST_LEFT,
        f"{errors[SEEN]:.2f} cm before, {errors[NETWORK]:.2f} cm after, {left:.2f} of it;",
        opponent=f"{best}: {errors[best]:.2f} cm.",
    )
    rows = [[name, error, error / errors[SEEN]] for name, error in errors.items()]
    return Result(
        "A simulated Kinect",
        [Table("", ["method", "error, cm", "share left"], rows, best="low")],
        [claim],
        {"kinect": moving(drawn, manifold.rate)},
        sample,
    )


def _simple_methods(
    manifold: MotionManifold, takes: list[np.ndarray], rng: np.random.Generator
) -> dict[str, Callable[[np.ndarray], np.ndarray]]:
    """A filter, and PCA of the training takes. The width of the filter and the number of axes are
    chosen on every `CHOOSING_EVERY`-th of these takes, held back."""
    if len(takes) < CHOOSING_EVERY:
        raise ValueError(f"it needs {CHOOSING_EVERY} takes to train on, to choose settings")
    others = [take for number, take in enumerate(takes, start=1) if number % CHOOSING_EVERY]
    choosing = clips_of(manifold, takes[CHOOSING_EVERY - 1 :: CHOOSING_EVERY])
    choosing = choosing.evenly(CHOOSING_WINDOWS)
    practice = seen_windows(choosing, rng)
    trial = _pca_of(manifold, others)
    sigma = min(SIGMAS, key=lambda each: choosing.error(_filtered(practice, each)))
    axes = min(trial.sizes, key=lambda each: choosing.error(trial.project(practice, each)))
    pca = _pca_of(manifold, takes)
    return {
        "Gaussian filter over time": lambda x: _filtered(x, sigma),
        "PCA on windows": lambda x: pca.project(x, axes),
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


def _pca_of(manifold: MotionManifold, takes: list[np.ndarray]) -> PCA:
    windows = clips_of(manifold, takes).evenly(TRAINING_WINDOWS).x
    return PCA.fit(windows.reshape(len(windows), -1))


def _filtered(x: np.ndarray, sigma: float) -> np.ndarray:
    return gaussian_filter1d(x, sigma, axis=1, mode="nearest")
