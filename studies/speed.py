"""The time of training steps, encoding and projection, beside the same network in PyTorch.

If PyTorch is installed, its network must give the same results, and is timed in turn with ours; the
ratio is PyTorch's time divided by ours. With --training whole trainings on the takes of --data are
timed, until all have reached one error.

    python -m studies speed --batch 1 16
    python -m studies speed --training --data bandai --test '*_005.bvh'
"""

import os
from collections.abc import Iterator, Sequence

import numpy as np

from numpy_cae.cli.shared.output import note
from numpy_cae.fast import accelerate
from numpy_cae.fast.blas import blas_threads
from numpy_cae.models import ConvAutoencoder
from studies.shared.material import Material
from studies.shared.result import Result, Table
from studies.timing.alternately import matrix_product_peak, time_alternately
from studies.timing.time_to_quality import time_to_quality
from studies.timing.torch_convolutional import TorchModel, cases, require_agreement, torch

CHECKED_WINDOWS = 4
"""Windows with which PyTorch's results are compared, in float64; more would take longer."""
MOST_LOAD = 0.5
"""MOST_LOAD: above this load of the machine, the mean of the last minute, times are unreliable."""


def run(
    batch: tuple[int, ...] = (1, 4, 16, 64),
    rounds: int = 21,
    training: bool = False,
    material: Material | None = None,
) -> Result:
    """Time every case at every batch size. ArithmeticError if PyTorch computes something else."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    busy = ""
    if load > MOST_LOAD:
        busy = f"Other programs use the processor ({load:.1f} on average in the last minute), so "
        busy += "neither the times nor the ratios are reliable."
        note(busy)
    if training and material is None:
        raise ValueError("--training needs the takes of --data")
    if training:
        table = time_to_quality(material)
    else:
        header = ["what", "B", "ms a window", "spread, %", "PyTorch, ms", "spread, %", "ratio"]
        formats = ("", "", ".3f", ".0f", ".3f", ".0f", ".2f")
        count = len(header) if torch is not None else 4
        table = Table("", header[:count], list(rows(batch, rounds)), formats)
    made = {"BLAS": f"{blas_threads() or 'unknown'} threads"}
    made["matrix-product peak"] = f"{matrix_product_peak() / 1e9:.0f} GFLOP/s"
    if torch is not None:
        made["PyTorch"] = f"{torch.__version__}, {torch.get_num_threads()} threads"
    return Result("Times of the convolutional network", [table], note=busy, provenance=made)


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
            functions = {"ours": case.function(model)}
            if torch is not None:
                functions["theirs"] = TorchModel(model).function(case)
            times = time_alternately(functions, rounds)
            row: list[object] = [case.name, batch]
            for timing in times.values():
                row += [1e3 * timing.median / batch, 100 * timing.spread]
            note(f"{case.name}, {batch}: {row[2]:.3f} ms a window")
            if torch is not None:
                row.append(times["theirs"].median / times["ours"].median)
            yield row
