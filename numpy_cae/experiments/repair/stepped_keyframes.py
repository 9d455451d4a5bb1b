"""Stepped animation, every 15th frame held: holden2015, section 7, "Filling in Missing Data".

The paper projects it without knowing the keys and finds smooth transitions between them. Where the
keys are known, one can also interpolate between them, or fill in the rest (`fill`).
"""

from __future__ import annotations

import numpy as np

from numpy_cae.baselines import interpolate_cubically, interpolate_linearly
from numpy_cae.experiments.clips import ENDS_HELD, Clips, project_ends_held
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.repair.repair_baselines import MEDIAN, printed, repair_baselines
from numpy_cae.experiments.result import Animation, Claim, Result, Table
from numpy_cae.experiments.split import split_of
from numpy_cae.manifold import MotionManifold, fill, keyframe_mask
from numpy_cae.motion import POSITIONS
from numpy_cae.motion.joints import JOINTS
from numpy_cae.viz import CORRUPTED, PLAIN, PROJECTED, TRUTH, feature_figure, world_actors

EVERY = 15
DELAY = (EVERY - 1) // 2
"""Mean number of frames that a held key lags behind."""
P = 0.1
"""Of the linear denoiser; also the paper's corruption in training."""
HELD, TRUE = "held", "truth"
LINEAR, CUBIC = "linear interpolation of the keys", "cubic interpolation of the keys"
FILLED = "fill, keys known"
KEYS_KNOWN = (LINEAR, CUBIC, FILLED)
CAPTION = (
    f"Every {EVERY}th frame is held until the next, in all 63 features; measured up to the last "
    f"key. A held key lags behind by {DELAY} frames on average, which a method that does not know "
    f'the keys cannot detect: "delayed" is the error against the truth {DELAY} frames before.'
)


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Hold every 15th frame of test windows and fill in the frames between."""
    split = split_of(manifold, material)
    choosing, testing = _up_to_last_key(split.choosing), _up_to_last_key(split.testing)
    keys = np.arange(0, testing.x.shape[1], EVERY)
    held, practice = _held(testing.x), _held(choosing.x)
    filled, settings = {HELD: held}, {}
    for baseline in repair_baselines(split):
        if baseline.name == MEDIAN:
            continue  # the median of a step function is that function
        setting = baseline.best(practice, choosing)
        filled[baseline.name] = baseline.repair(held, setting)
        settings[baseline.name] = printed(setting)
    filled[f"linear denoiser, 15 frames, p = {P}"] = split.moments.solve(1 - P).repair(held)
    filled[ENDS_HELD] = project_ends_held(manifold, held)
    known = np.zeros(testing.x.shape, dtype=bool)
    known[:, keys] = True
    filled[LINEAR] = interpolate_linearly(held, known)
    filled[CUBIC] = interpolate_cubically(held, keys)
    filled[FILLED] = testing.each(lambda x: fill(manifold, x, keyframe_mask(len(x), EVERY)))
    filled[TRUE] = testing.x

    delayed = testing.later(DELAY)
    measured = {
        name: (testing.error(x), delayed.error(x), testing.jitter(x)) for name, x in filled.items()
    }
    knows = {name: "yes" if name in KEYS_KNOWN else "no" for name in measured} | {TRUE: ""}
    rows = [[name, knows[name], *each, settings.get(name)] for name, each in measured.items()]
    header = ["method", "keys known", "error, cm", "delayed, cm", "jitter, m/s²", "setting"]
    window = testing.typical()
    colours = {HELD: CORRUPTED, LINEAR: PLAIN, CUBIC: PLAIN, ENDS_HELD: PROJECTED, TRUE: TRUTH}
    motions = {name: (testing.features(filled[name], window), colours[name]) for name in colours}
    moving = {name: motions[name] for name in (HELD, ENDS_HELD, TRUE)}
    return Result(
        "Filling in: stepped keyframes",
        [Table(CAPTION, header, rows)],
        _claims(measured),
        lambda: _figure(motions, manifold.rate),
        Animation(world_actors(moving), manifold.rate),
        split.text(),
    )


def _held(x: np.ndarray) -> np.ndarray:
    frames = np.arange(x.shape[1])
    return x[:, frames - frames % EVERY]


def _up_to_last_key(clips: Clips) -> Clips:
    """Only frames between two keys count; windows with one key are left out."""
    frames = np.count_nonzero(clips.real, axis=1)
    last = (frames - 1) // EVERY * EVERY
    between = np.arange(clips.real.shape[1]) <= last[:, None]
    return clips.where(last > 0, between)


def _claims(measured: dict[str, tuple[float, float, float]]) -> list[Claim]:
    held, held_delayed, held_jitter = measured[HELD]
    error, delayed, jitter = measured[ENDS_HELD]
    truth = measured[TRUE][2]
    filled = measured[FILLED][0]
    best = min((LINEAR, CUBIC), key=lambda name: measured[name][0])
    return [
        Claim(
            "Projection inserts smooth transitions between stepped keyframes (holden2015, section "
            "7; held if the jitter differs from the truth's by less than half of it).",
            abs(jitter - truth) < truth / 2,
            f"{held_jitter:.1f} m/s² held, {jitter:.1f} projected, truth {truth:.1f}.",
        ),
        Claim(
            "The inserted transitions correspond to motion (section 7; held if they are nearer to "
            "the true motion than the held keys are, both undelayed and delayed).",
            error < held and delayed < held_delayed,
            f"{held:.2f} cm held, {error:.2f} cm projected; delayed {held_delayed:.2f} and "
            f"{delayed:.2f} cm.",
        ),
        Claim(
            "They are nearer to the true motion than an interpolation of the keys (not in the "
            "paper).",
            filled < measured[best][0],
            f"{best} {measured[best][0]:.2f} cm; the network {error:.2f} cm without the keys "
            f"({delayed:.2f} cm delayed), {filled:.2f} cm with them.",
        ),
    ]


def _figure(motions: dict[str, tuple[np.ndarray, str]], rate: float):
    """The coordinate that moves most, over time."""
    column = int(np.argmax(np.ptp(motions[TRUE][0][:, POSITIONS], axis=0)))
    name = f"{JOINTS[column // 3]} {'xyz'[column % 3]}".replace("_", " ")
    return feature_figure(motions, column, rate, name, {LINEAR: ":", CUBIC: "--"})
