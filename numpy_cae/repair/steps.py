"""The steps of a repair by evidence, in their order. None of them needs a model."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from numpy_cae.motion.motion import Motion
from numpy_cae.repair.displaced import find_displaced, mend_displaced
from numpy_cae.repair.feet import find_feet, mend_feet
from numpy_cae.repair.finding import Finding
from numpy_cae.repair.interpolated import interpolate
from numpy_cae.repair.jitter import find_jitter, find_jumps, mend_jumps, smooth_motion
from numpy_cae.repair.presets import Preset
from numpy_cae.repair.spikes import find_spikes
from numpy_cae.repair.still import find_still


@dataclass(frozen=True)
class Step:
    """How damage of some kinds is found and mended.

    `option` is the name of the setting of a preset with which the step is taken.
    """

    kinds: tuple[str, ...]
    find: Callable[[Motion, float], list[Finding]]
    mend: Callable[[Motion, list[Finding]], Motion]
    option: str = ""


LEFT = "left alone, since the feet would slide more"
"""LEFT: what the evidence of findings says that are not mended."""


STEPS = (
    Step(("repeated", "frozen"), find_still, interpolate),
    Step(("turned", "displaced", "length", "root elsewhere"), find_displaced, mend_displaced),
    Step(("spike",), find_spikes, interpolate),
    Step(("jitter",), find_jitter, smooth_motion, "smooth"),
    Step(("jumps",), find_jumps, mend_jumps),
    Step(("foot",), find_feet, mend_feet, "feet"),
)


def mend(
    motion: Motion, preset: Preset | None = None, given: Sequence[Finding] | None = None
) -> tuple[Motion, list[Finding]]:
    """The motion without the damage that the file itself shows, and what was found.

    Parameters
    ----------
    motion : Motion
    preset : Preset, optional
        Findings have a confidence of at least 1 - `preset.sensitivity`.
    given : sequence of Finding, optional
        Only these are mended, and nothing is looked for.

    Returns
    -------
    Motion, list of Finding

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30:32, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> [finding.kind for finding in mend(motion)[1]]
    ['spike']
    """
    preset, found = preset or Preset(), list[Finding]()
    for step in STEPS:
        if step.option and getattr(preset, step.option):
            damage = step.find(motion, preset.sensitivity)
        elif given is not None:
            damage = [finding for finding in given if finding.kind in step.kinds]
        else:
            damage = [] if step.option else step.find(motion, preset.sensitivity)
        if damage:
            mended = step.mend(motion, damage)
            if step.option and mended is motion:
                damage = [replace(f, evidence=f"{f.evidence}; {LEFT}") for f in damage]
            motion, found = mended, found + damage
    return motion, found
