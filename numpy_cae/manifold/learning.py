"""Learning manifolds: holden2015, sections 4 and 6; jang2018, "Experimental Setup"."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import partial

import numpy as np

from numpy_cae import training
from numpy_cae.fast import with_engine
from numpy_cae.manifold.model_arrays import MAX_LENGTH
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.sequence_manifold import SequenceManifold, common_bones
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.motion import (
    CLIP,
    JOINTS,
    LENGTH,
    RATE,
    AngleSequence,
    bone_lengths,
    cut_clips,
    cut_windows,
)
from numpy_cae.motion.features import FEATURES, POSITIONS, TURN, VELOCITY, features_on_mean_skeleton
from numpy_cae.training.state import HELD_OUT

Report = Callable[[training.TrainingState], None]
MAX_WINDOW_RMS = 2.0
"""All features are scaled down until no window has a root mean square of more than
this times that of all: a person lying down among people standing would make training diverge."""
MIN_SPREAD = 1e-3
"""A spread (m, rad) smaller than this may be rounding error. Instead of it a sequential
network divides by 1, and a convolutional one by MIN_SPREAD."""
HIDDEN = 128
"""Units of each GRU. jang2018 states neither this number nor the next two
(docs/lab_book/sequence_claims.md)."""
LATENT = 8
"""The size of z."""
BURN_IN = 5
"""Steps of the decoder before the first frame."""
MOST_MEASURED = 20
"""The error while a network learns is that of at most this many test takes."""
CLIP_STEP = 5
"""The mean and deviation are computed from clips that start this many frames apart, or
further apart where there would be more than `MOST_CLIPS` of them."""
MOST_CLIPS = 4000
"""The mean and deviation are computed from about this many clips, to bound memory."""


def learn_manifold(
    takes: Sequence[np.ndarray],
    schedule: training.Schedule | None = None,
    seed: int = 0,
    *,
    window: int = LENGTH,
    overlap: int | None = None,
    filters: Sequence[int] = (64, 128, 256),
    taps: int = 15,
    bound: float = 0.9,
    report: Report | None = None,
    checkpoint: training.Checkpoint | None = None,
    engine: str = "fast",
    testing: Sequence[np.ndarray] = (),
) -> MotionManifold:
    """Train a convolutional manifold on takes.

    Parameters
    ----------
    takes : sequence of (F, 20, 3) arrays of float
        World positions of the twenty joints in metres, at 30 frames a second.
    schedule : Schedule, optional
        The paper's where None.
    window, overlap : int
        Numbers of frames; with three layers `window` is a multiple of 8. Successive windows overlap
        by half a window where None.
    filters, taps, bound
        As in `ConvAutoencoder`.
    report, checkpoint, engine
        As in `train_autoencoder`; the engine is that of `load_manifold`.
    testing : sequence of (F, 20, 3) arrays of float
        Takes to measure the error on after each epoch of fine tuning; nothing is learned from them.

    Returns
    -------
    MotionManifold

    Raises
    ------
    ValueError
        If there are no takes, they do not move, or `window` is not a multiple of the stride.

    Examples
    --------
    A tiny network that has seen one walk for one epoch:

    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import learn_manifold
    >>> from numpy_cae.mocap import body_of
    >>> from numpy_cae.training import Schedule, Stage
    >>> takes = [body_of(make_take("walk", 0, seconds=4.0, rate=30.0).motion)]
    >>> schedule = Schedule(layer=Stage(epochs=0), fine_tuning=Stage(epochs=1, rate=0.1))
    >>> manifold = learn_manifold(takes, schedule, window=32, overlap=16, filters=(8, 12), taps=5)
    >>> manifold
    manifold of layers with 8, 12 filters, learned from 1 take
    >>> manifold.stride, manifold.receptive_radius
    (4, 6)
    """
    takes = list(takes)
    if not takes:
        raise ValueError("there are no takes to learn from")
    require_bodies(takes, "takes")
    require_bodies(testing, "testing")
    if not filters:
        raise ValueError("filters is empty, expected the number of filters of each layer")
    if taps < 1 or taps % 2 == 0:
        raise ValueError(f"taps is {taps}, expected an odd number, so that a filter has a centre")
    schedule = schedule or training.Schedule()
    overlap = window // 2 if overlap is None else overlap
    rng = np.random.default_rng(seed)
    network = ConvAutoencoder(
        filters=filters, taps=taps, bound=bound, rng=rng, initial=schedule.initial
    )
    network = with_engine(network, engine)
    if window % network.stride:
        raise ValueError(f"window is {window}, expected a multiple of {network.stride}")
    manifold, windows = _normalise_takes(network, takes, window, overlap, schedule)
    if testing:
        report = report_with_error(report, manifold, testing)
    state = training.train_autoencoder(network, windows, schedule, rng, report, checkpoint)
    manifold.settings = {
        "seed": seed,
        "window": window,
        "overlap": overlap,
        "takes": len(takes),
        "windows": len(windows),
        "schedule": asdict(schedule),
        "losses": state.losses,
    }
    return manifold


def require_bodies(takes: Sequence[np.ndarray], name: str) -> None:
    """Raise ValueError, naming the argument and the take, unless all are (F, 20, 3), finite and of
    the size of a person."""
    for number, take in enumerate(takes):
        where = f"{name}[{number}]"
        shape = np.shape(take)
        if len(shape) != 3 or shape[1:] != (len(JOINTS), 3) or not shape[0]:
            expected = f"expected (frames, {len(JOINTS)}, 3) and at least one frame"
            raise ValueError(f"{where} has shape {shape}, {expected}")
        if not np.isfinite(take).all():
            raise ValueError(f"{where} has values that are not finite")
        longest = bone_lengths(np.asarray(take)).max()
        if longest > MAX_LENGTH:
            problem = f"{where} has a bone of {longest:.3g} m, expected at most {MAX_LENGTH:g} m"
            raise ValueError(f"{problem}: positions are in metres")


def _normalise_takes(
    network: ConvAutoencoder,
    takes: Sequence[np.ndarray],
    window: int,
    overlap: int,
    schedule: training.Schedule,
) -> tuple[MotionManifold, np.ndarray]:
    """A manifold with the normalisation of takes (F, 20, 3), and their normalised windows."""
    features, lengths = features_on_mean_skeleton(takes, RATE)
    # The features of a large database are gigabytes: keep them once, as views of one array.
    frames = np.concatenate(features)
    features = np.split(frames, np.cumsum([len(take) for take in features])[:-1])
    mean_pose, scale = _mean_and_scale(frames, features, window, overlap, schedule.rms)
    manifold = MotionManifold(network, mean_pose, scale, lengths, RATE, window=window)
    manifold.rescales = schedule.fine_tuning.rescaled
    return manifold, _windows(manifold, features, overlap)


def report_with_error(
    report: Report | None, manifold: MotionManifold, takes: Sequence[np.ndarray]
) -> Report:
    """The report, after the error of the manifold on takes was added to the losses of the state.

    The error is the mean distance (cm) of the joints from their projection. It is measured at the
    end of each epoch in which the whole network learns, on one window of each take, of at most
    `MOST_MEASURED` takes.
    """
    measured = takes[:: -(-len(takes) // MOST_MEASURED)]
    clips = [manifold.features(take)[0][: manifold.window] for take in measured]

    def measure_and_report(state: training.TrainingState) -> None:
        if state.step == 0 and not state.name.startswith("layer"):
            offsets = [manifold.project(clip) - clip for clip in clips]
            vectors = np.concatenate(offsets)[:, POSITIONS].reshape(-1, 3)
            error = 100 * float(np.linalg.norm(vectors, axis=1).mean())
            state.losses.setdefault(HELD_OUT, []).append(error)
        if report is not None:
            report(state)

    return measure_and_report


def learn_sequences(
    sequences: Sequence[AngleSequence],
    schedule: training.SequenceSchedule | None = None,
    seed: int | np.random.Generator = 0,
    *,
    report: Report | None = None,
    checkpoint: training.Checkpoint | None = None,
    hidden: int = HIDDEN,
    latent: int = LATENT,
    burn_in: int = BURN_IN,
    frames: int = CLIP,
    engine: str = "fast",
) -> SequenceManifold:
    """Train a sequential manifold on motions of one action.

    Parameters
    ----------
    sequences : sequence of AngleSequence
        Motions shorter than a clip are skipped.
    schedule, seed, report, checkpoint, engine
        As in `learn_manifold`; after 0 epochs the network is as it was drawn from the seed, or from
        a generator, which is then advanced.
    hidden, latent, burn_in
        As in `SequentialAutoencoder`.
    frames : int
        Frames in a clip.

    Returns
    -------
    SequenceManifold

    Raises
    ------
    ValueError
        If there are no motions, or their rigs differ.

    Examples
    --------
    >>> from data_synth import make_take
    >>> from numpy_cae.manifold import learn_sequences
    >>> from numpy_cae.mocap import angles_of
    >>> from numpy_cae.training import SequenceSchedule
    >>> sequences = [angles_of(make_take("walk", 0, seconds=4.0, rate=50.0).motion)]
    >>> schedule = SequenceSchedule(epochs=1, steps=2, batch=4, directions=4)
    >>> manifold = learn_sequences(sequences, schedule, hidden=6, latent=3)
    >>> manifold.network.encode(manifold.normalise(sequences[0].numbers[None, :50])).shape
    (1, 3)
    """
    if not sequences:
        raise ValueError("there are no motions to learn from")
    schedule = schedule or training.SequenceSchedule()
    rng = np.random.default_rng(seed)
    table, bones = common_bones(sequences)
    step = max(CLIP_STEP, sum(map(len, sequences)) // MOST_CLIPS)
    clips = cut_clips(sequences, step, frames)
    network = SequentialAutoencoder(len(table.columns), hidden, latent, rng, burn_in=burn_in)
    network = with_engine(network, engine)
    manifold = SequenceManifold(network, *mean_and_deviation(clips), table, bones, frames=frames)
    draw = partial(manifold.random_clips, sequences)
    state = training.train_sequential(network, draw, schedule, rng, report, checkpoint)
    manifold.settings = {
        "seed": seed,
        "frames": frames,
        "motions": len(sequences),
        "schedule": asdict(schedule),
        "losses": {"sequences": state.losses["sequences"]},
    }
    for term in ("reconstruction", "discrepancy"):
        manifold.settings[term] = state.losses.get(term, [])[-1:]
    return manifold


def mean_and_deviation(clips: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The mean and deviation of each column of clips (N, T, F); 1 for that of a constant column."""
    deviation = clips.std(axis=(0, 1))
    return clips.mean(axis=(0, 1)), np.where(deviation < MIN_SPREAD, 1.0, deviation)


def _windows(manifold: MotionManifold, features: Sequence[np.ndarray], overlap: int) -> np.ndarray:
    """The normalised windows of all takes, written take by take into one array."""
    window = manifold.window
    counts = [len(cut_windows(take, window, overlap)[0]) for take in features]
    dtype = manifold.network.layers[0].w.dtype
    windows = np.empty((sum(counts), window, FEATURES), dtype)
    for end, count, take in zip(np.cumsum(counts), counts, features, strict=True):
        windows[end - count : end] = manifold.normalise(cut_windows(take, window, overlap)[0])
    return windows


def _mean_and_scale(
    frames: np.ndarray, features: Sequence[np.ndarray], window: int, overlap: int, rms: float
) -> tuple[np.ndarray, np.ndarray]:
    """The mean pose and the factor of each feature, (63,): one for all positions, one for
    velocity and one for turn, since a turn of a frame is a tenth as large as a position and would
    not be learned."""
    mean_pose = frames.mean(axis=0)
    scale = np.ones(FEATURES)
    for part in (POSITIONS, VELOCITY, TURN):
        spread = np.sqrt(np.mean((frames[:, part] - mean_pose[part]) ** 2))
        if part is POSITIONS and spread < MIN_SPREAD:
            raise ValueError("every frame of the takes is the same: there is nothing to learn")
        scale[part] = rms / max(spread, MIN_SPREAD)
    largest = 0.0
    for take in features:
        windows, _ = cut_windows(take, window, overlap)
        squares = np.mean(((windows - mean_pose) * scale) ** 2, axis=(1, 2))
        largest = max(largest, float(np.sqrt(squares.max())))
    return mean_pose, scale * min(1.0, MAX_WINDOW_RMS * rms / largest)
