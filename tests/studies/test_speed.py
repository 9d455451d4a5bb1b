"""Times: both implementations agree, its arithmetic is right, its table is complete."""

import numpy as np
import pytest

from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from studies import speed
from studies.timing import alternately
from studies.timing.alternately import Timing, time_alternately
from studies.timing.torch_convolutional import TorchModel, cases, require_agreement, torch
from studies.timing.torch_sequential import SequenceCase, TorchSequenceModel

if torch is not None:
    torch.set_num_threads(1)  # only values are compared here

needs_torch = pytest.mark.skipif(torch is None, reason="PyTorch is not installed")

NAMES = [
    *(f"{what}, {how}" for what in ("layer 1", "layer 2", "whole") for how in ("random", "even")),
    "encode",
    "encode + decode",
]


def small(dtype=np.float32):
    return ConvAutoencoder(filters=(4, 6), taps=5, dtype=dtype)


def test_functions_are_timed_alternately_and_a_time_has_a_median_and_a_spread(monkeypatch):
    now, calls = [0.0], []

    def wait(name, seconds):
        calls.append(name)
        now[0] += seconds

    monkeypatch.setattr(alternately.time, "perf_counter", lambda: now[0])
    times = time_alternately({"a": lambda: wait("a", 4.0), "b": lambda: wait("b", 5.0)}, 3)
    assert "".join(calls).endswith("aabb")
    assert list(times["a"].seconds) == [4.0] * 3 and times["b"].median == 5
    timing = Timing(np.array([1.0, 2.0, 3.0, 4.0, 100.0]))
    assert timing.median == 3
    assert timing.spread == pytest.approx((4 - 2) / 2 / 3)


@needs_torch
def test_pytorch_computes_the_same():
    model = small(np.float64)
    for case in cases(model, 3):
        theirs = TorchModel(model).function(case)
        require_agreement(case.name, case.function(accelerate(model))(), theirs())
    rng = np.random.default_rng(0)
    model = SequentialAutoencoder(5, 7, 3, rng, np.float64, burn_in=2)
    for name, weight in model.weights.items():
        model.weights[name] = rng.normal(scale=0.4, size=weight.shape)
    case = SequenceCase.drawn(model, 4)
    theirs = TorchSequenceModel(model).function(case)
    require_agreement("sequential", case.function(accelerate(model))(), theirs())


@needs_torch
def test_different_computations_are_not_timed(monkeypatch):
    encode, reconstruct = TorchModel.encode, TorchSequenceModel.reconstruct

    def reversed_twice(model, x):
        z, x_hat = reconstruct(model, x)
        return z, x_hat.flip(1)

    monkeypatch.setattr(TorchModel, "encode", lambda *arguments: 0.999 * encode(*arguments))
    monkeypatch.setattr(TorchSequenceModel, "reconstruct", reversed_twice)
    with pytest.raises(ArithmeticError, match="differs in 'layer 1, random'"):
        next(speed.rows([1], 1))
    with pytest.raises(ArithmeticError, match="differs in 'sequential'"):
        next(speed.sequence_rows([2], 1))


@pytest.mark.parametrize("load", [0.1, 3.0])
def test_the_table_has_a_row_for_each_case(monkeypatch, load):
    monkeypatch.setattr(speed, "ConvAutoencoder", small)
    monkeypatch.setattr(alternately, "MIN_SECONDS", 1e-4)
    monkeypatch.setattr(speed, "matrix_product_peak", lambda: 1e11)
    monkeypatch.setattr(speed, "torch", None)
    monkeypatch.setattr(speed.os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    result = speed.run((1, 2), rounds=1)
    assert result.provenance["matrix-product peak"] == "100 GFLOP/s"
    assert ("Other programs use the processor" in result.note) == (load > 1)
    (table,) = result.tables
    assert len(table.header) == 4 and {len(row) for row in table.rows} == {4}
    assert all([row[0] for row in table.rows].count(name) == 2 for name in NAMES)


@needs_torch
def test_the_sequential_network_has_a_row_for_each_width(monkeypatch):
    monkeypatch.setattr(speed, "HIDDEN", (4, 6))
    monkeypatch.setattr(alternately, "MIN_SECONDS", 1e-4)
    (table,) = speed.run((1, 2), 1, sequential=True).tables
    assert [row[:2] for row in table.rows] == [
        [f"hidden {units}", batch] for batch in (1, 2) for units in (4, 6)
    ]
    assert all(len(row) == 7 for row in table.rows)
