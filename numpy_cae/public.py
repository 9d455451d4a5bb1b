"""The functions of `import numpy_cae`: load, repair, fill, show and learn, for whole motions.

Everything that they do can be done with more options in `numpy_cae.motion`, `numpy_cae.manifold`
and `numpy_cae.viz`.
"""

import tempfile
import webbrowser
from collections.abc import Sequence
from pathlib import Path

from numpy_cae import notebook, training, viz
from numpy_cae.manifold import MotionManifold, Repaired, fill_motion, learn_manifold, starter
from numpy_cae.manifold.repair import repair as repair_motion
from numpy_cae.motion import JOINTS, Motion, find_motion_files
from numpy_cae.motion import load_motion as load
from numpy_cae.motion.joints import joint_mask
from numpy_cae.motion.read.many import read_bodies
from numpy_cae.motion.retarget.rigs import joint_index
from numpy_cae.viz.viewer import Player

__all__ = ["fill", "learn", "load", "repair", "show"]


def repair(motion: Motion, manifold: MotionManifold | None = None, **options) -> Repaired:
    """Find what is damaged in a motion and fill it in; the rest of the motion is unchanged.

    Parameters
    ----------
    motion : Motion
        As `load` returns it.
    manifold : MotionManifold, optional
        As `learn` returns it; the starter model of the package where None.
    **options
        Of `numpy_cae.manifold.repair`: `damaged`, `preset`, `findings`.

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
    >>> numpy_cae.repair(motion)
    left_wrist: frame 30: moved 27.9 cm, at most 27.9
    found:
      left_elbow: frame 30: spike (73° from the frames before and after): 27.9 cm, confidence 0.94
    """
    return repair_motion(motion, manifold or starter(), **options)


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
        As in `repair`.

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
    names = [JOINTS[joint_index(name, motion.skeleton)] for name in joints or JOINTS]
    first, last = (0, len(motion) - 1) if frames is None else frames
    if not 0 <= first <= last < len(motion):
        raise ValueError(f"frames {first} to {last}, the motion has 0 to {len(motion) - 1}")
    missing = joint_mask(len(motion), names, slice(first, last + 1))
    return fill_motion(motion, manifold or starter(), missing)


def show(*motions: Motion, path: str | Path | None = None) -> Player | None:
    """Play motions side by side in the viewer.

    In a notebook the last line of a cell displays the viewer. Elsewhere a page is written and
    opened in the browser.

    Parameters
    ----------
    *motions : Motion
        Of any rigs. Frames are those of the first motion; others are taken to its rate.
    path : path, optional
        Of the page, .html, which is then written and not opened.

    Returns
    -------
    Player or None
        The viewer, in a notebook; else None.
    """
    rate = motions[0].rate
    colours = [viz.PROJECTED]
    if len(motions) > 1:
        colours = [viz.CORRUPTED, viz.PROJECTED, viz.TRUTH, viz.PLAIN]
    actors = [
        viz.motion_actor(motion, f"motion {number + 1}", colours[number % len(colours)], rate)
        for number, motion in enumerate(motions)
    ]
    if path is None and notebook.shell():
        return viz.in_notebook(actors, rate)
    page = Path(path or Path(tempfile.mkdtemp(prefix="numpy_cae_"), "motions.html"))
    viz.save_viewer(actors, page, rate)
    if path is None:
        webbrowser.open(page.as_uri())
    return None


def learn(folder: str | Path, recipe: str = "fast", seed: int = 0) -> MotionManifold:
    """Learn a manifold from every motion file in a folder and its subfolders.

    Progress is printed. `numpy-cae train` has more options, and continues after an interruption.

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
        `project` a motion onto it, give it to `repair` and `fill`, or `save` it.

    Raises
    ------
    MotionFileError, UnknownRigError
        If a file cannot be used.
    ValueError
        If there is no such recipe.
    """
    schedule = training.recipe(recipe)
    takes = []
    for body in read_bodies(find_motion_files(folder)):
        if body.problem is not None:
            raise body.problem
        takes.append(body.positions)
    return learn_manifold(takes, schedule, seed, report=training.ProgressPrinter())
