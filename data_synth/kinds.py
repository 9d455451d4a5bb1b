"""The kinds of motion by name, and `make_take`."""

from collections.abc import Sequence

import numpy as np

from data_synth.assemble import assemble
from data_synth.body import Body, draw_body
from data_synth.dog import bouts, hold_lead
from data_synth.exercise import jumping_jacks, squats
from data_synth.fighting import kick, punch
from data_synth.manner import MANNERS, draw_manner
from data_synth.press_ups import press_ups
from data_synth.route import grid
from data_synth.sidestep import sidestep
from data_synth.stage import Stage
from data_synth.standing import idle, wave
from data_synth.take import Take
from data_synth.waiting import waiting
from data_synth.walking import bends, set_out, turn_at, walk

HOLDEN2015_KINDS = (
    "walk", "confident_walk", "walk_with_turn", "old_mans_walk", "sidestep", "run", "press_ups",
    "squats", "jumping_jacks", "kick", "punch", "wave", "idle",
)  # fmt: skip
"""Motions that holden2015 shows or that are frequent in the CMU database."""
JANG2018_KINDS = ("walking", "waiting", "walking_dog")
"""The three actions of jang2018, from Human3.6M."""
KINDS = (*HOLDEN2015_KINDS, *JANG2018_KINDS)

_WALKS = {
    "walk": ("neutral", "brisk", "tired"),
    "confident_walk": ("confident",),
    "walk_with_turn": ("neutral", "confident"),
    "old_mans_walk": ("old",),
    "run": ("run",),
    "walking": ("neutral", "confident", "brisk", "tired", "old"),
    "walking_dog": ("neutral", "tired", "brisk"),
}
_GESTURES = {
    "sidestep": sidestep,
    "press_ups": press_ups,
    "squats": squats,
    "jumping_jacks": jumping_jacks,
    "kick": kick,
    "punch": punch,
    "wave": wave,
    "idle": idle,
    "waiting": waiting,
}
# The speed of gestures in each style.
_TEMPOS = {"neutral": 1.0, "brisk": 1.18, "tired": 0.85}
# Seconds of walking before the first frame of a take that does not begin at rest.
_LEAD = 2.5
# In seconds; a shorter take begins and ends while walking.
_TIME_TO_STOP = 6.0


def styles_of(kind: str) -> tuple[str, ...]:
    """The styles that a kind can have.

    Raises
    ------
    ValueError
        If the kind is not known.
    """
    require_kinds([kind])
    if kind == "run":
        return ("run",)
    if kind in _WALKS:
        return tuple(style for style in MANNERS if style != "run")
    return tuple(_TEMPOS)


def require_kinds(kinds: Sequence[str]) -> list[str]:
    """The same kinds, if there are any and all are known; else ValueError."""
    unknown = [kind for kind in kinds if kind not in KINDS]
    if unknown or not kinds:
        wrong = f"no kind {unknown[0]!r}" if unknown else "no kind is given"
        raise ValueError(f"{wrong}; there are {', '.join(KINDS)}")
    return list(kinds)


def make_take(
    kind: str,
    seed: int | np.random.Generator = 0,
    seconds: float = 8.0,
    rate: float = 120.0,
    style: str | None = None,
    body: Body | None = None,
) -> Take:
    """One take of a kind of motion; every seed gives another one.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    seed : int or numpy.random.Generator
        The same number gives the same take; a generator is advanced.
    seconds : float
    rate : float
        Frames a second.
    style : str, optional
        One of `styles_of(kind)`; by default drawn from those that suit the kind.
    body : Body, optional
        By default a random one.

    Returns
    -------
    Take

    Raises
    ------
    ValueError
        If the kind or its style is not known, or `seconds` or `rate` is not above 0.
    """
    styles = styles_of(kind)
    if style is not None and style not in styles:
        raise ValueError(f"{kind} has no style {style!r}; it has {', '.join(styles)}")
    for name, value in (("seconds", seconds), ("rate", rate)):
        if not (np.isfinite(value) and value > 0):
            raise ValueError(f"{name} is {value}, expected a number above 0")
    rng = np.random.default_rng(seed)
    body = body or draw_body(rng)
    style = style or str(rng.choice(_WALKS.get(kind, styles)))
    make = _walk if kind in _WALKS else _gesture
    return make(kind, style, body, seconds, rate, rng)


def _gesture(
    kind: str, style: str, body: Body, seconds: float, rate: float, rng: np.random.Generator
) -> Take:
    tempo = _TEMPOS[style] * float(np.exp(rng.normal(0, 0.06)))
    stage = Stage(body, _frame_times(seconds, rate), rng)
    if style == "tired":
        stage.add("bend", 5.0)
        stage.add("nod", 8.0)
    _GESTURES[kind](stage, seconds, tempo)
    pose, contacts = stage.pose()
    motion = assemble(body, pose, rate)
    return Take(motion, kind, style, body, contacts, stage.target_path(), stage.heading)


def _walk(
    kind: str, style: str, body: Body, seconds: float, rate: float, rng: np.random.Generator
) -> Take:
    manner = draw_manner(rng, style)
    # Some takes begin or end at rest, some while walking, as recordings do.
    stands = [kind != "run" and seconds > _TIME_TO_STOP and rng.random() < 0.5 for _ in range(2)]
    lead, trail = (0.0 if standing else _LEAD for standing in stands)
    times = grid(lead + seconds + trail)
    begin = rng.uniform(0.3, 1.0) if stands[0] else 0.0
    end = times[-1] - (rng.uniform(0.3, 1.0) if stands[1] else 0.0)
    headings = _headings(kind, rng, times, lead, seconds)
    walks = bouts(rng, begin, end) if kind == "walking_dog" else [(begin, end)]
    route, phase = set_out(rng, manner, body.stature, times, headings, walks)
    t = lead + _frame_times(seconds, rate)
    pose, contacts = walk(body, manner, route, phase, t, rng)
    if kind == "walking_dog":
        hold_lead(pose, body, route.heading(t), t, rng)
    motion = assemble(body, pose, rate)
    return Take(motion, kind, style, body, contacts, route.place(t), route.heading(t))


def _frame_times(seconds: float, rate: float) -> np.ndarray:
    return np.arange(max(round(seconds * rate), 1)) / rate


def _headings(
    kind: str, rng: np.random.Generator, times: np.ndarray, lead: float, seconds: float
) -> np.ndarray:
    if kind == "walk_with_turn":
        angle = rng.choice([-1, 1]) * np.radians(rng.uniform(60, 170))
        when = lead + seconds * rng.uniform(0.4, 0.6)
        return turn_at(rng, times, angle, when, abs(angle) / np.radians(55) + 1.0)
    if kind == "walking_dog":
        return bends(rng, times, 0.6)
    if kind == "walking":
        return bends(rng, times, rng.choice([0.2, 0.8, 1.6]))
    return bends(rng, times, 0.25)
