"""`numpy-cae bench`: how fast it is here, beside this machine's limit, PyTorch and the paper."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from data_synth import make_takes
from numpy_cae.bench import growth, paper, reading, sequence, table
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.cli import arguments as kinds
from numpy_cae.cli.as_json import add_json_argument, print_json
from numpy_cae.motion import load_motion

Measured = TypeVar("Measured")


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """A table by default; the paper's schedule or the growth of the cost where asked."""
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
        help="windows at a time (default: 1 4 16 64; with --paper and --full 1 16, with "
        "--sequential 16 64)",
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
    instead.add_argument("--full", action="store_true", help="the same, all 25 epochs")
    instead.add_argument(
        "--growth",
        type=Path,
        metavar="PNG",
        help="double windows, frames and channels in turn, and draw what that costs",
    )
    instead.add_argument(
        "--walks",
        type=kinds.positive,
        metavar="MINUTES",
        help="make so many minutes of synthetic walking at 30 frames a second",
    )
    instead.add_argument(
        "--reading",
        type=Path,
        nargs="+",
        metavar="FILE",
        help="read motion files, beside pybvh and bvh where they are installed",
    )
    add_json_argument(parser)
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure and print."""
    if args.growth:
        kinds.require_place(args.growth)
    _warn_of_others()
    if args.paper or args.full:
        epochs = paper.EPOCHS if args.full else 1
        batches = args.batch or (1, 16)
        runs = (paper.run_paper(batch, epochs, show_progress=not args.quiet) for batch in batches)
        _say(args, runs, lambda run: f"{run.text()}\n")
    elif args.reading:
        for path in args.reading:
            load_motion(path)  # what is wrong with a file is said of it, not of a reader
        rows = reading.readings(args.reading, args.rounds)
        _say(args, rows, reading.Reading.text, reading.HEADER)
    elif args.walks:
        _say(args, [_walked(args.walks)], _Walked.text)
    elif args.growth:
        grown = growth.growth()
        _say(args, grown, growth.Growth.text)
        growth.draw(grown, args.growth)
        if not args.json:
            print(f"{args.growth}: the same, drawn")
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


@dataclass(frozen=True)
class _Walked:
    """How fast data_synth makes people walk, in processor time, so on one core."""

    motion_seconds: float
    processor_seconds: float

    def text(self) -> str:
        """A sentence."""
        spent = self.processor_seconds
        return (
            f"{self.motion_seconds / 60:.1f} minutes of walking at 30 frames a second made in "
            f"{spent:.1f} s of one core: {self.motion_seconds / spent:.0f} times real time"
        )


def _walked(minutes: float) -> _Walked:
    start = time.process_time()
    motion = sum(take.motion.seconds for take in make_takes(minutes, kinds=["walk"], rate=30))
    return _Walked(motion, time.process_time() - start)


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
