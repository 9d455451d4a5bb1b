"""Figure 3 of jang2018: "stretching, crossing the legs, and resting on the wall have been
reconstructed" in samples of waiting.

Clips of known behaviour are made by the functions that make waiting (`data_synth.waiting`), one act
each, by people that no network has seen; standing still is the fourth behaviour. A sample has the
behaviour of the nearest of these clips.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from data_synth import waiting
from data_synth.assemble import assemble
from data_synth.body import draw_body
from data_synth.stage import Stage
from numpy_cae.evaluation import clip_distances
from numpy_cae.mocap import angles_of
from numpy_cae.motion import cut_clips
from numpy_cae.motion.angles import ANGLE_RATE
from studies.jang2018.training import Study

CLIPS = 16
"""Clips of each act."""
SECONDS = 9.0
START = 0.4
"""An act begins so many seconds after the take."""
STANDING = "standing"
ACTS: dict[Callable | None, str] = {
    waiting.stretch: "stretching",
    waiting.twist_legs: "crossed legs",
    waiting.rest_on_wall: "resting on the wall",
    waiting.lean_back: "resting on the wall",
    None: STANDING,
}
"""Act of `data_synth.waiting` to the behaviour."""
SHOWN = ("stretching", "crossed legs", "resting on the wall")
"""The behaviours of figure 3."""


def count_behaviours(study: Study, clips: np.ndarray, seed: int) -> Counter[str]:
    """How many of the normalised clips (N, F, 54) have each behaviour."""
    references = study.manifold.normalise(_references(seed, study.manifold.frames, CLIPS))
    labels = [label for label in ACTS.values() for _ in range(CLIPS)]
    nearest = clip_distances(clips, references).argmin(axis=1)
    return Counter(labels[place] for place in nearest)


@cache
def _references(seed: int, frames: int, count: int) -> np.ndarray:
    """So many clips (F, 54) of each act, in the order of `ACTS`."""
    references = []
    for number, act in enumerate(ACTS):
        for repeat in range(count):
            rng = np.random.default_rng([seed, 7, number, repeat])
            references.append(_clip(act, rng, frames))
    return np.array(references)


def _clip(act: Callable | None, rng: np.random.Generator, frames: int) -> np.ndarray:
    """The frames (F, 54) in the middle of one act, by a random person."""
    body = draw_body(rng)
    stage = Stage(body, np.arange(round(SECONDS * ANGLE_RATE)) / ANGLE_RATE, rng)
    end = SECONDS
    if act is not None:
        end = act(stage, START, 1.0)
    pose, _ = stage.pose()
    sequence = angles_of(assemble(body, pose, ANGLE_RATE))
    middle = round((START + min(end, SECONDS)) / 2 * ANGLE_RATE)
    first = int(np.clip(middle - frames // 2, 0, len(sequence) - frames))
    part = replace(sequence, numbers=sequence.numbers[first : first + frames])
    return cut_clips([part], frames=frames)[0]
