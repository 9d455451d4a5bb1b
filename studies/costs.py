"""What whole commands cost, and how cost grows with each size.

Commands are processes of their own: seconds of all their processors, start included, and the
peak memory of the first process. A slope is that of a straight line through the larger sizes,
logarithm of the time over logarithm of the size: 1 is linear.

    python -m studies costs -o costs
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from data_synth import make_take, plan_takes, write_series
from numpy_cae.fast import accelerate
from numpy_cae.mocap import load_motion, write_bvh
from numpy_cae.models import ConvAutoencoder, SequentialAutoencoder
from numpy_cae.motion import Motion, Skeleton
from studies.shared.messages import note
from studies.shared.result import Picture, Result, Table
from studies.timing.torch_networks import FRAMES, LATENT, step

SECONDS = (1, 10, 60, 600, 3600)
"""Lengths of the files that are repaired (s)."""
FILES = (1, 10, 100, 300)
WINDOWS = (1, 4, 16, 64, 256, 1024)
JOINTS = (20, 50, 100, 200, 500, 1000)
HIDDEN = (64, 128, 256, 512, 1024)
LARGE = 2
"""The slope is that of so many of the largest sizes."""
MINUTES = 45.0
"""Minutes of synthetic motion, of which a network learns."""
TAKES = 280
"""The network learns from so many of these takes, the first."""
ROOT = Path(__file__).parents[1]
"""The folder from which `python -m studies` is run."""
Costs = Mapping[int, tuple[float, float | None]]
"""Size to seconds, and megabytes if they were measured."""


def run() -> Result:
    """Measure everything in a temporary folder, which takes ten minutes and half a gigabyte."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        series = write_series(plan_takes(MINUTES)[:TAKES], folder / "takes", rate=30.0).parent
        rows = list(_commands(folder, series))
        commands = Table("", ["command", "processor, s", "peak, MB"], rows, ("", ".2f", ".0f"))
        costs_by_size = dict(_growth(folder))
    rows = [_row(quantity, costs) for quantity, costs in costs_by_size.items()]
    header = ["size", "from", "to", "first, s", "last, s", "slope", "peak at the last, MB"]
    growth = Table("", header, rows, ("", "", "", ".3f", ".3f", ".2f", ".0f"))
    pictures = {
        f"growth_{quantity.split()[0]}": Picture(partial(_figure, quantity, costs))
        for quantity, costs in costs_by_size.items()
    }
    return Result("Costs", [commands, growth], figures=pictures)


def _cost(*words: object) -> tuple[float, float]:
    """Processor seconds and peak memory (MB) of a command of `numpy-cae`."""
    command = [str(word) for word in words]
    process = subprocess.Popen(
        [sys.executable, "-m", "studies.timing.peak_memory", *command],
        cwd=ROOT,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    with process.stderr:
        messages = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3):  # 3: nothing had to be repaired
        raise OSError(f"{' '.join(command)} ended with status {process.returncode}")
    seconds = usage.ru_utime + usage.ru_stime
    note(f"{' '.join(command[:2])}: {seconds:.2f} s")
    kilobytes = int(re.findall(r"VmHWM:\s+(\d+)", messages)[-1])
    return seconds, kilobytes / 1e3


def _commands(folder: Path, takes: Path) -> Iterator[list[object]]:
    damaged = write_walk(folder / "damaged.bvh", 80 / 30, spike=True)
    yield ["--help", *_cost("--help")]
    yield ["repair of 80 frames", *_cost("repair", damaged, "-o", folder / "fixed.bvh")]
    yield ["demo", *_cost("demo", "-o", folder / "demo", "--quiet")]
    model = folder / "model.npz"
    count = len(list(takes.rglob("*.bvh")))
    learned = _cost("train", takes, "-o", model, "--recipe", "fast", "--quiet")
    yield [f"train --recipe fast, {count} takes", *learned]


def write_walk(path: Path, seconds: float, spike: bool = False) -> Path:
    """A walk at thirty frames a second, repeated after ten seconds, with one turned elbow."""
    motion = make_take("walk", 0, seconds=10.0, rate=30.0).motion
    motion = motion.at(np.arange(round(30 * seconds)) % len(motion))
    if spike:
        motion.rotations[40, motion.skeleton.index("lradius")] = (0.0, 0.0, 0.6, 0.8)
    write_bvh(motion, path, unit=0.01)
    return path


def _seconds(work: Callable[[], object], times: int = 3) -> float:
    """Processor seconds of a call, the least of some."""
    least = np.inf
    for _ in range(times):
        begun = time.process_time()
        work()
        least = min(least, time.process_time() - begun)
    return float(least)


def _growth(folder: Path) -> Iterator[tuple[str, Costs]]:
    """What grows, and its costs by size."""
    long = {n: write_walk(folder / f"{n}.bvh", n) for n in SECONDS}
    out = folder / "out.bvh"
    repaired = {n: _cost("repair", long[n], "-o", out, "--overwrite", "--project") for n in SECONDS}
    yield "frames of a file that is repaired", {30 * n: cost for n, cost in repaired.items()}
    yield "files that are repaired", {n: _cost("repair", *_copies(folder, n)) for n in FILES}
    network = accelerate(ConvAutoencoder())
    windows = {n: np.ones((n, FRAMES, 63), np.float32) for n in WINDOWS}
    yield (
        "windows that are projected",
        {n: (_seconds(partial(network.project, x)), None) for n, x in windows.items()},
    )
    yield "joints of a file that is read", {n: (_joints(folder, n), None) for n in JOINTS}
    yield "hidden units in a step of sequences", {n: (_of_step(n), None) for n in HIDDEN}


def _copies(folder: Path, count: int) -> list[object]:
    """The arguments of a repair of so many files."""
    files = folder / f"files_{count}"
    files.mkdir()
    text = (folder / "damaged.bvh").read_bytes()
    for number in range(count):
        (files / f"{number}.bvh").write_bytes(text)
    return [files, "-o", folder / f"fixed_{count}"]


def _joints(folder: Path, count: int) -> float:
    """Seconds to read ten seconds of a chain of so many joints."""
    names = tuple(f"joint{n}" for n in range(count))
    chain = Skeleton(names, tuple(range(-1, count - 1)), np.full((count, 3), 0.01))
    turns = np.random.default_rng(0).normal(size=(300, count, 4))
    turns /= np.linalg.norm(turns, axis=-1, keepdims=True)
    path = folder / f"chain_{count}.bvh"
    write_bvh(Motion(chain, 30.0, turns, np.tile(chain.offsets, (300, 1, 1))), path)
    return _seconds(partial(load_motion, path))


def _of_step(units: int) -> float:
    """Seconds of a step of training with 16 clips."""
    model = accelerate(SequentialAutoencoder(hidden=units, latent=LATENT))
    return _seconds(step(model, 16)[0], 5)


def _slope(costs: Costs) -> float:
    sizes = sorted(costs)[-LARGE:]
    return float(np.polyfit(np.log(sizes), np.log([costs[n][0] for n in sizes]), 1)[0])


def _row(quantity: str, costs: Costs) -> list[object]:
    first, *_, last = sorted(costs)
    return [quantity, first, last, costs[first][0], costs[last][0], _slope(costs), costs[last][1]]


def _figure(quantity: str, costs: Costs) -> Figure:
    """Seconds over size, both logarithmic, beside linear growth through the last size."""
    sizes = sorted(costs)
    seconds = [costs[size][0] for size in sizes]
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    axes.loglog(sizes, seconds, "o-", label=f"measured, slope {_slope(costs):.2f}")
    axes.loglog(sizes, [seconds[-1] * size / sizes[-1] for size in sizes], "--", label="linear")
    axes.set(xlabel=quantity, ylabel="processor seconds")
    axes.legend()
    return figure
