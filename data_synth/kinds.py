"""The kinds of motion, by name, and the call that makes a take of one."""

from __future__ import annotations

import numpy as np

from data_synth.assemble import assemble
from data_synth.body import Body, draw_body
from data_synth.dog import bouts, hold_lead
from data_synth.exercise import jumping_jacks, press_ups, squats
from data_synth.fighting import kick, punch
from data_synth.manner import draw_manner
from data_synth.sidestep import sidestep
from data_synth.stage import Stage
from data_synth.standing import idle, wave
from data_synth.take import Take
from data_synth.waiting import waiting
from data_synth.walking import bends, grid, set_out, turn_at, walk

_WALKS = {
    "walk": ("neutral", "brisk", "tired"),
    "confident_walk": ("confident",),
    "old_mans_walk": ("old",),
    "walk_with_turn": ("neutral", "confident"),
    "run": ("run",),
    "walking": ("neutral", "confident", "brisk", "tired", "old"),
    "walking_dog": ("neutral", "tired", "brisk"),
}
_GESTURES = {
    "sidestep": sidestep,
    "squats": squats,
    "jumping_jacks": jumping_jacks,
    "kick": kick,
    "punch": punch,
    "wave": wave,
    "idle": idle,
    "waiting": waiting,
}
_TEMPOS = {"neutral": 1.0, "brisk": 1.18, "tired": 0.85}
_LEAD = 2.5
KINDS = (*_WALKS, *_GESTURES, "press_ups")


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
    if kind not in KINDS:
        raise ValueError(f"no kind {kind!r}; there are {', '.join(KINDS)}")
    if not (seconds > 0 and rate > 0):
        raise ValueError(f"seconds is {seconds} and rate is {rate}, expected numbers above 0")
    rng = np.random.default_rng(seed)
    body = body or draw_body(rng)
    if kind in _WALKS:
        return _walk(kind, rng, seconds, rate, style, body)
    return _gesture(kind, rng, seconds, rate, style, body)


def _gesture(kind, rng, seconds, rate, style, body) -> Take:
    style = style or str(rng.choice(list(_TEMPOS)))
    tempo = _TEMPOS[style] * float(np.exp(rng.normal(0, 0.06)))
    t = np.arange(max(round(seconds * rate), 1)) / rate
    stage = Stage(body, t, rng)
    if kind == "press_ups":
        pose, contacts = press_ups(stage, seconds, tempo)
        return Take(
            assemble(body, pose, rate), kind, style, contacts, pose.place[:, [0, 2]], stage.heading
        )
    _GESTURES[kind](stage, seconds, tempo)
    pose, contacts = stage.pose()
    return Take(assemble(body, pose, rate), kind, style, contacts, stage.asked(), stage.heading)


def _walk(kind, rng, seconds, rate, style, body) -> Take:
    style = style or str(rng.choice(_WALKS[kind]))
    manner = draw_manner(rng, style)
    # Some takes begin and end standing, some in full stride, as recordings do.
    lead, trail = (_LEAD if kind == "run" or rng.random() < 0.5 else 0.0 for _ in range(2))
    times = grid(seconds + lead + trail)
    begin = 0.0 if lead else rng.uniform(0.3, 1.0)
    end = times[-1] if trail else times[-1] - rng.uniform(0.3, 1.0)
    if kind == "walk_with_turn":
        angle = rng.choice([-1, 1]) * np.radians(rng.uniform(60, 170))
        when = lead + seconds * rng.uniform(0.4, 0.6)
        headings = turn_at(rng, times, angle, when, abs(angle) / np.radians(55) + 1.0)
    elif kind == "walking_dog":
        headings = bends(rng, times, 0.6)
    elif kind == "walking":
        headings = bends(rng, times, rng.choice([0.2, 0.8, 1.6]))
    else:
        headings = bends(rng, times, 0.25)
    walks = bouts(rng, begin, end) if kind == "walking_dog" else [(begin, end)]
    route, phase = set_out(rng, manner, body.stature, times, headings, walks)
    t = lead + np.arange(max(round(seconds * rate), 1)) / rate
    pose, contacts = walk(body, manner, route, phase, t, rng)
    if kind == "walking_dog":
        hold_lead(pose, body, route.heading(t), t, rng)
    motion = assemble(body, pose, rate)
    return Take(motion, kind, style, contacts, route.place(t), route.heading(t))
