"""Repair the damaged joints and frames of a motion, and leave the rest of the file unchanged. The
command looks for turned limbs, spikes, frozen and repeated frames, bones of wrong length and a body
that jumps to another place, and mends what it finds. A T-pose at the start is kept. A model fills
in long gaps. What only the model finds unusual is proposed and not changed. The command prints each
finding and how far the joints moved. In a folder every file is repaired. Exit status: 0 if
something was changed, 3 if nothing was changed, 4 if nothing was changed and the motion is unlike
those that the model learned, 1 if some of several files could not be used, 2 if no file could.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae repair demo/damaged.bvh -o fixed.bvh --html
  numpy-cae repair demo/damaged.bvh -o video.bvh --from video
  numpy-cae repair demo/damaged.bvh -o fixed.bvh --joint left_wrist --frames 30 75
  numpy-cae repair demo/damaged.bvh -o part.bvh --only 1
  numpy-cae repair demo/damaged.bvh --dry-run --findings found.json
  numpy-cae repair demo/damaged.bvh -o fixed.bvh --mask found.json
"""

import argparse
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from numpy_cae.cleanup import PRESETS, Finding, Preset, Repaired, project_motion, repair_motion
from numpy_cae.cleanup.result import measure_distances, weaken
from numpy_cae.cleanup.words import count
from numpy_cae.cli.shared import arguments, change_files, damage_options, files
from numpy_cae.cli.shared.output import working
from numpy_cae.cli.shared.summary import asks_for_more, summary_of_repair
from numpy_cae.manifold import MotionManifold
from numpy_cae.mocap.load import load_motion
from numpy_cae.motion import Motion

READING_SHARE, REPAIR_SHARE = 0.04, 0.9
"""The shares of the time that reading and a plain repair take, of three minutes of damaged motion;
the rest is writing."""
SLOW_READING_SHARE, SLOW_REPAIR_SHARE = 0.03, 0.92
"""The same of a repair with smoothing and feet."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The files, what is damaged and how it is repaired."""
    change_files.add_arguments(parser)
    group = damage_options.add_arguments(parser, "damaged", "found in the motion")
    findings = "JSON file to write the findings to, for --mask; for several motions a folder"
    group.add_argument("--findings", type=Path, metavar="JSON", help=findings)
    sensitivity = "0 to 1: a finding is mended if its confidence is at least 1 - S (default: 0.5)"
    group.add_argument("--sensitivity", type=arguments.fraction, metavar="S", help=sensitivity)
    add = parser.add_argument_group("how it is repaired").add_argument
    source = "; ".join(f"{name}: {preset}" for name, preset in PRESETS.items())
    add("--from", dest="source", choices=list(PRESETS), help=f"what recorded the motion. {source}")
    add("--smooth", **arguments.FLAG, help="also remove jitter from the whole motion")
    add("--feet", **arguments.FLAG, help="also hold each standing foot at one place on the floor")
    project = "instead of all this, pass the whole motion through the network, as the paper does"
    add("--project", **arguments.FLAG, help=project)
    only = "repair these findings and no others, also if they are proposals, by their numbers in "
    only += "the printed list, on the page and in the file of --findings"
    strength = "0 to 1: 0.5 moves each joint half of the way to the repair (default: 1)"
    add("--strength", type=arguments.fraction, metavar="S", help=strength)
    fade = "seconds over which each repaired stretch fades in and out (default: 0)"
    add("--fade", type=arguments.rate, metavar="SECONDS", help=fade)
    add("--only", nargs="+", type=arguments.positive_number, metavar="N", help=only)


def run(args: argparse.Namespace) -> int:
    """Load, repair, write and print each motion."""
    manifold = files.load_model(args)
    preset = _preset(args)
    is_plain = preset == Preset() and args.strength is None and args.fade is None
    if args.project and (damage_options.is_chosen(args) or not is_plain):
        options = "--joint, --mask, --from, --smooth, --feet, --strength, --fade and --sensitivity"
        raise ValueError(f"--project changes the whole motion: use it without {options}")
    if args.source:
        print(f"--from {args.source}: {preset}")
    outcome = change_files.Outcome(args)
    reading = arguments.reading(args)
    shares = (READING_SHARE, REPAIR_SHARE)
    if asks_for_more(args):
        shares = (SLOW_READING_SHARE, SLOW_REPAIR_SHARE)
    with working(outcome.title) as is_done:
        for number, (source, target) in enumerate(outcome.targets.items()):
            progress = outcome.progress_of(number, *shares, is_done)
            with outcome.of_file(source):
                motion = load_motion(source, **reading)
                progress(0.0)
                repaired = _repair(args, motion, manifold, preset, progress)
                progress(1.0)
                summary = summary_of_repair(args, source, target, motion, repaired)
                # The motion last: where a page or findings may not be replaced, nothing is written.
                findings = change_files.write_file_of_findings(outcome, source, repaired)
                page, row = change_files.write_page(outcome, source, motion, repaired, summary)
                written = change_files.write_motion(outcome, source, motion, repaired)
                written |= page | findings
                change_files.print_summary(outcome, source, motion, repaired, summary, written)
                outcome.rows.append(row)
    return outcome.end()


def _repair(
    args: argparse.Namespace,
    motion: Motion,
    manifold: MotionManifold,
    preset: Preset,
    progress: Callable[[float], None],
) -> Repaired:
    """The repair of a motion that the options ask for."""
    if args.project:
        projected = project_motion(motion, manifold)
        moved = measure_distances(motion, projected)
        return Repaired(projected, np.ones(moved.shape, bool), moved)
    findings = damage_options.chosen_findings(args, motion)
    repaired = repair_motion(motion, manifold, preset=preset, findings=findings, progress=progress)
    if args.only:
        repaired = repair_motion(motion, manifold, findings=_only(args.only, repaired))
    strength = 1.0 if args.strength is None else args.strength
    return weaken(repaired, strength, args.fade or 0.0)


def _preset(args: argparse.Namespace) -> Preset:
    """That of --from, with the other options."""
    preset = PRESETS.get(args.source, Preset())
    sensitivity = preset.sensitivity if args.sensitivity is None else args.sensitivity
    smooth = preset.smooth or args.smooth
    return replace(preset, sensitivity=sensitivity, smooth=smooth, feet=preset.feet or args.feet)


def _only(numbers: list[int], repaired: Repaired) -> list[Finding]:
    """The findings of these numbers, which are to be repaired whatever their status."""
    listed = repaired.listed()
    if max(numbers) > len(listed):
        raise ValueError(f"--only {max(numbers)}: the repair has {count(len(listed), 'finding')}")
    return [replace(listed[number - 1], status="repaired") for number in numbers]
