"""`python -m data_synth OUT`: a folder of synthetic motion files and their labels.

What a person can mend ends in one line on standard error and exit status 2.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections.abc import Sequence

from data_synth.kinds import KINDS, require_kinds
from data_synth.series import Plan, plan_cmu_scale, plan_takes
from data_synth.write_series import write_series

try:
    from tqdm import tqdm
except ImportError:  # the extra `progress` is optional
    tqdm = None

_EPILOG = f"""kinds: {", ".join(KINDS)}

examples:
  python -m data_synth motions --minutes 30 --seed 1
  python -m data_synth walks --minutes 5 --kinds walk,run
  python -m data_synth cmu --cmu-scale --rate 30"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run with these arguments (the command line's where None); the exit status."""
    args = _parser().parse_args(argv)
    try:
        if args.cmu_scale:
            plans = plan_cmu_scale(args.seed, args.kinds)
        else:
            plans = plan_takes(args.minutes, args.seed, args.kinds)
        with _Progress(plans, shown=not args.quiet) as progress:
            labels = write_series(plans, args.out, args.rate, progress.take_done)
    except (ValueError, OSError) as error:
        print(f"data_synth: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("data_synth: interrupted; there is no table of labels yet", file=sys.stderr)
        return 130
    print(f"{len(plans)} takes, {sum(p.seconds for p in plans) / 60:.1f} minutes: {labels}")
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m data_synth",
        description="Make people that walk, wait and press up, and write them as motion files.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("out", metavar="OUT", help="folder to write to; made if it is not there")
    length = parser.add_mutually_exclusive_group()
    length.add_argument("--minutes", type=_above_zero, default=10.0, help="default: 10")
    length.add_argument(
        "--cmu-scale",
        action="store_true",
        help="as much as the CMU database: 2605 takes that make 9673 windows",
    )
    parser.add_argument("--seed", type=_seed, default=0, help="default: 0")
    parser.add_argument(
        "--rate", type=_above_zero, default=120.0, help="frames a second, default: 120"
    )
    parser.add_argument(
        "--kinds", type=_kinds, metavar="KIND,…", help="only these kinds, separated by commas"
    )
    parser.add_argument("--quiet", action="store_true", help="show no progress")
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


class _Progress:
    """A bar of takes; where tqdm is not installed, a line every few seconds."""

    def __init__(self, plans: Sequence[Plan], shown: bool):
        self.total, self.done, self.shown = len(plans), 0, shown
        self.said = self.begun = time.monotonic()
        self.bar = None
        if shown and tqdm is not None:
            self.bar = tqdm(total=len(plans), unit=" takes", file=sys.stderr)

    def __enter__(self) -> _Progress:
        return self

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.close()

    def take_done(self, plan: Plan, take: object) -> None:
        """One more take is written."""
        self.done += 1
        now = time.monotonic()
        if self.bar is not None:
            self.bar.set_postfix_str(plan.kind, refresh=False)
            self.bar.update()
        elif self.shown and (now - self.said > 5 or self.done == self.total):
            self.said = now
            left = (now - self.begun) / self.done * (self.total - self.done)
            print(f"{self.done} of {self.total} takes, {left:.0f} s to go", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(main())
