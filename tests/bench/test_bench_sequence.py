"""The sequential autoencoder's benchmark: what is timed is the same network in both."""

import numpy as np
import pytest

from numpy_cae.bench import arithmetic, sequence, sequence_twin
from numpy_cae.bench.torch_twin import torch
from numpy_cae.cli import bench, main
from numpy_cae.models import SequentialAutoencoder

if torch is not None:
    torch.set_num_threads(1)

needs_torch = pytest.mark.skipif(torch is None, reason="PyTorch is not installed")


def small():
    rng = np.random.default_rng(0)
    model = SequentialAutoencoder(5, 7, 3, rng, np.float64)
    for name, weight in model.weights.items():
        model.weights[name] = rng.normal(scale=0.4, size=weight.shape)
    return model


@needs_torch
def test_pytorch_computes_the_same():
    model = small()
    sequence_twin.require_agreement(model, sequence_twin.SequenceCase.drawn(model, 4))


@needs_torch
def test_a_difference_from_pytorch_is_not_timed(monkeypatch):
    model = small()
    case = sequence_twin.SequenceCase.drawn(model, 4)
    monkeypatch.setattr(sequence_twin.SequenceTwin, "reconstruct", reversed_twice)
    with pytest.raises(ArithmeticError, match="differ in 'the loss'"):
        sequence_twin.require_agreement(model, case)


def reversed_twice(twin, x, original=sequence_twin.SequenceTwin.reconstruct):
    z, x_hat = original(twin, x)
    return z, x_hat.flip(1)


def test_operations_are_those_of_both_grus():
    model = SequentialAutoencoder(hidden=128, latent=32)
    gru = 3 * 128 * (54 + 128)
    expected = 2 * 50 * (3 * (2 * gru + 128 * 54) - 3 * 128 * 54)
    assert arithmetic.sequence_step(model, 50) == expected


def test_the_table_has_a_row_for_each_width(monkeypatch, capsys):
    monkeypatch.setattr(bench, "matrix_product_peak", lambda: 1e11)
    monkeypatch.setattr(sequence, "HIDDEN", (4, 6))
    assert main(["bench", "--sequential", "--batch", "2", "3", "--rounds", "1"]) == 0
    said = capsys.readouterr().out
    for name in ("hidden 4", "hidden 6"):
        assert said.count(f"| {name:16} |") == 2
