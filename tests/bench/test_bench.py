"""The benchmark: both implementations agree, its arithmetic is right, its table is complete."""

import sys
from pathlib import Path

import numpy as np
import pytest

from numpy_cae.bench import table
from numpy_cae.bench.convolutional import TorchModel, arrays_of, cases, require_agreement, torch
from numpy_cae.bench.table import Timing, time_alternately
from numpy_cae.cli import main
from numpy_cae.cli.commands import bench
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder

sys.path.append(str(Path(__file__).parents[2] / "docs"))
import sequential_step
from sequential_step import SequenceCase, TorchSequenceModel

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

    monkeypatch.setattr(table.time, "perf_counter", lambda: now[0])
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
        theirs = TorchModel(model).arrays(case)
        require_agreement(case.name, arrays_of(accelerate(model), case), theirs)
    rng = np.random.default_rng(0)
    model = SequentialAutoencoder(5, 7, 3, rng, np.float64, burn_in=2)
    for name, weight in model.weights.items():
        model.weights[name] = rng.normal(scale=0.4, size=weight.shape)
    case = SequenceCase.drawn(model, 4)
    theirs = TorchSequenceModel(model).arrays(case)
    require_agreement("sequential", case.arrays_of(accelerate(model)), theirs)


@needs_torch
def test_different_computations_are_not_timed(monkeypatch):
    encode, reconstruct = TorchModel.encode, TorchSequenceModel.reconstruct

    def reversed_twice(model, x):
        z, x_hat = reconstruct(model, x)
        return z, x_hat.flip(1)

    monkeypatch.setattr(TorchModel, "encode", lambda *arguments: 0.999 * encode(*arguments))
    monkeypatch.setattr(TorchSequenceModel, "reconstruct", reversed_twice)
    with pytest.raises(ArithmeticError, match="differs in 'layer 1, random'"):
        next(table.rows())
    with pytest.raises(ArithmeticError, match="differs in 'sequential'"):
        next(sequential_step.rows([2]))


def test_the_table_has_a_row_for_each_case(monkeypatch, capsys):
    monkeypatch.setattr(table, "ConvAutoencoder", small)
    monkeypatch.setattr(table, "MIN_SECONDS", 1e-4)
    monkeypatch.setattr(table, "matrix_product_peak", lambda: 1e11)
    monkeypatch.setattr(table, "torch", None)
    assert main(["bench", "--batch", "1", "2", "--rounds", "1"]) == 0
    printed = capsys.readouterr().out
    assert "matrix-product peak 100 GFLOP/s" in printed and "PyTorch" not in printed
    assert all(printed.count(f"| {name:16} |") == 2 for name in NAMES)


@needs_torch
def test_the_script_has_a_row_for_each_width(monkeypatch):
    monkeypatch.setattr(sequential_step, "HIDDEN", (4, 6))
    monkeypatch.setattr(table, "MIN_SECONDS", 1e-4)
    rows = [row.text() for row in sequential_step.rows([1, 2], 1)]
    assert [row[:14] for row in rows] == 2 * ["| hidden 4    ", "| hidden 6    "]
    assert all(row.count("|") == 6 for row in rows)


@pytest.mark.parametrize(("load", "warned"), [(0.1, False), (3.0, True)])
def test_a_busy_machine_gives_a_warning(monkeypatch, capsys, load, warned):
    monkeypatch.setattr(bench.os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    bench._warn_if_busy()
    assert ("other programs use the processor" in capsys.readouterr().err) == warned
