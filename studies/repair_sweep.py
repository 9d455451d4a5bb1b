"""Values removed with probability p from 0.1 to 0.9, repaired by the network and by baselines:
holden2015, section 7, "Fixing Corrupt Motion Data".

The methods are those of `numpy_cae.evaluation.tables`, grouped by what they are given: the
zeros as they are or, from "mask:" on, which values are missing. Errors are root mean squares of a
coordinate in at most 60 windows of the test takes. Baselines are fitted to the training takes; PCA
has the number of axes that is best on the test takes, which favours PCA.

    python -m studies repair_sweep --data bandai -m best.npz -o sweep

-o FOLDER also writes a page of one window with half, 80% and 90% of its values removed, repaired by
each method, moving.
"""

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from numpy_cae.evaluation import tables
from numpy_cae.evaluation.tables import Clips, Repairs, clips_of
from numpy_cae.manifold import MotionManifold
from numpy_cae.training import zero_values
from numpy_cae.viz import CORRUPTED, OTHERS, PLAIN, PROJECTED, TRUTH
from studies.shared.material import Material, testing_of
from studies.shared.result import Claim, Picture, Result, Table, moving

PS = (0.1, 0.3, tables.P, 0.8, 0.9)
DRAWN = {
    tables.DAMAGED: CORRUPTED,
    tables.NETWORK: PROJECTED,
    tables.PCHIP: OTHERS[0],
    tables.GAUSSIAN: OTHERS[1],
    tables.COMPLETED: PLAIN,
}
"""The methods that are drawn, and their colours."""
WINDOWS = 60
"""At most this many windows are repaired, since the Gaussian takes a tenth of a second for
each."""
Errors = dict[str, np.ndarray]
"""Method to its errors in cm, one for each p and each seed."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Remove values of test windows, drawn from the seed, and repair them with every method."""
    training = clips_of(manifold, [take.positions for take in material.training])
    testing, _ = testing_of(manifold, material)
    repairs = Repairs(manifold, training)
    errors = sweep(repairs, testing.pick_evenly(WINDOWS), PS, [seed])
    rows = [[method, *of_method.mean(axis=1)] for method, of_method in errors.items()]
    header = ["method", *(f"p = {p}" for p in PS)]
    of_half = {}
    for method, of_method in errors.items():
        of_half[method] = float(of_method[PS.index(tables.P)].mean())
    return Result(
        "Repair: values removed with probability p",
        [Table("Error, cm:", header, rows)],
        _claims(of_half),
        {f"removed_{p}": _picture(repairs, testing.pick_evenly(1), p, seed) for p in PS[2:]},
    )


def _picture(repairs: Repairs, window: Clips, p: float, seed: int) -> Picture:
    """A window of which values are removed, as each method repairs it, beside the truth."""
    damaged = zero_values(window.x, p, np.random.default_rng(seed))
    repaired = {method: x for method, _, x in repairs.apply(window, damaged, p)}
    denormalise = repairs.manifold.denormalise
    motions = {}
    for method, colour in DRAWN.items():
        motions[method] = denormalise(repaired[method][0]), colour
    motions["the truth"] = denormalise(window.x[0]), TRUTH
    return moving(motions, repairs.manifold.rate)


def sweep(repairs: Repairs, test: Clips, ps: Sequence[float], seeds: Sequence[int]) -> Errors:
    """The errors of every method where values are removed with each p, drawn from each seed."""
    errors: dict[str, list[float]] = defaultdict(list)
    for p in ps:
        for seed in seeds:
            damaged = zero_values(test.x, p, np.random.default_rng(seed))
            for method, _, repaired in repairs.apply(test, damaged, p):
                errors[method].append(test.error(repaired))
    return {method: np.reshape(values, (len(ps), -1)) for method, values in errors.items()}


def _claims(at: dict[str, float]) -> list[Claim]:
    """The network, which is given the zeros as they are, beside the best simple method that is
    given as much; and the completion beside the best simple method that is given the mask."""
    simple = min(tables.SIMPLE, key=lambda name: at[name])
    with_mask = min(tables.SIMPLE_WITH_MASK, key=lambda name: at[name])
    network = at[tables.NETWORK]
    completed = at[tables.COMPLETED]
    figures = f"{at[tables.DAMAGED]:.2f} cm before, {network:.2f} cm after;"
    opponent = f"{simple}: {at[simple]:.2f} cm."
    with_mask_figures = f"{with_mask}: {at[with_mask]:.2f} cm."
    return [
        Claim("half_recovered", network < at[tables.DAMAGED] / 2, figures, opponent=opponent),
        Claim("better_than_simple", network < at[simple], figures, opponent=opponent),
        Claim(
            "completed_better",
            completed < at[with_mask],
            f"{completed:.2f} cm;",
            opponent=with_mask_figures,
        ),
    ]
