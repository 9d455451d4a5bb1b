"""The actions of jang2018: motions of one kind, split by take, read or synthesised."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from data_synth import plan_takes
from numpy_cae.mocap import angles_of, find_motion_files
from numpy_cae.mocap.load import load_angles, matches_any
from numpy_cae.motion.angles import ANGLE_RATE, AngleSequence
from studies.shared.material import read_takes
from studies.shared.messages import note

ACTIONS = ("walking", "waiting", "walking_dog")
PERIODIC = ("walking", "walking_extra")
"""Actions of which jang2018 says that all samples look alike."""


@dataclass(frozen=True, eq=False)
class Action:
    """Motions of one action, split by take, whether it repeats itself, as walking does, and where
    they come from."""

    name: str
    training: list[AngleSequence]
    testing: list[AngleSequence]
    periodic: bool = False
    source: str = ""

    def described(self) -> str:
        """The source, and the minutes to train on and to test on."""
        halves = (self.training, self.testing)
        minutes = (sum(map(len, half)) / ANGLE_RATE / 60 for half in halves)
        return "{}, {:.1f} minutes to train on and {:.1f} to test on".format(self.source, *minutes)


def synthetic_action(kind: str, minutes: float, seed: int = 0, quiet: bool = True) -> Action:
    """Synthesise an action of `data_synth.JANG2018_KINDS`, so many minutes to train on and to test
    on; every take is of another person.

    With few people, the discrepancy of the held-out clips would measure who these people are
    rather than how the network encodes them.
    """
    plans = [plan_takes(minutes, number, [kind]) for number in (2 * seed + 1, 2 * seed + 2)]
    halves: tuple[list[AngleSequence], list[AngleSequence]] = ([], [])
    if not quiet:
        note(f"{kind}: {len(plans[0]) + len(plans[1])} takes are made")
    for half, planned in zip(halves, plans, strict=True):
        for plan in planned:
            take = replace(plan, person=plan.number).make(ANGLE_RATE)
            half.append(angles_of(take.motion))
    return Action(kind, *halves, kind in PERIODIC, "synthetic clips (data_synth)")


def read_action(folder: Path, patterns: Sequence[str], **reading: Any) -> Action:
    """Read every motion file below the folder; those whose name matches a pattern are for testing.

    `reading` are arguments of `load_angles`.
    """
    name = folder.resolve().name
    halves: tuple[list[AngleSequence], list[AngleSequence]] = ([], [])
    for path, sequence in read_takes(find_motion_files(folder), partial(load_angles, **reading)):
        halves[matches_any(path, patterns)].append(sequence)
    return Action(name, *halves, name in PERIODIC, folder.name)
