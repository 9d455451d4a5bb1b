"""What the filters learned: holden2015, section 6, "Once training is complete …", drawn.

A filter of the first layer is 15 frames of 63 features and can be drawn as it is; a filter of an
upper layer cannot. So at one moment a unit is raised from its mean to its 99th percentile, and the
layers below decode the difference, with tanh⁻¹ and its bound. The picture shows at which joints the
difference has its energy.
"""

from collections.abc import Sequence

import numpy as np

from numpy_cae.experiments.clips import clips_of
from numpy_cae.experiments.material import Material
from numpy_cae.experiments.result import Result, Table
from numpy_cae.manifold import MotionManifold
from numpy_cae.models import ConvLayer
from numpy_cae.motion import JOINTS, POSITIONS

WINDOWS = 64
"""Test windows that give the range of the hidden units."""
SILENT = 1e-8
"""A filter whose response has less energy than this is silent: it moves nothing."""


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Draw the filters of each layer by what they move; the seed is not used."""
    clips = clips_of(manifold, [take.positions for take in material.testing]).evenly(WINDOWS)
    layers, x, shares, rows = manifold.network.layers, clips.x, [], []
    for n, layer in enumerate(layers, 1):
        x, _ = layer.encode_with_pullback(x)
        response = responses_of(layers[:n], x[clips.real[:, :: 2**n]])
        shares.append(energy_by_joint(response))
        rows.append([f"layer {n}", len(response), len(response) - len(shares[-1])])
    table = Table("Filters, and those that move nothing:", ["layer", "filters", "silent"], rows)
    return Result("What the filters learned", [table], (), lambda: _figure(shares))


def responses_of(layers: Sequence[ConvLayer], units: np.ndarray) -> np.ndarray:
    """Raise each unit of the last of the layers (lowest first) and decode through all of them.

    Parameters
    ----------
    layers : sequence of ConvLayer
    units : (N, k) array of float
        The values of the last layer's units in many frames, which give means and percentiles.

    Returns
    -------
    (k, frames, 63) array of float
        What raising each unit adds to the normalised features, with even unpooling.
    """
    radius = sum(len(layer.w) // 2 * 2**n for n, layer in enumerate(layers))
    middle = -(-radius // 2 ** len(layers))
    mean, high = units.mean(axis=0), np.quantile(units, 0.99, axis=0)
    still = np.repeat(mean[None], 2 * middle + 1, axis=0)
    raised = np.repeat(still[None], units.shape[1] + 1, axis=0)  # the last one stays as it is
    filters = np.arange(units.shape[1])
    raised[filters, middle, filters] = high
    for layer in reversed(layers):
        raised, _ = layer.decode_with_pullback(raised.astype(layer.w.dtype))
    return raised[:-1] - raised[-1]


def energy_by_joint(responses: np.ndarray) -> np.ndarray:
    """The share of each filter's energy in each joint and in the path, (filters, 21).

    Filters that are silent are left out.
    """
    energy = np.square(responses, dtype=np.float64).sum(axis=1)
    energy = energy[energy.sum(axis=1) > SILENT]
    joints = energy[:, POSITIONS].reshape(len(energy), len(JOINTS), 3).sum(axis=-1)
    path = energy[:, POSITIONS.stop :].sum(axis=-1, keepdims=True)
    return np.concatenate([joints, path], axis=1) / energy.sum(axis=1, keepdims=True)


def _figure(layers: list[np.ndarray]):
    """The share of each filter's energy at each joint, by layer."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 6), layout="constrained")
    widths = [np.sqrt(len(shares)) for shares in layers]
    all_axes = figure.subplots(1, len(layers), sharey=True, width_ratios=widths, squeeze=False)[0]
    for n, (axes, shares) in enumerate(zip(all_axes, layers, strict=True), 1):
        order = np.lexsort((-shares.max(axis=1), shares.argmax(axis=1)))
        image = axes.imshow(shares[order].T, aspect="auto", cmap="magma", vmin=0, vmax=0.4)
        axes.set_yticks(range(21), [*[joint.replace("_", " ") for joint in JOINTS], "path"])
        axes.set(title=f"layer {n}", xlabel="filters, by their strongest joint")
    figure.colorbar(image, ax=all_axes).set_label("share of a filter's energy")
    return figure
