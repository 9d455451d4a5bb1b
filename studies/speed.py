"""The time of training steps, encoding and projection, beside the same networks in PyTorch.

If PyTorch is installed, its networks must give the same results, and are timed in turn with ours;
the ratio is PyTorch's time divided by ours. With --data whole trainings are timed, until all have
reached one error: of the convolutional network on these takes, of the sequential one on synthetic
walking.

    python -m studies speed --batch 1 16
    python -m studies speed --data bandai --test '*_005.bvh'
"""

import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from timeit import repeat

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.fast.thread_team import blas_threads
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from studies.shared.charts import draw_speed
from studies.shared.material import Material
from studies.shared.messages import note
from studies.shared.result import Picture, Result, Table
from studies.timing import torch_networks as nets
from studies.timing.time_to_quality import sequences_to_quality, time_to_quality

HIDDEN = (128, 512, 1024)
"""Hidden units of the timed sequential networks."""
CHECKED_WINDOWS = 4
"""Windows with which PyTorch's results are compared, in float64; more would take longer."""
CHECKED_UNITS = 24
"""Hidden units of the sequential network with which they are compared."""
MOST_LOAD = 0.5
"""Above this load of the machine, the mean of the last minute, times are unreliable."""


def run(
    batch: tuple[int, ...] = (1, 4, 16, 64),
    rounds: int = 21,
    clips: tuple[int, ...] = (16, 64),
    material: Material | None = None,
) -> Result:
    """Time every case at every batch size. ArithmeticError if PyTorch computes something else."""
    warning = _warning_of_load()
    if warning:
        note(warning)
    header = ["what", "B", "ms a window", "spread, %", "PyTorch, ms", "spread, %", "ratio"]
    formats = ("", "", ".3f", ".0f", ".3f", ".0f", ".2f")
    count = len(header) if nets.torch is not None else 4
    tables = [
        Table(title, header[:count], list(timed), formats)
        for title, timed in (
            ("Convolutional network:", rows(batch, rounds)),
            ("Training step of the sequential network:", sequence_rows(clips, rounds // 3 or 1)),
        )
    ]
    if material is not None:
        tables += [time_to_quality(material), sequences_to_quality()]
    figures = {}
    if nets.torch is not None:
        figures["speed"] = Picture(partial(draw_speed, tables[:2]))
    return Result(
        "Times beside PyTorch", tables, figures=figures, note=warning, provenance=_provenance()
    )


def _warning_of_load() -> str:
    """A sentence where other programs use the processor, else nothing."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if load <= MOST_LOAD:
        return ""
    return (
        f"Other programs use the processor ({load:.1f} on average in the last minute), so "
        "neither the times nor the ratios are reliable."
    )


def _provenance() -> dict[str, str]:
    """Threads and speed of the matrix products, and PyTorch's version and threads."""
    provenance = {
        "BLAS": f"{blas_threads() or 'unknown'} threads",
        "matrix-product peak": f"{matrix_product_peak() / 1e9:.0f} GFLOP/s",
    }
    if nets.torch is not None:
        threads = nets.torch.get_num_threads()
        provenance["PyTorch"] = f"{nets.torch.__version__}, {threads} threads"
    return provenance


def rows(batches: Sequence[int], rounds: int) -> Iterator[list[object]]:
    """Every case: the times here and in PyTorch, and their ratio."""
    if nets.torch is not None:
        exact = accelerate(ConvAutoencoder(dtype=np.float64))
        for case in nets.cases(exact, CHECKED_WINDOWS):
            theirs = nets.TorchModel(exact).function(case)
            nets.require_agreement(case.name, case.function(exact)(), theirs())
    for batch in batches:
        model = accelerate(ConvAutoencoder())
        for case in nets.cases(model, batch):
            theirs = nets.TorchModel(model).function(case) if nets.torch is not None else None
            yield _row(case.name, batch, case.function(model), theirs, rounds)


def sequence_rows(batches: Sequence[int], rounds: int) -> Iterator[list[object]]:
    """A training step of the sequential network for each number of hidden units."""
    if nets.torch is not None:
        small = SequentialAutoencoder(hidden=CHECKED_UNITS, latent=nets.LATENT, dtype=np.float64)
        ours, arguments = nets.step(accelerate(small), CHECKED_WINDOWS)
        nets.require_agreement("sequential", ours(), nets.torch_step(small, arguments)())
    for batch in batches:
        for units in HIDDEN:
            model = accelerate(SequentialAutoencoder(hidden=units, latent=nets.LATENT))
            ours, arguments = nets.step(model, batch)
            theirs = nets.torch_step(model, arguments) if nets.torch is not None else None
            yield _row(f"{units} hidden units", batch, ours, theirs, rounds)


def _row(
    name: str, batch: int, ours: Callable, theirs: Callable | None, rounds: int
) -> list[object]:
    """The times here and in PyTorch, and their ratio."""
    functions = {"ours": ours}
    if theirs is not None:
        functions["theirs"] = theirs
    times = time_alternately(functions, rounds)
    row: list[object] = [name, batch]
    for timing in times.values():
        row += [1e3 * timing.median / batch, 100 * timing.spread]
    note(f"{name}, {batch}: {row[2]:.3f} ms a window")
    if theirs is not None:
        row.append(times["theirs"].median / times["ours"].median)
    return row


PAUSE_SECONDS = 0.03
"""The wait before each measurement (s): the threads of OpenMP and BLAS wait actively
for a while after their work is done, which would slow down the next function."""
MIN_SECONDS = 0.03
"""A measurement takes at least this (s); a faster function is called several times."""


@dataclass(frozen=True, eq=False)
class Timing:
    """The seconds of one call, in each of many rounds."""

    seconds: np.ndarray

    @property
    def median(self) -> float:
        """Seconds."""
        return float(np.median(self.seconds))

    @property
    def spread(self) -> float:
        """Half the interquartile range, as a share of the median."""
        low, high = np.quantile(self.seconds, (0.25, 0.75))
        return float((high - low) / 2 / self.median)


def time_alternately(
    functions: Mapping[str, Callable[[], object]], rounds: int
) -> dict[str, Timing]:
    """Time every function once in each round; the result has the same names."""
    repeats = {name: _repeats(function) for name, function in functions.items()}
    seconds: dict[str, list[float]] = {name: [] for name in functions}
    for _ in range(rounds):
        for name, function in functions.items():
            time.sleep(PAUSE_SECONDS)
            function()  # the caches hold the data of the function before
            start = time.perf_counter()
            for _ in range(repeats[name]):
                function()
            seconds[name].append((time.perf_counter() - start) / repeats[name])
    return {name: Timing(np.array(rounds)) for name, rounds in seconds.items()}


def _repeats(function: Callable[[], object]) -> int:
    """Calls in one measurement; also a first call, which is slower."""
    function()
    start = time.perf_counter()
    function()
    return max(1, round(MIN_SECONDS / max(time.perf_counter() - start, 1e-9)))


def matrix_product_peak(size: int = 2048, rounds: int = 12) -> float:
    """Operations a second of a product of float32 (size, size) matrices, the best of the rounds."""
    a, b = np.random.default_rng(0).random((2, size, size), dtype=np.float32)
    out = np.empty_like(a)
    return 2 * size**3 / min(repeat(lambda: np.matmul(a, b, out=out), number=1, repeat=rounds))
