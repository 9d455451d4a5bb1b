"""Learning manifolds: holden2015, sections 4 and 6; jang2018, "Experimental Setup"."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from functools import partial

import numpy as np

from numpy_cae import training
from numpy_cae.fast import with_engine
from numpy_cae.manifold.model_arrays import MAX_LENGTH
from numpy_cae.manifold.motion_manifold import MotionManifold
from numpy_cae.manifold.probabilistic_pca import ProbabilisticPCA
from numpy_cae.manifold.sequence_manifold import SequenceManifold, common_bones
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.motion import (
    CLIP,
    JOINTS,
    LENGTH,
    RATE,
    AngleSequence,
    bone_lengths,
    change_lengths,
    cut_clips,
    positions_to_features,
)
from numpy_cae.motion.features import FEATURES, POSITIONS, TURN, VELOCITY
from numpy_cae.motion.windows import extend_to_window, window_starts
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
PART_FRAMES = 200_000
"""Features are normalised so many frames at a time: 0.1 GB of float64, 1.9 hours."""
PART_WINDOWS = 64
"""So many windows are measured at a time."""
CLIP_STEP = 5
"""The mean and deviation are computed from clips that start this many frames apart, or
further apart where there would be more than `MOST_CLIPS` of them."""
MOST_CLIPS = 4000
"""The mean and deviation are computed from about this many clips, to bound memory."""


def learn_manifold(
    takes: Iterable[np.ndarray],
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
    takes : iterable of (F, 20, 3) arrays of float
        World positions of the twenty joints in metres, at 30 frames a second. The memory of those
        that an iterator gives, and nothing else refers to, becomes free before the training.
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
    count = len(takes)
    manifold, windows = _normalise_takes(network, takes, window, overlap, schedule)
    if testing:
        report = report_with_error(report, manifold, testing)
    state = training.train_autoencoder(network, windows, schedule, rng, report, checkpoint)
    manifold.settings = {
        "seed": seed,
        "window": window,
        "overlap": overlap,
        "takes": count,
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
    takes: list[np.ndarray],
    window: int,
    overlap: int,
    schedule: training.Schedule,
) -> tuple[MotionManifold, training.Windows]:
    """A manifold with the normalisation and the context of takes (F, 20, 3), and their normalised
    windows.

    The takes are removed from the list, so that the memory of those which nothing else refers to
    becomes free: those of a large database are gigabytes, and so are their features.
    """
    windows, is_real, lengths = _cut_takes(takes, window, overlap)
    mean_pose, scale = _mean_and_scale(windows, is_real, schedule.rms)
    manifold = MotionManifold(network, mean_pose, scale, lengths, RATE, window=window)
    manifold.rescales = schedule.fine_tuning.rescaled
    # In the same memory: a number of the network is not longer than one of the features, so no
    # feature is overwritten before it is normalised.
    features = windows.frames
    frames: np.ndarray = np.ndarray(features.shape, network.layers[0].w.dtype, buffer=features)
    for part in _parts(len(features)):
        frames[part] = manifold.normalise(features[part])
    normalised = training.Windows(frames, windows.starts, window)
    manifold.context = ProbabilisticPCA.fit(normalised, is_real)
    return manifold, normalised


def _cut_takes(
    takes: list[np.ndarray], window: int, overlap: int
) -> tuple[training.Windows, np.ndarray, np.ndarray]:
    """The windows of the features of takes on their mean bones, a mask of the frames that were not
    added to short takes (F,), and the mean bone lengths (20,). The list is empty afterwards."""
    lengths_of_takes = [bone_lengths(take) for take in takes]
    lengths = np.mean(lengths_of_takes, axis=0)
    counts = [max(len(take), window) for take in takes]
    frames = np.empty((sum(counts), FEATURES))
    is_real = np.zeros(len(frames), bool)
    starts: list[np.ndarray] = []
    end = len(frames)
    # From the last to the first: the system takes back memory at the end of that in use.
    while takes:
        take = takes.pop()
        normalised = change_lengths(take, lengths_of_takes[len(takes)], lengths)
        features, _ = positions_to_features(normalised, RATE)
        first = end - counts[len(takes)]
        is_real[first : first + len(take)] = True
        frames[first:end] = extend_to_window(features, window)
        frames[first : first + len(take)] = features  # with the last velocity of a short take
        starts.append(first + window_starts(end - first, window, overlap))
        end = first
    return training.Windows(frames, np.concatenate(starts[::-1]), window), is_real, lengths


def _parts(count: int) -> list[slice]:
    """All frames, `PART_FRAMES` at a time: what is computed of them needs little memory then."""
    return [slice(first, first + PART_FRAMES) for first in range(0, count, PART_FRAMES)]


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


def _mean_and_scale(
    windows: training.Windows, is_real: np.ndarray, rms: float
) -> tuple[np.ndarray, np.ndarray]:
    """The mean pose and the factor of each feature, (63,): one for all positions, one for
    velocity and one for turn, since a turn of a frame is a tenth as large as a position and would
    not be learned."""
    parts = _parts(len(is_real))
    count = np.count_nonzero(is_real)
    mean_pose = np.zeros(FEATURES)
    for part in parts:
        mean_pose += windows.frames[part][is_real[part]].sum(axis=0)
    mean_pose /= count
    scale = np.ones(FEATURES)
    for columns in (POSITIONS, VELOCITY, TURN):
        mean = mean_pose[columns]
        total = 0.0
        for part in parts:
            total += np.sum((windows.frames[part, columns][is_real[part]] - mean) ** 2)
        spread = np.sqrt(total / (count * len(mean)))
        if columns is POSITIONS and spread < MIN_SPREAD:
            raise ValueError("every frame of the takes is the same: there is nothing to learn")
        scale[columns] = rms / max(spread, MIN_SPREAD)
    stands = is_real & ~np.append(is_real[1:], True)  # from the last frame of a short take on
    windows.frames[stands, VELOCITY.start :] = 0.0
    largest = 0.0
    for first in range(0, len(windows), PART_WINDOWS):
        normalised = (windows[first : first + PART_WINDOWS] - mean_pose) * scale
        largest = max(largest, float(np.sqrt(np.mean(normalised**2, axis=(1, 2)).max())))
    return mean_pose, scale * min(1.0, MAX_WINDOW_RMS * rms / largest)
