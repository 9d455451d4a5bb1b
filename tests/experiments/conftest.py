"""A small manifold and a few labelled takes, for every experiment that needs both."""

from __future__ import annotations

from pathlib import Path

import pytest

from data_synth import make_take
from numpy_cae.experiments.material import LabelledTake, Material
from numpy_cae.manifold import learn_manifold
from numpy_cae.motion import body_of
from numpy_cae.training import Schedule, Stage

CONTENTS = {"walk": ("neutral", "old"), "wave": ("neutral", "tired")}


@pytest.fixture(scope="session")
def labelled():
    """Two contents in two styles each: two training takes and a testing take of every pair."""

    def takes(seeds):
        made = []
        for kind, styles in CONTENTS.items():
            for style in styles:
                for seed in seeds:
                    motion = make_take(kind, seed, 3.0, 30.0, style).motion
                    path = Path(f"{kind}_{style}_{seed}.bvh")
                    made.append(LabelledTake(path, body_of(motion), "bandai", kind, style))
        return made

    return Material(takes([1, 2]), takes([3]))


@pytest.fixture(scope="session")
def small_manifold(labelled):
    """Two layers, learned in a second."""
    quick = Schedule(layer=Stage(epochs=2), fine_tuning=Stage(3, 0.05, 0.9, 0.0))
    return learn_manifold(
        [take.positions for take in labelled.training],
        quick,
        window=32,
        overlap=16,
        filters=(12, 16),
        taps=5,
        show_progress=False,
    )
