"""A step of training jang2018's network at three widths, beside PyTorch where it is installed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from numpy_cae.bench import arithmetic
from numpy_cae.bench.sequence_twin import (
    FRAMES,
    LATENT,
    SequenceCase,
    SequenceTwin,
    require_agreement,
)
from numpy_cae.bench.table import Row, peak_memory
from numpy_cae.bench.timing import time_in_turns
from numpy_cae.bench.torch_twin import torch
from numpy_cae.fast import accelerate
from numpy_cae.models import SequentialAutoencoder

HIDDEN = (128, 512, 1024)
BATCHES = (16, 64)
CHECKED = 24
"""Hidden units with which PyTorch is checked; more would only take longer."""


def rows(peak: float, batches: Sequence[int] = BATCHES, rounds: int = 21) -> Iterator[Row]:
    """Time every width and batch; a row as soon as it is known.

    Raises
    ------
    ArithmeticError
        If PyTorch is installed and computes something else.
    """
    if torch is not None:
        model = SequentialAutoencoder(hidden=CHECKED, latent=LATENT, dtype=np.float64)
        model = accelerate(model)
        for batch in batches:
            require_agreement(model, SequenceCase.drawn(model, batch))
    for batch in batches:
        for units in HIDDEN:
            model = SequentialAutoencoder(hidden=units, latent=LATENT)
            yield _row(accelerate(model), batch, peak, rounds)


def _row(model: SequentialAutoencoder, batch: int, peak: float, rounds: int) -> Row:
    case = SequenceCase.drawn(model, batch)
    memory = peak_memory(case.ours(model))
    functions = {"ours": case.ours(model)}
    if torch is not None:
        functions["theirs"] = SequenceTwin(model).theirs(case)
    times = time_in_turns(functions, rounds)
    operations = batch * arithmetic.sequence_step(model, FRAMES)
    name = f"hidden {model.hidden}"
    return Row(name, batch, operations, peak, memory, times["ours"], times.get("theirs"))
