"""The route of a walker: speed, heading and position on the floor as functions of time.

position(t) = ∫ speed(τ) · (sin heading(τ), cos heading(τ)) dτ
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import CubicHermiteSpline

_GRID = 200.0


@dataclass(frozen=True, eq=False)
class Route:
    """A route on the floor.

    Parameters
    ----------
    times : (N,) array
        Seconds.
    speeds, headings : (N,) arrays
        Metres a second and radians about Y, 0 facing +Z and growing towards +X (the left).
    start : (2,) array-like
        x and z at time 0, metres.
    """

    times: np.ndarray
    speeds: np.ndarray
    headings: np.ndarray
    start: tuple[float, float] = (0.0, 0.0)
    _place: CubicHermiteSpline = field(init=False, repr=False)

    def __post_init__(self) -> None:
        velocity = self.speeds[:, None] * np.stack(
            [np.sin(self.headings), np.cos(self.headings)], axis=-1
        )
        step = np.diff(self.times)[:, None]
        moved = np.concatenate(
            [np.zeros((1, 2)), np.cumsum(step * (velocity[1:] + velocity[:-1]) / 2, axis=0)]
        )
        place = CubicHermiteSpline(self.times, moved + np.asarray(self.start), velocity)
        object.__setattr__(self, "_place", place)

    def place(self, t: np.ndarray) -> np.ndarray:
        """x and z at each time, (..., 2), metres; standing still before and after."""
        return self._place(np.clip(t, self.times[0], self.times[-1]))

    def heading(self, t: np.ndarray) -> np.ndarray:
        """Radians about Y at each time."""
        return np.interp(t, self.times, self.headings)

    def speed(self, t: np.ndarray) -> np.ndarray:
        """Metres a second at each time."""
        return np.interp(t, self.times, self.speeds)


def grid(seconds: float) -> np.ndarray:
    """The times at which a route is sampled, 200 a second."""
    return np.arange(int(np.ceil(seconds * _GRID)) + 1) / _GRID
