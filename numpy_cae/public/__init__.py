"""The functions of `import numpy_cae`: load, save, repair, fill, project, show and learn.

Where a motion is expected, the path of a motion file is accepted too, and where a manifold is
expected, the path of a model file. Everything can be done with more options in `numpy_cae.mocap`,
`numpy_cae.manifold`, `numpy_cae.cleanup` and `numpy_cae.viz`.
"""

import os
import tempfile
import webbrowser
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from numpy_cae import mocap, training, viz
from numpy_cae.cleanup import Preset, Repaired, fill_motion, project_motion, repair_motion
from numpy_cae.cleanup.events import list_events, rows_of_events
from numpy_cae.cleanup.finding import Finding
from numpy_cae.cleanup.mask_file import require_movable
from numpy_cae.manifold import MotionManifold, learn_manifold
from numpy_cae.mocap import find_motion_files, load_motion
from numpy_cae.mocap.bodies import Problem, read_body, read_files, split_takes
from numpy_cae.mocap.file_motion import FileMotion
from numpy_cae.mocap.rigs.recognise import rig_of
from numpy_cae.mocap.rigs.rigs import Mappings
from numpy_cae.motion import JOINTS, LENGTH, Motion
from numpy_cae.motion.joints import joint_mask
from numpy_cae.public.inputs import (
    AnyFindings,
    FilePath,
    require_rate,
    require_whole,
    to_findings,
    to_frames,
    to_joints,
    to_manifold,
    to_motion,
    to_paths,
    to_strings,
)
from numpy_cae.training.schedule import change_schedule
from numpy_cae.viz.viewer import Player, running_shell

__all__ = ["fill", "learn", "load", "project", "repair", "save", "show"]


def load(
    path: FilePath,
    unit: float | None = None,
    max_rate: float | None = None,
    up: str | None = None,
    floor: float | None = None,
    mapping: Mappings = None,
) -> FileMotion:
    """Read a motion from a file: BVH, Acclaim or exponential-map text, of any rig.

    Parameters
    ----------
    path : path
        A .bvh, .amc or .txt file.
    unit, max_rate, up, floor, mapping
        What is not to be guessed: see `numpy_cae.mocap.load_motion`.

    Returns
    -------
    FileMotion
        A `Motion` with a method `save`. In a notebook it shows itself in the viewer.

    See Also
    --------
    save : Write a motion to a file.
    show : Play motions.
    numpy_cae.mocap.load_motion : The same function, with all its options explained.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> numpy_cae.save(make_take("walk", 0, seconds=2.0, rate=30.0).motion, "walk.bvh")
    >>> numpy_cae.load("walk.bvh")
    motion of 60 frames at 30 a second, 31 joints
    """
    return load_motion(path, unit, max_rate, up, floor, mapping)


def save(motion: Motion | FilePath, path: FilePath) -> None:
    """Write a motion to a file; what did not change is kept as in the file that it came from.

    Parameters
    ----------
    motion : Motion or path
        One that was made in memory is written as BVH.
    path : path
        The file to write: .bvh, or .amc if the motion was loaded from one.

    See Also
    --------
    load : Read a motion from a file.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> numpy_cae.save(make_take("walk", 0, seconds=2.0, rate=30.0).motion, "walk.bvh")
    """
    mocap.save(to_motion(motion), path)


def repair(
    motion: Motion | FilePath,
    manifold: MotionManifold | FilePath | None = None,
    damaged: np.ndarray | None = None,
    preset: Preset | None = None,
    findings: AnyFindings | None = None,
) -> Repaired:
    """Find what is damaged in a motion and mend it; the rest of the motion is unchanged.

    Parameters
    ----------
    motion : Motion or path
        As `load` returns it.
    manifold : MotionManifold or path, optional
        As `learn` returns it; the starter model of the package where None.
    damaged : (frames, 20) array of bool, optional
        In the frames of the file: only this is repaired, and nothing is looked for.
    preset : Preset, optional
        Which steps are taken; `Preset()` by default.
    findings : Finding, dict, several of them, or path, optional
        Only these are mended, whatever their confidence. A dict is an object of the JSON file that
        `numpy-cae repair --findings` writes or `--mask` reads; a path is that of such a file.

    Returns
    -------
    Repaired
        Its `motion` is the repaired one. Printed, it names the joints, frames and centimetres.

    See Also
    --------
    fill : Fill in joints that you name, whatever is in the file.
    project : Project the whole motion, damaged or not.
    show : Play the motion before and after.
    numpy_cae.cleanup.Preset : Which steps are taken.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> numpy_cae.repair(motion)  # doctest: +NORMALIZE_WHITESPACE
    left_wrist: frame 30: moved 24.2 cm, at most 24.2
    1 finding:
      1. left_elbow: frame 30: spike (76° from the frames before and after):
        left_wrist 24.2 cm, confidence 0.91
    """
    motion = to_motion(motion)
    chosen = None if findings is None else to_findings(findings, motion)
    return repair_motion(motion, to_manifold(manifold), damaged, preset, chosen)


def fill(
    motion: Motion | FilePath,
    joints: str | Iterable[str] | None = None,
    frames: Sequence[int] | None = None,
    manifold: MotionManifold | FilePath | None = None,
) -> Repaired:
    """Fill in joints of a motion in some frames; what the motion has there is ignored.

    Parameters
    ----------
    motion : Motion or path
    joints : str or several, optional
        Names of the twenty joints or of the rig's; all joints where None.
    frames : (int, int), optional
        The first and the last frame of the file, counted from 0; all frames where None.
    manifold : MotionManifold or path, optional
        As in `numpy_cae.repair`.

    Returns
    -------
    Repaired

    Raises
    ------
    ValueError
        If neither joints nor frames are given, or the motion does not have them.

    See Also
    --------
    repair : Find what is damaged, and mend it.
    numpy_cae.manifold.MotionManifold.complete : Complete values of features that are missing.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=4.0, rate=30.0).motion
    >>> numpy_cae.fill(motion, joints=["left_wrist"], frames=(30, 75))
    left_wrist: frames 30 to 75: moved 1.5 cm, at most 3.2
    """
    motion = to_motion(motion)
    if joints is None and frames is None:
        raise ValueError("say what is missing: joints, frames or both")
    names = list(JOINTS) if joints is None else to_joints(joints, motion)
    stretch = slice(0, len(motion)) if frames is None else to_frames(frames, motion)
    require_movable([Finding(name, (stretch.start, stretch.stop - 1)) for name in names], motion)
    missing = joint_mask(len(motion), names, stretch)
    return fill_motion(motion, to_manifold(manifold), missing)


def project(motion: Motion | FilePath, manifold: MotionManifold | FilePath | None = None) -> Motion:
    """Project a whole motion onto a manifold, in its own rig: the repair of holden2015.

    Parameters
    ----------
    motion : Motion or path
    manifold : MotionManifold or path, optional
        As in `numpy_cae.repair`.

    Returns
    -------
    Motion
        Its skeleton, rate, unit and length are those of `motion`.

    See Also
    --------
    repair : Change only what is damaged.
    learn : Learn a manifold of your own.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> numpy_cae.project(make_take("walk", 0, seconds=1.0, rate=120.0).motion)
    motion of 120 frames at 120 a second, 31 joints
    """
    return project_motion(to_motion(motion), to_manifold(manifold))


def show(
    *motions: Motion | FilePath,
    labels: str | Iterable[str] = (),
    findings: AnyFindings = (),
    path: FilePath | None = None,
) -> Player | None:
    """Play motions in the viewer, side by side.

    In a notebook the last line of a cell displays the viewer. Elsewhere a page is written and
    opened in the browser.

    Parameters
    ----------
    *motions : Motion or path
        Of any rigs. Frames are those of the first motion; others are taken to its rate. Two that
        were made of one file, such as `show(motion, repaired.motion)`, are "before" and "after":
        joints of the second are coloured by their distance from the first.
    labels : str or several
        A name for each motion; by default that of its file, if it was read from one.
    findings : as in `numpy_cae.repair`
        The findings of a repair: `show(motion, repaired.motion, findings=repaired.findings)`
        overlays the two motions, as their twenty joints, beside a list of the findings.
    path : path, optional
        The page to write, .html; it is not opened then.

    Returns
    -------
    Player or None
        The viewer, in a notebook; else None.

    Raises
    ------
    ValueError
        If there is no motion, or not one label for each, or findings of more or fewer than two
        motions.

    See Also
    --------
    load : Read a motion from a file.
    numpy_cae.viz.save_viewer : Write the page of any motions, with a summary.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> numpy_cae.show(walk, walk.at(slice(9)), labels=["walk", "its start"], path="walk.html")
    """
    if not motions:
        raise ValueError("motions: there is none to show, expected at least one")
    for motion in motions:
        if path is not None and not isinstance(motion, Motion):
            if os.path.realpath(path) == os.path.realpath(motion):
                raise ValueError(f"path is {path}, which is a motion to show; name a page, .html")
    loaded = [to_motion(motion, "motions") for motion in motions]
    entries = to_findings(findings, loaded[0])
    is_compared = bool(entries) or _are_of_one_file(loaded)
    names = to_strings(labels, "labels") or _labels(loaded, is_compared)
    if len(names) != len(loaded):
        raise ValueError(f"there are {len(names)} labels for {len(loaded)} motions")
    if not entries:
        actors = viz.side_by_side(loaded, names, is_compared)
    elif len(loaded) == 2:
        before, after = loaded
        actors = viz.before_and_after(before, after, rig_of(before).joints, names)
    else:
        expected = "expected two, before and after the repair that has the findings"
        raise ValueError(f"the number of motions is {len(loaded)}, {expected}")
    rows = rows_of_events(list_events(entries))
    rate = loaded[0].rate
    if path is None and running_shell():
        return viz.in_notebook(actors, rate, rows)
    page = Path(path or Path(tempfile.mkdtemp(prefix="numpy_cae_"), "motions.html"))
    viz.save_viewer(actors, page, rate, overlaid=bool(rows), findings=rows)
    if path is None:
        webbrowser.open(page.as_uri())
    return None


def _are_of_one_file(motions: Sequence[Motion]) -> bool:
    """Whether the motions are two that were made of one file, such as before and after a repair."""
    sources = [motion.source for motion in motions if isinstance(motion, FileMotion)]
    return len(motions) == len(sources) == 2 and sources[0] == sources[1]


def _labels(motions: Sequence[Motion], before_and_after: bool) -> list[str]:
    """The labels of motions that the user has given none."""
    if before_and_after:
        return ["before", "after"][: len(motions)]
    labels = []
    for number, motion in enumerate(motions, start=1):
        if isinstance(motion, FileMotion):
            labels.append(motion.source.name)
        else:
            labels.append(f"motion {number}")
    return labels


def learn(
    folders: FilePath | Iterable[FilePath],
    recipe: str = "fast",
    seed: int = 0,
    *,
    test: str | Iterable[str] = (),
    engine: str = "fast",
    quiet: bool = False,
    epochs: int | None = None,
    rate: float | None = None,
    batch: int | None = None,
    window: int = LENGTH,
    filters: Sequence[int] = (64, 128, 256),
    unit: float | None = None,
    up: str | None = None,
    floor: float | None = None,
    mapping: Mappings = None,
) -> MotionManifold:
    """Learn a manifold from every motion file in one or more folders and their subfolders.

    Progress is printed; in a notebook it is drawn. The parameters have the names of the options of
    `numpy-cae train`, which also trains the sequential network, and continues after an
    interruption.

    Parameters
    ----------
    folders : path or several
    recipe : {"fast", "best", "paper"}
        "fast" trains all layers at once with Adam, "best" does so for three times as many epochs,
        "paper" is the training of holden2015.
    seed : int
    test : str or several
        Patterns such as "*_005.bvh": names of files to measure the error on and not to learn from.
        The error (cm) after each epoch is in `settings["losses"]` of the manifold.
    engine : {"fast", "ops"}
        What computes the gradients: `numpy_cae.fast`, or the definitions in `numpy_cae.ops`.
    quiet : bool
        Show no progress.
    epochs, rate, batch : int, float, int, optional
        Instead of the recipe's: the number of epochs, with recipe "paper" of each layer and of fine
        tuning; the learning rate of the first epoch or the peak, with recipe "paper" of the layers;
        the number of windows in a step.
    window : int
        Frames in a window, at 30 a second.
    filters : sequence of int
        The number of filters of each layer.
    unit, up, floor, mapping
        How the files are read: see `numpy_cae.mocap.load_motion`.

    Returns
    -------
    MotionManifold
        Give it to `numpy_cae.project`, `repair` and `fill`, or `save` it.

    Raises
    ------
    MotionFileError, UnknownRigError
        If a file cannot be used.
    ValueError
        If there is no such recipe or engine, or a number does not fit.

    See Also
    --------
    project, repair, fill : What a manifold is used for.
    numpy_cae.manifold.learn_manifold : Learn from arrays instead of files.
    numpy_cae.manifold.learn_sequences : The sequential network of jang2018.
    """
    require_whole(seed, "seed", 0)
    require_whole(window, "window", 1)
    for number in filters:
        require_whole(number, "filters", 1)
    if epochs is not None:
        require_whole(epochs, "epochs", 1)
    if batch is not None:
        require_whole(batch, "batch", 1)
    if rate is not None:
        require_rate(rate)
    schedule = change_schedule(training.recipe(recipe), epochs, rate, batch)
    patterns = to_strings(test, "test")
    takes = _read_takes(folders, unit=unit, up=up, floor=floor, mapping=mapping)
    learning, testing = split_takes(takes, patterns)
    learn_takes = partial(
        learn_manifold,
        learning,
        schedule,
        seed,
        window=window,
        filters=filters,
        engine=engine,
        testing=testing,
    )
    if quiet:
        manifold = learn_takes()
    elif running_shell():
        with viz.LiveCurve("loss of a step") as curve:
            manifold = learn_takes(report=lambda state: curve.add(state.loss))
    else:
        manifold = learn_takes(report=training.ProgressPrinter())
    manifold.settings["test"] = patterns
    return manifold


def _read_takes(
    folders: FilePath | Iterable[FilePath], **reading: Any
) -> list[tuple[Path, np.ndarray]]:
    """Each motion file in the folders, and its positions (F, 20, 3) at thirty frames a second."""
    paths = []
    for folder in to_paths(folders, "folders"):
        paths += find_motion_files(folder)
    takes = []
    for path, body in zip(paths, read_files(paths, partial(read_body, **reading)), strict=True):
        if isinstance(body, Problem):
            raise body
        takes.append((path, body[0]))
    return takes
