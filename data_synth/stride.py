"""The stances of a walk, with their times and positions, and the foot that rolls over them.

A stance has four times. From the strike to foot flat the foot rotates about its heel, to heel
off it stands flat, to toe off it rotates about its ball while the toes stay on the floor: Perry's
heel, ankle and forefoot rockers (1992, chapter 3). So some point of the foot is always at rest.
"""

from dataclasses import dataclass

import numpy as np

from data_synth.body import Body
from data_synth.curves import ease
from numpy_cae.motion.features import rotate_about_y

# Seconds before a walk that begins with standing, and after a walk that ends with standing.
LONG_AGO = 1e4


@dataclass(eq=False)
class Stances:
    """The K stances of one foot, in order of time.

    Parameters
    ----------
    strike, flat, heel_off, toe_off : (K,) arrays
        Seconds; far off (`LONG_AGO`) where the walk begins and ends standing.
    ankle : (K, 3) array
        The ankle while the foot stands flat, in the world, metres.
    yaw : (K,) array
        The foot's direction about Y, radians.
    """

    strike: np.ndarray
    flat: np.ndarray
    heel_off: np.ndarray
    toe_off: np.ndarray
    ankle: np.ndarray
    yaw: np.ndarray

    def rolling(self, t: np.ndarray, k: np.ndarray) -> np.ndarray:
        """The foot's pitch as a share of that in the air: 1 at the strike, 0 flat, 1 at toe off."""
        loading = 1 - ease((t - self.strike[k]) / (self.flat[k] - self.strike[k]))
        # The heel is free to rise as it would in two thirds of the time from heel off to toe off.
        span = np.maximum(self.toe_off[k] - self.heel_off[k], 1e-3)
        return loading + ease((t - self.heel_off[k]) / (0.65 * span))

    def ankle_at(self, t: np.ndarray, k: np.ndarray, pitch: np.ndarray, body: Body) -> np.ndarray:
        """The ankle at times within stance k, (F, 3): turned about the heel or the ball."""
        pivot = np.where((t < self.flat[k])[:, None], body.heel, body.ball)
        moved = pivot - lift_front(pivot, pitch)
        return self.ankle[k] + rotate_about_y(moved, self.yaw[k])


def lift_front(way: np.ndarray, pitch: np.ndarray) -> np.ndarray:
    """The vectors (F, 3) with their front lifted by `pitch` radians: Rx(-pitch)."""
    c = np.cos(pitch)
    s = np.sin(pitch)
    x, y, z = np.moveaxis(np.broadcast_to(way, (*pitch.shape, 3)), -1, 0)
    return np.stack([x, c * y + s * z, c * z - s * y], axis=-1)
