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

from numpy_cae.cli.shared import arguments

TRUSTED = 15
"""TRUSTED: if at least this many of the twenty joints have the names of a known rig, the names
decide and not the hierarchy."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The file, the mapping to write and how the file is read."""
    add = parser.add_argument
    add("file", **arguments.FILE, help="motion file (.bvh, .amc or .txt) to read")
    add("-o", "--output", type=Path, metavar="JSON", help="file to write: our names, the rig's")
    arguments.add_shared(parser, "mapping unit up floor")


def run(args: argparse.Namespace) -> int:
    """Print how the file is understood, and write the mapping."""
    from numpy_cae.mocap import load_motion
    from numpy_cae.mocap.rigs.rigs import rig_by_names
    from numpy_cae.mocap.rigs.suggest import suggest_mapping
    from numpy_cae.motion import JOINTS

    reading = arguments.reading(args)
    motion = load_motion(args.file, **reading)
    by_names = rig_by_names(motion.skeleton, reading["mapping"])
    names = {joint: motion.skeleton.names[at] for joint, at in by_names.found.items()}
    if len(motion.rig.found) < len(JOINTS):
        # If only a few names are those of a known rig, they may mean other joints here.
        suggested = suggest_mapping(motion.skeleton)
        first, second = (names, suggested) if len(names) >= TRUSTED else (suggested, names)
        others = {ours: name for ours, name in second.items() if name not in first.values()}
        # A name may stand for another joint: LeftToe is the ankle where LeftToeEnd is the toe.
        mapping = max(others | first, suggested, key=len)
        motion = load_motion(args.file, **reading | {"mapping": mapping})
    rig = motion.rig
    own = {joint: at for joint, at in rig.found.items() if at not in rig.added}
    is_known = own == by_names.found and len(names) >= TRUSTED
    unknown = f"unknown ({by_names.known} has {len(names)} of the 20 joints)"
    unit, *notes = motion.notes
    print(
        f"{args.file}: {motion}\nunit   {unit.text}\nup     {motion.up.upper()}\n"
        f"floor  {motion.floor:.2f} m\nrig    {by_names.known if is_known else unknown}"
    )
    print("".join(f"note   {note.text}\n" for note in notes), end="")
    for joint in JOINTS:
        found = joint in rig.found
        name = motion.skeleton.names[rig.found[joint]] if found else "missing: name one"
        guessed = joint in own and name != names.get(joint)
        print(f"  {joint:15} {name}{' (suggested by the hierarchy: check it)' if guessed else ''}")
    if args.output is not None:
        _write({joint: motion.skeleton.names[own[joint]] for joint in JOINTS if joint in own}, args)
    return 0


def _write(mapping: dict[str, str], args: argparse.Namespace) -> None:
    """Write a mapping to the file of -o."""
    from numpy_cae.atomic_write import atomic_write

    with atomic_write(args.output) as temporary:
        text = json.dumps(mapping, indent=1, ensure_ascii=False)
        temporary.write_text(text + "\n", encoding="utf-8")
    print(f"{args.output}: {len(mapping)} joints; pass it with --mapping")
