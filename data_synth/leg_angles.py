"""The laboratory's angles applied to one person: the position of the ankle and so of the pelvis.

With the thigh at α and the knee bent by β, the ankle is, relative to the hip,

    ahead  l₁ sin α + l₂ sin(α - β),      up  -l₁ cos α - l₂ cos(α - β)

and the foot is pitched by α - β + ankle. The *fullness* of the angles, 0 standing still and 1 as
measured, depends on the length of the stride.
"""

from dataclasses import dataclass

import numpy as np

from data_synth.body import Body
from data_synth.manner import Manner
from data_synth.stride import lift_front

# Standing at ease: thigh slightly forwards, knee slightly bent, foot flat.
_STANDING_THIGH = np.radians(3.5)
_STANDING_KNEE = np.radians(7.0)
# The toes bend no further than this against the foot, so the foot stands no steeper at toe off.
_STEEPEST = np.radians(72.0)


@dataclass(frozen=True, eq=False)
class Implied:
    """The consequences of the angles and the length of a stride.

    Parameters
    ----------
    fullness : float
        Of the angles.
    height, sink : float
        The root's height standing still, and how much higher it is on average going, metres.
    bob : (2,) array
        Its cosine and sine of twice the stride's phase, metres.
    ahead : float
        How far the hip is ahead of the standing ankle at the strike, metres.
    """

    fullness: float
    height: float
    sink: float
    bob: np.ndarray
    ahead: float


class LegAngles:
    """The laboratory's curves applied to one person's legs.

    Parameters
    ----------
    body : Body
    manner : Manner
        In radians.
    """

    def __init__(self, body: Body, manner: Manner):
        self.body = body
        self.manner = manner

    def way(self, phase: np.ndarray, fullness) -> tuple[np.ndarray, np.ndarray]:
        """From hip to ankle, forwards and upwards, metres."""
        m = self.manner
        body = self.body
        thigh = _STANDING_THIGH + fullness * (m.curves.thigh(phase) - _STANDING_THIGH)
        bending = _bending(fullness)
        knee = _STANDING_KNEE + bending * (m.curves.knee(phase) - _STANDING_KNEE) + m.crouch
        thigh = thigh + 0.5 * m.crouch
        shank = thigh - knee
        ahead = body.thigh * np.sin(thigh) + body.shank * np.sin(shank)
        return ahead, -body.thigh * np.cos(thigh) - body.shank * np.cos(shank)

    def pitch(self, phase: np.ndarray, fullness) -> np.ndarray:
        """The pitch of a foot in the air, toes up positive, radians."""
        curves = self.manner.curves
        pitch = fullness * (curves.thigh(phase) + curves.ankle(phase))
        pitch = self.manner.roll * (pitch - _bending(fullness) * curves.knee(phase))
        steep = np.where(pitch < 0, pitch / _STEEPEST, 0.0)
        return pitch / (1 + steep**4) ** 0.25

    def implied_by_stride(self, stride: float) -> Implied:
        """The fullness of the angles in strides of a length, and the path of the pelvis.

        While a foot stands, its ankle is known and so is the way from the hip to it: their
        difference is where the pelvis is. By least squares over the stance,
        height = h + c cos 4πφ + s sin 4πφ and way ahead = z + L φ; the angles are as full as
        makes L the length of the stride, found by bisection.

        Parameters
        ----------
        stride : float
            Metres.
        """
        body = self.body
        curves = self.manner.curves
        phase = np.linspace(0.01, curves.toe_off - 0.06, 40)
        line = np.stack([np.ones(40), phase], axis=-1)
        rolls = (phase < curves.foot_flat) | (phase > curves.heel_off)
        pivots = np.where((phase < curves.foot_flat)[:, None], body.heel, body.ball)
        low = 0.0
        high = 2.0
        for _ in range(24):
            fullness = (low + high) / 2
            pitch = np.where(rolls, self.pitch(phase, fullness), 0.0)
            rolled = pivots - lift_front(pivots, pitch)
            ahead, down = self.way(phase, fullness)
            start, length = np.linalg.lstsq(line, rolled[:, 2] - ahead, rcond=None)[0]
            low, high = (fullness, high) if length < stride else (low, fullness)
        waves = [np.ones(40), np.cos(4 * np.pi * phase), np.sin(4 * np.pi * phase)]
        above_hip = -float(body.hip(0)[1])
        heights = body.ankle_height + rolled[:, 1] - down + above_hip
        mean, *bob = np.linalg.lstsq(np.stack(waves, axis=-1), heights, rcond=None)[0]
        _, straight_down = self.way(np.zeros(1), 0.0)
        standing = body.ankle_height - float(straight_down[0]) + above_hip
        bob = self.manner.bob * np.array(bob)
        return Implied(fullness, standing, float(mean) - standing, bob, float(start))


def _bending(fullness):
    """The knee's fullness, which grows less with speed than the thigh's (Winter, 1991)."""
    return np.tanh(fullness) / np.tanh(1.0)
