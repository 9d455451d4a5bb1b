"""The time of training steps, encoding and projection, beside the same networks in PyTorch.

If PyTorch is installed, its networks must give the same results, and are timed in turn with ours;
the ratio is PyTorch's time divided by ours. With --data whole trainings are timed, until all have
reached one error: of the convolutional network on these takes, of the sequential one on synthetic
walking.

    python -m studies speed --batch 1 16
    python -m studies speed --data bandai --test '*_005.bvh'
"""

import os
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from numpy_cae.cli.shared.output import note
from numpy_cae.fast import accelerate
from numpy_cae.fast.blas import blas_threads
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from studies.shared.material import Material
from studies.shared.result import Result, Table
from studies.timing.alternately import matrix_product_peak, time_alternately
from studies.timing.time_to_quality import sequences_to_quality, time_to_quality
from studies.timing.torch_convolutional import TorchModel, cases, require_agreement, torch
from studies.timing.torch_sequential import LATENT, step, torch_step

HIDDEN = (128, 512, 1024)
"""Hidden units of the timed sequential networks."""
CHECKED_WINDOWS, CHECKED_UNITS = 4, 24
"""Windows, and hidden units, with which PyTorch's results are compared, in float64; more would take
longer."""
MOST_LOAD = 0.5
"""MOST_LOAD: above this load of the machine, the mean of the last minute, times are unreliable."""


def run(
    batch: tuple[int, ...] = (1, 4, 16, 64),
    rounds: int = 21,
    clips: tuple[int, ...] = (16, 64),
    material: Material | None = None,
) -> Result:
    """Time every case at every batch size. ArithmeticError if PyTorch computes something else."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    busy = ""
    if load > MOST_LOAD:
        busy = f"Other programs use the processor ({load:.1f} on average in the last minute), so "
        busy += "neither the times nor the ratios are reliable."
        note(busy)
    header = ["what", "B", "ms a window", "spread, %", "PyTorch, ms", "spread, %", "ratio"]
    formats = ("", "", ".3f", ".0f", ".3f", ".0f", ".2f")
    count = len(header) if torch is not None else 4
    tables = [
        Table(title, header[:count], list(timed), formats)
        for title, timed in (
            ("Convolutional network:", rows(batch, rounds)),
            ("Training step of the sequential network:", sequence_rows(clips, rounds // 3 or 1)),
        )
    ]
    if material is not None:
        tables += [time_to_quality(material), sequences_to_quality()]
    made = {"BLAS": f"{blas_threads() or 'unknown'} threads"}
    made["matrix-product peak"] = f"{matrix_product_peak() / 1e9:.0f} GFLOP/s"
    if torch is not None:
        made["PyTorch"] = f"{torch.__version__}, {torch.get_num_threads()} threads"
    return Result("Times beside PyTorch", tables, note=busy, provenance=made)


def rows(batches: Sequence[int], rounds: int) -> Iterator[list[object]]:
    """Every case: the times here and in PyTorch, and their ratio."""
    if torch is not None:
        exact = accelerate(ConvAutoencoder(dtype=np.float64))
        for case in cases(exact, CHECKED_WINDOWS):
            theirs = TorchModel(exact).function(case)
            require_agreement(case.name, case.function(exact)(), theirs())
    for batch in batches:
        model = accelerate(ConvAutoencoder())
        for case in cases(model, batch):
            theirs = TorchModel(model).function(case) if torch is not None else None
            yield _row(case.name, batch, case.function(model), theirs, rounds)


def sequence_rows(batches: Sequence[int], rounds: int) -> Iterator[list[object]]:
    """A training step of the sequential network for each number of hidden units."""
    if torch is not None:
        small = SequentialAutoencoder(hidden=CHECKED_UNITS, latent=LATENT, dtype=np.float64)
        ours, given = step(accelerate(small), CHECKED_WINDOWS)
        require_agreement("sequential", ours(), torch_step(small, given)())
    for batch in batches:
        for units in HIDDEN:
            model = accelerate(SequentialAutoencoder(hidden=units, latent=LATENT))
            ours, given = step(model, batch)
            theirs = torch_step(model, given) if torch is not None else None
            yield _row(f"{units} hidden units", batch, ours, theirs, rounds)


def _row(
    name: str, batch: int, ours: Callable, theirs: Callable | None, rounds: int
) -> list[object]:
    """The times here and in PyTorch, and their ratio."""
    times = time_alternately({"ours": ours} | ({"theirs": theirs} if theirs else {}), rounds)
    row: list[object] = [name, batch]
    for timing in times.values():
        row += [1e3 * timing.median / batch, 100 * timing.spread]
    note(f"{name}, {batch}: {row[2]:.3f} ms a window")
    return [*row, times["theirs"].median / times["ours"].median] if theirs else row
