"""Is a deep stack justified? holden2015, section 7, "Limitations & Future Work".

    python -m studies depth --data bandai --test '*_005.bvh'

Stacks of 1, 2 and 3 layers, each with as many hidden numbers, are trained by the paper's schedule
with fewer epochs, and one of 3 layers without the sparsity term of equation 3.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.evaluation.tables import clips_of
from numpy_cae.manifold import MotionManifold, hidden_units, learn_manifold
from numpy_cae.training import Schedule, recipe, zero_values
from studies.shared.material import Material, features_of
from studies.shared.result import Claim, Result, Table

FILTERS = (32, 64, 128)
"""Half of the paper's. Each layer halves the frames and doubles the units."""
EPOCHS = 8
"""Of each layer and of fine tuning; the paper has 25."""
ACTIVE = 0.1
"""A hidden unit is active where its magnitude is larger."""
SPARSE = "three layers, α = 0"


def run(material: Material, seed: int = 0, epochs: int = EPOCHS) -> Result:
    """Train the stacks on the training takes, and repair the test takes with each."""
    schedule = recipe("paper")
    layer = replace(schedule.layer, epochs=epochs)
    fine = replace(schedule.fine_tuning, epochs=epochs)
    stacks = {f"{n} of {len(FILTERS)} layers": (FILTERS[:n], layer) for n in (1, 2, 3)}
    stacks[SPARSE] = FILTERS, replace(layer, alpha=0.0)
    takes = [take.positions for take in material.training]
    measured = {}
    for name, (filters, stage) in stacks.items():
        manifold = learn_manifold(takes, Schedule(stage, fine), seed, filters=filters)
        measured[name] = _measured(manifold, material, seed)
    header = ["stack", "reconstruction, cm", "half removed, cm", "active units"]
    rows = [[name, *values] for name, values in measured.items()]
    repair_errors = [repair_error for _, repair_error, _ in measured.values()]
    shares_active = [share_active for _, _, share_active in measured.values()]
    claims = [_claim_of_depth(*repair_errors[:3]), _claim_of_sparsity(*shares_active[2:])]
    table = Table(f"{epochs} epochs of each stage:", header, rows)
    return Result("Depth of the stack", [table], claims)


def _claim_of_depth(one: float, two: float, three: float) -> Claim:
    """Whether three layers repair better than two and one, from the errors in cm."""
    figures = f"three layers {three:.2f} cm;"
    opponent = f"two {two:.2f}, one {one:.2f} cm."
    return Claim("deep_justified", three < min(one, two), figures, opponent=opponent)


def _claim_of_sparsity(sparse: float, free: float) -> Claim:
    """Whether the sparsity term makes fewer units active, from the shares."""
    figures = f"{sparse:.0%} of the units are active with α = 0.01;"
    return Claim("sparsity", sparse < free, figures, opponent=f"{free:.0%} with α = 0.")


def _measured(
    manifold: MotionManifold, material: Material, seed: int
) -> tuple[float, float, float]:
    """The errors of reconstruction and with half of the values removed, cm, and the share of units
    that are active."""
    test = clips_of(manifold, [take.positions for take in material.testing])
    damaged = zero_values(test.x, 0.5, np.random.default_rng(seed))
    units = [hidden_units(manifold, take) for take in features_of(manifold, material.testing)]
    reconstruction, repair = (test.error(manifold.network.project(x)) for x in (test.x, damaged))
    return reconstruction, repair, float(np.mean(np.abs(np.concatenate(units)) > ACTIVE))
