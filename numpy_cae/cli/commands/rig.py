"""Print how a motion file is understood: its rig, the names of the twenty joints in the rig, the up
axis, the floor, the unit and the frame rate. With -o, also write the names of the joints to a file,
which can be corrected and given to other commands with --mapping.

examples, with the files that `numpy-cae demo` writes:
  numpy-cae rig demo/true.bvh -o mapping.json
  numpy-cae repair demo/damaged.bvh -o fixed.bvh --mapping mapping.json
"""

import argparse
import json
from pathlib import Path

from numpy_cae.atomic_write import atomic_write
from numpy_cae.cli.shared import arguments
from numpy_cae.mocap import load_motion
from numpy_cae.mocap.rigs.rigs import RiggedMotion, rig_by_names
from numpy_cae.mocap.rigs.suggest import suggest_mapping
from numpy_cae.motion import JOINTS, Motion, Skeleton

TRUSTED = 15
"""If at least this many of the twenty joints have the names of a common rig, the names
decide and not the hierarchy."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the mapping to write and how the file is read."""
    add = parser.add_argument
    add("file", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    add("-o", "--output", type=Path, metavar="JSON", help="file to write: our names, the rig's")
    arguments.add_shared(parser, "overwrite mapping unit up floor")


def run(args: argparse.Namespace) -> int:
    """Print how the file is understood, and write the mapping."""
    reading = arguments.reading(args)
    motion = load_motion(args.file, **reading)
    by_names = rig_by_names(motion.skeleton, reading["mapping"])
    names = {joint: motion.skeleton.names[index] for joint, index in by_names.indices.items()}
    if len(motion.rig.indices) < len(JOINTS):
        mapping = _suggest_names(motion.skeleton, names)
        motion = load_motion(args.file, **reading | {"mapping": mapping})
    rig = motion.rig
    in_file = {joint: index for joint, index in rig.indices.items() if index not in rig.added}
    if in_file == by_names.indices and len(names) >= TRUSTED:
        rig_name = by_names.name
    else:
        rig_name = f"unknown ({by_names.name} has {len(names)} of the 20 joints)"
    _print_file(args.file, motion, rig_name)
    _print_joints(motion, in_file, names)
    if args.output is not None:
        mapping = {j: motion.skeleton.names[in_file[j]] for j in JOINTS if j in in_file}
        _write_mapping(mapping, args.output)
    return 0


def _suggest_names(skeleton: Skeleton, names: dict[str, str]) -> dict[str, str]:
    """The names of as many joints as possible, by the names that are known and the hierarchy."""
    suggested = suggest_mapping(skeleton)
    # If only a few names are those of a common rig, they may mean other joints here.
    first, second = (names, suggested) if len(names) >= TRUSTED else (suggested, names)
    # A name may stand for another joint: LeftToe is the ankle where LeftToeEnd is the toe.
    additional = {joint: name for joint, name in second.items() if name not in first.values()}
    return max(additional | first, suggested, key=len)


def _print_file(path: Path, motion: Motion, rig_name: str) -> None:
    """Print what the motion is, and what the reader took for granted."""
    unit, *notes = motion.notes
    print(
        f"{path}: {motion}\nunit   {unit.text}\nup     {motion.up.upper()}\n"
        f"floor  {motion.floor:.2f} m\nrig    {rig_name}"
    )
    for note in notes:
        print(f"note   {note.text}")


def _print_joints(motion: RiggedMotion, in_file: dict[str, int], names: dict[str, str]) -> None:
    """Print the name of each joint in the rig, and whether the hierarchy suggested it."""
    for joint in JOINTS:
        if joint not in motion.rig.indices:
            print(f"  {joint:15} missing: name one")
            continue
        name = motion.skeleton.names[motion.rig.indices[joint]]
        if joint in in_file and name != names.get(joint):
            name += " (suggested by the hierarchy: check it)"
        print(f"  {joint:15} {name}")


def _write_mapping(mapping: dict[str, str], path: Path) -> None:
    """Write a mapping to a file."""
    with atomic_write(path) as temporary:
        text = json.dumps(mapping, indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    print(f"{path}: {len(mapping)} joints; pass it with --mapping")
