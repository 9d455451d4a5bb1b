"""The benchmark measures what it says: its twins agree, its arithmetic and its clock are right."""

import time

import numpy as np
import pytest

from numpy_cae.bench import arithmetic, growth, paper, table, torch_twin
from numpy_cae.bench.cases import cases
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.bench.timing import Timing, time_in_turns
from numpy_cae.cli import bench, main
from numpy_cae.models import ConvAutoencoder

if torch_twin.torch is not None:
    # What is compared here are values; PyTorch's threads only get into each other's way.
    torch_twin.torch.set_num_threads(1)

NAMES = [
    *(f"{what}, {how}" for what in ("layer 1", "layer 2", "whole") for how in ("random", "even")),
    "encode",
    "encode + decode",
]


def small(dtype=np.float32):
    return ConvAutoencoder(filters=(4, 6), taps=5, dtype=dtype)


def test_every_stage_both_unpoolings_and_projection_are_timed():
    assert [case.name for case in cases(small(), 2)] == NAMES


def test_operations_are_those_of_the_papers_network():
    layers = ConvAutoencoder().layers
    one = 2 * 15 * (160 * 63 * 64 + 80 * 64 * 128 + 40 * 128 * 256)
    assert arithmetic.encoding(layers, 160) == one
    assert arithmetic.training_step(layers, 160) == 6 * one - 2 * 15 * 160 * 63 * 64


def test_functions_are_timed_in_turns():
    calls = []

    def wait(name, seconds):
        calls.append(name)
        time.sleep(seconds)

    times = time_in_turns({"a": lambda: wait("a", 0.02), "b": lambda: wait("b", 0.04)}, rounds=3)
    assert calls[-4:] == ["a", "a", "b", "b"]
    assert 0.02 <= times["a"].median < 0.04 <= times["b"].median
    assert len(times["a"].seconds) == 3


def test_median_and_spread():
    timing = Timing(np.array([1.0, 2.0, 3.0, 4.0, 100.0]))
    assert timing.median == 3
    assert timing.spread == pytest.approx((4 - 2) / 2 / 3)


def test_the_peak_is_not_beaten_by_a_smaller_product():
    assert matrix_product_peak(512, 5) > 1e9


def test_memory_is_that_of_the_largest_moment():
    def work():
        np.ones(1_000_000)
        return np.ones(10)

    assert 8_000_000 <= table.peak_memory(work) < 9_000_000


@pytest.mark.skipif(torch_twin.torch is None, reason="PyTorch is not installed")
@pytest.mark.parametrize("name", NAMES)
def test_pytorch_computes_the_same(name):
    model = small(np.float64)
    case = next(case for case in cases(model, 3) if case.name == name)
    torch_twin.require_agreement(model, case)


@pytest.mark.skipif(torch_twin.torch is None, reason="PyTorch is not installed")
def test_a_difference_from_pytorch_is_not_timed(monkeypatch):
    model = small(np.float64)
    case = next(cases(model, 3))
    monkeypatch.setattr(torch_twin, "alpha", lambda case: 0.02)
    with pytest.raises(ArithmeticError, match="differ in 'layer 1, random'"):
        torch_twin.require_agreement(model, case)


def test_the_table_has_a_row_for_each_case(monkeypatch, capsys):
    monkeypatch.setattr(table, "ConvAutoencoder", small_for_table)
    monkeypatch.setattr(bench, "matrix_product_peak", lambda: 1e11)
    assert main(["bench", "--batch", "1", "2", "--rounds", "1"]) == 0
    said = capsys.readouterr().out
    assert "matrix-product peak" in said
    for name in NAMES:
        assert said.count(f"| {name:16} |") == 2


def small_for_table(dtype=np.float32):
    return small(dtype)


@pytest.mark.parametrize(("load", "warned"), [(0.1, False), (3.0, True)])
def test_a_busy_machine_is_said(monkeypatch, capsys, load, warned):
    monkeypatch.setattr(bench.os, "getloadavg", lambda: (load, 0.0, 0.0), raising=False)
    monkeypatch.setattr(bench.table, "rows", lambda *arguments: iter(()))
    monkeypatch.setattr(bench, "matrix_product_peak", lambda: 1e11)
    assert main(["bench"]) == 0
    assert ("other programs are at work" in capsys.readouterr().err) == warned


def test_the_papers_run_names_its_stages_and_scales_to_25_epochs():
    run = paper.run_paper(4, epochs=1, windows=8, show_progress=False)
    assert list(run.minutes) == list(paper.MINUTES)
    assert run.total > sum(run.minutes.values())
    text = run.text()
    assert "batch 4, 8 windows, scaled from 1 to 25 epochs" in text
    assert "|                  304 |" in text


def test_synthetic_windows_have_the_size_that_training_sees():
    windows = paper.synthetic_windows(200, 32)
    assert windows.dtype == np.float32
    assert np.sqrt(np.mean(windows**2)) == pytest.approx(0.25, rel=0.1)
    np.testing.assert_array_equal(windows, paper.synthetic_windows(200, 32))


def test_growth_finds_the_exponent(tmp_path):
    grown = growth.Growth("windows", [1, 2, 4, 8], [0.1, 0.4, 1.6, 6.4])
    assert grown.exponent == pytest.approx(2)
    assert "twice as many cost 4.00 times as much" in grown.text()
    growth.draw([grown, grown], tmp_path / "growth.png")
    assert (tmp_path / "growth.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="no folder"):
        growth.draw([grown, grown], tmp_path / "nowhere" / "growth.png")
