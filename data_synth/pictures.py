"""`python -m data_synth.pictures FOLDER`: a strip of poses of every kind, for the README.

Above as seen from the person's right, below from the front: right limbs red, left limbs blue. The
poses are as far apart in time as they say; each stands in its own place on the strip, on the
floor's line, in a body-sized frame.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image  # which matplotlib needs itself

from data_synth.kinds import KINDS, make_take
from data_synth.take import Take
from numpy_cae.atomic_write import atomic_write

POSES = 12
_LEFT, _RIGHT, _MIDDLE, _FLOOR = "#2166ac", "#b2182b", "#222222", "#999999"
# Seed, first second and seconds between poses: where each kind shows what it is.
_SCENES = {
    "walk": (5, 3.0, 0.1), "confident_walk": (4, 3.0, 0.1), "walk_with_turn": (3, 2.0, 0.35),
    "old_mans_walk": (6, 3.0, 0.13), "sidestep": (5, 0.6, 0.16), "run": (7, 2.0, 0.065),
    "press_ups": (4, 0.3, 0.22), "squats": (2, 0.2, 0.25), "jumping_jacks": (5, 0.7, 0.1),
    "kick": (5, 0.5, 0.14), "punch": (2, 0.4, 0.1), "wave": (2, 0.4, 0.2), "idle": (5, 0.5, 0.6),
    "walking": (13, 1.0, 0.12), "waiting": (2, 0.3, 1.2), "walking_dog": (2, 1.0, 0.5),
}  # fmt: skip
_RATE, _SECONDS = 100.0, 16.0


def strip(take: Take, first: float, between: float, poses: int = POSES) -> Figure:
    """Poses of a take in a row, from the side and from the front.

    Parameters
    ----------
    take : Take
    first, between : float
        Seconds.
    poses : int
    """
    frames = np.round((first + between * np.arange(poses)) * take.motion.rate).astype(int)
    frames = frames[frames < len(take.motion)]
    points, bones = _points_and_bones(take)
    lying = np.ptp(points[frames[0], :, 1]) < 1.1
    width, top = (2.0, 0.95) if lying else (1.0, 2.4 if "jacks" in take.kind else 1.95)
    figure = Figure(figsize=(10.5, 2 * 10.5 * (top + 0.1) / (width * (poses + 0.15))))
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    for row, angle in enumerate((-np.pi / 2, 0.0)):
        axes = figure.add_subplot(2, 1, row + 1)
        axes.axhline(0.0, color=_FLOOR, linewidth=0.8)
        for place, frame in enumerate(frames):
            flat = _seen(points[frame], take.heading[frame] + angle)
            flat[:, 0] += place * width
            lines = [flat[list(bone)] for bone, _ in bones]
            colours = [colour for _, colour in bones]
            axes.add_collection(
                LineCollection(lines, colors=colours, linewidths=1.6, capstyle="round")
            )
            if row:
                moment = f"{frame / take.motion.rate:.2f} s"
                axes.text(place * width, top, moment, ha="center", va="top", fontsize=6)
        axes.set(xlim=(-0.55 * width, (poses - 0.4) * width), ylim=(-0.1, top), aspect="equal")
        axes.axis("off")
    return figure


def _points_and_bones(take: Take):
    """Joints and tips, (F, J + tips, 3), and pairs of them with a colour."""
    skeleton = take.motion.skeleton
    positions, turned = take.motion.forward_kinematics()
    points, bones = [positions], []
    for joint, parent in enumerate(skeleton.parents):
        if parent >= 0:
            bones.append(((parent, joint), _colour(skeleton.names[joint])))
    for number, (joint, tip) in enumerate(skeleton.end_sites.items()):
        points.append((positions[:, joint] + turned[joint].apply(tip))[:, None])
        ends = (joint, len(skeleton.names) + number)
        bones.append((ends, _colour(skeleton.names[joint])))
    return np.concatenate(points, axis=1), bones


def _colour(name: str) -> str:
    if name in ("root", "lowerback", "lowerneck"):
        return _MIDDLE
    return {"l": _LEFT, "r": _RIGHT}.get(name[0], _MIDDLE)


def _seen(points: np.ndarray, azimuth: float) -> np.ndarray:
    """From the direction `azimuth` about Y, the root in the middle: right and up, (N, 2)."""
    x, _, z = (points - points[0]).T
    return np.stack([np.cos(azimuth) * x - np.sin(azimuth) * z, points[:, 1]], axis=-1)


def _save_small(figure: Figure, path: Path) -> None:
    """As PNG of a few colours, a quarter of the size."""
    whole = io.BytesIO()
    figure.savefig(whole, format="png", dpi=95, facecolor="white")
    with atomic_write(path) as beside:
        Image.open(whole).convert("RGB").quantize(48).save(beside, format="png", optimize=True)


def main(argv: list[str] | None = None) -> int:
    """Write one PNG a kind into a folder."""
    arguments = sys.argv[1:] if argv is None else argv
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print("usage: python -m data_synth.pictures FOLDER", file=sys.stderr)
        return 2
    folder = Path(arguments[0])
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for kind in KINDS:
            seed, first, between = _SCENES[kind]
            figure = strip(make_take(kind, seed, _SECONDS, _RATE), first, between)
            _save_small(figure, folder / f"{kind}.png")
            print(folder / f"{kind}.png")
    except (ValueError, OSError) as error:
        print(f"data_synth.pictures: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
