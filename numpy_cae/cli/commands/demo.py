"""Repair a damaged walk with the starter model. Then train a network on synthetic motions, repair
test motions of which half of the values were removed, and compare the errors with those of PCA.

example: numpy-cae demo -o demo
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from data_synth import make_take
from numpy_cae import viz
from numpy_cae.atomic_write import make_folder
from numpy_cae.cleanup import repair_motion
from numpy_cae.cli.shared import arguments
from numpy_cae.evaluation.tables import NOTE, P, compare_repairs
from numpy_cae.manifold import MotionManifold, learn_manifold, starter
from numpy_cae.mocap import body_of, write_bvh
from numpy_cae.motion import RATE, Motion
from numpy_cae.motion.quaternions import from_vector, product
from numpy_cae.training import ProgressPrinter, recipe, zero_values
from numpy_cae.viz.actor import local_actors

KINDS = ("walk", "run", "walk_with_turn", "kick", "old_mans_walk", "squats", "sidestep", "punch")
TAKES = 96
SECONDS = 8.0
"""The length of each take."""
TEST_EVERY = 6
"""Every sixth take of each kind is for testing."""
_FEWER = replace(recipe("fast").fine_tuning, epochs=14, batch=8)
SCHEDULE = replace(recipe("fast"), fine_tuning=_FEWER)
"""Recipe fast with fewer epochs and smaller batches. Both were chosen on the third take in six of
each kind, after training on the takes that are neither the third nor the sixth (tested) ones."""
DAMAGE = (
    ("rfemur", (35.0, 0.0, 35.0), slice(50, 95)),
    ("lhumerus", (0.0, 40.0, 0.0), slice(20, 21)),
    ("rhumerus", (30.0, 30.0, 0.0), slice(120, 122)),
)
"""A twisted leg and two spikes: joints, rotation vectors in degrees, frames."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The folder, the seed and the progress."""
    output = "folder for all results, created if it does not exist (default: demo)"
    parser.add_argument("-o", "--output", **arguments.FOLDER, default=Path("demo"), help=output)
    arguments.add_shared(parser, "overwrite seed quiet")


def run(args: argparse.Namespace) -> int:
    """Repair a walk; then train, measure and draw."""
    make_folder(args.output)
    _repair_a_walk(args.output, args.seed)
    _train(args.output, args.seed, not args.quiet)
    return 0


def _repair_a_walk(folder: Path, seed: int) -> None:
    """Damage a walk, repair it with the starter model, and write a page to look at."""
    true = make_take("walk", seed, seconds=5.0, rate=RATE).motion
    rotations = true.rotations.copy()
    for joint, vector, frames in DAMAGE:
        wrong = rotations[frames, true.skeleton.index(joint)]
        wrong[:] = product(wrong, from_vector(np.radians(vector)))
    damaged = replace(true, rotations=rotations)
    repaired = repair_motion(damaged, starter()).motion
    motions = {
        "damaged": (damaged, viz.CORRUPTED),
        "repaired": (repaired, viz.PROJECTED),
        "true": (true, viz.TRUTH),
    }
    for name, (motion, _) in motions.items():
        write_bvh(motion, folder / f"{name}.bvh", unit=0.01)
    actors = [viz.motion_actor(motion, name, colour) for name, (motion, colour) in motions.items()]
    viz.save_viewer(actors, folder / "index.html", RATE, "a damaged walk, repaired")
    before = _measure_distances(damaged, true)
    after = _measure_distances(repaired, true)
    is_wrong = before > 1
    print(
        f"{folder}/index.html: open it in a browser: a damaged walk, the same repaired, and the "
        f"true one\n{is_wrong.sum()} joint positions were wrong by {before[is_wrong].mean():.1f} "
        f"cm on average; after the repair they are {after[is_wrong].mean():.1f} cm off\n"
        f"{folder}/damaged.bvh, repaired.bvh, true.bvh: the same for other programs\n",
        flush=True,
    )


def _measure_distances(motion: Motion, true: Motion) -> np.ndarray:
    """The distance of each joint from the true one, (F, 20) in centimetres."""
    return 100 * np.linalg.norm(body_of(motion) - body_of(true), axis=-1)


def _train(folder: Path, seed: int, show_progress: bool) -> None:
    """Train a network, print the table of errors, and draw figure 1."""
    training: list[np.ndarray] = []
    testing: list[np.ndarray] = []
    for number in range(TAKES):
        kind = KINDS[number % len(KINDS)]
        take = make_take(kind, seed * TAKES + number, seconds=SECONDS, rate=RATE)
        is_test = number // len(KINDS) % TEST_EVERY == TEST_EVERY - 1
        half = testing if is_test else training
        half.append(body_of(take.motion))
    report = ProgressPrinter() if show_progress else None
    manifold = learn_manifold(training, SCHEDULE, seed, report=report)
    manifold.save(folder / "model.npz")
    if show_progress:
        print("comparing the network with other methods", file=sys.stderr, flush=True)
    print(f"\n{compare_repairs(manifold, training, testing, seed).text()}\n\n{NOTE}\n")
    _draw_figure_1(folder, manifold, testing[0], seed)
    print(
        f"{folder}/figure_1.png: orange lost half of its values, blue is its projection by the "
        f"network\n{folder}/model.npz: the network, for `numpy-cae repair -m` and other commands"
    )


def _draw_figure_1(folder: Path, manifold: MotionManifold, take: np.ndarray, seed: int) -> None:
    """Draw a test take with half of its values removed, projected, and in truth."""
    truth = manifold.features(take)[0]
    zeroed = zero_values(manifold.normalise(truth), P, np.random.default_rng(seed))
    corrupted = manifold.denormalise(zeroed)
    motions = {
        "half of the values removed": (corrupted, viz.CORRUPTED),
        "projected": (manifold.project(corrupted), viz.PROJECTED),
        "truth": (truth, viz.TRUTH),
    }
    figure = viz.strip_figure(local_actors(motions), RATE, azimuth=55.0)
    viz.save_figure(figure, folder / "figure_1.png")
