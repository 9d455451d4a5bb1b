"""Draw docs/pictures/completion.gif and holes_filled.gif: missing values filled in by several
methods, side by side, moving, with the error over time below.

    python -m tools.filling_pictures

Both are of a synthetic walk and the starter model, which learned from other synthetic walks too.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure

from data_synth import make_take
from numpy_cae.cleanup import fill_motion
from numpy_cae.cleanup.joint_regression import regress_positions
from numpy_cae.manifold import MotionManifold, starter
from numpy_cae.mocap import body_of, body_positions
from numpy_cae.motion import JOINTS, PARENTS, POSITIONS, RATE
from numpy_cae.motion.joints import LIMBS, joint_mask
from numpy_cae.viz.figures import camera_view
from studies.damage import CURVES, curve_filling
from studies.shared.charts import BLUE, GREEN, GREY, ORANGE, PURPLE
from studies.shared.completions import CURVE, LINES, NETWORK, WEIGHED, complete_by_every_method

PICTURES = Path(__file__).parents[1] / "docs" / "pictures"
SHARE = 0.9
"""Of the values so many are removed."""
SEED = 5
"""Of the take, and of the values that are removed."""
EVERY = 3
"""Every third frame is drawn, 10 a second."""
COLOURS = (ORANGE, PURPLE, BLUE, GREEN)
Poses = Mapping[str, np.ndarray]
"""Method to positions (F, 20, 3)."""


def completed_poses(manifold: MotionManifold) -> tuple[np.ndarray, Poses]:
    """The true poses and those of each method, of which `SHARE` of the values were removed."""
    walk = body_of(make_take("walk", SEED, seconds=4.0, rate=RATE).motion)
    features, _ = manifold.features(walk)
    known = np.random.default_rng(SEED).random(features.shape) >= SHARE
    completed = complete_by_every_method(manifold, features, known)
    titles = {
        LINES: "straight line",
        CURVE: "Gaussian process",
        NETWORK: "network",
        WEIGHED: "weighed: complete",
    }
    poses = {title: poses_of(completed[name]) for name, title in titles.items()}
    return poses_of(features), poses


def poses_of(features: np.ndarray) -> np.ndarray:
    """The positions (F, 20, 3) in the body's frame."""
    return features[:, POSITIONS].reshape(-1, len(JOINTS), 3)


def filled_poses(limb: str, hole: slice, manifold: MotionManifold) -> tuple[np.ndarray, Poses]:
    """The true poses and those of each method, of which a limb is missing for a while."""
    motion = make_take("walk", SEED, seconds=4.0, rate=RATE).motion
    mask = joint_mask(len(motion), LIMBS[limb], hole)
    name, curve = next(iter(CURVES.items()))
    features, _ = manifold.features(body_positions(motion))
    truth = poses_of(features)
    by_curve, _ = manifold.features(body_positions(curve_filling(curve, motion, mask)))
    by_fill, _ = manifold.features(body_positions(fill_motion(motion, manifold, mask).motion))
    part = limb.removeprefix("left_")
    poses = {
        f"{part}: curve ({name.split()[0]})": poses_of(by_curve),
        f"{part}: regression": poses_of(regress_positions(features, mask)),
        f"{part}: fill": poses_of(by_fill),
    }
    return truth, poses


def animate(rows: list[tuple[np.ndarray, Poses]], path: Path, height: float) -> None:
    """Write a GIF: a row of moving poses over the truth in grey, and a row of errors below it."""
    columns = max(len(poses) for _, poses in rows)
    figure = Figure(figsize=(1.7 * columns, height * len(rows)), layout="constrained", dpi=70)
    panels = figure.subplots(
        2 * len(rows), columns, squeeze=False, height_ratios=[3, 1] * len(rows)
    )
    moving = []
    for number, (truth, poses) in enumerate(rows):
        errors = {name: error_of(positions, truth) for name, positions in poses.items()}
        most = 1.05 * max(error.max() for error in errors.values())
        for column, (name, positions) in enumerate(poses.items()):
            panel = panels[2 * number, column]
            track = panels[2 * number + 1, column]
            mean = np.sqrt(np.mean(errors[name][errors[name] > 0] ** 2))
            panel.set_title(f"{name}\n{mean:.1f} cm", fontsize=8)
            moving.append(draw_pose(panel, truth, GREY, 1.0))
            moving.append(draw_pose(panel, positions, COLOURS[column], 1.8))
            track.plot(np.arange(len(truth)) / RATE, errors[name], color=COLOURS[column], lw=1)
            track.set_ylim(0, most)
            track.tick_params(labelsize=6)
            if column == 0:
                track.set_ylabel("error, cm", fontsize=7)
            else:
                track.set_yticklabels([])
            moving.append(draw_moment(track))
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once, not for each frame
    frames = range(0, len(rows[0][0]), EVERY)

    def show(frame: int) -> None:
        for move in moving:
            move(frame)

    animation = FuncAnimation(figure, show, frames, repeat=True)
    animation.save(path, PillowWriter(fps=round(RATE / EVERY)))


def error_of(positions: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """The error (cm) of each frame: root mean square of a coordinate, of joints that differ."""
    off = 100 * (positions - truth)
    differ = np.linalg.norm(off, axis=-1).max(axis=0) > 1e-3
    return np.sqrt(np.mean(off[:, differ] ** 2, axis=(1, 2)))


def draw_pose(panel, positions: np.ndarray, colour: str, width: float):
    """Draw the first pose; return what moves it to another frame."""
    views = camera_view(positions, 40.0)[..., :2]
    lines = []
    for _ in JOINTS[1:]:
        lines += panel.plot([], [], color=colour, lw=width, solid_capstyle="round")
    panel.set_xlim(-0.75, 0.75)
    panel.set_ylim(views[..., 1].min() - 0.1, views[..., 1].max() + 0.1)
    panel.set_aspect("equal")
    panel.axis("off")

    def move(frame: int) -> None:
        for joint, line in enumerate(lines, start=1):
            line.set_data(*views[frame, [joint, PARENTS[joint]]].T)

    return move


def draw_moment(track):
    """Draw a line at the first frame; return what moves it to another frame."""
    line = track.axvline(0, color=GREY, lw=0.8)

    def move(frame: int) -> None:
        line.set_xdata([frame / RATE, frame / RATE])

    return move


if __name__ == "__main__":
    network = starter()
    animate([completed_poses(network)], PICTURES / "completion.gif", 3.4)
    hole = slice(40, 85)
    parts = [filled_poses(limb, hole, network) for limb in ("left_leg", "left_arm")]
    animate(parts, PICTURES / "holes_filled.gif", 3.0)
