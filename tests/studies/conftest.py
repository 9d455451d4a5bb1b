"""A small manifold, a few labelled takes, and the result of every study of takes on them."""

from dataclasses import replace
from functools import cache
from importlib import import_module
from itertools import product

import pytest

from data_synth import make_take
from numpy_cae.manifold import learn_manifold
from numpy_cae.mocap import body_of, write_bvh
from numpy_cae.training import Schedule, Stage
from studies.shared.damages import DAMAGES
from studies.shared.material import LabelledTake, Material
from studies.shared.options import parameters

CONTENTS = ("walk neutral", "walk old", "wave neutral", "wave tired", "press_ups ")
SMALL = {
    "repair_sweep": {"WINDOWS": 3},
    "damage": {"TAKES": 1, "ONSETS": (0, 2)}
    | {"DAMAGES": {kind: DAMAGES[kind] for kind in ("twisted leg", "dropped frames", "jitter")}},
    "sampling": {"DRAWN": 4},
    "comparison": {"QUERIES": 2, "OF_SCENE": 1, "SECONDS": 3.0, "NEAREST": 2},
    "depth": {
        "FILTERS": (4, 6, 8),
        "ADAM_EPOCHS": 1,
        "recipe": lambda name: Schedule(layer=Stage(rate=0.02)),
    },
    "training_choices": {"FILTERS": (4, 6, 8)}
    | {"recipe": lambda name: Schedule(layer=Stage(rate=0.02))},
    "scaling": {"STEPS": 8, "SIZES": (4, 8), "PAPER_WINDOWS": 100}
    | {"KERNEL_SIZES": (10, 20), "MEMORY_SIZES": (2, 4), "LANDMARKS": 5}
    | {"PCA_SIZES": (10, 20)},
    "shared.small_networks": {"FILTERS": (4, 6, 8), "TESTING_WINDOWS": 3},
}
"""Constants of studies that would take long."""


def shrink(patch):
    patch.setattr("numpy_cae.manifold.weighted_completion.MOST_TRIALS", 1)
    for study, constants in SMALL.items():
        for constant, value in constants.items():
            patch.setattr(f"studies.{study}.{constant}", value)


@pytest.fixture(scope="module")
def small():
    """Studies with few of everything; what patches them."""
    with pytest.MonkeyPatch.context() as patch:
        shrink(patch)
        yield patch


@pytest.fixture(scope="session")
def labelled(tmp_path_factory):
    """Five pairs of content and style: two training takes and a testing take of each."""
    folder = tmp_path_factory.mktemp("labelled")

    def takes(seeds):
        labelled = []
        for content, seed in product(CONTENTS, seeds):
            kind, style = content.split(" ")
            motion = make_take(kind, seed, 3.0, 30.0, style or None).motion
            path = folder / f"{kind}_{style}_{seed}.bvh"
            write_bvh(motion, path, unit=0.01)
            labelled.append(LabelledTake(path, body_of(motion), "bandai", kind, style))
        return labelled

    return Material(takes([1, 2]), takes([3]))


@pytest.fixture(scope="session")
def small_manifold(labelled):
    """Two layers, learned in a second."""
    quick = Schedule(layer=Stage(epochs=2), fine_tuning=Stage(epochs=3, rate=0.05, alpha=0.0))
    takes = [take.positions for take in labelled.training]
    return learn_manifold(takes, quick, window=32, overlap=16, filters=(12, 16), taps=5)


@pytest.fixture(scope="session")
def result_of(small_manifold, labelled):
    """The result of a study by name, run once, with its figures drawn."""

    @cache
    def run(name):
        module = import_module(f"studies.{name}")
        with pytest.MonkeyPatch.context() as patch:
            shrink(patch)
            values = {"manifold": small_manifold, "material": labelled, "seed": 0, "epochs": 1}
            values |= {"seeds": 2, "takes": 1}
            names = [name for name in parameters(module.run) if name in values]
            result = module.run(**{name: values[name] for name in names})
            pictures = {}
            for title, picture in result.figures.items():
                figure = picture.draw()
                pictures[title] = replace(picture, draw=lambda figure=figure: figure)
            return replace(result, figures=pictures)

    return run
