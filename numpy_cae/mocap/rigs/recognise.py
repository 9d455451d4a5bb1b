"""Recognise the twenty joints in the rig of a file: by names, by hierarchy, or not at all.

The names of known rigs come first. If they leave joints open, the hierarchy suggests these, or all.
A suggestion with nothing against it (`checks`) is used and noted; a doubtful one is only noted, and
`find_joints` then refuses the rig. Doubts about a rig that names determine are noted, too.
"""

from dataclasses import replace

import numpy as np

from numpy_cae.mocap.rigs.checks import doubt, order_problem
from numpy_cae.mocap.rigs.completed import completed, sampled
from numpy_cae.mocap.rigs.rigs import ADDED, Mappings, match_rig, with_joint_names
from numpy_cae.mocap.rigs.suggest import suggest_mapping
from numpy_cae.motion.joints import JOINTS
from numpy_cae.motion.motion import Motion
from numpy_cae.motion.skeleton import Skeleton


def recognised(motion: Motion, mapping: Mappings = None) -> Motion:
    """The motion with names for the twenty joints of its rig, and with the missing ones added.

    Parameters
    ----------
    motion : Motion
    mapping : dict of joint name to the rig's joint name, or several, optional
        The user's, as in `load_motion`; they are not changed.

    Returns
    -------
    Motion
        If names alone do not determine the joints, `unit_note` says what was done about it.

    Examples
    --------
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 1, seconds=1.0, rate=30.0).motion
    >>> recognised(walk).skeleton.names == walk.skeleton.names
    True
    """
    skeleton = with_joint_names(motion.skeleton, mapping)
    motion = replace(motion, skeleton=skeleton)
    by_names = completed(motion)
    joints = _joints(by_names.skeleton)
    if len(joints) == len(JOINTS) and not order_problem(by_names.skeleton, joints):
        problem = "" if mapping else _doubt(by_names)  # an animal's rig may have a person's names
        note = f"; is this a person? {problem}" if problem else ""
        return replace(by_names, unit_note=motion.unit_note + note)
    names = {joint: skeleton.names[index] for joint, index in match_rig(skeleton)[1].items()}
    # Where a joint has position channels, its offset may be wrong: the median in the motion is not.
    offsets = np.median(sampled(motion).translations, axis=0)
    suggested = suggest_mapping(replace(skeleton, offsets=offsets))
    problem = ""
    for candidate in filter(None, (suggested | names, names, suggested)):
        joint_names = candidate | skeleton.joint_names
        named = replace(motion, skeleton=replace(skeleton, joint_names=joint_names))
        proposed = completed(named, estimate=True)
        problem = _doubt(proposed)
        if not problem:
            return replace(proposed, unit_note=f"{motion.unit_note}; {_note(proposed, names)}")
    note = f"; rig not recognised: {problem}" if problem and len(joints) < len(JOINTS) else ""
    return replace(by_names, unit_note=motion.unit_note + note)


def _joints(skeleton: Skeleton) -> list[int]:
    """The indices of those of the twenty joints that names determine."""
    found = match_rig(skeleton)[1]
    return [found[joint] for joint in JOINTS if joint in found]


def _doubt(proposed: Motion) -> str:
    """Why the proposed joints may be wrong; empty if there is no reason to doubt."""
    joints = _joints(proposed.skeleton)
    if len(set(joints)) < len(JOINTS):
        return f"only {len(set(joints))} of the 20 joints were found"
    poses = sampled(proposed)
    rest = replace(proposed.skeleton, offsets=np.median(poses.translations, axis=0))
    body = np.concatenate([rest.rest_positions()[None, joints], poses.positions(joints)])
    return doubt(proposed.skeleton, joints, body)


def _note(motion: Motion, names: dict[str, str]) -> str:
    """What was proposed, for a person; `names` are the joints that a known rig's names gave."""
    skeleton = motion.skeleton
    by_hierarchy = [our for our, name in skeleton.joint_names.items() if names.get(our) != name]
    added = [name.removesuffix(ADDED) for name in skeleton.names if name.endswith(ADDED)]
    listed = ", ".join(by_hierarchy) if len(by_hierarchy) < 4 else f"{len(by_hierarchy)} joints"
    ways = [f"{listed} found by the hierarchy"] if by_hierarchy else []
    ways += [f"{', '.join(added)} added"] if added else []
    return f"{' and '.join(ways)}: `numpy-cae rig` lists the joints"
