"""A repair in a few sentences and numbers, as the page shows it first."""

from collections import Counter

import numpy as np

from numpy_cae.motion.contacts import foot_sliding
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.curves import usual_body
from numpy_cae.repair.interpolated import with_finite_values
from numpy_cae.repair.jumps import sharp_steps
from numpy_cae.repair.presets import PRESETS, fitting_preset, shaking
from numpy_cae.repair.repaired import Repaired, count

Measures = list[tuple[str, float, float]]
"""The name of each measure with its unit, and its value before and after."""


def sentences(repaired: Repaired, advises: bool = True) -> list[str]:
    """What was found and changed, what a user should know about it and, if that is wanted, which
    preset fits."""
    kinds = Counter(finding.kind for finding in repaired.findings)
    found = ", ".join(f"{kind} {number}" for kind, number in kinds.most_common())
    changed = repaired.touched.any(axis=1).sum() / repaired.motion.rate
    said = [
        f"{count(len(repaired.findings), 'finding')}{f': {found}' if found else ''}",
        f"{changed:.1f} of {repaired.motion.seconds:.1f} s are changed",
    ]
    if repaired.proposed:
        said.append(f"{count(len(repaired.proposed), 'proposal')}, not changed")
    if not repaired.known:
        said.append("unlike what the model knows: only what the file itself shows was mended")
    if advises and repaired.original and (name := fitting_preset(repaired.original)):
        said.append(f"motion like this is repaired with --from {name}: {PRESETS[name]}")
    return said


def measures(before: Motion, after: Motion) -> Measures:
    """Measures of damage, each of the motion before and after."""
    finite = with_finite_values(before)[0]
    named = {"jumps": _jumps, "feet slide, cm/s": _sliding, "jitter, m/s²": shaking}
    return [(name, measure(finite), measure(after)) for name, measure in named.items()]


def _jumps(motion: Motion) -> float:
    return float(np.count_nonzero(sharp_steps(motion)))


def _sliding(motion: Motion) -> float:
    return foot_sliding(usual_body(motion), motion.rate)
