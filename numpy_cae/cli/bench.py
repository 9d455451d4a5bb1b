"""Time training steps, encoding and projection. If PyTorch is installed, the same network in
PyTorch is checked to give the same results and timed alternately with this one; 'ratio' is
PyTorch's time divided by this one's.

example: numpy-cae bench --batch 1 16
"""

import argparse
import os

from numpy_cae.bench import paper, table
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.output import note, print_json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """What to measure, and how often."""
    add = parser.add_argument
    sizes = "batch sizes (default: 1 4 16 64; with --paper 1 16, with --sequential 16 64)"
    add("--batch", type=kinds.positive_number, nargs="+", metavar="B", help=sizes)
    rounds = "number of measurements of each time in the table (default: 21)"
    add("--rounds", **kinds.COUNT, default=21, help=rounds)
    instead = parser.add_mutually_exclusive_group().add_argument
    sequential = "time training steps of the sequential autoencoder of three sizes instead"
    instead("--sequential", **kinds.FLAG, help=sequential)
    stages = "train the paper's four stages for one epoch each instead, scaled to its 25 epochs"
    instead("--paper", **kinds.FLAG, help=stages)
    kinds.add_shared(parser, "json quiet")


def run(args: argparse.Namespace) -> int:
    """Measure and print each row when it is measured, or with --json all of them at the end."""
    _warn_if_busy()
    header = "" if args.paper else table.header(matrix_product_peak())
    if args.paper:
        batches = args.batch or (1, 16)
        rows = (paper.run_paper(batch, show_progress=not args.quiet) for batch in batches)
    else:
        rows = (table.sequence_rows if args.sequential else table.rows)(args.batch, args.rounds)
    if args.json:
        print_json(list(rows))
        return 0
    if header:
        print(header, flush=True)
    for row in rows:
        print(row.text(), end="\n\n" if args.paper else "\n", flush=True)
    return 0


def _warn_if_busy() -> None:
    """Warn if other programs use the processor, which makes all figures meaningless."""
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if busy > 0.5:
        note(
            f"numpy-cae bench: other programs use the processor ({busy:.1f} of them on average "
            "over the last minute), so neither the times nor the ratios are reliable"
        )
