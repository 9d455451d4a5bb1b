"""The angles of hip, knee and ankle over one stride, from the gait laboratory, as Fourier series.

The values are those of healthy adults at their own speed: Winter, *The Biomechanics and Motor
Control of Human Gait* (1991), with the phases as in Perry, *Gait Analysis* (1992), and, for running
near 3 m/s, Novacheck, *Gait & Posture* 7 (1998) 77-95. They are rounded to the degree and given
every 5 % of the stride, from heel strike to the next heel strike of the same foot. The thigh is
measured against the vertical; knee flexion and ankle dorsiflexion are positive.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

_WALK = {
    "thigh": [22, 20.5, 18, 14.5, 10, 5.5, 1, -3.5, -8, -12,
              -15.5, -16, -12, -4, 6, 14.5, 21, 25, 25.5, 24],
    "knee": [5, 11, 17, 19, 18, 15, 11.5, 9, 8, 9.5, 14, 23, 36.5, 51, 61, 64, 57, 42, 23, 8],
    "ankle": [0, -5, -5, -1, 2.5, 5, 7, 8.5, 9.5, 9.5, 6, -4, -15, -19, -13, -6, -1.5, 0.5, 1.5, 1],
}  # fmt: skip
_RUN = {
    "thigh": [28, 27, 23, 17, 10, 2, -6, -13, -17, -16, -10, -1, 10, 21, 31, 38, 42, 42, 38, 32],
    "knee": [17, 29, 38, 40, 36, 29, 22, 18, 22, 36, 56, 76, 92, 100, 99, 88, 67, 42, 21, 13],
    "ankle": [5, 9, 16, 20, 20, 15, 3, -12, -22, -22, -14, -6, -1, 2, 4, 5, 6, 6, 6, 5],
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class FourierSeries:
    """y(φ) = Σ_k a_k cos(2πkφ) + b_k sin(2πkφ), φ in strides, y in radians."""

    cosines: np.ndarray
    sines: np.ndarray

    def __call__(self, phase: np.ndarray) -> np.ndarray:
        """The angle in radians at each phase (any shape), 1.0 being a whole stride."""
        # Powers of one complex exponential cost a tenth of a cosine for each harmonic.
        turn = np.exp(2j * np.pi * np.asarray(phase))
        series = self.cosines - 1j * self.sines
        total = np.full(turn.shape, series[-1])
        for coefficient in series[-2::-1]:
            total = total * turn + coefficient
        return total.real

    @property
    def mean(self) -> float:
        """The mean over a stride, radians."""
        return float(self.cosines[0])


def fourier_series(degrees: Sequence[float], harmonics: int = 7) -> FourierSeries:
    """The series through equally spaced samples of one period.

    Parameters
    ----------
    degrees : sequence of float
    harmonics : int
        Gait needs six or seven: 99.7 % of the power of joint angles lies below the seventh
        (Winter, 2009, section 3.4.2).
    """
    spectrum = np.fft.rfft(np.radians(degrees))[: harmonics + 1] / len(degrees)
    spectrum[1:] *= 2
    return FourierSeries(spectrum.real, -spectrum.imag)


@dataclass(frozen=True)
class LegCurves:
    """One gait: the angles of the leg and the times of the foot's contacts, in strides.

    Parameters
    ----------
    thigh, knee, ankle : FourierSeries
    foot_flat, heel_off, toe_off : float
        Counted from the strike of the same foot.
    """

    thigh: FourierSeries
    knee: FourierSeries
    ankle: FourierSeries
    foot_flat: float
    heel_off: float
    toe_off: float


WALK = LegCurves(
    **{joint: fourier_series(degrees) for joint, degrees in _WALK.items()},
    foot_flat=0.058,
    heel_off=0.34,
    toe_off=0.57,
)
RUN = LegCurves(
    **{joint: fourier_series(degrees) for joint, degrees in _RUN.items()},
    foot_flat=0.06,
    heel_off=0.16,
    toe_off=0.355,
)
