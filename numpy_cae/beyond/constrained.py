"""Projection under constraints, "a constrained projection operator" (holden2015, section 7).

Among the hidden units near Φ(X), those are found whose motion is close to the plain projection and

    bones       keep their lengths,
    feet        do not slide while in contact,
    joints      stay above the ground,
    pins        are where the user wants them.

The last step, which leaves the manifold, sets the bone lengths exactly. The losses of feet, ground
and pins are evaluated after this step, so that it cannot undo them.
"""

import numpy as np

from numpy_cae.beyond import constraints
from numpy_cae.beyond.constraints import Pullback
from numpy_cae.beyond.exact_lengths import exact_lengths
from numpy_cae.beyond.optimise_latent import optimise_latent
from numpy_cae.beyond.pins import Pins
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.contacts import find_contacts, floor_height
from numpy_cae.motion.features import (
    VELOCITY,
    RootTransform,
    features_to_positions,
    trajectory_of,
)

CLOSENESS_WEIGHT, BONES_WEIGHT, FEET_WEIGHT, GROUND_WEIGHT, PINS_WEIGHT = 1.0, 0.1, 10.0, 1.0, 1.0
"""Weights of the squared distance to the plain projection and of the error of each constraint."""
BETA = 0.1  # of `optimise_latent`
GROUND_MARGIN = 0.01
"""Metres that a joint may be below the floor on which the feet of the plain projection stand."""
MAX_STEPS = 200


def project_constrained(
    manifold: MotionManifold,
    features: np.ndarray,
    start: RootTransform | None = None,
    contacts: np.ndarray | None = None,
    pins: Pins | None = None,
    steps: int = MAX_STEPS,
) -> np.ndarray:
    """The motion on the manifold near Φ†(Φ(X)) that satisfies the constraints.

    Parameters
    ----------
    manifold : MotionManifold
    features : (F, 63) array of float
        On the manifold's mean skeleton.
    start : RootTransform, optional
        Of the first frame; the origin where None.
    contacts : (F, 2) array of bool
        When each foot stands; found in the plain projection where None.
    pins : Pins, optional
        They are reached from the way of the root in `features`, which the result then has.
    steps : int
        Largest number of iterations.

    Returns
    -------
    (F, 63) array of float64
        Every bone has the length of the manifold's mean skeleton, up to rounding.
    """
    start = start or RootTransform()
    units = manifold.encode(features)
    plain = manifold.project(features, manifold.shifts)
    positions = features_to_positions(plain, start)
    if contacts is None:
        contacts = find_contacts(positions, manifold.rate)
    ground = floor_height(positions) - GROUND_MARGIN
    trajectory = trajectory_of(features, start)

    def objective(x: np.ndarray) -> tuple[float, np.ndarray]:
        exact, exact_back = exact_lengths(x, manifold.lengths)
        terms = [
            (CLOSENESS_WEIGHT, constraints.squared_difference(exact, plain)),
            (FEET_WEIGHT, constraints.foot_sliding_error(exact, contacts)),
            (GROUND_WEIGHT, constraints.ground_penetration(exact, ground)),
        ]
        if pins is not None:
            target = (pins.targets, pins.weights, pins.body)
            terms.append((PINS_WEIGHT, constraints.pin_error(exact, trajectory, *target)))
        loss, d_exact = _weighted(terms)
        bones = constraints.bone_length_error(x, manifold.lengths)
        bones_loss, d = _weighted([(BONES_WEIGHT, bones)])
        return loss + bones_loss, d + exact_back(d_exact)

    found = optimise_latent(manifold, units, len(features), objective, BETA, steps)
    exact, _ = exact_lengths(manifold.decode(found, len(features)), manifold.lengths)
    if pins is not None:
        exact[:, VELOCITY.start :] = features[:, VELOCITY.start :]
    return exact


def _weighted(terms: list[tuple[float, tuple[float, Pullback]]]) -> tuple[float, np.ndarray]:
    """Σ w L in squared centimetres, and Σ w dL/df, of terms (w, (L, pullback))."""
    loss = constraints.CENTIMETRES * sum(weight * loss for weight, (loss, _) in terms)
    gradients = [pullback(constraints.CENTIMETRES * weight) for weight, (_, pullback) in terms]
    return loss, sum(gradients[1:], start=gradients[0])
