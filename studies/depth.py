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
"""EPOCHS: of each layer and of fine tuning; the paper has 25."""
ACTIVE = 0.1
"""ACTIVE: a hidden unit is active where its magnitude is larger."""
SPARSE = "three layers, α = 0"


def run(material: Material, seed: int = 0, epochs: int = EPOCHS) -> Result:
    """Train the stacks on the training takes, and repair the test takes with each."""
    schedule = recipe("paper")
    layer = replace(schedule.layer, epochs=epochs)
    fine = replace(schedule.fine_tuning, epochs=epochs)
    kinds = {f"{n} of {len(FILTERS)} layers": (FILTERS[:n], layer) for n in (1, 2, 3)}
    kinds[SPARSE] = FILTERS, replace(layer, alpha=0.0)
    takes = [take.positions for take in material.training]
    measured = {}
    for name, (filters, stage) in kinds.items():
        manifold = learn_manifold(takes, Schedule(stage, fine), seed, filters=filters)
        measured[name] = _measured(manifold, material, seed)
    header = ["stack", "reconstruction, cm", "half removed, cm", "active units"]
    rows = [[name, *values] for name, values in measured.items()]
    one, two, three, free = measured.values()
    deep = f"three layers {three[1]:.2f} cm;"
    shallow = f"two {two[1]:.2f}, one {one[1]:.2f} cm."
    active = f"{three[2]:.0%} of the units are active with α = 0.01;"
    claims = [
        Claim("deep_justified", three[1] < min(one[1], two[1]), deep, opponent=shallow),
        Claim("sparsity", three[2] < free[2], active, opponent=f"{free[2]:.0%} with α = 0."),
    ]
    table = Table(f"{epochs} epochs of each stage:", header, rows)
    return Result("Depth of the stack", [table], claims)


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
