"""Projection that keeps what a body must keep: "a constrained projection operator", which
holden2015, section 7, leaves to the future.

Among the hidden units near Φ(X), those whose motion stays close to the plain projection while

    bones       keep their lengths
    feet        stay where they stand
    joints      stay above the ground
    pins        are where the user wants them

are found by descent along the manifold (`descent`). The last step, which leaves it, sets the
lengths exactly; what is asked of feet, ground and pins is asked of the motion after that step, so
that it undoes nothing.
"""

from __future__ import annotations

import numpy as np

from numpy_cae.beyond import constraints
from numpy_cae.beyond.constraints import Pullback
from numpy_cae.beyond.exact_lengths import exact_lengths
from numpy_cae.beyond.optimise_latent import descend_to
from numpy_cae.beyond.pins import Pins
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.contacts import find_contacts, floor_height
from numpy_cae.motion.features import RootTransform, features_to_positions

CLOSE, BONES, FEET, GROUND, PINS = 1.0, 0.1, 10.0, 1.0, 1.0
"""What the squared distance to the plain projection and that from each constraint weigh."""
NEAR = 0.1
"""β of `descend_to`: what a mean square of 1 in the hidden units weighs."""
UNDER = 0.01
"""Metres that a joint may be below where the feet of the plain projection stand."""
STEPS = 200


def project_constrained(
    manifold: MotionManifold,
    features: np.ndarray,
    start: RootTransform | None = None,
    contacts: np.ndarray | None = None,
    pins: Pins | None = None,
    steps: int = STEPS,
) -> np.ndarray:
    """The motion on the manifold near Φ†(Φ(X)) that keeps bones, feet, ground and pins.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the manifold's mean skeleton.
    start : RootTransform, optional
        Where the motion starts, for pins; the origin where None.
    contacts : (F, 2) array of bool, optional
        When each foot stands; found in the plain projection where None.
    pins : Pins, optional
    steps : int
        Of the descent, at most.

    Returns
    -------
    (F, 63) array of float64
        Every bone at the length of the manifold's mean skeleton, up to rounding.
    """
    start = start or RootTransform()
    units = manifold.encode(features)
    plain = manifold.project(features, manifold.shifts)
    positions = features_to_positions(plain, start)
    if contacts is None:
        contacts = find_contacts(positions, manifold.rate)
    ground = floor_height(positions) - UNDER
    everything = np.ones_like(plain)

    def wish(x: np.ndarray) -> tuple[float, np.ndarray]:
        exact, exact_back = exact_lengths(x, manifold.lengths)
        terms = [
            (CLOSE, constraints.unlike(exact, plain, everything)),
            (FEET, constraints.feet_moved(exact, contacts)),
            (GROUND, constraints.below_ground(exact, ground)),
        ]
        if pins is not None:
            asked = (pins.targets, pins.weights, pins.body)
            terms.append((PINS, constraints.out_of_place(exact, start, *asked)))
        loss, d_exact = _weighted(terms)
        before, d = _weighted([(BONES, constraints.bone_lengths_off(x, manifold.lengths))])
        return loss + before, d + exact_back(d_exact)

    found = descend_to(manifold, units, len(features), wish, NEAR, steps)
    exact, _ = exact_lengths(manifold.decode(found, len(features)), manifold.lengths)
    return exact


def _weighted(terms: list[tuple[float, tuple[float, Pullback]]]) -> tuple[float, np.ndarray]:
    """Σ w L in squared centimetres, and Σ w dL/df, of terms (w, (L, pullback))."""
    loss = constraints.CENTIMETRES * sum(weight * loss for weight, (loss, _) in terms)
    return loss, sum(pullback(constraints.CENTIMETRES * weight) for weight, (_, pullback) in terms)
