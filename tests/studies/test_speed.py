"""Times: both implementations agree, its arithmetic is right, its table is complete."""

from dataclasses import replace

import numpy as np
import pytest

from numpy_cae.fast import accelerate
from numpy_cae.fast.thread_team import is_limited_to_one_blas_thread
from numpy_cae.models import ConvAutoencoder
from numpy_cae.training import SEQUENCE_RECIPES, recipe
from studies import speed
from studies.timing import alternately, time_to_quality
from studies.timing.alternately import Timing, time_alternately
from studies.timing.torch_networks import TorchModel, cases, require_agreement, torch

if torch is not None:
    torch.set_num_threads(1)  # only values are compared here

needs_torch = pytest.mark.skipif(torch is None, reason="PyTorch is not installed")

NAMES = ["whole, random", "whole, even", "encode", "encode + decode"]


def small(dtype=np.float32):
    return ConvAutoencoder(filters=(4, 6), taps=5, dtype=dtype)


def test_functions_are_timed_alternately_and_a_time_has_a_median_and_a_least():
    now, calls = [0.0], []

    def wait(name, seconds):
        calls.append(name)
        now[0] += seconds

    functions = {"a": lambda: wait("a", 4.0), "b": lambda: wait("b", 5.0)}
    times = time_alternately(functions, 3, lambda: now[0])
    assert "".join(calls).endswith("aabb")
    assert list(times["a"].seconds) == [4.0] * 3 and times["b"].median == 5
    timing = Timing(np.array([1.0, 2.0, 3.0, 4.0, 100.0]))
    assert (timing.median, timing.least) == (3, 1)


@needs_torch
def test_pytorch_computes_the_same():
    model = small(np.float64)
    for case in cases(model, 3):
        theirs = TorchModel(model).function(case)
        require_agreement(case.name, case.function(accelerate(model))(), theirs())


@needs_torch
def test_different_computations_are_not_timed(monkeypatch):
    speed.require_same_results()
    encode = TorchModel.encode
    with monkeypatch.context() as patch:
        patch.setattr(TorchModel, "encode", lambda *arguments: 0.999 * encode(*arguments))
        with pytest.raises(ArithmeticError, match="differs in 'layer 1, random'"):
            speed.run()
    monkeypatch.setattr(torch, "sort", lambda z, dim: (z, None))
    with pytest.raises(ArithmeticError, match="differs in 'sequential'"):
        speed.run()


@needs_torch
def test_a_ratio_has_its_spread(monkeypatch):
    monkeypatch.setattr(alternately, "MIN_SECONDS", 1e-4)
    monkeypatch.setattr(speed, "HIDDEN", (4,))
    row = next(speed.sequence_rows([2], 5, 1))
    assert len(row) == len(speed.HEADER + speed.OF_PYTORCH)
    low, high = map(float, row[-2].split(" to "))
    assert low <= round(row[-1], 2) <= high


def test_a_block_of_one_thread_limits_blas():
    with speed.limited_to(1):
        assert is_limited_to_one_blas_thread()
    assert not is_limited_to_one_blas_thread()


@pytest.mark.parametrize("load", [0.1, 3.0])
def test_the_table_has_a_row_for_each_case(monkeypatch, load):
    monkeypatch.setattr(speed, "ConvAutoencoder", small)
    monkeypatch.setattr(alternately, "MIN_SECONDS", 1e-4)
    monkeypatch.setattr(speed, "matrix_product_peak", lambda: 1e11)
    monkeypatch.setattr(speed.nets, "torch", None)
    monkeypatch.setattr(speed.os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    monkeypatch.setattr(speed, "HIDDEN", (4, 6))
    result = speed.run((1, 2), rounds=1, clips=(2,))
    assert result.provenance["matrix-product peak"].startswith("100 on 1")
    assert ("The processor was used" in result.note) == (load > 1)
    table, sequences = result.tables[:2]
    assert [found.caption.split(", ")[1] for found in result.tables[:2]] == ["1 thread:"] * 2
    assert [row[:2] for row in sequences.rows] == [["4 hidden units", 2], ["6 hidden units", 2]]
    assert len(table.header) == 4 and {len(row) for row in table.rows} == {4}
    assert all([row[0] for row in table.rows].count(name) == 2 for name in NAMES)


def upright_takes(material):
    """Those of walking and waving, which an untrained network misses by less than ten centimetres.

    It misses press-ups by more, and three epochs change little.
    """
    training = [take for take in material.training if take.content != "press_ups"]
    testing = [take for take in material.testing if take.content != "press_ups"]
    return replace(material, training=training, testing=testing)


@needs_torch
def test_a_training_is_timed_to_the_lowest_error_that_all_reach(monkeypatch, labelled):
    curves = {"ours": [(2.0, 3.0), (4.0, 1.9), (6.0, 1.0)], "theirs": [(5.0, 4.0), (10.0, 2.0)]}
    table = time_to_quality.quality(curves, "cm")
    assert table.header[1] == "seconds to 2.000 cm"
    assert table.rows[1] == ["theirs", 10.0, 2.5, 10.0, 2.0]
    stage = replace(recipe("fast").fine_tuning, epochs=3, rate=1e-4)
    tiny = replace(recipe("fast"), fine_tuning=stage)
    monkeypatch.setattr(time_to_quality.training, "recipe", lambda name: tiny)
    monkeypatch.setattr(time_to_quality, "USUAL", replace(stage, norm=None))
    table = time_to_quality.time_to_quality(upright_takes(labelled))
    assert [row[0] for row in table.rows][1:] == [
        f"PyTorch, {s} settings" for s in ("usual", "our")
    ]
    assert 0 < table.rows[0][4] < 10 and np.isfinite([row[4] for row in table.rows]).all()
    few = replace(SEQUENCE_RECIPES["fast"], epochs=2, steps=2, batch=4)
    monkeypatch.setattr(time_to_quality.training, "SEQUENCE_RECIPES", {"fast": few})
    monkeypatch.setattr(time_to_quality, "USUAL_SEQUENCES", few)
    monkeypatch.setattr(time_to_quality, "MINUTES", 0.3)
    table = time_to_quality.sequences_to_quality()
    assert [0.1 < row[4] < 3 for row in table.rows] == [True] * 3
