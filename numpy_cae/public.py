"""The functions of `import numpy_cae`: load, save, repair, fill, project, show and learn.

Everything can be done with more options in `numpy_cae.mocap`, `numpy_cae.manifold`,
`numpy_cae.cleanup` and `numpy_cae.viz`.
"""

import tempfile
import webbrowser
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from numpy_cae import ipython, training, viz
from numpy_cae.cleanup import Finding, Preset, Repaired, fill_motion, repair_motion
from numpy_cae.cleanup import project_motion as project
from numpy_cae.manifold import MotionManifold, learn_manifold, starter
from numpy_cae.mocap import find_motion_files
from numpy_cae.mocap import load_motion as load
from numpy_cae.mocap import save as save
from numpy_cae.mocap.bodies import Problem, read_body, read_each
from numpy_cae.mocap.rigs.recognise import joint_index, rig_of
from numpy_cae.motion import JOINTS, Motion
from numpy_cae.motion.joints import joint_mask
from numpy_cae.viz.viewer import Player

__all__ = ["fill", "learn", "load", "project", "repair", "save", "show"]


def repair(
    motion: Motion,
    manifold: MotionManifold | None = None,
    damaged: np.ndarray | None = None,
    preset: Preset | None = None,
    findings: Sequence[Finding] | None = None,
) -> Repaired:
    """Find what is damaged in a motion and mend it; the rest of the motion is unchanged.

    Parameters
    ----------
    motion : Motion
        As `load` returns it.
    manifold : MotionManifold, optional
        As `learn` returns it; the starter model of the package where None.
    damaged : (frames, 20) array of bool, optional
        In the frames of the file: only this is repaired, and nothing is looked for.
    preset : Preset, optional
        Which steps are taken; `Preset()` by default.
    findings : sequence of Finding, optional
        Only these are mended, whatever their confidence.

    Returns
    -------
    Repaired
        Its `motion` is the repaired one. Printed, it names the joints, frames and centimetres.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=2.0, rate=30.0).motion
    >>> motion.rotations[30, motion.skeleton.index("lradius")] = [0.6, 0.0, 0.0, 0.8]
    >>> numpy_cae.repair(motion)  # doctest: +NORMALIZE_WHITESPACE
    left_wrist: frame 30: moved 27.9 cm, at most 27.9
    1 finding:
      1. left_elbow: frame 30: spike (73° from the frames before and after):
        27.9 cm, confidence 0.94
    """
    return repair_motion(motion, manifold or starter(), damaged, preset, findings)


def fill(
    motion: Motion,
    joints: Sequence[str] | None = None,
    frames: tuple[int, int] | None = None,
    manifold: MotionManifold | None = None,
) -> Repaired:
    """Fill in joints of a motion in some frames; what the motion has there is ignored.

    Parameters
    ----------
    motion : Motion
    joints : sequence of str, optional
        Names of the twenty joints or of the rig's; all joints where None.
    frames : (int, int), optional
        The first and the last frame of the file, counted from 0; all frames where None.
    manifold : MotionManifold, optional
        As in `numpy_cae.repair`.

    Returns
    -------
    Repaired

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> motion = make_take("walk", 0, seconds=4.0, rate=30.0).motion
    >>> numpy_cae.fill(motion, joints=["left_wrist"], frames=(30, 75))
    left_wrist: frames 30 to 75: moved 3.1 cm, at most 6.4
    """
    names = [JOINTS[joint_index(name, motion)] for name in joints or JOINTS]
    first, last = (0, len(motion) - 1) if frames is None else frames
    if not 0 <= first <= last < len(motion):
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
    missing = joint_mask(len(motion), names, slice(first, last + 1))
    return fill_motion(motion, manifold or starter(), missing)


def show(
    *motions: Motion,
    labels: Sequence[str] = (),
    findings: Sequence[Finding] = (),
    path: str | Path | None = None,
) -> Player | None:
    """Play motions in the viewer, side by side.

    In a notebook the last line of a cell displays the viewer. Elsewhere a page is written and
    opened in the browser.

    Parameters
    ----------
    *motions : Motion
        Of any rigs. Frames are those of the first motion; others are taken to its rate. Joints of
        a motion with the joints and frames of the first are coloured by their distance from it.
    labels : sequence of str, optional
        A name for each motion.
    findings : sequence of Finding, optional
        Of a repair, as in `show(motion, repaired.motion, findings=repaired.findings)`: the two
        motions are overlaid, as their twenty joints, beside a list of the findings.
    path : path, optional
        Of the page, .html, which is then written and not opened.

    Returns
    -------
    Player or None
        The viewer, in a notebook; else None.

    Raises
    ------
    ValueError
        If there is not one label for each motion.

    Examples
    --------
    >>> import numpy_cae
    >>> from data_synth import make_take
    >>> walk = make_take("walk", 0, seconds=1.0, rate=30.0).motion
    >>> numpy_cae.show(walk, walk.at(slice(9)), labels=["walk", "its start"], path="walk.html")
    """
    rate = motions[0].rate
    default = ["before", "after"] if findings else [f"motion {n + 1}" for n in range(len(motions))]
    labels = labels or default
    if len(labels) != len(motions):
        raise ValueError(f"there are {len(labels)} labels for {len(motions)} motions")
    actors = viz.side_by_side(motions, labels)
    if findings:
        actors = viz.before_and_after(*motions, rig_of(motions[0]).joints, labels)
    entries = [finding.to_json() for finding in findings]
    if path is None and ipython.shell():
        return viz.in_notebook(actors, rate, entries)
    page = Path(path or Path(tempfile.mkdtemp(prefix="numpy_cae_"), "motions.html"))
    viz.save_viewer(actors, page, rate, overlaid=bool(findings), findings=entries)
    if path is None:
        webbrowser.open(page.as_uri())
    return None


def learn(folder: str | Path, recipe: str = "fast", seed: int = 0) -> MotionManifold:
    """Learn a manifold from every motion file in a folder and its subfolders.

    Progress is printed, in a notebook drawn. `numpy-cae train` has more options, and continues
    after an interruption.

    Parameters
    ----------
    folder : path
    recipe : {"fast", "best", "paper"}
        "fast" trains all layers at once with Adam, "best" does so for three times as many epochs,
        "paper" is the training of holden2015.
    seed : int

    Returns
    -------
    MotionManifold
        Give it to `numpy_cae.project`, `repair` and `fill`, or `save` it.

    Raises
    ------
    MotionFileError, UnknownRigError
        If a file cannot be used.
    ValueError
        If there is no such recipe.
    """
    schedule = training.recipe(recipe)
    takes = []
    for body in read_each(find_motion_files(folder), read_body):
        if isinstance(body, Problem):
            raise body
        takes.append(body[0])
    if not ipython.shell():
        return learn_manifold(takes, schedule, seed, report=training.ProgressPrinter())
    with viz.LiveCurve("loss of a step") as curve:
        return learn_manifold(takes, schedule, seed, report=lambda state: curve.add(state.loss))
