"""Random and even unpooling of the same hidden units: holden2015, section 5.

    python -m studies unpoolings --data bandai --test '*_005.bvh' -m paper.npz

Random unpooling "results in some noise in the produced animation", even unpooling "does result in
smooth animation with no high frequency noise".
"""

import numpy as np

from numpy_cae.evaluation.clips import Clips
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import features_to_positions
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH
from studies.shared.body import jitter
from studies.shared.clips import testing_of
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table, moving

RANDOM, EVEN, TRUE = "random unpooling", "even unpooling", "truth"
COLOURS = {TRUE: TRUTH, EVEN: PROJECTED, RANDOM: CORRUPTED}
NOISY, SMOOTH = 2.0, 1.5
"""NOISY, SMOOTH: the jitter is that many times the truth's at least, or at most."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Decode the hidden units of test windows in both ways; the masks are drawn from the seed."""
    testing, sample = testing_of(manifold, material)
    y = manifold.network.encode(testing.x)
    decoded = {
        TRUE: testing.x,
        EVEN: manifold.network.decode(y),
        RANDOM: _decoded_at_random(manifold, y, np.random.default_rng(seed)),
    }
    trembling = {name: _jitter(testing, x) for name, x in decoded.items()}
    times = {name: each / trembling[TRUE] for name, each in trembling.items()}
    rows = [[name, testing.error(x), trembling[name], times[name]] for name, x in decoded.items()]
    header = ["unpooling", "error, cm", "jitter, m/s²", "of the truth's"]
    figures = {name: f"{ratio:.1f} times the jitter of the truth." for name, ratio in times.items()}
    motions = {n: (manifold.denormalise(decoded[n][0]), colour) for n, colour in COLOURS.items()}
    return Result(
        "Two inverses of max pooling",
        [Table("", header, rows)],
        [
            Claim("random_noisy", times[RANDOM] > NOISY, figures[RANDOM]),
            Claim("even_smooth", times[EVEN] < SMOOTH, figures[EVEN]),
        ],
        {"unpoolings": moving(motions, manifold.rate)},
        sample,
    )


def _decoded_at_random(
    manifold: MotionManifold, y: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    for layer in reversed(manifold.network.layers):
        y, _ = layer.decode_with_pullback(y, rng.random(y.shape) < 0.5)
    return y


def _jitter(testing: Clips, x: np.ndarray) -> float:
    """The mean jitter of windows, of the frames that count, m/s²."""
    manifold = testing.manifold
    each = zip(manifold.denormalise(x), testing.real, strict=True)
    kept = [features[real] for features, real in each if real.sum() > 2]
    return float(np.mean([jitter(features_to_positions(one), manifold.rate) for one in kept]))
