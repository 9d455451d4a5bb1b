"""The time of training steps, encoding and projection, beside the same networks in PyTorch.

If PyTorch is installed, its networks must give the same results, and are timed in turn with ours;
the ratio is PyTorch's time divided by ours. With --sequential the steps are those of jang2018's
network, whose decoder's input is its own last output. With --training whole trainings are timed,
until all have reached one error, on the takes of --data or on synthetic motion.

    python -m studies speed --batch 1 16
    python -m studies speed --sequential --batch 16 64
    python -m studies speed --training --data bandai --test '*_005.bvh'
    python -m studies speed --training --sequential
"""

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from numpy_cae.cli.shared.output import note
from numpy_cae.fast import accelerate
from numpy_cae.fast.blas import blas_threads
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from studies.shared.material import Material
from studies.shared.result import Result, Table
from studies.timing.alternately import matrix_product_peak, time_alternately
from studies.timing.time_to_quality import time_to_quality
from studies.timing.torch_convolutional import TorchModel, cases, require_agreement, torch
from studies.timing.torch_sequential import LATENT, SequenceCase, TorchSequenceModel

HIDDEN = (128, 512, 1024)
"""Hidden units of the timed sequential networks."""
CHECKED_WINDOWS, CHECKED_HIDDEN = 4, 24
"""Windows, and hidden units, with which PyTorch's results are compared, in float64; more would take
longer."""
MOST_LOAD = 0.5
"""MOST_LOAD: above this load of the machine, the mean of the last minute, times are unreliable."""


def run(
    batch: tuple[int, ...] = (1, 4, 16, 64),
    rounds: int = 21,
    sequential: bool = False,
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
    if training:
        table = time_to_quality(material, sequential)
    else:
        timed = sequence_rows(batch, rounds) if sequential else rows(batch, rounds)
        header = ["what", "B", "ms a window", "spread, %", "PyTorch, ms", "spread, %", "ratio"]
        formats = ("", "", ".3f", ".0f", ".3f", ".0f", ".2f")
        count = len(header) if torch is not None else 4
        table = Table("", header[:count], list(timed), formats)
    made = {"BLAS": f"{blas_threads() or 'unknown'} threads"}
    made["matrix-product peak"] = f"{matrix_product_peak() / 1e9:.0f} GFLOP/s"
    if torch is not None:
        made["PyTorch"] = f"{torch.__version__}, {torch.get_num_threads()} threads"
    network = "sequential" if sequential else "convolutional"
    return Result(f"Times of the {network} network", [table], note=busy, provenance=made)


def rows(batches: Sequence[int], rounds: int) -> Iterator[list[object]]:
    """Every case of the convolutional network."""
    if torch is not None:
        exact = accelerate(ConvAutoencoder(dtype=np.float64))
        for case in cases(exact, CHECKED_WINDOWS):
            theirs = TorchModel(exact).function(case)
            require_agreement(case.name, case.function(exact)(), theirs())
    for batch in batches:
        model = accelerate(ConvAutoencoder())
        for case in cases(model, batch):
            yield _timed(case.name, batch, model, TorchModel, case, rounds)


def sequence_rows(batches: Sequence[int], rounds: int) -> Iterator[list[object]]:
    """A training step of the sequential network at every width."""
    if torch is not None:
        small = SequentialAutoencoder(hidden=CHECKED_HIDDEN, latent=LATENT, dtype=np.float64)
        exact = accelerate(small)
        case = SequenceCase.drawn(exact, CHECKED_WINDOWS)
        theirs = TorchSequenceModel(exact).function(case)
        require_agreement("sequential", case.function(exact)(), theirs())
    for batch in batches:
        for units in HIDDEN:
            model = accelerate(SequentialAutoencoder(hidden=units, latent=LATENT))
            case = SequenceCase.drawn(model, batch)
            yield _timed(f"hidden {units}", batch, model, TorchSequenceModel, case, rounds)


def _timed(
    name: str, batch: int, model: Any, torch_model: Callable, case: Any, rounds: int
) -> list[object]:
    """A row: the times of a case, here and in PyTorch, and their ratio."""
    functions = {"ours": case.function(model)}
    if torch is not None:
        functions["theirs"] = torch_model(model).function(case)
    times = time_alternately(functions, rounds)
    row: list[object] = [name, batch]
    for timing in times.values():
        row += [1e3 * timing.median / batch, 100 * timing.spread]
    note(f"{name}, {batch}: {row[2]:.3f} ms a window")
    return [*row, times["theirs"].median / times["ours"].median] if torch is not None else row
