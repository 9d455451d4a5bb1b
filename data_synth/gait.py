"""Walking and running: the laboratory's joint angles, corrected so that no standing foot slides.

The angles of `gait_curves` determine the path of each ankle under the moving pelvis. While a foot
stands, the floor determines its ankle (`stride`); while it swings, it follows the angles plus a
correction that joins the two,

    ankle(t) = nominal(t) + c(t),     c = stance - nominal, with equal speeds, at toe off and strike

and the leg is bent to it by two-bone inverse kinematics.
"""

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

from data_synth.body import SIGN, Body
from data_synth.curves import drift, ease, fade_out, smooth_over
from data_synth.leg_angles import LegAngles
from data_synth.manner import Manner, in_radians
from data_synth.pose import Leg
from data_synth.route import Route
from data_synth.stride import LONG_AGO, Stances, lift_front
from numpy_cae.motion.features import rotate_about_y


class Gait:
    """The legs and pelvis of a person on a route.

    Parameters
    ----------
    body : Body
    manner : Manner
        In degrees, as listed.
    route : Route
    phase : (N,) array
        Strides done at each of `route.times`, whole numbers at left heel strikes. The walker
        stands where it begins and where it ends.
    rng : numpy.random.Generator
        Draws what differs from step to step.
    """

    def __init__(
        self, body: Body, manner: Manner, route: Route, phase: np.ndarray, rng: np.random.Generator
    ):
        self.body = body
        self.route = route
        self._phase = phase
        self.manner = in_radians(manner)
        self.full_speed = max(float(route.speeds.max()), 1e-6)
        rate = float(np.max(np.diff(phase)) / (route.times[1] - route.times[0]))
        # Where the clock stands still only the ends of that time tell when a phase was reached.
        ticks = np.concatenate([[False], np.diff(phase) > 1e-9, [False]])
        ticking = ticks[1:] | ticks[:-1]
        self._clock = phase[ticking], route.times[ticking]
        self._stride = self.full_speed / rate
        self._angles = LegAngles(body, self.manner)
        self._implied = self._angles.implied_by_stride(self._stride)
        self._drifts = [drift(rng, 1.0) for _ in range(2)]
        self.stances = [self._plan(side, rng) for side in (0, 1)]
        self._lowered = lambda t: 0.0
        self._lowered = self._lowering()
        self._bridges = [self._bridge(side) for side in (0, 1)]

    # -- the pelvis ------------------------------------------------------------------------

    def phase(self, t: np.ndarray) -> np.ndarray:
        """Number of strides at each time."""
        return np.interp(t, self.route.times, self._phase)

    def vigour(self, t: np.ndarray) -> np.ndarray:
        """0 standing, 1 at full speed."""
        return self.route.speed(t) / self.full_speed

    def pelvis_angles(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Heading including the pelvis's own rotation, tilt forwards and drop, radians."""
        m = self.manner
        angle = 2 * np.pi * self.phase(t)
        vigour = self.vigour(t)
        turn = -m.pelvis_turn * vigour * np.cos(angle - 0.10)
        drop = m.pelvis_drop * vigour * np.cos(angle - 2 * np.pi * 0.16)
        tilt = 0.35 * m.lean + np.radians(1.2) * vigour * np.cos(2 * angle - 0.6)
        return self.route.heading(t) + turn, tilt, drop

    def pelvis(self, t: np.ndarray) -> tuple[np.ndarray, Rotation]:
        """The position of the root, (F, 3), and the rotation of the pelvis."""
        m = self.manner
        angle = 2 * np.pi * self.phase(t)
        vigour = self.vigour(t)
        sway = m.sway * vigour * np.cos(angle - 2 * np.pi * 0.30)
        sway = sway + 0.006 * (1 - vigour) * self._drifts[0](t)
        twice = np.stack([np.cos(2 * angle), np.sin(2 * angle)], axis=-1)
        surge = 0.012 * vigour * np.cos(2 * angle + 0.9) + 0.004 * (1 - vigour) * self._drifts[1](t)
        bob = vigour**2 * (self._implied.sink + twice @ self._implied.bob)
        place = rotate_about_y(
            np.stack([sway, self._implied.height + bob - self._lowered(t), surge], axis=-1),
            self.route.heading(t),
        )
        place[..., [0, 2]] += self.route.place(t)
        yaw, tilt, drop = self.pelvis_angles(t)
        return place, Rotation.from_euler("YXZ", np.stack([yaw, tilt, drop], axis=-1))

    def _lowering(self):
        """How far the pelvis sinks so that the legs reach both standing feet, smoothed."""
        rate = 100.0
        t = np.arange(self.route.times[0], self.route.times[-1] + 1 / rate, 1 / rate)
        place, pelvis = self.pelvis(t)
        need = np.zeros(len(t))
        for side in (0, 1):
            hip = place + pelvis.apply(self.body.hip(side))
            k, _, _ = self._locate(t, side)
            # A little beyond toe off, which falls between two of these times.
            standing = t < self.stances[side].toe_off[k] + 1 / rate
            ankle = self._standing_ankle(t, k, side)
            flat = np.sum((ankle - hip)[:, [0, 2]] ** 2, axis=-1)
            highest = np.sqrt(np.maximum((0.993 * self.body.leg) ** 2 - flat, 1e-4))
            need = np.maximum(need, np.where(standing, hip[:, 1] - ankle[:, 1] - highest, 0.0))
        need = smooth_over(need, 0.2 * rate)
        return CubicSpline(t, need)

    # -- the feet --------------------------------------------------------------------------

    def leg(self, t: np.ndarray, side: int) -> tuple[Leg, np.ndarray]:
        """One leg at each time, and whether the ball of its foot stands still, (F,) bool."""
        stances = self.stances[side]
        k, standing, u = self._locate(t, side)
        pitch = self._standing_pitch(t, k, side)
        ankle = stances.ankle_at(t, k, pitch, self.body)
        yaw = stances.yaw[k].copy()
        toes = np.where(t > stances.heel_off[k], np.maximum(-pitch, 0.0), 0.0)
        swing = ~standing
        if swing.any():
            ts = t[swing]
            ks = k[swing]
            us = u[swing]
            yaw[swing] += (stances.yaw[ks + 1] - stances.yaw[ks]) * ease(us)
            pitch[swing] = self._free_pitch(ts, side)
            ankle[swing] = self._swing(ts, ks, us, side)
            relax = np.clip(us / 0.45, 0.0, 1.0)
            bend = np.maximum(-self._free_pitch(stances.toe_off[ks], side), 0.0)
            toes[swing] = bend * (1 - ease(relax))
        foot = Rotation.from_euler("YX", np.stack([yaw, -pitch], axis=-1))
        splay = np.full(len(t), np.radians(2.0))
        ball_rests = standing & (t >= stances.flat[k])
        return Leg(ankle, foot, toes, splay), ball_rests

    def _locate(self, t: np.ndarray, side: int):
        """The stance of each time or the one before its swing; whether standing; how far swung."""
        stances = self.stances[side]
        k = np.maximum(np.searchsorted(stances.strike, t, side="right") - 1, 0)
        standing = t <= stances.toe_off[k]
        after = np.minimum(k + 1, len(stances.strike) - 1)
        span = np.where(standing, 1.0, stances.strike[after] - stances.toe_off[k])
        u = np.where(standing, 0.0, (t - stances.toe_off[k]) / span)
        return k, standing, u

    def _free_pitch(self, t: np.ndarray, side: int) -> np.ndarray:
        return self._angles.pitch(
            self.phase(t) - 0.5 * side, self._implied.fullness * self.vigour(t)
        )

    def _standing_pitch(self, t: np.ndarray, k: np.ndarray, side: int) -> np.ndarray:
        return self._free_pitch(t, side) * self.stances[side].rolling(t, k)

    def _standing_ankle(self, t: np.ndarray, k: np.ndarray, side: int) -> np.ndarray:
        pitch = self._standing_pitch(t, k, side)
        return self.stances[side].ankle_at(t, k, pitch, self.body)

    def _nominal(self, t: np.ndarray, side: int) -> np.ndarray:
        """The ankle by the angles alone, (F, 3), in the world."""
        body = self.body
        sign = SIGN[side]
        place, pelvis = self.pelvis(t)
        ahead, up = self._angles.way(
            self.phase(t) - 0.5 * side, self._implied.fullness * self.vigour(t)
        )
        aside = np.full_like(ahead, sign * (self.manner.width - body.hip_width) / 2)
        hip = place + pelvis.apply(body.hip(side))
        return hip + rotate_about_y(np.stack([aside, up, ahead], axis=-1), self.route.heading(t))

    def _plan(self, side: int, rng: np.random.Generator) -> Stances:
        curves = self.manner.curves
        route = self.route
        m = self.manner
        sign = SIGN[side]
        first = self._phase[0]
        last = self._phase[-1]
        # The last strike before the walk begins, then every one until it ends.
        strikes = np.arange(np.floor(first - 0.5 * side + 1e-9), last) + 0.5 * side
        strikes = strikes[strikes < last - 0.04]
        count = len(strikes)
        # Small enough for a walker who pauses to do so with both feet flat (see `set_out`).
        jitter = np.clip(rng.normal(0.0, 0.003, (3, count)), -0.004, 0.004)

        def time(after, row):
            return np.interp(strikes + after + jitter[row], *self._clock)

        strike = time(0.0, 0)
        flat = time(curves.foot_flat, 0)
        heel_off = time(curves.heel_off, 1)
        toe_off = time(curves.toe_off, 2)
        strike[0], flat[0] = -2 * LONG_AGO, -LONG_AGO
        heel_off[-1], toe_off[-1] = LONG_AGO, 2 * LONG_AGO
        middle_phase = 0.5 * (curves.foot_flat + curves.heel_off)
        passing = np.interp(strikes + middle_phase, *self._clock)
        heading = route.heading(passing)
        vigour = self.vigour(passing)
        behind = self._implied.ahead + self._stride * middle_phase
        ahead = self.body.hip(0)[2] - vigour * behind
        ahead += (1 - vigour) * self._angles.way(np.zeros(1), 0.0)[0]
        aside = sign * (0.5 * m.width + np.clip(rng.normal(0, 0.008, count), -0.016, 0.016))
        ankle = rotate_about_y(np.stack([aside, np.zeros(count), ahead], axis=-1), heading)
        ankle[:, [0, 2]] += route.place(passing)
        ankle[:, 1] = self.body.ankle_height
        yaw = heading + sign * (m.toe_out + np.radians(1.5) * rng.normal(size=count).clip(-2, 2))
        return Stances(strike, flat, heel_off, toe_off, ankle, yaw)

    def _bridge(self, side: int, h: float = 0.004):
        """For each swing, the correction and its speed at toe off and at the strike."""
        stances = self.stances[side]
        k = np.arange(len(stances.strike) - 1)
        off = stances.toe_off[:-1]
        strike = stances.strike[1:]
        ends = []
        for t, stance, step in ((off, k, -h), (strike, k + 1, h)):
            here = self._standing_ankle(t, stance, side) - self._nominal(t, side)
            there = self._standing_ankle(t + step, stance, side) - self._nominal(t + step, side)
            ends += [here, (there - here) / step]
        lift = self._lift(k, ends, side)
        return (*ends, lift)

    def _lift(self, k: np.ndarray, ends: list[np.ndarray], side: int) -> np.ndarray:
        """How much each swing must be raised for the sole to clear the floor."""
        stances = self.stances[side]
        u = np.linspace(0.15, 0.85, 22)
        if not len(k):
            return np.zeros(0)
        off = stances.toe_off[k]
        span = stances.strike[k + 1] - stances.toe_off[k]
        t = (off[:, None] + u * span[:, None]).ravel()
        ks = np.repeat(k, len(u))
        us = np.tile(u, len(k))
        ankle = self._swing_unlifted(t, ks, us, side, ends)
        pitch = self._free_pitch(t, side)
        sole = (ankle + lift_front(self.body.heel, pitch))[:, 1]
        for point, since in ((self.body.ball_sole, 0.0), (self.body.toe_tip, 0.45)):
            height = (ankle + lift_front(point, pitch))[:, 1]
            sole = np.where(us >= since, np.minimum(sole, height), sole)
        bump = np.sin(np.pi * us) ** 2
        need = self.manner.clearance - sole / bump
        return np.maximum(need.reshape(len(k), -1).max(axis=1), 0.0)

    def _swing_unlifted(self, t, k, u, side, ends):
        stances = self.stances[side]
        span = stances.strike[k + 1] - stances.toe_off[k]
        value0, speed0, value1, speed1 = (end[k] for end in ends)
        since = u * span
        until = (1 - u) * span
        correction = value0 + (value1 - value0) * ease(u)[:, None]
        correction += fade_out(since)[:, None] * speed0 - fade_out(until)[:, None] * speed1
        return self._nominal(t, side) + correction

    def _swing(self, t, k, u, side):
        *ends, lift = self._bridges[side]
        ankle = self._swing_unlifted(t, k, u, side, ends)
        ankle[:, 1] += lift[k] * np.sin(np.pi * u) ** 2
        return ankle
