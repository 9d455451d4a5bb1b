"""Actions: motions in joint space to train jang2018's network on and to measure it on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from data_synth import plan_takes
from numpy_cae.experiments.material import each_usable, is_test
from numpy_cae.motion import (
    ANGLE_RATE,
    AngleSequence,
    Coordinates,
    Mappings,
    angles_of,
    load_angles,
)

PERIODIC = ("walking", "walking_extra")
"""Actions of which jang2018 says that all samples look alike."""


@dataclass(frozen=True)
class Action:
    """Motions of one action, split by take.

    Parameters
    ----------
    name : str
    training, testing : lists of AngleSequence
    periodic : bool
        Whether the motion repeats itself, as walking does.
    """

    name: str
    training: list[AngleSequence]
    testing: list[AngleSequence]
    periodic: bool = False


def synthetic_action(kind: str, minutes: float, seed: int = 0) -> Action:
    """Synthesise an action of `data_synth.JANG2018_KINDS`, so many minutes to train on and to test
    on; every take is of another person.

    With few people, the discrepancy of the held-out clips would measure who these people are
    rather than how the network encodes them.
    """
    halves = [
        [
            angles_of(replace(plan, person=plan.number).make(ANGLE_RATE).motion)
            for plan in plan_takes(minutes, number, [kind])
        ]
        for number in (2 * seed + 1, 2 * seed + 2)
    ]
    return Action(kind, *halves, periodic=kind in PERIODIC)


def read_action(
    name: str,
    folders: Sequence[str | Path],
    patterns: Sequence[str],
    mapping: Mappings = None,
    coordinates: Coordinates | None = None,
    strict: bool = False,
) -> Action:
    """Read every motion file below the folders; those whose name matches a pattern are for testing.

    `mapping` and `coordinates` are those of `load_angles`, `strict` that of `each_usable`.
    """
    halves: tuple[list[AngleSequence], list[AngleSequence]] = ([], [])
    angles = each_usable(folders, lambda path: load_angles(path, mapping, coordinates), strict)
    for path, sequence in angles:
        halves[is_test(path, patterns)].append(sequence)
    return Action(name, *halves, periodic=name in PERIODIC)
