"""Measure the time of training steps, encoding and projection. If PyTorch is installed, the same
network in PyTorch must give the same results and is timed in turn with this one; `ratio` is
PyTorch's time divided by ours.

example: numpy-cae bench --batch 1 16
"""

import argparse
import os

from numpy_cae.cli.shared import arguments
from numpy_cae.cli.shared.output import note


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to measure, and how often."""
    add = parser.add_argument
    sizes = "batch sizes (default: 1 4 16 64)"
    add("--batch", type=arguments.positive_number, nargs="+", metavar="B", help=sizes)
    rounds = "number of measurements of each time in the table (default: 21)"
    add("--rounds", **arguments.COUNT, default=21, help=rounds)


def run(args: argparse.Namespace) -> int:
    """Print each row as soon as it is measured."""
    from numpy_cae.bench import table  # imports PyTorch, which takes seconds

    _warn_if_busy()
    print(table.header(), flush=True)
    for row in table.rows(args.batch, args.rounds):
        print(row.text(), flush=True)
    return 0


def _warn_if_busy() -> None:
    """Warn if other programs use the processor: the times then mean nothing."""
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if busy > 0.5:
        load = f"other programs use the processor ({busy:.1f} on average in the last minute)"
        note(f"numpy-cae bench: {load}, so neither the times nor the ratios are reliable")
