"""What the names of methods in the tables of the report mean, for its legend."""

from collections.abc import Sequence

from numpy_cae.experiments.result import Result

MEANINGS = {
    "damaged": "the damaged motion itself, with nothing done to it",
    "the network": "projection onto the manifold: the motion is encoded and decoded once",
    "ends held": "windows are padded with their first and last frames instead of the mean pose",
    "all shifts": "the mean of the projections at all positions of the pooling grid",
    "rescaled": "known values are divided by the share that is known, 1 - p, before the method",
    "linear denoiser": "the best linear map from 15 damaged frames to the frame in their middle",
    "PCA on frames": "principal components of single poses; their number is chosen",
    "PCA on windows": "principal components of whole windows; their number is chosen",
    "median filter": "each value becomes the median of its neighbours in time",
    "Savitzky-Golay": "a polynomial fitted to the neighbours in time of each value",
    "linear interpolation": "a straight line over each hole, which must be known",
    "the mean pose": "the mean of all poses in training",
    "along the manifold": "hidden units are interpolated and decoded",
    "constrained projection": "projection, then bone lengths, standing feet and ground are kept",
    "untrained": "the same network before training",
    "fitted prior": "hidden units of a training window, mixed with those of its nearest neighbours",
    "uniform prior": "hidden units drawn independently and uniformly",
}
"""Part of a method's name to its meaning."""


def legend_of(results: Sequence[Result]) -> dict[str, str]:
    """The meanings of those names that the first columns of the results' tables contain."""
    rows = [row for result in results for table in result.tables for row in table.rows]
    names = {str(row[0]) for row in rows}
    return {
        part: meaning for part, meaning in MEANINGS.items() if any(part in name for name in names)
    }
