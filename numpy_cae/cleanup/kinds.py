"""The kinds of damage: one row of `KINDS` each.

A new kind is a row here, and in `repair.STEPS` the functions that find and mend it, unless a step
that is there does. Findings, the steps of a repair, holes, pages and files of findings read the
row.
"""

from dataclasses import dataclass

from numpy_cae.motion import JOINTS

BODY = "body"
"""The joint of a finding about the whole body."""
ROTATION, ROOT, BONE = "rotation", "root", "bone"
"""The channels of a joint: its rotation; its translation if it moves the whole body; its
translation if it is the length of a bone."""
HIPS = ("left_hip", "right_hip")
TURNED_JOINTS = (*HIPS, "left_shoulder", "right_shoulder")
"""The joints that turn a limb."""
TOES = ("left_toe", "right_toe")


@dataclass(frozen=True)
class Kind:
    """A kind of damage.

    Parameters
    ----------
    name : str
        The word that is printed, and that a file of findings has.
    step : str
        The step of a repair (`repair.STEPS`) that mends it; "" if the repair does so before or
        after its steps.
    joints : tuple of str
        What a finding may be about; any joint of the rig or the body where it is empty.
    is_of_one_joint : bool
        A finding is about one joint and never covers the whole file: the other frames show what is
        right.
    channel : str
        `ROTATION`, `ROOT` or `BONE` if one channel of the joint is damaged; "" if all may be.
    is_offset : bool
        Between its ends the motion is right but for an offset, which is undone: of such damage only
        the ends jump.
    is_filled : bool
        The manifold fills in a finding that lasts long.
    """

    name: str
    step: str = ""
    joints: tuple[str, ...] = ()
    is_of_one_joint: bool = False
    channel: str = ""
    is_offset: bool = False
    is_filled: bool = False

    @property
    def is_of_translation(self) -> bool:
        """Whether only a translation is damaged."""
        return self.channel in (ROOT, BONE)


# A pose of reference at the start, which a jump ends.
T_POSE = Kind("T-pose", joints=(BODY,))
# The body is at another place for some frames, or from a frame on.
ROOT_ELSEWHERE = Kind(
    "root elsewhere", "displacements", is_of_one_joint=True, channel=ROOT, is_offset=True
)
# A rotation is turned, by the same turn, for some frames or from a frame on.
TURNED = Kind("turned", "displacements", is_of_one_joint=True, channel=ROTATION, is_offset=True)
# A hip is turned, by a turn that begins and ends within a few frames.
LIMB_TURNED = Kind("limb turned", "limb turns", HIPS)
# A hip or a shoulder is turned, by a turn that begins and ends within a few hundredths of a second.
LIMB_TURNED_QUICKLY = Kind("limb turned quickly", "quick turns", TURNED_JOINTS)
# A rotation is another between a jump and the jump back.
DISPLACED = Kind(
    "displaced", "displacements", is_of_one_joint=True, channel=ROTATION, is_filled=True
)
# A rotation jumps away and back within a few frames.
SPIKE = Kind("spike", "spikes", channel=ROTATION)
# A bone has another length than in the rest of the file.
LENGTH = Kind("length", "displacements", is_of_one_joint=True, channel=BONE, is_offset=True)
# The file repeats a pose until the motion jumps on.
REPEATED = Kind("repeated", "freezes", (BODY,), is_filled=True)
# A rotation stands still until it jumps.
FROZEN = Kind("frozen", "freezes", channel=ROTATION, is_filled=True)
# Values are no numbers.
NOT_FINITE = Kind("not finite", is_filled=True)
# A joint jumps from frame to frame.
JUMPS = Kind("jumps", "jumps", (BODY, *JOINTS))
# Noise in every frame.
JITTER = Kind("jitter", "jitter", (BODY,))
# A foot that stands slides, or is in the floor or above it; of the body, the root does not move as
# the feet do.
FOOT = Kind("foot", "feet", (BODY, *TOES))
# The user says so: the manifold fills it in.
MARKED = Kind("marked", joints=(BODY, *JOINTS))

KINDS = {
    kind.name: kind
    for kind in (
        *(T_POSE, ROOT_ELSEWHERE, TURNED, LIMB_TURNED, LIMB_TURNED_QUICKLY, DISPLACED),
        *(SPIKE, LENGTH),
        *(REPEATED, FROZEN, NOT_FINITE, JUMPS, JITTER, FOOT, MARKED),
    )
}
"""The row of each kind by its name, in the order in which messages list them."""


def kind_of_place(channel: str) -> Kind:
    """What is wrong where the translation of a channel is another: `ROOT_ELSEWHERE` or `LENGTH`."""
    return ROOT_ELSEWHERE if channel == ROOT else LENGTH
