"""Does training scale with the data? holden2015, section 7, "Computational Time" and "Comparison".

    python -m studies scaling --data bandai --test '*_005.bvh'

Time: the paper trains on 9,673 windows, 25 epochs of each layer and then fine tuning, in 5 hours
and 4 minutes on a Quadro K2000: 43, 51, 77 and 133 minutes. The paper does not state the epochs of
fine tuning. By its minutes, (43 + 51 + 77) / 25 are those of an epoch of all three layers, and 133
minutes are about 19 epochs. Here steps of each stage are timed, one window each as in the paper, in
seconds of the processor, on windows of random numbers, whose values do not matter for the time; the
time of the whole training is that of so many steps. PCA is timed on a tenth of the windows, and
grows at most with the cube of their number.

Error: networks of half of the filters learn from a quarter, half and all of the training takes, as
does a linear map of 15 frames.
"""

import time
from collections.abc import Callable

import numpy as np

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.baselines import Gaussian
from numpy_cae.evaluation.tables import LINEAR
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import TrainingState, recipe, train_autoencoder
from studies.shared.judging import Interval, all_of, seeds_below
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table
from studies.shared.small_networks import EPOCHS, SEEDS, P, SmallNetworks, mean_and_range
from studies.shared.trained import Trainer
from studies.training_choices import shortened

PAPER_WINDOWS = 9673
PAPER_MINUTES = {"layer 1": 43, "layer 2": 51, "layer 3": 77, "fine tuning": 133}
FINE_TUNING_EPOCHS = 19
"""Of the paper, by its minutes."""
STEPS = 60
"""Steps of each stage that are timed."""
SIZES = (20, 40, 80)
"""Windows of the epochs that are timed to see how time grows."""
PARTS = (4, 2, 1)
"""Networks learn from every so-many-th training take."""
MOST_SLOPE = 1.1
SLOPES = 3
"""So often a slope is measured: one alone varies by a tenth with what else the machine does."""


def run(
    material: Material,
    seed: int = 0,
    trainer: Trainer | None = None,
    epochs: int = EPOCHS,
    seeds: int = SEEDS,
) -> Result:
    """Time the training, and train on parts of the takes."""
    networks = SmallNetworks.of(material, trainer, seed, seeds)
    times, in_time = _time_training()
    slope = _slope_of(time_steps)
    slope_of_map = _slope_of(fit_linear_map)
    errors = {}
    errors_of_map = {}
    for part in PARTS:
        few = SmallNetworks(
            networks.takes[::part], networks.testing, networks.trainer, networks.seeds
        )
        manifolds = few.learn(shortened(recipe("paper"), epochs))
        errors[len(few.takes)] = [of_seed.repair for of_seed in few.errors(manifolds)]
        errors_of_map[len(few.takes)] = few.error_of_linear_map()
    rows = []
    for takes, of_seeds in errors.items():
        rows.append([f"{takes} takes", mean_and_range(of_seeds), errors_of_map[takes]])
    header = ["learned from", "half removed, cm", LINEAR]
    table = Table("Error by the number of takes:", header, rows, ("", "", ".3f"))
    few_takes, *_, all_takes = errors.values()
    map_of_few, *_, map_of_all = errors_of_map.values()
    is_better = seeds_below(all_takes, few_takes)
    map_scales = slope_of_map.at_most(MOST_SLOPE) and map_of_all < map_of_few
    scales = Claim(
        "scales",
        all_of(slope.at_most(MOST_SLOPE), is_better),
        f"the time of an epoch grows with the power {slope:.2f} of the windows; half removed, "
        f"{mean_and_range(few_takes)} cm with a quarter of the takes, {mean_and_range(all_takes)} "
        "with all;",
        opponent=f"{LINEAR}: power {slope_of_map:.2f}, {map_of_few:.3f} and {map_of_all:.3f} cm.",
        fulfilled_by=LINEAR if map_scales else "",
    )
    return Result("Scaling with the data", [times, table], [in_time, scales])


def _time_training() -> tuple[Table, Claim]:
    """The minutes of the paper's training with the paper's windows, counted from steps."""
    rows: list[list[object]] = []
    minutes = {}
    for name, seconds in time_steps(STEPS).items():
        epochs = FINE_TUNING_EPOCHS if name == "fine tuning" else 25
        steps = epochs * PAPER_WINDOWS
        low, middle, high = (steps * value / 60 for value in np.percentile(seconds, (25, 50, 75)))
        minutes[name] = np.array([low, middle, high])
        step = 1e3 * float(np.median(seconds))
        rows.append([name, step, epochs, middle, f"{low:.0f} to {high:.0f}", PAPER_MINUTES[name]])
    low, middle, high = np.sum(list(minutes.values()), axis=0)
    limit = sum(PAPER_MINUTES.values())
    of_pca = _minutes_of_pca()
    rows.append(["all", None, None, middle, f"{low:.0f} to {high:.0f}", limit])
    rows.append(["PCA on windows", None, None, of_pca, "", None])
    header = ["stage", "ms a step", "epochs", "minutes", "quartiles", "the paper's minutes"]
    caption = f"{PAPER_WINDOWS} windows, processor time:"
    fulfilled: bool | None = None
    if high <= limit:
        fulfilled = True
    elif low > limit:
        fulfilled = False
    claim = Claim(
        "trained_in_time",
        fulfilled,
        f"{middle:.0f} minutes of processor time (quartiles {low:.0f} to {high:.0f}); the paper's "
        f"{limit} on its graphics card;",
        opponent=f"PCA on windows at most {of_pca:.0f} minutes.",
        fulfilled_by="PCA on windows" if of_pca <= limit else "",
    )
    return Table(caption, header, rows, ("", ".2f", "", ".0f", "", "")), claim


def time_steps(windows: int) -> dict[str, list[float]]:
    """Seconds of processor time of the steps of each stage of the paper's training, one epoch of so
    many windows each; the first steps, which make buffers, are left out."""
    x = _random_windows(windows)
    seconds: dict[str, list[float]] = {}
    before = time.process_time()

    def note_time(state: TrainingState) -> None:
        nonlocal before
        now = time.process_time()
        if state.step > windows // 6:
            seconds.setdefault(state.name, []).append(now - before)
        before = now

    schedule = shortened(recipe("paper"), 1)
    train_autoencoder(accelerate(ConvAutoencoder()), x, schedule, report=note_time)
    return seconds


def fit_linear_map(windows: int) -> np.ndarray:
    """The linear map of 15 frames, fitted to so many windows."""
    x = _random_windows(windows)
    return Gaussian(x, np.ones(x.shape[:2], bool)).linear_map(P)


def _slope_of(learn: Callable[[int], object]) -> Interval:
    """The slope of the logarithm of the time of learning over that of the number of windows: the
    median of `SLOPES` measurements, the smallest and the largest."""
    slopes = []
    for _ in range(SLOPES):
        seconds = []
        for windows in SIZES:
            seconds.append(_seconds(lambda windows=windows: learn(windows)))
        slopes.append(float(np.polyfit(np.log(SIZES), np.log(seconds), 1)[0]))
    return Interval(float(np.median(slopes)), min(slopes), max(slopes))


def _minutes_of_pca() -> float:
    """The most minutes of processor time that PCA of the paper's windows takes, from those of a
    tenth of them and the growth with the cube."""
    x = _random_windows(PAPER_WINDOWS // 10).reshape(PAPER_WINDOWS // 10, -1)
    return _seconds(lambda: PCA.fit(x)) * 10**3 / 60


def _random_windows(count: int) -> np.ndarray:
    return np.random.default_rng(0).normal(0, 0.25, (count, 160, 63)).astype(np.float32)


def _seconds(work: Callable[[], object]) -> float:
    """Seconds of processor time."""
    start = time.process_time()
    work()
    return time.process_time() - start
