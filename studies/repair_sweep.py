"""Values removed with probability p from 0.1 to 0.9, repaired by the network and by baselines:
holden2015, section 7, "Fixing Corrupt Motion Data".

Errors are root mean squares of a coordinate. With the mask unknown no method is given the removed
values; rescaling, the linear denoiser and the chosen settings use p. Ends repeated: windows are
padded with their end frames, not with the mean pose. Averaged over all shifts: the mean of the
projections at all positions of the pooling grid, for the kind of input that the network was trained
on.

A removed value is zero, the value of the mean pose. So the expected value is E[X_c] = (1 - p) X,
and the linear methods and the network are also given X_c / (1 - p), whose expected value is X.
"""

from collections import defaultdict

import numpy as np

from numpy_cae.evaluation import PCA
from numpy_cae.evaluation.clips import Clips
from numpy_cae.evaluation.gaussian import Gaussian, filtered
from numpy_cae.manifold import MotionManifold
from numpy_cae.manifold.shifted_projection import project_shifted
from numpy_cae.training import zero_values
from numpy_cae.training.interpolation import interpolated
from numpy_cae.viz import CORRUPTED, OTHERS, PLAIN, PROJECTED, Curve, curves_figure
from studies.shared.clips import AVERAGED, NETWORK, REPEATED, Split, project_repeated, split_of
from studies.shared.material import Material
from studies.shared.result import Claim, Picture, Result, Table

PCA_ON_FRAMES, PCA_ON_WINDOWS = "PCA on frames", "PCA on windows"
PS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
HALF = 0.5
"""The p of the paper's figure 1."""
CORRUPTED_ROW, LINEAR = "damaged, nothing done", "linear denoiser, 15 frames"
RESCALED = ", rescaled"
INTERPOLATED = "monotone cubic (PCHIP), mask given"
Errors = dict[str, list[float]]
"""Method to errors in cm, one for each p."""


def repair_baselines(split: Split) -> dict[str, tuple[PCA, PCA]]:
    """PCA on single frames and on whole windows, each fitted to `Split.fitting`, for choosing the
    number of axes on `Split.choosing`, and to all training windows. A filter over time is a linear
    map of frames: the linear denoiser is the best one of its length."""
    _, frames, features = split.testing.x.shape
    return {
        name: (
            PCA.fit(split.fitting.x.reshape(-1, size)),
            PCA.fit(split.training.x.reshape(-1, size)),
        )
        for name, size in ((PCA_ON_FRAMES, features), (PCA_ON_WINDOWS, frames * features))
    }


def run(manifold: MotionManifold, material: Material, seed: int = 0) -> Result:
    """Remove values of test windows, drawn from the seed, and repair them with every method."""
    split = split_of(manifold, material)
    errors = swept(manifold, split, seed)
    floor = split.testing.error(project_shifted(manifold.network, split.testing.x))
    columns = [f"p = {p}" for p in PS]
    *rows, mask_given = ([name, *row] for name, row in errors.items())
    return Result(
        "Repair: values removed with probability p",
        [
            Table("Error, cm, mask unknown:", ["mask unknown", *columns], rows, best="low"),
            Table("An easier problem, mask given:", ["mask given", *columns], [mask_given]),
        ],
        _claims(errors, floor, RESCALED if manifold.rescales else ""),
        {"repair_sweep": Picture(lambda: _figure(errors))},
        note=f"{split.sample} {split.fitted()}",
    )


def swept(manifold: MotionManifold, split: Split, seed: int) -> Errors:
    """The errors of every method, cm, for each p."""
    baselines = repair_baselines(split)
    gaussian = Gaussian.fit(split.training.x, split.training.real)
    errors: Errors = defaultdict(list)
    for number, p in enumerate(PS):
        rng = np.random.default_rng([seed, number])
        practice, _ = _removed(split.choosing, p, rng)
        damaged, known = _removed(split.testing, p, rng)
        repaired = {CORRUPTED_ROW: damaged}
        for suffix, factor in (("", 1.0), (RESCALED, 1 / (1 - p))):
            for name, (trial, pca) in baselines.items():
                tried = {s: trial.project(practice * factor, s) for s in trial.sizes}
                best = min(tried, key=lambda size: split.choosing.error(tried[size]))
                repaired[name + suffix] = pca.project(damaged * factor, best)
            x = damaged * factor
            repaired[NETWORK + suffix] = project_shifted(manifold.network, x)
            repaired[REPEATED + suffix] = project_repeated(manifold, x)
            if bool(suffix) == manifold.rescales:
                averaged = project_repeated(manifold, x, average_shifts=True)
                repaired[AVERAGED + suffix] = averaged
        repaired[LINEAR] = filtered(damaged, gaussian.linear_map(p))
        repaired[INTERPOLATED] = interpolated(damaged, known)
        for name, x in repaired.items():
            errors[name].append(split.testing.error(x))
    return errors


def _removed(clips: Clips, p: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """X_c, and which of its values are known."""
    kept = zero_values(np.ones_like(clips.x), p, rng)
    return clips.x * kept, kept > 0


def _claims(errors: Errors, floor: float, suffix: str) -> list[Claim]:
    at = {name: row[PS.index(HALF)] for name, row in errors.items()}
    plain, corrupted = at[NETWORK + suffix], at[CORRUPTED_ROW]
    best = min(error for name, error in at.items() if name.startswith(NETWORK))
    pca = min(error for name, error in at.items() if name.startswith("PCA"))
    return [
        Claim(
            "half_recovered",
            plain < corrupted / 2,
            f"{corrupted:.2f} cm before, {plain:.2f} cm after, {plain / corrupted:.2f} of it "
            f"({at[REPEATED + suffix]:.2f} cm with the ends of a window repeated, "
            f"{at[AVERAGED + suffix]:.2f} cm with that and averaged over all shifts of the "
            f"pooling grid); the projection of an undamaged motion is {floor:.2f} cm off.",
        ),
        Claim("better_than_pca", best < pca, f"network {best:.2f} cm, PCA {pca:.2f} cm."),
        Claim(
            "better_than_linear",
            best < at[LINEAR],
            f"network {best:.2f} cm, linear denoiser {at[LINEAR]:.2f} cm.",
        ),
    ]


def _figure(errors: Errors):
    """Error over p of five methods: each with or without rescaling, whichever is better."""
    methods = (CORRUPTED_ROW, NETWORK, LINEAR, PCA_ON_WINDOWS)
    drawn = zip(methods, (CORRUPTED, PROJECTED, *OTHERS), strict=False)
    curves = [Curve(PS, errors[INTERPOLATED], INTERPOLATED, PLAIN, ":")]
    for method, colour in drawn:
        variants = [name for name in (method, method + RESCALED) if name in errors]
        name = min(variants, key=lambda variant: sum(errors[variant]))
        curves.append(Curve(PS, errors[name], name, colour))
    figure = curves_figure(curves, "p, share of values removed", "error, cm")
    figure.axes[0].set_ylim(0, 1.1 * max(errors[CORRUPTED_ROW]))
    return figure
