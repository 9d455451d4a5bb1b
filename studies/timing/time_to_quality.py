"""The times that trainings need to one error: numpy_cae, and the same networks in PyTorch.

The trainings run in turns in one process, so that a change of the machine's speed affects all of
them.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

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
from studies.timing.torch_convolutional import TorchModel, torch
from studies.timing.torch_sequential import SequenceCase, TorchSequenceModel

MINUTES = 20.0
"""Without --data: minutes of synthetic motion, of which every fourth take is held out."""
SEQUENCE_MINUTES = 180.0
"""Minutes of synthetic walking to train on, and as many of other people to hold out."""


def time_to_quality(material: Material | None, sequential: bool) -> Table:
    """Train in turns, on the takes of a material or on synthetic motion."""
    if torch is None:
        raise ValueError("PyTorch is not installed (package torch)")
    made = sequential_trainings() if sequential else convolutional_trainings(material)
    train_in_turns(made, note)
    return Quality(made, "of the variance" if sequential else "cm").table()


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


@dataclass(frozen=True)
class Quality:
    """Trainings compared; ours is the first."""

    trainings: Sequence[Training]
    unit: str

    @property
    def target(self) -> float:
        """The lowest error that all reach."""
        return max(min(each.errors) for each in self.trainings)

    @property
    def ratios(self) -> dict[str, float]:
        """The seconds of each training to the target, divided by ours."""
        ours = self.trainings[0].seconds_to(self.target)
        return {each.name: each.seconds_to(self.target) / ours for each in self.trainings}

    def table(self) -> Table:
        """A row for each training."""
        seconds = f"seconds to {self.target:.3f} {self.unit}"
        header = ["training", seconds, "ratio", "seconds in all", f"lowest error, {self.unit}"]
        rows = [
            [
                each.name,
                each.seconds_to(self.target),
                self.ratios[each.name],
                each.seconds[-1],
                min(each.errors),
            ]
            for each in self.trainings
        ]
        return Table("", header, rows, ("", ".1f", ".2f", ".1f", ".3f"))


def train_in_turns(
    trainings: Sequence[Training], progress: Callable[[str], None] = lambda line: None
) -> None:
    """Train all, each time the one with the smallest share of its turns done, so that a change of
    the machine's speed affects all of them. `progress` gets a line of text after each turn."""
    while waiting := [each for each in trainings if len(each.errors) < each.count]:
        each = min(waiting, key=lambda one: len(one.errors) / one.count)
        each.take_turn()
        done = f"{each.name}, {len(each.errors)}/{each.count}"
        progress(f"{done}: {each.seconds[-1]:.1f} s, held-out error {each.errors[-1]:.3f}")


USUAL = Stage(epochs=50, rate=0.001, batch=16, alpha=0.0, zeroed=(0.1, 0.8), rescaled=True)
"""PyTorch with the usual settings: Adam's and `OneCycleLR`'s own, no bound on the norm. The batch,
the peak rate and the epochs are those that need the least time
(docs/lab_book/end_to_end.md)."""
USUAL_SEQUENCES = SequenceSchedule(rate=0.001)
"""The same, with the batch and the bound on the norm of the recipe paper."""
USUAL_BETA_2 = 0.999

Change = Callable[[np.ndarray], np.ndarray]
"""Repairs normalised windows, or denoises normalised clips."""


def trainings(
    windows: np.ndarray, schedule: Schedule, error: Callable[[Change], float], seed: int = 0
) -> list[Training]:
    """Denoising end to end of normalised windows (N, T, 63): ours by the fine tuning of `schedule`,
    PyTorch's by `USUAL` and by the same, all from the initial weights of `schedule`. `error`
    measures a repair, in cm."""
    torch.manual_seed(seed)
    stage, rng = schedule.fine_tuning, np.random.default_rng(seed)
    model = accelerate(ConvAutoencoder(rng=rng, initial=schedule.initial))
    usual, same, first = (TorchModel(model) for _ in range(3))
    # The first step takes seconds.
    next(torch_epochs(first, windows[: USUAL.batch], USUAL, USUAL_BETA_2))
    turns = (
        epochs(model, windows, stage),
        torch_epochs(usual, windows, USUAL, USUAL_BETA_2),
        torch_epochs(same, windows, stage, BETA_2),
    )

    def error_of(project: Change) -> float:
        return error(lambda x: project(x / (1 - zeroed_fraction(x))))

    projections = model.project, usual.project, same.project
    return _trainings((stage, USUAL, stage), turns, projections, error_of)


def sequence_trainings(
    draw: Draw, held_out: np.ndarray, schedule: SequenceSchedule, seed: int = 0
) -> list[Training]:
    """The same of clips that `draw` draws: ours by `schedule`, PyTorch's by `USUAL_SEQUENCES` and
    by `schedule`. The mean squared error is that of `held_out`, clips (N, T, features)."""
    rng = np.random.default_rng(seed)
    sizes = held_out.shape[2], HIDDEN, LATENT
    model = accelerate(SequentialAutoencoder(*sizes, rng, burn_in=BURN_IN))
    usual, same = TorchSequenceModel(model), TorchSequenceModel(model)
    turns = (
        sequence_epochs(model, draw, schedule),
        torch_sequence_epochs(usual, draw, USUAL_SEQUENCES, USUAL_BETA_2),
        torch_sequence_epochs(same, draw, schedule, BETA_2),
    )

    def error_of(denoise: Change) -> float:
        return float(np.mean((denoise(held_out) - held_out) ** 2, dtype=np.float64))

    by = schedule, USUAL_SEQUENCES, schedule
    return _trainings(by, turns, (model.denoise, usual.denoise, same.denoise), error_of)


def _trainings(
    by: tuple, turns: tuple, changes: tuple[Change, ...], error_of: Callable[[Change], float]
) -> list[Training]:
    names = "numpy_cae", "PyTorch, usual settings", "PyTorch, our settings"
    return [
        Training(name, stage.epochs, each, lambda change=change: error_of(change))
        for name, stage, each, change in zip(names, by, turns, changes, strict=True)
    ]


def epochs(
    model: ConvAutoencoder, windows: np.ndarray, stage: Stage, seed: int = 0
) -> Iterator[None]:
    """Train for an epoch at each `next`, as `numpy-cae train` does."""
    state = TrainingState(model.parameters, np.random.default_rng(seed))
    schedule = Schedule(layer=Stage(epochs=0), fine_tuning=stage)
    for _ in autoencoder_steps(model, windows, schedule, state):
        if state.step == 0:
            yield


def sequence_epochs(
    model: SequentialAutoencoder, draw: Draw, schedule: SequenceSchedule, seed: int = 0
) -> Iterator[None]:
    """The same for the sequential network."""
    state = TrainingState(model.weights, np.random.default_rng(seed))
    for _ in sequential_steps(model, draw, schedule, state):
        if state.step == 0:
            yield


def torch_epochs(
    model: TorchModel, windows: np.ndarray, stage: Stage, beta_2: float
) -> Iterator[None]:
    """`epochs` in PyTorch."""
    windows = torch.tensor(np.ascontiguousarray(windows.transpose(0, 2, 1)))
    parameters = [parameter for w, b, _ in model.layers for parameter in (w, b)]
    steps = stage.epochs * -(-len(windows) // stage.batch)
    update = _torch_update(parameters, stage, steps, beta_2)
    (low, high), whole = stage.zeroed, [None] * len(model.layers)
    for _ in range(stage.epochs):
        for chosen in torch.randperm(len(windows)).split(stage.batch):
            x = windows[chosen]
            p = low + (high - low) * torch.rand(len(x), 1, 1)
            y = model.encode(x * (torch.rand(x.shape) >= p) / (1 - p), model.layers)
            ((model.decode(y, model.layers, whole) - x) ** 2).mean().backward()
            update()
        yield


def torch_sequence_epochs(
    model: TorchSequenceModel, draw: Draw, schedule: SequenceSchedule, beta_2: float, seed: int = 0
) -> Iterator[None]:
    """`sequence_epochs` in PyTorch."""
    rng, sizes = np.random.default_rng(seed), (schedule.batch, LATENT)
    update = _torch_update(model.parameters, schedule, schedule.epochs * schedule.steps, beta_2)
    for _ in range(schedule.epochs):
        for _ in range(schedule.steps):
            prior = rng.standard_normal(sizes, dtype=np.float32)
            directions = unit_directions(schedule.directions, LATENT, rng)
            case = SequenceCase(draw(rng, schedule.batch), prior, directions)
            model.function(case, schedule.weight)()
            update()
        yield


def _torch_update(
    parameters: list, by: Stage | SequenceSchedule, steps: int, beta_2: float
) -> Callable[[], None]:
    """A function that moves parameters by Adam and a one-cycle rate and clears their gradients."""
    optimiser = torch.optim.Adam(parameters, betas=(0.9, beta_2), fused=True)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, by.rate, steps)

    def update() -> None:
        if by.norm is not None:
            torch.nn.utils.clip_grad_norm_(parameters, by.norm)
        optimiser.step()
        rates.step()
        optimiser.zero_grad()

    return update


def convolutional_trainings(material: Material | None) -> list[Training]:
    """Of the convolutional network; the error is that of the table of `numpy-cae train`."""
    if material is None:
        halves: tuple[list, list] = ([], [])
        for plan in plan_takes(MINUTES):
            halves[plan.number % 4 == 0].append(body_of(plan.make(RATE).motion))
        material = unlabelled(*halves)
    schedule = recipe("fast")
    windows, testing = windows_of(material, schedule.rms)
    damaged = zero_values(testing.x, 0.5, np.random.default_rng(0))
    return trainings(windows, schedule, lambda repair: testing.error(repair(damaged)))


def windows_of(material: Material, rms: float) -> tuple[np.ndarray, Clips]:
    """Normalised windows (N, T, 63) to train on, scaled to `rms`, and the windows to test on."""
    takes = [take.positions for take in material.training]
    untrained = Schedule(Stage(epochs=0), Stage(epochs=0), rms=rms)
    # For the mean pose, the scale and the mean skeleton; its network is not used.
    frame = learn_manifold(takes, untrained, filters=(1,), taps=1)
    cut = [frame.normalise(cut_windows(frame.features(take)[0])[0]) for take in takes]
    return np.concatenate(cut), testing_of(frame, material)[0]


def sequential_trainings() -> list[Training]:
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
