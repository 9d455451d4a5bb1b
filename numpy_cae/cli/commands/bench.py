"""Time training steps, encoding and projection. If PyTorch is installed, the same network in
PyTorch is checked to give the same results and timed alternately with this one; 'ratio' is
PyTorch's time divided by this one's. With --quality, time whole trainings to the same error.

examples:
  numpy-cae bench --batch 1 16
  numpy-cae bench --quality --data motions/ --test '*_005.bvh'
"""

import argparse
import os
from collections.abc import Callable

import numpy as np

from numpy_cae.bench import quality, table
from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.output import note, print_json

SEQUENCE_MINUTES = 180.0
"""Minutes of synthetic walking to train on, and as many of other people to hold out."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to measure, and how often."""
    add = parser.add_argument
    sizes = "batch sizes (default: 1 4 16 64; with --sequential 16 64)"
    add("--batch", type=arguments.positive_number, nargs="+", metavar="B", help=sizes)
    rounds = "number of measurements of each time in the table (default: 21)"
    add("--rounds", **arguments.COUNT, default=21, help=rounds)
    sequential = "time training steps of the sequential autoencoder of three sizes instead"
    add("--sequential", **arguments.FLAG, help=sequential)
    arguments.add_shared(parser, "json quiet")
    add = parser.add_argument_group("time to a given quality").add_argument
    trainings = (
        "train by --recipe fast and, in turns, in PyTorch with Adam, and compare the times to the "
        "lowest error of held-out motion with half of the values removed that all reach (minutes)"
    )
    add("--quality", **arguments.FLAG, help=trainings)
    data = "folders of motion files for --quality (default: 20 minutes of synthetic motions)"
    add("--data", **arguments.FOLDERS, help=data)
    add("--test", **arguments.PATTERNS, help="names of the files to hold out, required with --data")
    arguments.add_shared(parser, "mapping unit up floor")


def run(args: argparse.Namespace) -> int:
    """Measure and print each row when it is measured, or with --json all of them at the end."""
    if args.quality:
        return _quality(args)
    _warn_if_busy()
    rows = (table.sequence_rows if args.sequential else table.rows)(args.batch, args.rounds)
    if args.json:
        print_json(list(rows))
        return 0
    print(table.header(), flush=True)
    for row in rows:
        print(row.text(), flush=True)
    return 0


def _quality(args: argparse.Namespace) -> int:
    """Train in turns; print the table."""
    quality.require_torch()
    _warn_if_busy()
    trainings = _sequential_trainings(args) if args.sequential else _trainings(args)
    quality.train_in_turns(trainings, (lambda line: None) if args.quiet else note)
    compared = quality.Quality(trainings, "of the variance" if args.sequential else "cm")
    if args.json:
        print_json(compared.data())
    else:
        print(compared.text())
    return 0


def _trainings(args: argparse.Namespace) -> list[quality.Training]:
    """Of the convolutional network; the error is that of the table of `numpy-cae train`."""
    from numpy_cae.bench.trainings import trainings
    from numpy_cae.cli.shared.takes import training_and_test_takes
    from numpy_cae.experiments.ablation.ablation import HALF_REMOVED, Evaluation
    from numpy_cae.training import recipe

    evaluation = Evaluation(training_and_test_takes(args))

    def error(repair: Callable[[np.ndarray], np.ndarray]) -> float:
        return evaluation.measure(repair, seed=0)[HALF_REMOVED]

    return trainings(evaluation.windows, recipe("fast").fine_tuning, error)


def _sequential_trainings(args: argparse.Namespace) -> list[quality.Training]:
    """Of the sequential network, on synthetic walking; the error is of other people's clips."""
    from numpy_cae.bench.trainings import sequence_trainings
    from numpy_cae.experiments.sequences.study import synthetic_action
    from numpy_cae.manifold.learning import mean_and_deviation
    from numpy_cae.motion import cut_clips, draw_clips
    from numpy_cae.training import SEQUENCE_RECIPES

    if args.data:
        raise ValueError("--quality --sequential trains on synthetic walking: leave out --data")
    action = synthetic_action("walking", SEQUENCE_MINUTES)
    mean, deviation = mean_and_deviation(cut_clips(action.training))

    def normalised(clips: np.ndarray) -> np.ndarray:
        return ((clips - mean) / deviation).astype(np.float32)

    return sequence_trainings(
        lambda rng, batch: normalised(draw_clips(action.training, batch, rng)),
        normalised(cut_clips(action.testing, step=600)),
        SEQUENCE_RECIPES["fast"],
    )


def _warn_if_busy() -> None:
    """Warn if other programs use the processor, which makes all figures meaningless."""
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if busy > 0.5:
        load = f"other programs use the processor ({busy:.1f} on average in the last minute)"
        note(f"numpy-cae bench: {load}, so neither the times nor the ratios are reliable")
