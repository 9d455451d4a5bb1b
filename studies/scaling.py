"""Does training scale with the data? holden2015, section 7, "Computational Time" and "Comparison".

    python -m studies scaling --data bandai --test '*_005.bvh'

Time: the paper trains on 9,673 windows, 25 epochs of each layer and then fine tuning, in 5 hours
and 4 minutes on a Quadro K2000: 43, 51, 77 and 133 minutes. The paper does not state the epochs of
fine tuning. By its minutes, (43 + 51 + 77) / 25 are those of an epoch of all three layers, and 133
minutes are about 19 epochs. Here steps of each stage are timed, one window each as in the paper, in
seconds of the processor, on windows of random numbers, whose values do not matter for the time; the
time of the whole training is that of so many steps. PCA is timed on a tenth of the windows, and
grows at most with the cube of their number.

Other methods: section 2 says that kernel methods "cannot scale as the covariance matrix grows as
the square of the number of data points used", section 7 that data structures such as KD trees are
"very computationally expensive" and that PCA is scalable. Time and memory of kernel PCA, with all
windows and with a few landmarks (Williams and Seeger 2001), are measured on growing numbers of
windows; a KD tree on a fortieth of the paper's windows, where building grows as N log N and a
search that prunes nothing as N².

Error: networks of half of the filters learn from a quarter, half and all of the training takes, as
does a linear map of 15 frames.
"""

import time
import tracemalloc
from collections.abc import Callable, Sequence
from math import log

import numpy as np
from scipy.spatial import KDTree

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.baselines import Gaussian
from numpy_cae.evaluation.tables import LINEAR, NETWORK
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import TrainingState, recipe, train_autoencoder
from studies.shared.judging import Interval, all_of, seeds_below
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table, combined
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
"""So often a slope is measured, with fewer seeds less often: one alone varies by a tenth with what
else the machine does."""
KERNEL_SIZES = (150, 300, 600)
"""Windows to which kernel methods are fitted to see how their time and memory grow."""
PCA_SIZES = (100, 200, 400)
"""Windows to which PCA is fitted."""
MEMORY_SIZES = (5, 10, 20)
"""Windows of the trainings whose memory is measured."""
LANDMARKS = 50
LEAST_POWER = 1.5
"""A cost that grows with at least this power of the number of windows is nearer to the square than
to proportion."""
TREE_PART = 40
"""A KD tree is built of this part of the paper's windows."""
KERNEL = "kernel PCA"
KERNEL_OF_LANDMARKS = f"kernel PCA with {LANDMARKS} landmarks"
TREE = "KD tree of windows"
PAIRS = "distances of all pairs"


def run(
    material: Material,
    seed: int = 0,
    trainer: Trainer | None = None,
    epochs: int = EPOCHS,
    seeds: int = SEEDS,
) -> Result:
    """Time the training, and train on parts of the takes."""
    networks = SmallNetworks.of(material, trainer, seed, seeds)
    times, in_time, minutes = _time_training()
    repetitions = min(seeds, SLOPES)
    slope = _slope_of(time_steps, SIZES, repetitions)
    slope_of_map = _slope_of(fit_linear_map, SIZES, repetitions)
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
    parts = [
        Result("", [times, table], [in_time, scales]),
        _compare_kernels(slope, slope_of_map, repetitions),
        _time_trees(minutes),
        _scale_pca(repetitions),
    ]
    return combined("Scaling with the data", parts)


def _time_training() -> tuple[Table, Claim, Interval]:
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
    table = Table(caption, header, rows, ("", ".2f", "", ".0f", "", ""))
    return table, claim, Interval(middle, low, high)


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


def _slope_of(learn: Callable[[int], object], sizes: Sequence[int], repetitions: int) -> Interval:
    """The slope of the logarithm of the time of learning over that of the number of windows: the
    median of the repetitions, the smallest and the largest."""
    slopes = []
    for _ in range(repetitions):
        seconds = []
        for windows in sizes:
            seconds.append(_seconds(lambda windows=windows: learn(windows)))
        slopes.append(_slope(sizes, seconds))
    return Interval(float(np.median(slopes)), min(slopes), max(slopes))


def _slope(sizes: Sequence[int], costs: Sequence[float]) -> float:
    """The power with which the costs grow with the sizes."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def _slope_of_memory(learn: Callable[[int], object], sizes: Sequence[int]) -> float:
    """The slope of the logarithm of the memory that learning needs over that of the number of
    windows; what exists before is not counted."""
    peaks = []
    for windows in sizes:
        tracemalloc.start()
        try:
            learn(windows)
            peaks.append(float(tracemalloc.get_traced_memory()[1]))
        finally:
            tracemalloc.stop()
    return _slope(sizes, peaks)


def fit_kernel_pca(rows: np.ndarray) -> np.ndarray:
    """The coordinates (N, N) of rows (N, D) on all axes of kernel PCA (Schölkopf et al. 1998), with
    the Gaussian kernel of the median distance."""
    distances = squared_distances(rows, rows)
    covariance = np.exp(-distances / np.median(distances))
    mean = covariance.mean(axis=0)
    covariance += mean.mean() - mean - mean[:, None]
    spread, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(spread.clip(0))


def fit_landmarks(rows: np.ndarray) -> np.ndarray:
    """The coordinates (N, L) of rows (N, D) by Nyström's method, of which the inner products
    approximate the Gaussian kernel: K_NL K_LL^(-1/2) for the first L rows as landmarks."""
    landmarks = rows[:LANDMARKS]
    between = squared_distances(landmarks, landmarks)
    scale = np.median(between)
    spread, vectors = np.linalg.eigh(np.exp(-between / scale))
    axes = vectors / np.sqrt(spread.clip(1e-6))
    return np.exp(-squared_distances(rows, landmarks) / scale) @ axes


def squared_distances(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    """‖a - b‖² of rows (N, D) and (M, D), (N, M), by one matrix product."""
    squares = np.einsum("ij,ij->i", rows, rows)
    squares_of_others = np.einsum("ij,ij->i", others, others)
    distances = rows @ others.T
    distances *= -2  # in place: twice the rows would be a copy of them
    distances += squares[:, None]
    distances += squares_of_others
    return distances


def _compare_kernels(of_network: Interval, of_map: Interval, repetitions: int) -> Result:
    """How time and memory of kernel PCA grow with the windows, beside those of the network, whose
    time is given, and of the linear map. The first trainings of a process fill caches, so their
    memory is not measured: those of the time come before."""
    rows = _random_windows(max(KERNEL_SIZES)).reshape(max(KERNEL_SIZES), -1)
    windows = _random_windows(max(MEMORY_SIZES))
    schedule = shortened(recipe("paper"), 1)

    def train(count: int) -> TrainingState:
        return train_autoencoder(accelerate(ConvAutoencoder()), windows[:count], schedule)

    kernels = {KERNEL: fit_kernel_pca, KERNEL_OF_LANDMARKS: fit_landmarks}
    times = {NETWORK: of_network, LINEAR: of_map}
    memory = {NETWORK: _slope_of_memory(train, MEMORY_SIZES)}
    for name, fit in kernels.items():

        def fit_to(count: int, fit: Callable[[np.ndarray], np.ndarray] = fit) -> np.ndarray:
            return fit(rows[:count])

        times[name] = _slope_of(fit_to, KERNEL_SIZES, repetitions)
        memory[name] = _slope_of_memory(fit_to, KERNEL_SIZES)
    grows = all_of(times[KERNEL].at_least(LEAST_POWER), memory[KERNEL] >= LEAST_POWER)
    scales = {}
    listed = {}
    for name, power in memory.items():
        scales[name] = all_of(times[name].at_most(MOST_SLOPE), power <= MOST_SLOPE)
        listed[name] = f"{times[name]:.2f} and {power:.2f}"
    claim = Claim(
        "kernels_grow",
        all_of(grows, scales[NETWORK]),
        f"time and memory of {KERNEL} grow with the powers {listed[KERNEL]} of the windows, of the "
        f"network {listed[NETWORK]};",
        opponent=f"{KERNEL_OF_LANDMARKS} {listed[KERNEL_OF_LANDMARKS]}; {LINEAR} in time "
        f"{of_map:.2f}.",
        fulfilled_by=f"{KERNEL_OF_LANDMARKS}, which grows no faster than the network"
        if scales[KERNEL_OF_LANDMARKS]
        else "",
    )
    table_rows = [[name, power.value, memory.get(name)] for name, power in times.items()]
    header = ["learning", "time", "memory"]
    return Result("", [Table("Power of the windows:", header, table_rows)], [claim])


def _time_trees(training: Interval) -> Result:
    """The minutes of a KD tree of the paper's windows beside those of the training."""
    count = max(PAPER_WINDOWS // TREE_PART, 2)
    rows = _random_windows(count).reshape(count, -1)
    trees = []
    building = _seconds(lambda: trees.append(KDTree(rows)))
    searching = _seconds(lambda: trees[0].query(rows, k=2))
    comparing = _seconds(lambda: squared_distances(rows, rows))
    growth = PAPER_WINDOWS / count
    minutes_building = building * growth * log(PAPER_WINDOWS) / log(count) / 60
    minutes = minutes_building + searching * growth**2 / 60
    minutes_comparing = comparing * growth**2 / 60
    claim = Claim(
        "trees_expensive",
        training.below(minutes),
        f"{minutes_building:.2f} minutes for the tree, {minutes:.0f} with the search; the training "
        f"{training:.0f};",
        opponent=f"{PAIRS} {minutes_comparing:.1f} minutes.",
        fulfilled_by=PAIRS if minutes_comparing > training.high else "",
    )
    table_rows = [
        [f"{TREE}, built", minutes_building],
        [f"{TREE}, with the nearest of each window", minutes],
        [PAIRS, minutes_comparing],
        ["the paper's training", training.value],
    ]
    caption = f"{PAPER_WINDOWS} windows, processor time:"
    return Result("", [Table(caption, ["what", "minutes"], table_rows)], [claim])


def _scale_pca(repetitions: int) -> Result:
    """How the time of fitting PCA to frames and to windows grows."""
    windows = _random_windows(max(PCA_SIZES))
    fits = {
        "PCA on frames": lambda count: PCA.fit(windows[:count].reshape(-1, windows.shape[2])),
        "PCA on windows": lambda count: PCA.fit(windows[:count].reshape(count, -1)),
    }
    rows = []
    claims = []
    for name, fit in fits.items():
        power = _slope_of(fit, PCA_SIZES, repetitions)
        rows.append([name, power.value])
        figures = f"the time grows with the power {power:.2f} of the windows."
        claims.append(Claim("pca_scales", power.at_most(MOST_SLOPE), figures, name))
    return Result("", [Table("Growth with the windows:", ["fitting", "time"], rows)], claims)


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
