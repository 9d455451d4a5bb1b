"""One view of a motion: what the rules of a repair look at, each computed once.

All metres are those of a body of usual size, so that characters of any size are judged alike.

What a view computes is kept as long as the view is, and the memory for long motions is managed here
alone: of an hour at 120 Hz the motion takes 0.75 GB and its body 0.2 GB. Only the body is large;
jumps take a byte for each joint and frame and are computed in blocks. A view of the next version of
a motion computes only the poses that differ (`after`), and one of every n-th frame none (`every`).
"""

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from numpy_cae.cleanup.channels import Channel, channels_of, off_cubic
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.mocap.rigs.rigs import UnknownRigError
from numpy_cae.motion import JOINTS, RATE, Motion
from numpy_cae.motion.contacts import FEET, sliding_of
from numpy_cae.motion.features import problem_of
from numpy_cae.motion.filters import median_of
from numpy_cae.motion.joints import SIDES
from numpy_cae.motion.motion import blocks, whole_step

LEG_JOINTS = [
    [JOINTS.index(f"{side}_{joint}") for joint in ("hip", "knee", "ankle", "toe")] for side in SIDES
]
"""The joints of both legs among the twenty, in the order of `contacts.FEET`."""
LEG_METRES = 0.84
"""The length of thigh and shank together of a body of usual size (m): that of the mean skeleton of
the starter model."""
OFF_MEDIAN_METRES = 0.08
"""A step of a joint jumps if it differs from the median of seven steps by more than this (m)."""
SHARP_METRES = OFF_MEDIAN_METRES / 2
"""A step that jumps is sharp only if its joint is further than this from a cubic (m), as after a
single step of `OFF_MEDIAN_METRES`."""
SHARP_METRES_A_SECOND_SQUARED = 45.0
"""A step that jumps is sharp only if its joint is further from the cubic than this acceleration
(m/s²) moves it in the time of a frame."""
SHARPNESS_RATIO = 0.45
"""A step that jumps is sharp only if its joint is further from the cubic than this times its
largest step of two frames around. After a frame that is elsewhere the ratio is 1, in noise about 1,
where a joint moves to another place within a step 0.5, where it stops within a frame 0.33; in fast
motion at 24 to 30 frames a second it is mostly below 0.2."""
SHARP = 2
"""The level of a step that jumps and is sharp (`View.jump_levels`)."""


class View:
    """A motion as the rules of a repair look at it.

    Parameters
    ----------
    motion : Motion
        On any rig in which the twenty joints can be found; finite.

    Raises
    ------
    UnknownRigError
        By the properties, if joints are missing or the first pose is not a person's.

    Examples
    --------
    >>> from data_synth import make_take
    >>> view = View(make_take("walk", 0, seconds=2.0, rate=30.0).motion)
    >>> view.body.shape, view.frames(0.5), bool(view.jumps.any())
    ((60, 20, 3), 15, False)
    """

    def __init__(self, motion: Motion):
        self.motion = motion

    def __len__(self) -> int:
        return len(self.motion)

    @property
    def rate(self) -> float:
        """Frames a second."""
        return self.motion.rate

    def frames(self, seconds: float) -> int:
        """A time in frames."""
        return round(seconds * self.motion.rate)

    def after(self, motion: Motion) -> "View":
        """The view of the motion after a step of a repair, of as many frames."""
        if motion is self.motion:
            return self
        view = View(motion)
        differs = np.any(motion.rotations != self.motion.rotations, axis=(1, 2))
        differs |= np.any(motion.translations != self.motion.translations, axis=(1, 2))
        if self._has_body and not differs[0]:  # the size is that of the first pose
            body = self.body.copy()
            body[differs] = motion.at(differs).positions(rig_of(motion).joints) / self.size
            view._body_and_size = body, self.size
        return view

    def every(self, step: int) -> "View":
        """The view of every n-th frame."""
        motion = self.motion.at(slice(None, None, step))
        view = View(replace(motion, rate=self.rate / step))
        if self._has_body:
            view._body_and_size = self.body[::step], self.size
        return view

    def at_about_thirty(self) -> tuple["View", int]:
        """The view of every n-th frame, about thirty a second, and n."""
        step = max(1, round(self.rate / RATE))
        return self.every(step), step

    def resampled(self, rate: float) -> "View":
        """The view of the motion at another rate."""
        view = View(self.motion.resampled(rate))
        step = whole_step(self.rate, rate)
        if step and self._has_body:  # frames are only dropped
            view._body_and_size = self.body[::step], self.size
        return view

    @property
    def _has_body(self) -> bool:
        return "_body_and_size" in vars(self)

    @cached_property
    def _body_and_size(self) -> tuple[np.ndarray, float]:
        positions = self.motion.positions(rig_of(self.motion).joints)
        problem = problem_of(positions[:1])
        if problem:
            raise UnknownRigError(problem)
        legs = [positions[0, leg[:3]] for leg in LEG_JOINTS]  # hip, knee, ankle
        length = np.linalg.norm(np.diff(legs, axis=1), axis=-1).sum(axis=-1).mean()
        size = float(length / LEG_METRES) or 1.0
        positions /= size
        return positions, size

    @property
    def size(self) -> float:
        """The length of the legs, divided by that of a body of usual size."""
        return self._body_and_size[1]

    @property
    def body(self) -> np.ndarray:
        """The twenty joints, as those of a body of usual size, (frames, 20, 3) in metres."""
        return self._body_and_size[0]

    @property
    def is_person(self) -> bool:
        """Whether the joints are found and the first pose is a person's."""
        try:
            return self.size > 0
        except UnknownRigError:
            return False

    @cached_property
    def toes(self) -> np.ndarray:
        """Both toes, as those of a body of usual size, (frames, 2, 3) in metres."""
        return np.take(self.body, FEET, axis=1)

    @cached_property
    def channels(self) -> list[Channel]:
        """The rotations and translations that change."""
        return list(channels_of(self.motion, self.size))

    @cached_property
    def sliding(self) -> float:
        """How fast standing feet slide (`contacts.foot_sliding`), cm/s of a body of usual size."""
        return sliding_of(self.toes, self.rate)

    @cached_property
    def jumps(self) -> np.ndarray:
        """`jump_levels` of all frames."""
        return self.jump_levels()

    def jump_levels(self, frames: np.ndarray | None = None, sensitivity: float = 0.5) -> np.ndarray:
        """How much the steps to the next frame jump.

        Parameters
        ----------
        frames : (N,) array of int, optional
            Only these are looked at; all frames where None.
        sensitivity : float
            With more of it less counts as sharp.

        Returns
        -------
        (frames, 20) array of int8
            0 where a step does not jump, 1 where it differs by more than `OFF_MEDIAN_METRES` from
            the median of seven steps, `SHARP` where, besides, its joint is off the cubic through
            the two frames before it and the two after it.
        """
        levels = np.zeros((len(self), len(JOINTS)), np.int8)
        acceleration = SHARP_METRES_A_SECOND_SQUARED / self.rate**2
        least = max(SHARP_METRES, acceleration) / (2 * sensitivity)
        for part in blocks(np.arange(len(self) - 1) if frames is None else frames):
            first = max(int(part[0]) - 5, 0)
            positions = self.body[first : int(part[-1]) + 6]
            steps = np.diff(positions, axis=0)
            is_jump = np.linalg.norm(steps - median_of(steps, 3), axis=-1) > OFF_MEDIAN_METRES
            off = np.linalg.norm(off_cubic(positions), axis=-1)
            lengths = np.pad(np.linalg.norm(steps, axis=-1), ((2, 2), (0, 0)))
            largest = sliding_window_view(lengths, 5, axis=0).max(axis=-1)
            threshold = np.maximum(least, SHARPNESS_RATIO * largest)
            is_sharp = np.maximum(off[:-1], off[1:]) >= threshold
            levels[part] = (is_jump * np.where(is_sharp, SHARP, 1))[part - first]
        return levels
