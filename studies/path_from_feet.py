"""How well does `repair --feet` find the path of a root that the file does not have?

The hips of every EVERY-th take, at most SECONDS of it at thirty frames a second, are held at one
place, as many estimators from video hold them. Rotations get noise of 1 and of 3 degrees about each
axis with a correlation of 0.7 from frame to frame, and are smoothed by `smooth_motion`. The true
path and the true contacts are known.

    python -m studies path_from_feet --data bandai

docs/lab_book/evidence.md has the figures.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.evaluation import foot_sliding
from numpy_cae.evaluation import jitter as acceleration
from numpy_cae.mocap import body_positions, find_motion_files, load_motion, retarget
from numpy_cae.motion import Motion
from numpy_cae.motion.contacts import FEET, find_contacts
from numpy_cae.motion.quaternions import from_vector, product
from numpy_cae.repair.feet import find_feet, mend_feet
from numpy_cae.repair.jumps import smooth_motion
from studies.shared.result import Result, Table

EVERY, SECONDS, RATE = 23, 8.0, 30.0
DEGREES, CORRELATION = (1.0, 3.0), 0.7
HEADER = (
    "path from the true one, cm",
    "speed of joints from the true one, cm/s",
    "feet that truly stand, cm/s",
    "lower foot, cm/s",
    "acceleration, m/s²",
)
METHODS: dict[str, Callable[[Motion], Motion]] = {
    "hips held": lambda motion: motion,
    "the lower toe held in each frame": lambda motion: _toe_held(motion),
    "--feet": lambda motion: mend_feet(motion, find_feet(motion, 0.6)),
}


def run(folders: Sequence[Path], every: int = EVERY, seed: int = 0) -> Result:
    """Measure every method on every EVERY-th take of the folders."""
    rng, measures = np.random.default_rng(seed), {name: [] for name in METHODS}
    paths = [path for folder in folders for path in find_motion_files(folder)]
    for path in paths[::every]:
        take = load_motion(path)
        take = take.resampled(RATE) if take.rate > 40 else take
        take = take.at(slice(round(SECONDS * RATE)))
        for degrees in DEGREES:
            held = smooth_motion(noisy(hips_held(take), degrees, rng))
            for name, method in METHODS.items():
                measures[name].append(measured(method(held), take))
    rows = [[name, *np.nanmean(values, axis=0)] for name, values in measures.items()]
    caption = f"{len(measures['--feet'])} damaged takes."
    return Result("The path of the root", [Table(caption, ["", *HEADER], rows, best="low")], [])


def hips_held(motion: Motion) -> Motion:
    """The motion with its hips at one place."""
    body = body_positions(motion)
    return retarget(motion, body - body[:, :1] + np.median(body[:, :1], axis=0))


def noisy(motion: Motion, degrees: float, rng: np.random.Generator) -> Motion:
    """The motion with correlated noise on the rotations that change."""
    white = rng.normal(size=(*motion.rotations.shape[:2], 3)) * np.radians(degrees)
    noise = white.copy()
    for frame in range(1, len(noise)):
        fresh = np.sqrt(1 - CORRELATION**2) * white[frame]
        noise[frame] = CORRELATION * noise[frame - 1] + fresh
    changes = np.ptp(motion.rotations, axis=0).max(axis=-1) > 1e-6
    turns = from_vector(noise * changes[:, None])
    return replace(motion, rotations=product(motion.rotations, turns))


def measured(motion: Motion, take: Motion) -> list[float]:
    """The measures of `HEADER`."""
    after, true = body_positions(motion), body_positions(take)
    off = (after - true)[:, 0]
    path = np.linalg.norm((off - off[0])[:, [0, 2]], axis=-1).mean()
    speed = np.linalg.norm(np.diff(after - true, axis=0), axis=-1).mean() * take.rate
    contacts = find_contacts(true, take.rate)
    steps = np.linalg.norm(np.diff(after[:, FEET][..., [0, 2]], axis=0), axis=-1) * take.rate
    stands = contacts[1:] & contacts[:-1]
    slides = steps[stands].mean() if stands.any() else np.nan
    lower = foot_sliding(after, take.rate)
    return [100 * path, 100 * speed, 100 * slides, lower, acceleration(after, take.rate)]


def _toe_held(motion: Motion) -> Motion:
    """The simplest rule: in each step the root moves so that the toe of the lower foot does not."""
    body = body_positions(motion)
    toes = body[:, FEET]
    lower = (toes[1:, :, 1] + toes[:-1, :, 1]).argmin(axis=1)
    steps = np.diff(toes, axis=0)[np.arange(len(lower)), lower]
    return retarget(motion, body - np.cumsum(np.pad(steps, ((1, 0), (0, 0))), axis=0)[:, None])
