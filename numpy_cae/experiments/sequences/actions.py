"""What jang2018's network is learned from: motions of one action, in joint space, split by take."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from data_synth import JANG2018_KINDS, plan_takes, styles_of
from numpy_cae.experiments.material import is_test
from numpy_cae.motion import ANGLE_RATE, AngleSequence, angles_of, find_motion_files, load_angles

PERIODIC = ("walking", "walking_extra")
"""Actions of which jang2018 says that all samples look alike."""


@dataclass(frozen=True)
class Action:
    """Motions of one action to learn from and others to measure on.

    Parameters
    ----------
    name : str
    training, testing : lists of AngleSequence
    periodic : bool
        Whether it repeats itself, as walking does.
    styles : tuple of str
        In which data_synth can make more of it; none where the motions are real.
    """

    name: str
    training: list[AngleSequence]
    testing: list[AngleSequence]
    periodic: bool = False
    styles: tuple[str, ...] = ()


def synthetic_action(
    kind: str, minutes: float = 180.0, test_minutes: float = 180.0, seed: int = 0
) -> Action:
    """One of jang2018's three actions, made by formula, every take of another person.

    So that nobody is both trained on and tested, and a thousand held-out clips are of many: of few,
    who they are would show in the discrepancy more than how the network encodes them.

    Parameters
    ----------
    kind : str
        One of `data_synth.JANG2018_KINDS`.
    minutes, test_minutes : float
    seed : int
    """
    if kind not in JANG2018_KINDS:
        raise ValueError(f"no action {kind!r}; there are {', '.join(JANG2018_KINDS)}")
    halves = [
        [
            angles_of(replace(plan, person=plan.number).make(ANGLE_RATE).motion)
            for plan in plan_takes(long, number, [kind])
        ]
        for long, number in ((minutes, 2 * seed + 1), (test_minutes, 2 * seed + 2))
    ]
    return Action(kind, *halves, periodic=kind in PERIODIC, styles=styles_of(kind))


def read_action(
    name: str,
    folders: Sequence[str | Path],
    patterns: Sequence[str],
    mapping: dict[str, str] | None = None,
    unit: float | None = None,
) -> Action:
    """The motions of every file below the folders.

    Parameters
    ----------
    name : str
    folders : sequence of paths
    patterns : sequence of str
        Files whose name matches one of them are for testing.
    mapping, unit
        As `load_angles` takes them.

    Raises
    ------
    MotionFileError, UnknownRigError
        As `load_angles` does.
    """
    halves: tuple[list[AngleSequence], list[AngleSequence]] = ([], [])
    for path in (path for folder in folders for path in find_motion_files(folder)):
        halves[is_test(path, patterns)].append(load_angles(path, mapping, unit))
    return Action(name, *halves, periodic=name in PERIODIC)
