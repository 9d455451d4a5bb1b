"""`numpy-cae bench`: how fast it is here, beside this machine's limit, PyTorch and the paper."""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from dataclasses import asdict
from pathlib import Path

from data_synth import make_takes
from numpy_cae.bench import growth, paper, reading, sequence, table
from numpy_cae.bench.peak import matrix_product_peak
from numpy_cae.cli import arguments as kinds
from numpy_cae.motion import load_motion


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
    parser.add_argument("--json", action="store_true", help="with --reading: print JSON")
    parser.add_argument("--quiet", action="store_true", help="show no progress")
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Measure and print."""
    if args.growth:
        kinds.require_place(args.growth)
    if args.json and not args.reading:
        raise ValueError("--json is for --reading")
    _warn_of_others()
    if args.paper or args.full:
        epochs = paper.EPOCHS if args.full else 1
        for batch in args.batch or (1, 16):
            print(paper.run_paper(batch, epochs, show_progress=not args.quiet).text(), flush=True)
            print()
    elif args.reading:
        _reading(args)
    elif args.walks:
        print(_walks(args.walks))
    elif args.growth:
        grown = growth.growth()
        print("\n".join(each.text() for each in grown))
        growth.draw(grown, args.growth)
        print(f"{args.growth}: the same, drawn")
    else:
        peak = matrix_product_peak()
        print(table.header(peak), flush=True)
        timed = sequence if args.sequential else table
        for row in timed.rows(peak, args.batch or timed.BATCHES, args.rounds):
            print(row.text(), flush=True)
    return 0


def _reading(args: argparse.Namespace) -> None:
    for path in args.reading:
        load_motion(path)  # what is wrong with a file is said of it, not of a reader
    rows = reading.readings(args.reading, args.rounds)
    if args.json:
        print(json.dumps([asdict(row) for row in rows], indent=1))
    else:
        print("\n".join([reading.HEADER, *(row.text() for row in rows)]))


def _walks(minutes: float) -> str:
    """How fast data_synth makes people walk, in processor time, so on one core."""
    start = time.process_time()
    motion = sum(take.motion.seconds for take in make_takes(minutes, kinds=["walk"], rate=30))
    spent = time.process_time() - start
    return (
        f"{motion / 60:.1f} minutes of walking at 30 frames a second made in {spent:.1f} s of one "
        f"core: {motion / spent:.0f} times real time"
    )


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
