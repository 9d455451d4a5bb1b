"""The benchmark: both implementations agree, its arithmetic is right, its table is complete."""

import time

import numpy as np
import pytest

from numpy_cae.bench import convolutional, table
from numpy_cae.bench.convolutional import TorchModel, arrays_of, cases, require_agreement, torch
from numpy_cae.bench.sequential import SequenceCase, TorchSequenceModel
from numpy_cae.bench.table import Timing, time_alternately
from numpy_cae.cli import main
from numpy_cae.cli.commands import bench
from numpy_cae.fast import accelerate
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder

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


def small_sequential():
    rng = np.random.default_rng(0)
    model = SequentialAutoencoder(5, 7, 3, rng, np.float64, burn_in=2)
    for name, weight in model.weights.items():
        model.weights[name] = rng.normal(scale=0.4, size=weight.shape)
    return model


def test_every_stage_both_unpoolings_and_projection_are_timed():
    assert [case.name for case in cases(small(), 2)] == NAMES


def test_functions_are_timed_alternately():
    calls = []

    def wait(name, seconds):
        calls.append(name)
        time.sleep(seconds)

    times = time_alternately({"a": lambda: wait("a", 0.04), "b": lambda: wait("b", 0.05)}, 3)
    assert calls[-4:] == ["a", "a", "b", "b"]
    assert times["a"].median >= 0.04
    assert len(times["a"].seconds) == 3


def test_median_and_spread():
    timing = Timing(np.array([1.0, 2.0, 3.0, 4.0, 100.0]))
    assert timing.median == 3
    assert timing.spread == pytest.approx((4 - 2) / 2 / 3)


@needs_torch
@pytest.mark.parametrize("name", NAMES)
def test_pytorch_computes_the_same(name):
    model = small(np.float64)
    case = next(case for case in cases(model, 3) if case.name == name)
    theirs = TorchModel(model).arrays(case)
    require_agreement(name, arrays_of(model, case), theirs)
    require_agreement(name, arrays_of(accelerate(model), case), theirs)


@needs_torch
def test_pytorch_computes_the_same_sequential_step():
    model = small_sequential()
    case = SequenceCase.drawn(model, 4)
    theirs = TorchSequenceModel(model).arrays(case)
    require_agreement("sequential", case.arrays_of(model), theirs)
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
        next(table.sequence_rows([2]))


@pytest.mark.parametrize("with_torch", [True, False])
def test_the_table_has_a_row_for_each_case(monkeypatch, capsys, with_torch):
    monkeypatch.setattr(table, "ConvAutoencoder", small)
    monkeypatch.setattr(table, "matrix_product_peak", lambda: 1e11)
    if not with_torch:
        monkeypatch.setattr(table, "torch", None)
    batches = ["1", "2"] if with_torch else ["1"]
    assert main(["bench", "--batch", *batches, "--rounds", "1"]) == 0
    printed = capsys.readouterr().out
    assert "matrix-product peak" in printed
    assert ("PyTorch" in printed) == (with_torch and convolutional.torch is not None)
    for name in NAMES:
        assert printed.count(f"| {name:16} |") == len(batches)


def test_the_table_has_a_row_for_each_width(monkeypatch, capsys):
    monkeypatch.setattr(table, "matrix_product_peak", lambda: 1e11)
    monkeypatch.setattr(table, "HIDDEN", (4, 6))
    assert main(["bench", "--sequential", "--batch", "2", "3", "--rounds", "1"]) == 0
    printed = capsys.readouterr().out
    for name in ("hidden 4", "hidden 6"):
        assert printed.count(f"| {name:16} |") == 2


@pytest.mark.parametrize(("load", "warned"), [(0.1, False), (3.0, True)])
def test_a_busy_machine_gives_a_warning(monkeypatch, capsys, load, warned):
    monkeypatch.setattr(bench.os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    monkeypatch.setattr(bench.table, "rows", lambda *arguments: iter(()))
    monkeypatch.setattr(table, "matrix_product_peak", lambda: 1e11)
    assert main(["bench"]) == 0
    assert ("other programs use the processor" in capsys.readouterr().err) == warned
