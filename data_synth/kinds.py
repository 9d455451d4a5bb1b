"""The kinds of motion, by name, and the call that makes a take of one."""

from __future__ import annotations

import numpy as np

from data_synth.assemble import assemble
from data_synth.body import Body, draw_body
from data_synth.curves import drift
from data_synth.manner import draw_manner
from data_synth.take import Take
from data_synth.walking import bends, grid, set_out, turn_at, walk

_STYLES = {
    "walk": ("neutral", "brisk", "tired"),
    "confident_walk": ("confident",),
    "old_mans_walk": ("old",),
    "walk_with_turn": ("neutral", "confident"),
    "run": ("run",),
}
KINDS = tuple(_STYLES)


def make_take(
    kind: str,
    seed: int | np.random.Generator = 0,
    seconds: float = 8.0,
    rate: float = 120.0,
    style: str | None = None,
    body: Body | None = None,
) -> Take:
    """One take of a kind of motion, unlike any other of another seed.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    seed : int or numpy.random.Generator
    seconds : float
    rate : float
        Frames a second.
    style : str, optional
        Drawn where None.
    body : Body, optional
        Drawn where None.

    Returns
    -------
    Take

    Raises
    ------
    ValueError
        If the kind or the style is not known, or a length or rate is not positive.
    """
    if kind not in _STYLES:
        raise ValueError(f"no kind {kind!r}; there are {', '.join(KINDS)}")
    if not (seconds > 0 and rate > 0):
        raise ValueError(f"seconds is {seconds} and rate is {rate}, expected numbers above 0")
    rng = np.random.default_rng(seed)
    body = body or draw_body(rng)
    style = style or str(rng.choice(_STYLES[kind]))
    manner = draw_manner(rng, style)
    # Some takes begin and end standing, some in full stride, as recordings do.
    lead = 2.5 if kind == "run" or rng.random() < 0.5 else -rng.uniform(0.3, 1.0)
    trail = 2.5 if kind == "run" or rng.random() < 0.5 else -rng.uniform(0.3, 1.0)
    skip = max(lead, 0.0)
    times = grid(seconds + skip + max(trail, 0.0))
    if kind == "walk_with_turn":
        angle = rng.choice([-1, 1]) * np.radians(rng.uniform(60, 170))
        when = skip + seconds * rng.uniform(0.4, 0.6)
        headings = turn_at(rng, times, angle, when, abs(angle) / np.radians(55) + 1.0)
    else:
        headings = rng.uniform(-np.pi, np.pi) + drift(rng, 0.15, 0.03, 0.15)(times)
    begin, end = max(-lead, 0.0), times[-1] + min(trail, 0.0)
    route, phase = set_out(rng, manner, body.stature, headings, times, begin, end)
    t = skip + np.arange(max(round(seconds * rate), 1)) / rate
    pose, contacts = walk(body, manner, route, phase, t, rng)
    motion = assemble(body, pose, rate)
    return Take(motion, kind, style, contacts, route.place(t), route.heading(t))


__all__ = ["KINDS", "bends", "make_take"]
