"""Find damage by `likelihood.explain`, and mend it: turns and offsets are undone, the rest is
mended by the menders of `repair`."""

from dataclasses import replace
from itertools import pairwise

import numpy as np

from numpy_cae.cleanup import Finding, repair_motion
from numpy_cae.cleanup.finding import joint_names
from numpy_cae.cleanup.kinds import FROZEN, ROOT_ELSEWHERE, SPIKE, TURNED
from numpy_cae.cleanup.result import join_motions, measure_distances
from numpy_cae.cleanup.view import View
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import Motion
from numpy_cae.motion.hole_curves import interpolate_rotations, interpolate_values
from numpy_cae.motion.quaternions import from_vector, product
from studies.explaining.likelihood import CALIBRATION, Event, explain
from studies.explaining.scoring import Outcome

LEAST_CONFIDENCE = 0.05
"""Events below this are not findings."""
MENDED_CONFIDENCE = 0.5
"""Events from this on are mended."""
KINDS = {"turned": TURNED, "root offset": ROOT_ELSEWHERE, "spike": SPIKE, "hold": FROZEN}
"""The kinds of findings; an arm that is held is frozen."""


def confidence_of(kind: str, gain: float) -> float:
    """σ(α + β · gain)."""
    alpha, beta = CALIBRATION[kind]
    return float(1 / (1 + np.exp(-np.clip(alpha + beta * gain, -50, 50))))


def explain_and_mend(motion: Motion, manifold: MotionManifold) -> Outcome:
    """What `explain` finds, and the motion with what is likely mended."""
    events, possible_cuts = explain(motion)
    cuts = [at for at, gain in possible_cuts if confidence_of("cut", gain) >= MENDED_CONFIDENCE]
    mended = motion
    findings = []
    rest = []
    for name, event in events:
        sure = confidence_of(event.kind, event.gain)
        if sure < LEAST_CONFIDENCE or any(event.first < cut < event.end for cut in cuts):
            continue
        for joint in _joints_of(name, event):
            kind = KINDS.get(event.kind, FROZEN).name
            finding = Finding(joint, (event.first, event.end - 1), kind, "", 0.0, sure)
            findings.append(finding)
            if event.kind not in ("turned", "root offset"):
                rest.append(finding)
        if event.kind in ("turned", "root offset") and sure >= MENDED_CONFIDENCE:
            mended = undo(mended, name, event)
    likely = [finding for finding in rest if finding.confidence >= MENDED_CONFIDENCE]
    if likely:
        mended = _mend_parts(mended, likely, cuts, manifold)
    moved = float(measure_distances(motion, mended).max(initial=0.0))
    return Outcome(findings, cuts, mended, moved)


def _joints_of(name: str, event: Event) -> list[str]:
    """The joints that an event is about."""
    if event.kind == "arm held":
        return [name, name.replace("shoulder", "elbow")]
    return [name]


def undo(motion: Motion, name: str, event: Event) -> Motion:
    """The motion without a turn or an offset of a joint; where that begins and ends, it is
    interpolated."""
    joint = joint_names(motion).index(name)
    frames = np.arange(event.first, event.end)
    missing = np.zeros((len(motion), 1), bool)
    missing[event.first : event.first + event.rise - 1] = True
    missing[event.end - event.fall + 1 : event.end] = True
    vectors = event.vectors_at(frames)
    if event.kind == "root offset":
        translations = motion.translations.copy()
        size = View(motion).size
        translations[frames, joint] -= size * vectors
        values = interpolate_values(translations[:, [joint]], missing, motion.rate)
        translations[:, [joint]] = values
        return replace(motion, translations=translations)
    channels = [x for x in View(motion).channels if x.is_rotation and x.joint == joint]
    back = from_vector(-vectors / channels[0].lever)
    rotations = motion.rotations.copy()
    q = rotations[frames, joint]
    rotations[frames, joint] = product(back, q) if event.in_parent else product(q, back)
    rotations[:, [joint]] = interpolate_rotations(rotations[:, [joint]], missing, motion.rate)
    return replace(motion, rotations=rotations)


def _mend_parts(
    motion: Motion, findings: list[Finding], cuts: list[int], manifold: MotionManifold
) -> Motion:
    """The motion with findings mended, each part between cuts by itself."""
    ends = [0, *cuts, len(motion)]
    parts = []
    for first, end in pairwise(ends):
        part = motion.at(slice(first, end))
        inside = []
        for finding in findings:
            start, last = finding.frames
            if first <= start and last < end and last + 1 - start < end - first:
                inside.append(replace(finding, frames=(start - first, last - first)))
        parts.append(repair_motion(part, manifold, findings=inside).motion if inside else part)
    mended = parts[0]
    for part in parts[1:]:
        mended = join_motions(mended, part)
    return mended
