"""`numpy-cae bench`: the speed here, compared with PyTorch and the paper."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from typing import TypeVar

from numpy_cae.bench import paper, table
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import add_json_argument, print_json

Measured = TypeVar("Measured")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand."""
    parser = subparsers.add_parser(
        "bench",
        help="measure the speed of training and projection",
        description="Time training steps, encoding and projection. If PyTorch is installed, the "
        "same network in PyTorch is checked to give the same results and timed alternately with "
        "this one; 'ratio' is PyTorch's time divided by this one's.",
        epilog="example: numpy-cae bench --batch 1 16",
    )
    parser.add_argument(
        "--batch",
        type=kinds.positive_number,
        nargs="+",
        metavar="B",
        help="batch sizes (default: 1 4 16 64; with --paper 1 16, with --sequential 16 64)",
    )
    parser.add_argument(
        "--rounds",
        type=kinds.positive_number,
        default=21,
        help="number of measurements of each time in the table (default: 21)",
    )
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument(
        "--sequential",
        action="store_true",
        help="time training steps of the sequential autoencoder instead, on clips of 50 frames "
        "with 128, 512 and 1024 hidden units",
    )
    instead.add_argument(
        "--paper",
        action="store_true",
        help="train the paper's four stages on 9673 windows for one epoch each instead, and scale "
        "the times to 25 epochs",
    )
    add_json_argument(parser)
    parser.add_argument("--quiet", action="store_true", help="do not show the progress")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure and print."""
    _warn_if_busy()
    if args.paper:
        batches = args.batch or (1, 16)
        runs = (paper.run_paper(batch, show_progress=not args.quiet) for batch in batches)
        _print_rows(args, runs, lambda run: f"{run.text()}\n")
    else:
        timed_rows = table.sequence_rows if args.sequential else table.rows
        rows = timed_rows(args.batch, args.rounds)
        _print_rows(args, rows, table.Row.text, table.header(matrix_product_peak()))
    return 0


def _print_rows(
    args: argparse.Namespace,
    rows: Iterable[Measured],
    text: Callable[[Measured], str],
    header: str = "",
) -> None:
    """Print each row when it is measured, or with --json all of them at the end."""
    if args.json:
        print_json(list(rows))
        return
    if header:
        print(header, flush=True)
    for row in rows:
        print(text(row), flush=True)


def _warn_if_busy() -> None:
    """Warn if other programs use the processor, which makes all figures meaningless."""
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if busy > 0.5:
        print(
            f"numpy-cae bench: other programs use the processor ({busy:.1f} of them on average "
            "over the last minute), so neither the times nor the ratios are reliable; threads that "
            "wait for each other suffer most, those of PyTorch more than these",
            file=sys.stderr,
        )
