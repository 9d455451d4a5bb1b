"""The times that trainings need to one error: numpy_cae, and the same networks in PyTorch.

The trainings run in turns in one process, so that a change of the machine's speed affects all of
them.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from data_synth import plan_takes
from numpy_cae.cli.shared.output import note
from numpy_cae.evaluation.clips import Clips
from numpy_cae.fast import accelerate
from numpy_cae.manifold import learn_manifold
from numpy_cae.manifold.learning import BURN_IN, HIDDEN, LATENT, mean_and_deviation
from numpy_cae.manifold.shifted_projection import zeroed_fraction
from numpy_cae.mocap import body_of
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.motion import RATE, cut_clips, cut_windows, draw_clips
from numpy_cae.training import (
    SEQUENCE_RECIPES,
    Schedule,
    SequenceSchedule,
    Stage,
    TrainingState,
    recipe,
    unit_directions,
    zero_values,
)
from numpy_cae.training.adam import BETA_2
from numpy_cae.training.layerwise import autoencoder_steps
from numpy_cae.training.sequential import Draw, sequential_steps
from studies.jang2018.actions import synthetic_action
from studies.shared.clips import testing_of
from studies.shared.material import Material, unlabelled
from studies.shared.result import Table
from studies.timing.alternately import PAUSE_SECONDS
from studies.timing.torch_convolutional import TorchModel, torch, windows
from studies.timing.torch_sequential import SequenceCase, TorchSequenceModel

MINUTES = 20.0
"""Without --data: minutes of synthetic motion, of which every fourth take is held out."""
SEQUENCE_MINUTES = 180.0
"""Minutes of synthetic walking to train on, and as many of other people to hold out."""
USUAL = Stage(epochs=50, rate=0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch with the usual settings: Adam's and `OneCycleLR`'s own, no bound on the norm. The batch,
the peak rate and the epochs are those that need the least time
(docs/lab_book/end_to_end.md)."""
USUAL_SEQUENCES = SequenceSchedule(rate=0.001)
"""The same, with the batch and the bound on the norm of the recipe paper."""
USUAL_BETA_2 = 0.999


@dataclass
class Training:
    """A training in `count` turns, such as epochs, with the seconds and the error after each.

    `turns` trains for one turn at each `next`; `error` measures the network on held-out motion.
    """

    name: str
    count: int
    turns: Iterator[None]
    error: Callable[[], float]
    seconds: list[float] = field(default_factory=list)
    errors: list[float] = field(default_factory=list)

    def take_turn(self) -> None:
        """Train for one turn and measure; only the training is timed."""
        time.sleep(PAUSE_SECONDS)
        start = time.perf_counter()
        next(self.turns)
        before = self.seconds[-1] if self.seconds else 0.0
        self.seconds.append(before + time.perf_counter() - start)
        self.errors.append(self.error())

    def seconds_to(self, error: float) -> float:
        """The seconds of training after which the error is first at most so large."""
        turn = next(turn for turn, each in enumerate(self.errors) if each <= error)
        return self.seconds[turn]


def time_to_quality(material: Material | None, sequential: bool) -> Table:
    """Train in turns, on the takes of a material or on synthetic motion."""
    if torch is None:
        raise ValueError("PyTorch is not installed (package torch)")
    made = on_clips() if sequential else on_takes(material)
    train_in_turns(made)
    return quality(made, "of the variance" if sequential else "cm")


def train_in_turns(trainings: Sequence[Training]) -> None:
    """Train all, each time the one with the smallest share of its turns done, so that a change of
    the machine's speed affects all of them."""
    while waiting := [each for each in trainings if len(each.errors) < each.count]:
        each = min(waiting, key=lambda one: len(one.errors) / one.count)
        each.take_turn()
        done = f"{each.name}, {len(each.errors)}/{each.count}"
        note(f"{done}: {each.seconds[-1]:.1f} s, held-out error {each.errors[-1]:.3f}")


def quality(trainings: Sequence[Training], unit: str) -> Table:
    """The seconds of each training to the lowest error that all reach; ours is the first."""
    target = max(min(each.errors) for each in trainings)
    seconds = [each.seconds_to(target) for each in trainings]
    rows = [
        [each.name, needed, needed / seconds[0], each.seconds[-1], min(each.errors)]
        for each, needed in zip(trainings, seconds, strict=True)
    ]
    needed = f"seconds to {target:.3f} {unit}"
    header = ["training", needed, "ratio", "seconds in all", f"lowest error, {unit}"]
    return Table("", header, rows, ("", ".1f", ".2f", ".1f", ".3f"))


def trainings(
    x: np.ndarray, schedule: Schedule, error: Callable[[Callable], float], seed: int = 0
) -> list[Training]:
    """Denoising end to end of normalised windows (N, T, 63): ours by the fine tuning of `schedule`,
    PyTorch's by `USUAL` and by the same, all from the initial weights of `schedule`. `error`
    measures a repair, in cm."""
    torch.manual_seed(seed)
    rng, stage = np.random.default_rng(seed), schedule.fine_tuning
    model = accelerate(ConvAutoencoder(rng=rng, initial=schedule.initial))
    whole = Schedule(layer=Stage(epochs=0), fine_tuning=stage)
    state = TrainingState(model.parameters, np.random.default_rng(seed))
    ours = _epochs(autoencoder_steps(model, x, whole, state), state)
    next(torch_epochs(TorchModel(model), x[: USUAL.batch], USUAL, USUAL_BETA_2))  # takes seconds

    def error_of(network: Any) -> float:
        return error(lambda x: network.project(x / (1 - zeroed_fraction(x))))

    def theirs(network: TorchModel, by: Stage, beta_2: float) -> Iterator[None]:
        return torch_epochs(network, x, by, beta_2)

    return _three(model, TorchModel, ours, theirs, (stage, USUAL), error_of)


def sequence_trainings(
    draw: Draw, held_out: np.ndarray, schedule: SequenceSchedule, seed: int = 0
) -> list[Training]:
    """The same of clips that `draw` draws: ours by `schedule`, PyTorch's by `USUAL_SEQUENCES` and
    by `schedule`. The mean squared error is that of `held_out`, clips (N, T, features)."""
    sizes, rng = (held_out.shape[2], HIDDEN, LATENT), np.random.default_rng(seed)
    model = accelerate(SequentialAutoencoder(*sizes, rng, burn_in=BURN_IN))
    state = TrainingState(model.weights, np.random.default_rng(seed))
    ours = _epochs(sequential_steps(model, draw, schedule, state), state)

    def error_of(network: Any) -> float:
        return float(np.mean((network.denoise(held_out) - held_out) ** 2, dtype=np.float64))

    def theirs(network: TorchSequenceModel, by: SequenceSchedule, beta_2: float) -> Iterator[None]:
        return torch_sequence_epochs(network, draw, by, beta_2)

    both = schedule, USUAL_SEQUENCES
    return _three(model, TorchSequenceModel, ours, theirs, both, error_of)


def _three(
    model: Any, torch_model: Callable, ours: Iterator, theirs: Callable, by: tuple, error: Callable
) -> list[Training]:
    """Our training, and PyTorch's by the usual settings and by ours, from the same weights."""
    settings = {"PyTorch, usual settings": (by[1], USUAL_BETA_2)}
    settings["PyTorch, our settings"] = by[0], BETA_2
    made = [Training("numpy_cae", by[0].epochs, ours, lambda: error(model))]
    for name, (stage, beta_2) in settings.items():
        network = torch_model(model)
        turns = theirs(network, stage, beta_2)
        made.append(Training(name, stage.epochs, turns, lambda net=network: error(net)))
    return made


def _epochs(steps: Iterator, state: TrainingState) -> Iterator[None]:
    """Train for an epoch at each `next`, as `numpy-cae train` does."""
    for _ in steps:
        if state.step == 0:
            yield


def torch_epochs(model: TorchModel, x: np.ndarray, stage: Stage, beta_2: float) -> Iterator[None]:
    """The same in PyTorch."""
    every = windows(x)
    update = _torch_update(model, stage, -(-len(every) // stage.batch), beta_2)
    (low, high), masks = stage.zeroed, [None] * len(model.layers)
    for _ in range(stage.epochs):
        for chosen in torch.randperm(len(every)).split(stage.batch):
            x = every[chosen]
            p = low + (high - low) * torch.rand(len(x), 1, 1)
            corrupted = x * (torch.rand(x.shape) >= p) / (1 - p)
            model.loss(x, corrupted, masks, model.layers).backward()
            update()
        yield


def torch_sequence_epochs(
    model: TorchSequenceModel, draw: Draw, schedule: SequenceSchedule, beta_2: float, seed: int = 0
) -> Iterator[None]:
    """The same of the sequential network."""
    rng, sizes = np.random.default_rng(seed), (schedule.batch, LATENT)
    update = _torch_update(model, schedule, schedule.steps, beta_2)
    for _ in range(schedule.epochs):
        for _ in range(schedule.steps):
            prior = rng.standard_normal(sizes, dtype=np.float32)
            directions = unit_directions(schedule.directions, LATENT, rng)
            case = SequenceCase(draw(rng, schedule.batch), prior, directions)
            model.function(case, schedule.weight)()
            update()
        yield


def _torch_update(model: Any, by: Any, steps: int, beta_2: float) -> Callable[[], None]:
    """A function that moves parameters by Adam and a one-cycle rate and clears their gradients;
    `steps` are those of an epoch."""
    optimiser = torch.optim.Adam(model.parameters, betas=(0.9, beta_2), fused=True)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, by.rate, by.epochs * steps)

    def update() -> None:
        if by.norm is not None:
            torch.nn.utils.clip_grad_norm_(model.parameters, by.norm)
        optimiser.step()
        rates.step()
        optimiser.zero_grad()

    return update


def on_takes(material: Material | None) -> list[Training]:
    """Of the convolutional network; the error is that of the table of `numpy-cae train`."""
    if material is None:
        halves: tuple[list, list] = ([], [])
        for plan in plan_takes(MINUTES):
            halves[plan.number % 4 == 0].append(body_of(plan.make(RATE).motion))
        material = unlabelled(*halves)
    schedule = recipe("fast")
    x, testing = windows_of(material, schedule.rms)
    damaged = zero_values(testing.x, 0.5, np.random.default_rng(0))
    return trainings(x, schedule, lambda repair: testing.error(repair(damaged)))


def windows_of(material: Material, rms: float) -> tuple[np.ndarray, Clips]:
    """Normalised windows (N, T, 63) to train on, scaled to `rms`, and the windows to test on."""
    takes = [take.positions for take in material.training]
    untrained = Schedule(Stage(epochs=0), Stage(epochs=0), rms=rms)
    # For the mean pose, the scale and the mean skeleton; its network is not used.
    frame = learn_manifold(takes, untrained, filters=(1,), taps=1)
    cut = [frame.normalise(cut_windows(frame.features(take)[0])[0]) for take in takes]
    return np.concatenate(cut), testing_of(frame, material)[0]


def on_clips() -> list[Training]:
    """Of the sequential network, on synthetic walking; the error is of other people's clips."""
    action = synthetic_action("walking", SEQUENCE_MINUTES)
    mean, deviation = mean_and_deviation(cut_clips(action.training))

    def normalised(clips: np.ndarray) -> np.ndarray:
        return ((clips - mean) / deviation).astype(np.float32)

    return sequence_trainings(
        lambda rng, batch: normalised(draw_clips(action.training, batch, rng)),
        normalised(cut_clips(action.testing, step=600)),
        SEQUENCE_RECIPES["fast"],
    )
