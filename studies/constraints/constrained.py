"""Projection under constraints, "a constrained projection operator" (holden2015, section 7).

An optimisation changes the hidden units Φ(X) until the decoded motion is close to the plain
projection and

    bones       keep their lengths,
    feet        do not slide while in contact,
    joints      stay above the ground.

The last step sets the bone lengths exactly, and so leaves the manifold. The losses of feet and
ground are evaluated after this step, so that the step cannot undo them.
"""

import numpy as np

from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.motion.contacts import find_contacts, floor_height
from numpy_cae.motion.features import RootTransform, features_to_positions
from studies.constraints import constraints
from studies.constraints.constraints import Pullback
from studies.constraints.exact_lengths import exact_lengths
from studies.constraints.optimise_latent import optimise_latent

CLOSENESS_WEIGHT = 1.0
"""Weight of the squared distance to the plain projection."""
BONES_WEIGHT, FEET_WEIGHT, GROUND_WEIGHT = 0.1, 10.0, 1.0
"""Weight of the error of each constraint."""
BETA = 0.1
"""β of `optimise_latent`."""
GROUND_MARGIN = 0.01
"""A joint may be this far (m) below the floor on which the feet of the plain projection stand."""
MAX_STEPS = 200


def project_constrained(
    manifold: MotionManifold,
    features: np.ndarray,
    start: RootTransform | None = None,
    contacts: np.ndarray | None = None,
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
    steps : int
        Largest number of iterations.

    Returns
    -------
    (F, 63) array of float64
        Every bone has the length of the manifold's mean skeleton, up to rounding.
    """
    start = start or RootTransform()
    units = manifold.encode(features)
    plain = manifold.project(features, average_shifts=True)
    positions = features_to_positions(plain, start)
    if contacts is None:
        contacts = find_contacts(positions, manifold.rate)
    ground = floor_height(positions) - GROUND_MARGIN

    def objective(x: np.ndarray) -> tuple[float, np.ndarray]:
        exact, exact_back = exact_lengths(x, manifold.lengths)
        terms = [
            (CLOSENESS_WEIGHT, constraints.squared_difference(exact, plain)),
            (FEET_WEIGHT, constraints.foot_sliding_error(exact, contacts)),
            (GROUND_WEIGHT, constraints.ground_penetration(exact, ground)),
        ]
        loss, d_exact = _weighted(terms)
        bones = constraints.bone_length_error(x, manifold.lengths)
        bones_loss, d = _weighted([(BONES_WEIGHT, bones)])
        return loss + bones_loss, d + exact_back(d_exact)

    optimised = optimise_latent(manifold, units, len(features), objective, BETA, steps)
    exact, _ = exact_lengths(manifold.decode(optimised, len(features)), manifold.lengths)
    return exact


def _weighted(terms: list[tuple[float, tuple[float, Pullback]]]) -> tuple[float, np.ndarray]:
    """Σ w L in squared centimetres, and Σ w dL/df, of terms (w, (L, pullback))."""
    loss = constraints.CENTIMETRES * sum(weight * loss for weight, (loss, _) in terms)
    gradients = [pullback(constraints.CENTIMETRES * weight) for weight, (_, pullback) in terms]
    return loss, sum(gradients[1:], start=gradients[0])
