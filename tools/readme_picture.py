"""Make the moving pictures of README.md: a damaged walk, its repair and the true walk.

    python -m tools.readme_picture docs

writes `repaired_walk.gif` for a light page and `repaired_walk_dark.gif` for a dark one.

The walk is synthetic (`data_synth`), so the picture has no licence but that of this repository. The
left leg is turned by 50 degrees for 1.5 seconds, then the right arm by 70 degrees for as long.
`repair` with the starter model receives the damaged motion and nothing else.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from PIL import Image

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
PALETTE = 48
"""Colours of a picture; more make the file larger."""


@dataclass(frozen=True)
class Page:
    """The page on which a picture is shown.

    Parameters
    ----------
    paper, floor : str
        Colours of the background and of the line of the floor.
    file : str
    colours : mapping of str to str
        The colour of each walk.
    """

    paper: str
    floor: str
    file: str
    colours: dict[str, str]


PAGES = (
    Page("#ffffff", "#dddddd", "repaired_walk.gif", COLOURS),
    Page(
        "#0d1117",
        "#3a424c",
        "repaired_walk_dark.gif",
        {"damaged": "#f0944d", "repaired": "#5f9be0", "true walk": "#5ec26b"},
    ),
)


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


def draw(walks: dict[str, np.ndarray], page: Page, path: Path) -> None:
    """Write walks, (F, 20, 3) each, side by side as a GIF; the cameras follow the true walk."""
    figure = Figure(figsize=(6.6, 2.9), dpi=100, facecolor=page.paper)
    canvas = FigureCanvasAgg(figure)
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    bodies = {}
    for place, (name, colour) in enumerate(page.colours.items(), start=1):
        axes = figure.add_subplot(1, 3, place)
        axes.set(xlim=(-0.95, 0.95), ylim=(-0.25, 1.95), aspect="equal")
        axes.axis("off")
        axes.text(0, 1.85, name, ha="center", color=colour, fontsize=11)
        axes.plot([-0.6, 0.6], [0, 0], color=page.floor, linewidth=1)
        shades = [_shade(colour, joint, page.paper) for joint in JOINTS[1:]]
        lines = LineCollection([], colors=shades, linewidths=4, capstyle="round")
        head = axes.plot([], [], "o", color=colour, markersize=15)[0]
        bodies[name] = axes.add_collection(lines), head

    pictures = []
    for frame in range(0, len(walks["true walk"]), STEP):
        middle = np.median(walks["true walk"][frame], axis=0)
        follow = middle * [1.0, 0.0, 1.0]  # the point of the floor below it
        for name, (lines, head) in bodies.items():
            view = camera_view(walks[name][frame] - follow, AZIMUTH)
            lines.set_segments(bones(view, PARENTS))
            head.set_data(*(view[JOINTS.index("head")] + [0, 0.06])[:, None])
        canvas.draw()
        pictures.append(Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB"))
    first, *others = _with_one_palette(pictures, page.paper)
    milliseconds = 10 * round(100 * STEP / RATE)  # GIF counts hundredths of a second
    first.save(path, save_all=True, append_images=others, duration=milliseconds, loop=0)


def _with_one_palette(pictures: list[Image.Image], paper: str) -> list[Image.Image]:
    """The pictures with the colours of the first, without dithering, so that files are small. The
    paper has its exact colour, to which Pillow's choice of the nearest one is only near."""
    palette = pictures[0].quantize(PALETTE - 1)
    colours = (palette.getpalette() or [])[: 3 * (PALETTE - 1)]
    ground = [round(255 * part) for part in to_rgb(paper)]
    reduced = []
    for picture in pictures:
        indices = np.array(picture.quantize(palette=palette, dither=Image.Dither.NONE))
        indices[(np.asarray(picture) == ground).all(axis=-1)] = PALETTE - 1
        image = Image.fromarray(indices)
        image.putpalette(colours + ground)
        reduced.append(image)
    return reduced


def _shade(colour: str, joint: str, paper: str) -> np.ndarray:
    """The left side is nearer to the paper's colour than the right, as in the viewer."""
    strength = 0.6 if joint.startswith("left") else 1.0
    return strength * np.array(to_rgb(colour)) + (1 - strength) * np.array(to_rgb(paper))


def main(folder: str) -> None:
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
    for page in PAGES:
        draw(walks, page, Path(folder) / page.file)


if __name__ == "__main__":
    main(*sys.argv[1:])
