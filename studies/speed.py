"""The time of training steps, encoding and projection, beside the same networks in PyTorch.

If PyTorch is installed, its networks must give the same results, and are timed in turn with ours,
in many short rounds, on one thread and on as many as BLAS uses. A ratio is PyTorch's time divided
by ours: that of the least times, and of the times of each round the quartiles and the median. With
--data whole trainings are timed, until all have reached one error: of the convolutional network on
these takes, of the sequential one on synthetic walking.

    python -m studies speed --batch 1 16
    python -m studies speed --data bandai --test '*_005.bvh'
"""

import os
import platform
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from functools import partial
from pathlib import Path
from timeit import repeat

import numpy as np

from numpy_cae.fast import accelerate
from numpy_cae.fast.thread_team import blas_kernel, blas_threads, one_thread
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from studies.shared.charts import draw_speed
from studies.shared.material import Material
from studies.shared.messages import note
from studies.shared.result import Picture, Result, Table
from studies.timing import torch_networks as nets
from studies.timing.alternately import time_alternately
from studies.timing.time_to_quality import sequences_to_quality, time_to_quality

HIDDEN = (128, 512, 1024)
"""Hidden units of the timed sequential networks."""
CHECKED_WINDOWS = 4
"""Windows with which PyTorch's results are compared, in float64; more would take longer."""
CHECKED_UNITS = 24
"""Hidden units of the sequential network with which they are compared."""
MOST_LOAD = 0.5
"""Above this load of the machine, the mean of the last minute, times are unreliable."""


HEADER = ["what", "B", "ms a window, least", "median"]
OF_PYTORCH = ["PyTorch, least", "median", "ratio of the least", "ratio, quartiles", "ratio"]
FORMATS = ("", "", ".3f", ".3f", ".3f", ".3f", ".2f", "", ".2f")


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
    if nets.torch is not None:
        require_same_results()
    header = HEADER
    if nets.torch is not None:
        header = HEADER + OF_PYTORCH
    tables = []
    for threads in numbers_of_threads():
        with limited_to(threads):
            for title, timed in (
                ("Convolutional network", rows(batch, rounds, threads)),
                (
                    "Training step of the sequential network",
                    sequence_rows(clips, rounds // 3 or 1, threads),
                ),
            ):
                caption = f"{title}, {threads} {'thread' if threads == 1 else 'threads'}:"
                tables.append(Table(caption, header, list(timed), FORMATS))
    on_all_threads = tables[-2:]
    if material is not None:
        tables += [time_to_quality(material), sequences_to_quality()]
    figures = {}
    if nets.torch is not None:
        figures["speed"] = Picture(partial(draw_speed, on_all_threads))
    return Result(
        "Times beside PyTorch", tables, figures=figures, note=warning, provenance=_provenance()
    )


def numbers_of_threads() -> list[int]:
    """One, and as many as BLAS uses."""
    return sorted({1, blas_threads() or 1})


@contextmanager
def limited_to(threads: int) -> Iterator[None]:
    """A block in which PyTorch uses so many threads, and BLAS one if they are one."""
    torch = nets.torch
    before = torch.get_num_threads() if torch is not None else 0
    if torch is not None:
        torch.set_num_threads(threads)
    try:
        with one_thread() if threads == 1 else nullcontext():
            yield
    finally:
        if torch is not None:
            torch.set_num_threads(before)


def _warning_of_load() -> str:
    """A sentence where other programs use the processor, else nothing."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if load <= MOST_LOAD:
        return ""
    return (
        f"The processor was used in the last minute ({load:.1f} on average). If other programs "
        "still use it, neither the times nor the ratios are reliable."
    )


def _provenance() -> dict[str, str]:
    """The processor, the kernels of BLAS, the speed of matrix products and PyTorch's version."""
    peaks = []
    for threads in numbers_of_threads():
        with limited_to(threads):
            peaks.append(f"{matrix_product_peak() / 1e9:.0f} on {threads}")
    provenance = {
        "processor": _processor(),
        "BLAS": f"{blas_threads() or 'unknown'} threads, kernels for {blas_kernel()}",
        "matrix-product peak": f"{', '.join(peaks)} threads, GFLOP/s",
    }
    if nets.torch is not None:
        provenance["PyTorch"] = nets.torch.__version__
    return provenance


def _processor() -> str:
    """The name of the processor, where the system tells it."""
    path = Path("/proc/cpuinfo")
    if path.exists():
        for line in path.read_text("utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"


def require_same_results() -> None:
    """Raise ArithmeticError unless PyTorch's networks compute the same as ours."""
    exact = accelerate(ConvAutoencoder(dtype=np.float64))
    for case in nets.cases(exact, CHECKED_WINDOWS):
        theirs = nets.TorchModel(exact).function(case)
        nets.require_agreement(case.name, case.function(exact)(), theirs())
    small = SequentialAutoencoder(hidden=CHECKED_UNITS, latent=nets.LATENT, dtype=np.float64)
    ours, arguments = nets.step(accelerate(small), CHECKED_WINDOWS)
    nets.require_agreement("sequential", ours(), nets.torch_step(small, arguments)())


def rows(batches: Sequence[int], rounds: int, threads: int) -> Iterator[list[object]]:
    """Every case of the whole network: the times here and in PyTorch, and their ratio."""
    for batch in batches:
        model = accelerate(ConvAutoencoder(), threads)
        for case in nets.cases(model, batch):
            if case.layer is not None:
                continue
            theirs = nets.TorchModel(model).function(case) if nets.torch is not None else None
            yield _row(case.name, batch, case.function(model), theirs, rounds)


def sequence_rows(batches: Sequence[int], rounds: int, threads: int) -> Iterator[list[object]]:
    """A training step of the sequential network for each number of hidden units."""
    for batch in batches:
        for units in HIDDEN:
            model = accelerate(SequentialAutoencoder(hidden=units, latent=nets.LATENT), threads)
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
        row += [1e3 * timing.least / batch, 1e3 * timing.median / batch]
    note(f"{name}, {batch}: {row[3]:.3f} ms a window")
    if theirs is not None:
        ratios = times["theirs"].seconds / times["ours"].seconds
        low, middle, high = np.quantile(ratios, (0.25, 0.5, 0.75))
        row += [times["theirs"].least / times["ours"].least, f"{low:.2f} to {high:.2f}", middle]
    return row


def matrix_product_peak(size: int = 2048, rounds: int = 12) -> float:
    """Operations a second of a product of float32 (size, size) matrices, the best of the rounds."""
    a, b = np.random.default_rng(0).random((2, size, size), dtype=np.float32)
    out = np.empty_like(a)
    return 2 * size**3 / min(repeat(lambda: np.matmul(a, b, out=out), number=1, repeat=rounds))
