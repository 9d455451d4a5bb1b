"""The finding about a T-pose at the start of a motion, whose rule is in `mocap.t_pose`."""

from numpy_cae.mocap.t_pose import leading_t_pose
from numpy_cae.motion.motion import Motion
from numpy_cae.repair.finding import BODY, Finding, confidence


def find_t_pose(motion: Motion, sensitivity: float = 0.5) -> list[Finding]:
    """At most one finding, of kind "T-pose".

    Examples
    --------
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[0, 1:] = [0.0, 0.0, 0.0, 1.0]
    >>> find_t_pose(motion)
    [body: frame 0: T-pose (...
    """
    pose = leading_t_pose(motion, 1 / (2 * sensitivity))
    if pose is None:
        return []
    why = f"arms held out, then all joints move by {100 * pose.step:.0f} cm in a frame"
    return [Finding(BODY, (0, pose.frames - 1), "T-pose", why, 0.0, confidence(pose.score))]
