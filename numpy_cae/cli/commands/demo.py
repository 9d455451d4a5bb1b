"""Make a small synthetic set of motions, train on it, repair a test clip that lost half of its
values, and compare that with PCA.

example: numpy-cae demo -o demo
"""

import argparse
from pathlib import Path

from data_synth import make_take
from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.takes import read_takes
from numpy_cae.experiments.material import unlabelled
from numpy_cae.experiments.repair import half_removed
from numpy_cae.manifold import learn_manifold, project_motion, save_manifold
from numpy_cae.motion import fit_motion, load_motion, write_bvh, write_like
from numpy_cae.training import ProgressPrinter, Schedule, Stage
from numpy_cae.viz import save_viewer

KINDS = ("walk", "run", "walk_with_turn", "kick", "old_mans_walk", "squats", "sidestep", "punch")
TAKES = 96
SECONDS = 8.0
SCHEDULE = Schedule(
    layer=Stage(epochs=7), fine_tuning=Stage(epochs=20, rate=0.15, decay=0.93, alpha=0.0)
)
"""Shorter than the paper's, on a hundredth of its motion, so that the demo takes about a minute."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The folder, the seed and the progress."""
    output = "folder for all results, created if it does not exist (default: demo)"
    parser.add_argument("-o", "--output", **arguments.FOLDER, default=Path("demo"), help=output)
    arguments.add_shared(parser, "seed quiet")


def run(args: argparse.Namespace) -> int:
    """Make motions, train, measure and draw."""
    out = args.output
    (out / "motions").mkdir(parents=True, exist_ok=True)
    paths = _make_motions(out / "motions", args.seed)
    training, testing = read_takes(paths, test=["*_test.bvh"])
    manifold = learn_manifold(
        training, SCHEDULE, args.seed, report=None if args.quiet else ProgressPrinter()
    )
    save_manifold(manifold, out / "model.npz")
    material = unlabelled(training, testing)
    print(f"\n{half_removed.run(manifold, material, args.seed).text()}\n")
    figure = half_removed.figure_1(manifold, material, args.seed)
    figure.save_picture(out / "figure_1.png")
    save_viewer(figure.animation.actors, out / "index.html", figure.animation.rate, "numpy_cae")
    take = half_removed.typical(manifold, material.testing).positions
    for name, positions in half_removed.half_removed_positions(manifold, take, args.seed).items():
        write_bvh(fit_motion(positions, manifold.lengths, manifold.rate), out / f"{name}.bvh")
    corrupted = load_motion(out / "corrupted.bvh")
    projected = project_motion(corrupted, manifold)
    write_like(out / "corrupted.bvh", corrupted, projected, out / "projected.bvh")
    print(
        f"{out}/index.html: open it in a browser; orange lost half of its values, path included, "
        f"blue is its projection, green the truth\n{out}/figure_1.png: the same, drawn\n"
        f"{out}/truth.bvh and corrupted.bvh: the same for Blender, both on the true path\n"
        f"{out}/projected.bvh: made by `numpy-cae repair {out}/corrupted.bvh -m {out}/model.npz "
        f"--project -o {out}/projected.bvh`"
    )
    return 0


def _make_motions(folder: Path, seed: int) -> list[Path]:
    """Write takes of every kind in turn as BVH files, every sixth of a kind for testing."""
    paths = []
    for number in range(TAKES):
        kind, round_ = KINDS[number % len(KINDS)], number // len(KINDS)
        take = make_take(kind, seed * TAKES + number, seconds=SECONDS, rate=30.0)
        suffix = "_test" if round_ % 6 == 5 else ""
        paths.append(folder / f"{kind}_{round_ + 1:02d}{suffix}.bvh")
        write_bvh(take.motion, paths[-1], unit=0.01)
    return paths
