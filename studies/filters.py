"""What the filters express: holden2015, section 6, "Once training is complete …".

    python -m studies filters --data bandai --test '*_005.bvh' -m best.npz

One unit of a layer is raised at one moment from its mean to its 99th percentile in test windows;
the layers below decode the difference. A filter moves the joints and lasts the frames that have
together nine tenths of the energy of this response. An untrained network is measured beside it.
"""

import numpy as np

from numpy_cae.evaluation.clips import Clips
from numpy_cae.manifold import MotionManifold
from numpy_cae.motion import JOINTS, POSITIONS
from studies.comparison import untrained
from studies.shared.clips import testing_of
from studies.shared.material import Material
from studies.shared.result import Claim, Result, Table

WINDOWS = 64
"""Test windows that give the range of the hidden units."""
ENERGY = 0.9
"""ENERGY: the share of a response's energy in its joints and its frames."""
SILENT = 1e-8
"""SILENT: a filter whose response has less energy than this moves nothing, and is left out."""
HEADER = ("layer", "frames", "untrained", "joints", "untrained", "correlation", "untrained")


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Measure the filters of each layer, and those of an untrained network of this seed."""
    clips = testing_of(manifold, material)[0].evenly(WINDOWS)
    trained, initial = (_layers(each, clips) for each in (manifold, untrained(manifold, seed)))
    rows = [
        [f"layer {n + 1}", *(value for pair in zip(*both, strict=True) for value in pair)]
        for n, both in enumerate(zip(trained, initial, strict=True))
    ]
    frames, joints, correlations = np.array(trained).T
    _, _, initial_correlations = np.array(initial).T
    listed = ", ".join(f"{value:.1f}" for value in joints)
    lasting = ", ".join(f"{value:.1f}" for value in frames)
    return Result(
        "What the filters express",
        [Table("Medians over the filters; mean correlation of two units:", HEADER, rows)],
        [
            Claim(
                "filters_correspond",
                bool(joints[0] >= 2 and frames[0] >= 3),
                f"a filter of layer 1 moves {joints[0]:.0f} joints for {frames[0]:.0f} frames.",
            ),
            Claim(
                "filters_independent",
                bool(correlations[0] < initial_correlations[0]),
                f"two units of layer 1 correlate {correlations[0]:.2f};",
                opponent=f"untrained {initial_correlations[0]:.2f}.",
            ),
            Claim(
                "filters_combine",
                bool((np.diff(joints) > 0).all() and (np.diff(frames) > 0).all()),
                f"joints by layer {listed}, frames {lasting}.",
            ),
        ],
    )


def _layers(manifold: MotionManifold, clips: Clips) -> list[tuple[float, float, float]]:
    """For each layer the frames that a filter lasts, the joints that it moves, and the mean
    magnitude of the correlation of two units."""
    measured = []
    for n in range(1, len(manifold.network.layers) + 1):
        units = manifold.network.encode(clips.x, layers=n)[clips.real[:, :: 2**n]]
        energy = np.square(_responses(manifold, units, n)[..., POSITIONS], dtype=np.float64)
        energy = energy.reshape(*energy.shape[:2], len(JOINTS), 3).sum(axis=-1)
        energy = energy[energy.sum(axis=(1, 2)) > SILENT]
        varied = units[:, units.std(axis=0) > 1e-6]
        correlation = np.abs(np.corrcoef(varied, rowvar=False))
        between = (correlation.sum() - len(correlation)) / (correlation.size - len(correlation))
        measured.append((_count(energy.sum(axis=2)), _count(energy.sum(axis=1)), float(between)))
    return measured


def _responses(manifold: MotionManifold, units: np.ndarray, n: int) -> np.ndarray:
    """What raising each of the units (N, k) of layer n adds to the motion, (k, frames, 63)."""
    layers = manifold.network.layers[:n]
    middle = sum(len(layer.w) // 2 * 2**below for below, layer in enumerate(layers)) // 2**n + 1
    filters = np.arange(units.shape[1])
    raised = np.tile(units.mean(axis=0), (len(filters) + 1, 2 * middle + 1, 1))
    raised[filters, middle, filters] = np.quantile(units, 0.99, axis=0)
    for layer in reversed(layers):
        raised, _ = layer.decode_with_pullback(raised.astype(layer.w.dtype))
    return raised[:-1] - raised[-1]  # the last one has no unit raised


def _count(energy: np.ndarray) -> float:
    """The median number of columns that have together `ENERGY` of each row's energy."""
    share = np.sort(energy, axis=1)[:, ::-1].cumsum(axis=1) / energy.sum(axis=1, keepdims=True)
    return float(np.median(1 + (share < ENERGY).sum(axis=1)))
