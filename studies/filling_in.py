"""Values removed from takes and completed by every method that is given the mask: holden2015,
section 7, "Filling in Missing Data".

    python -m studies filling_in --data bandai --test '*_003.bvh'
    python -m studies filling_in --data bandai --test '*_003.bvh' --takes 3 --seeds 1

Of at most `--takes` takes of each source, evenly spaced, each value is removed with probability p,
in at most 160 frames in the middle of the take. Errors are root mean squares of the missing joint
coordinates over all takes and seeds. `complete` weighs a Gaussian process of each column,
principal components of the training takes, and the network's completion, most of them refined by
what the frames of the take say (numpy_cae/manifold/weighted_completion.py has the equations). What
the network adds is the difference to the same without the network. docs/lab_book/completion.md has
the findings.

Holes of joints are measured by `python -m studies holes`, a wrist that is missing for a whole clip
by `wrist`, stepped keys by `stepped_keys`.
"""

from numpy_cae.manifold import MotionManifold
from studies.shared.completions import table_of_removed_values
from studies.shared.material import Material, evenly, features_of
from studies.shared.result import Result


def run(
    manifold: MotionManifold, material: Material, takes: int = 12, seeds: int = 2, seed: int = 0
) -> Result:
    """Remove values of test takes, and complete them by every method, source by source."""
    if takes < 1 or seeds < 1:
        raise ValueError("--takes and --seeds are 1 or more")
    tables = []
    for source in dict.fromkeys(take.source for take in material.testing):
        chosen = features_of(manifold, evenly(material.of(source).testing, takes))
        numbers = range(seed, seed + seeds)
        tables.append(table_of_removed_values(manifold, chosen, numbers, source))
    return Result("Filling in: values removed with probability p", tables)
