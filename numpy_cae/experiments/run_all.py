"""Several experiments, some of them at the same time in processes of their own."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

from numpy_cae.experiments.catalogue import ALONE
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.section import Section, run_section
from numpy_cae.manifold import MotionManifold, load_manifold

_THREADS = "OPENBLAS_NUM_THREADS"


def run_all(
    names: Sequence[str], model: Path, material: Material, seed: int = 0, processes: int = 1
) -> Iterator[Section]:
    """Each section when it is done; those of `ALONE` last.

    Parameters
    ----------
    names : sequence of str
        Of `EXPERIMENTS`.
    model : path of the model file
    material : Material
    seed : int
    processes : int
        Experiments at the same time.

    Raises
    ------
    ValueError
        If a process was ended from outside.
    """
    manifold = load_manifold(model)
    shared = [name for name in names if name not in ALONE]
    if processes == 1 or len(shared) < 2:
        yield from (run_section(name, manifold, material, seed) for name in shared)
    else:
        yield from _in_processes(shared, model, material, seed, processes)
    for name in (name for name in names if name in ALONE):
        yield run_section(name, manifold, material, seed)


def _in_processes(
    names: Sequence[str], model: Path, material: Material, seed: int, processes: int
) -> Iterator[Section]:
    before = os.environ.get(_THREADS)
    os.environ[_THREADS] = "1"  # each process uses one core; NumPy reads this when imported
    try:
        pool = ProcessPoolExecutor(
            min(processes, len(names)),
            mp_context=multiprocessing.get_context("spawn"),
            initializer=_begin,
            initargs=(model, material, seed),
        )
        with pool:
            for done in as_completed([pool.submit(_run, name) for name in names]):
                yield done.result()
    except BrokenProcessPool:
        raise ValueError(
            "a process that ran experiments was ended from outside, perhaps for lack of memory: "
            "try --processes 1"
        ) from None
    finally:
        if before is None:
            del os.environ[_THREADS]
        else:
            os.environ[_THREADS] = before


_inputs: tuple[MotionManifold, Material, int] | None = None
"""Of a process of the pool: what its experiments are run on."""


def _begin(model: Path, material: Material, seed: int) -> None:
    global _inputs
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C ends it; the parent reports
    _inputs = load_manifold(model), material, seed


def _run(name: str) -> Section:
    return run_section(name, *_inputs)
