"""Make the moving picture of README.md: a damaged walk, its repair and the true walk.

    python -m tools.readme_picture docs/repaired_walk.gif

The walk is synthetic (`data_synth`), so the picture has no licence but that of this repository. The
left leg is turned by 50 degrees for 1.5 seconds, then the right arm by 70 degrees for as long.
`repair` with the starter model receives the damaged motion and nothing else.
"""

import sys
from dataclasses import replace
from itertools import chain

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

from data_synth import make_take
from numpy_cae.cleanup import repair_motion
from numpy_cae.manifold import starter
from numpy_cae.mocap import body_positions
from numpy_cae.motion import JOINTS, PARENTS, RATE, Motion
from numpy_cae.motion.quaternions import product
from numpy_cae.viz.figures import bones, camera_view

SECONDS = 6.0
"""Duration of the walk."""
STEP = 2
"""Frames of the motion for each picture."""
AZIMUTH = 60.0
"""Degrees from which the camera looks."""
STRETCH = 45
"""Frames of each damage."""
COLOURS = {"damaged": "#e8833a", "repaired": "#2f6db5", "true walk": "#3f9a4b"}


def damaged_walk(motion: Motion) -> Motion:
    """The motion with a turned left leg and, later, a turned right arm."""
    rotations = motion.rotations.copy()
    for name, start, degrees in (("lfemur", 25, 50), ("rhumerus", 105, -70)):
        half = np.radians(degrees) / 2
        turn = np.array([0, 0, np.sin(half), np.cos(half)])  # a quaternion about the Z axis
        frames = slice(start, start + STRETCH)
        joint = motion.skeleton.names.index(name)
        rotations[frames, joint] = product(rotations[frames, joint], turn)
    return replace(motion, rotations=rotations)


def draw(walks: dict[str, np.ndarray], path: str) -> None:
    """Write walks, (F, 20, 3) each, side by side as a GIF; the cameras follow the true walk."""
    figure = Figure(figsize=(6.6, 2.9), dpi=100)
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    bodies = {}
    for place, (name, colour) in enumerate(COLOURS.items(), start=1):
        axes = figure.add_subplot(1, 3, place)
        axes.set(xlim=(-0.95, 0.95), ylim=(-0.25, 1.95), aspect="equal")
        axes.axis("off")
        axes.text(0, 1.85, name, ha="center", color=colour, fontsize=11)
        axes.plot([-0.6, 0.6], [0, 0], color="#dddddd", linewidth=1)
        shades = [_shade(colour, joint) for joint in JOINTS[1:]]
        lines = LineCollection([], colors=shades, linewidths=4, capstyle="round")
        head = axes.plot([], [], "o", color=colour, markersize=15)[0]
        bodies[name] = axes.add_collection(lines), head

    def show(frame: int) -> list:
        middle = np.median(walks["true walk"][frame], axis=0)
        follow = middle * [1.0, 0.0, 1.0]  # the point of the floor below it
        for name, (lines, head) in bodies.items():
            view = camera_view(walks[name][frame] - follow, AZIMUTH)
            lines.set_segments(bones(view, PARENTS))
            head.set_data(*(view[JOINTS.index("head")] + [0, 0.06])[:, None])
        return list(chain.from_iterable(bodies.values()))

    moments = range(0, len(walks["true walk"]), STEP)
    animation = FuncAnimation(figure, show, frames=moments, init_func=lambda: [])
    animation.save(path, writer=PillowWriter(fps=round(RATE / STEP)))


def _shade(colour: str, joint: str) -> np.ndarray:
    """The left side is lighter than the right, as in the viewer."""
    strength = 0.6 if joint.startswith("left") else 1.0
    return 1 - (1 - np.array(to_rgb(colour))) * strength


def main(path: str) -> None:
    """Make the walks and draw them."""
    truth = make_take("walk", seed=7001, seconds=SECONDS, rate=RATE).motion
    damaged = damaged_walk(truth)
    repaired = repair_motion(damaged, starter()).motion
    motions = dict(zip(COLOURS, (damaged, repaired, truth), strict=True))
    walks = {name: body_positions(motion) for name, motion in motions.items()}
    for name in ("damaged", "repaired"):
        error = np.linalg.norm(walks[name] - walks["true walk"], axis=-1)
        mean = 100 * error.mean()
        largest = 100 * error.max()
        print(f"{name}: {mean:.1f} cm from the true walk in the mean, {largest:.0f} at most")
    draw(walks, path)


if __name__ == "__main__":
    main(*sys.argv[1:])
