"""What the scripts of single experiments share: their options, and printing the result."""

import argparse
from collections.abc import Callable
from pathlib import Path

from numpy_cae.experiments.material import Material, read_material
from numpy_cae.experiments.result import Result
from numpy_cae.manifold import MotionManifold, load_manifold, starter


def main(run: Callable[[MotionManifold, Material, int], Result], description: str) -> None:
    """Measure on the test takes in folders by `run`, as `numpy-cae report` does, and print."""
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    add = parser.add_argument
    add("--data", type=Path, nargs="+", required=True, help="folders of motion files")
    add("--test", nargs="+", required=True, help="names of the test files, such as '*_005.bvh'")
    add("-m", "--model", type=Path, help="a model that has not seen them (default: the starter)")
    add("--seed", type=int, default=0)
    args = parser.parse_args()
    manifold = load_manifold(args.model) if args.model else starter()
    result = run(manifold, read_material(args.data, args.test), args.seed)
    print(result.text(), "", *(claim.text() for claim in result.claims), sep="\n")
