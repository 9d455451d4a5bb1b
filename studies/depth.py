"""Is a deep stack justified? holden2015, section 7, "Limitations & Future Work".

    python -m studies depth --data bandai --test '*_005.bvh'

Stacks of 1, 2 and 3 layers, each with as many hidden numbers, are trained by the paper's schedule
with fewer epochs, and one of 3 layers without the sparsity term of equation 3.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.evaluation.clips import clips_of
from numpy_cae.manifold import hidden_units, learn_manifold
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
    rows = []
    for name, (filters, stage) in kinds.items():
        manifold = learn_manifold(takes, Schedule(stage, fine), seed, filters=filters)
        test = clips_of(manifold, [take.positions for take in material.testing])
        damaged = zero_values(test.x, 0.5, np.random.default_rng(seed))
        errors = (test.error(manifold.network.project(x)) for x in (test.x, damaged))
        units = [hidden_units(manifold, take) for take in features_of(manifold, material.testing)]
        active = float(np.mean(np.abs(np.concatenate(units)) > ACTIVE))
        rows.append([name, *errors, active])
    (_, _, one, _), (_, _, two, _), (_, _, three, sparse), (_, _, _, free) = rows
    header = ["stack", "reconstruction, cm", "half removed, cm", "active units"]
    return Result(
        "Depth of the stack",
        [Table(f"{epochs} epochs of each stage:", header, rows)],
        [
            Claim(
                "deep_justified",
                three < min(one, two),
                f"three layers {three:.2f} cm;",
                opponent=f"two {two:.2f}, one {one:.2f} cm.",
            ),
            Claim(
                "sparsity",
                sparse < free,
                f"{sparse:.0%} of the units are active with α = 0.01;",
                opponent=f"{free:.0%} with α = 0.",
            ),
        ],
    )
