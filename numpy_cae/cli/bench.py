"""`numpy-cae bench`: how fast it is here, beside this machine's limit, PyTorch and the paper."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Iterable
from typing import TypeVar

from numpy_cae.bench import paper, sequence, table
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import add_json_argument, print_json

Measured = TypeVar("Measured")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """A table by default; the paper's schedule where asked."""
    parser = subparsers.add_parser(
        "bench",
        help="measure the speed of training and projection",
        description="Time training steps, encoding and projection. 'of peak' is the arithmetic of "
        "the direct convolution over the time, as a share of what a large matrix product reaches "
        "in this process: blocks need less arithmetic, so it may pass 100%%. Where PyTorch is "
        "installed, the same network in it is checked to agree and timed in turns with ours.",
        epilog="example: numpy-cae bench --batch 1 16",
    )
    parser.add_argument(
        "--batch",
        type=kinds.positive_number,
        nargs="+",
        metavar="B",
        help="windows at a time (default: 1 4 16 64; with --paper 1 16, with --sequential 16 64)",
    )
    parser.add_argument(
        "--rounds", type=kinds.positive_number, default=21, help="of the table (default: 21)"
    )
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument(
        "--sequential",
        action="store_true",
        help="training steps of the sequential autoencoder on clips of 50 frames instead, with "
        "128, 512 and 1024 hidden units",
    )
    instead.add_argument(
        "--paper",
        action="store_true",
        help="train the paper's four stages on 9673 windows for an epoch each, scaled to 25",
    )
    add_json_argument(parser)
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure and print."""
    _warn_of_others()
    if args.paper:
        batches = args.batch or (1, 16)
        runs = (paper.run_paper(batch, 1, show_progress=not args.quiet) for batch in batches)
        _say(args, runs, lambda run: f"{run.text()}\n")
    else:
        peak = matrix_product_peak()
        timed = sequence if args.sequential else table
        rows = timed.rows(peak, args.batch or timed.BATCHES, args.rounds)
        _say(args, rows, table.Row.text, table.header(peak))
    return 0


def _say(
    args: argparse.Namespace,
    rows: Iterable[Measured],
    text: Callable[[Measured], str],
    header: str = "",
) -> None:
    """Each row as soon as it is measured, or with --json all of them at the end."""
    if args.json:
        print_json(list(rows))
        return
    if header:
        print(header, flush=True)
    for row in rows:
        print(text(row), flush=True)


def _warn_of_others() -> None:
    """Say so where other programs keep the processor busy: no figure would mean anything then."""
    busy = os.getloadavg()[0] if hasattr(os, "getloadavg") else 0.0
    if busy > 0.5:
        print(
            f"numpy-cae bench: other programs are at work here ({busy:.1f} of them on average over "
            "the last minute); threads that wait for each other suffer most, PyTorch's more than "
            "ours, so neither the times nor the ratios are to be quoted",
            file=sys.stderr,
        )
