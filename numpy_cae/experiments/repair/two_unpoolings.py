"""The two inverses of max pooling when decoding: holden2015, section 5.

    random      the pooled value on one frame of its pair, zero on the other
    even        half of the value on both frames

The paper trains its layers with the first and decodes its results with the second. Here one
trained network decodes the same hidden units with both.
"""

import numpy as np

from numpy_cae.experiments.clips import cut_ends, hold_ends, project_ends_held, testing_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import joint_slice
from numpy_cae.viz import CORRUPTED, PROJECTED, TRUTH, feature_figure, world_actors

EVEN, RANDOM, TRUE = "even", "random", "truth"


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Encode test windows and decode them with both unpoolings; the seed is for the random one."""
    testing, sample = testing_of(manifold, material)
    decoded = {
        RANDOM: decode_at_random(manifold, testing.x, np.random.default_rng(seed)),
        EVEN: project_ends_held(manifold, testing.x),
        TRUE: testing.x,
    }
    error = {name: testing.error(x) for name, x in decoded.items()}
    jitter = {name: testing.jitter(x) for name, x in decoded.items()}
    truth = jitter[TRUE]
    rows = [[name, error[name], jitter[name], jitter[name] / truth] for name in decoded]
    claims = [
        Claim(
            "Random unpooling results in some noise (holden2015, section 5; held if the jitter is "
            "more than twice the truth's).",
            jitter[RANDOM] > 2 * truth,
            f"{jitter[RANDOM]:.1f} m/s², truth {truth:.1f}; error {error[RANDOM]:.2f} cm.",
        ),
        Claim(
            "Even unpooling results in smooth animation without high-frequency noise (section 5; "
            "held if the jitter is at most the truth's).",
            jitter[EVEN] <= truth,
            f"{jitter[EVEN]:.1f} m/s², truth {truth:.1f}, random {jitter[RANDOM]:.1f}; error "
            f"{error[EVEN]:.2f} cm.",
        ),
    ]
    colours = {RANDOM: CORRUPTED, EVEN: PROJECTED, TRUE: TRUTH}
    window, height = testing.typical(), joint_slice("left_wrist").start + 1
    motions = {name: (testing.features(decoded[name], window), colours[name]) for name in decoded}
    return Result(
        "The two unpoolings",
        [Table("", ["unpooling", "error, cm", "jitter, m/s²", "of the truth's"], rows)],
        claims,
        lambda: feature_figure(motions, height, manifold.rate, "height of the left wrist"),
        Animation(world_actors(motions), manifold.rate),
        sample,
    )


def decode_at_random(
    manifold: MotionManifold, x: np.ndarray, rng: np.random.Generator
) -> np.ndarray:
    """Φ†(Φ(X)) of windows (N, T, 63) with random unpooling."""
    y = manifold.network.encode(hold_ends(manifold, x))
    for layer in reversed(manifold.network.layers):
        y, _ = layer.decode_with_pullback(y, rng.random(y.shape) < 0.5)
    return cut_ends(manifold, y, x.shape[1])
