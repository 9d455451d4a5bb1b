"""`python -m data_synth OUT`: a folder of synthetic motion files and their labels.

An error that the user can correct prints one line on standard error; the exit status is then 2.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence

from data_synth.kinds import KINDS, require_kinds
from data_synth.series import Plan, plan_cmu_scale, plan_takes
from data_synth.write_series import write_series
from numpy_cae.atomic_write import replacing
from numpy_cae.progress import ProgressLine, time_to_go

_EPILOG = f"""kinds: {", ".join(KINDS)}

examples:
  python -m data_synth motions --minutes 30 --seed 1
  python -m data_synth walks --minutes 5 --kinds walk,run
  python -m data_synth cmu --cmu-scale --rate 30"""


MOST_MINUTES = 1e5
"""All takes are planned before the first is written."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run with these arguments, by default the command line's; return the exit status."""
    args = _parser().parse_args(argv)
    try:
        if args.minutes > MOST_MINUTES:
            raise ValueError(f"--minutes is {args.minutes:g}, expected at most {MOST_MINUTES:g}")
        if args.cmu_scale:
            plans = plan_cmu_scale(args.seed, args.kinds)
        else:
            plans = plan_takes(args.minutes, args.seed, args.kinds)
        with ProgressLine() as line:
            report = None if args.quiet else _Progress(line, len(plans))
            with replacing(args.overwrite):
                labels = write_series(plans, args.out, args.rate, report)
    except (ValueError, OSError) as error:
        print(f"data_synth: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("data_synth: interrupted; there is no table of labels yet", file=sys.stderr)
        return 130
    print(f"{len(plans)} takes, {sum(p.seconds for p in plans) / 60:.1f} minutes: {labels}")
    return 0


class _Progress:
    """A report to `write_series` that shows how many takes are written."""

    def __init__(self, line: ProgressLine, total: int):
        self.line = line
        self.total = total
        self.done = 0

    def __call__(self, plan: Plan, take: object) -> None:
        """Count one more take."""
        self.done += 1
        to_go = time_to_go(self.line.seconds, self.done / self.total)
        self.line.show(f"{self.done} of {self.total} takes{to_go}")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m data_synth",
        description="Write synthetic motions (walks, gestures, …) as BVH files with labels.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("out", metavar="OUT", help="folder to write to, created if missing")
    length = parser.add_mutually_exclusive_group()
    length.add_argument(
        "--minutes", type=_above_zero, default=10.0, help="total duration in minutes, default: 10"
    )
    length.add_argument(
        "--cmu-scale",
        action="store_true",
        help="as many takes as the CMU database: 2605, which make 9673 windows",
    )
    parser.add_argument(
        "--seed", type=_seed, default=0, help="seed of the random numbers, default: 0"
    )
    parser.add_argument(
        "--rate", type=_above_zero, default=120.0, help="frames a second, default: 120"
    )
    parser.add_argument(
        "--kinds",
        type=_kinds,
        metavar="KIND,…",
        help="restrict to these kinds, separated by commas",
    )
    parser.add_argument(
        "--overwrite", action="store_true", help="replace files that exist with other contents"
    )
    parser.add_argument("--quiet", action="store_true", help="print no progress")
    return parser


def _above_zero(text: str) -> float:
    """A finite number above 0."""
    value = float(text)
    if not 0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text} is not a number above 0")
    return value


def _seed(text: str) -> int:
    """0, 1, 2, …"""
    value = int(text)
    if value < 0:
        raise argparse.ArgumentTypeError(f"{text} is below 0")
    return value


def _kinds(text: str) -> list[str]:
    try:
        return require_kinds([kind.strip() for kind in text.split(",") if kind.strip()])
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


if __name__ == "__main__":
    sys.exit(main())
