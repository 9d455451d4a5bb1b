"""The arguments of an exercise, drawn as the file `lesson_NN.toml` states.

x = "batch frames channels"                    an array of these sizes
x = {array = "batch frames", within = 1.3}     with entries between -1.3 and 1.3
x = {array = "batch", within = 1.3, around = 2} with entries between 0.7 and 3.3
x = {uniform = "batch frames", within = 0.5}   between -0.5 and 0.5, on no grid
known = {half = "batch frames"}                booleans, half of them True, or one more
taps = {size = "taps"}                         a size
loss = {recorded = "LOSS"}                     the function of this text, which records its calls
q = {by = "some_joint"}                        a function of (case, rng, arguments so far)
bound = 0.9                                    a value

Where the sizes of an exercise have "values", arrays are of the class that a case states (CLASSES).

The texts and the functions that single exercises name follow below, lesson by lesson.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from numpy_cae.course.exercises.checks import Recorded
from numpy_cae.course.solutions.building_blocks import to_features
from numpy_cae.course.solutions.second_paper import block_matrices
from numpy_cae.models.sequential_autoencoder import Weights, weight_shapes
from numpy_cae.verify.operations.case import ORDINARY, Case
from numpy_cae.verify.operations.operation import OPERATIONS
from numpy_cae.verify.operations.shapes import shape_of
from numpy_cae.verify.operations.values import spread

Arguments = dict[str, Any]
"""The arguments of a call by name, in their order; a function that draws one gets those before."""


def draw_as_stated(entries: Mapping[str, object]) -> Callable[[Case], Arguments]:
    """The function that draws the arguments of a case as the entries of an exercise state."""

    def draw(case: Case) -> Arguments:
        rng = case.rng()
        arguments: Arguments = {}
        for name, entry in entries.items():
            arguments[name] = _draw_argument(entry, case, rng, arguments)
        return arguments

    return draw


def _draw_argument(
    entry: object, case: Case, rng: np.random.Generator, arguments: Arguments
) -> object:
    """One argument; `arguments` has those before it."""
    match entry:
        case str(sizes):
            return _change_class(case, rng, spread(rng, shape_of(case, sizes)))
        case {"array": sizes, "within": largest, **optional}:
            array = spread(rng, shape_of(case, sizes), largest) + optional.get("around", 0.0)
            return _change_class(case, rng, array)
        case {"half": sizes}:
            shape = shape_of(case, sizes)
            return rng.permutation(np.arange(np.prod(shape)) % 2 == 0).reshape(shape)
        case {"uniform": sizes, "within": largest}:
            return draw_uniform(case, rng, shape_of(case, sizes), largest)
        case {"size": name}:
            return case[name]
        case {"recorded": name}:
            return Recorded(globals()[name])
        case {"by": name}:
            return globals()[name](case, rng, arguments)
    return entry


def uniform(rng: np.random.Generator, shape: tuple[int, ...], bound: float) -> np.ndarray:
    """Random entries between -bound and bound: sums of those on a grid would tie in the pooling."""
    return rng.uniform(-bound, bound, shape).round(3)


def _keep_array(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    return array


def _multiply_by_four(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    return 4.0 * array


def _round_to_quarters(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    return np.round(4.0 * array) / 4.0


def _repeat_first_frame(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    quarters = _round_to_quarters(rng, array)
    if quarters.ndim < 3:
        return quarters
    return np.repeat(quarters[:, :1], quarters.shape[1], axis=1)


def _zero_or_keep(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    return array * rng.choice([0.0, 1.0]) + 0.0


def _make_tiny(rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    return 1e-6 * array


TIED_CLASSES = ("ties", "equal frames", "zeros")
"""The classes of values in which frames are equal, in any order of summation."""
CLASSES: dict[str, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    ORDINARY: _keep_array,
    "random": _keep_array,
    "saturated": _multiply_by_four,
    "ties": _round_to_quarters,
    "equal frames": _repeat_first_frame,
    "zeros": _zero_or_keep,
    "tiny": _make_tiny,
}
"""How ordinary arrays are changed to those of a class.

The sums and products of quarters are exact, so that ties do not depend on the order of summation.
Saturated units lie beyond every bound. Of "zeros" half of the arrays are zero.
"""


def _change_class(case: Case, rng: np.random.Generator, array: np.ndarray) -> np.ndarray:
    """An array of the class of values that a case states, by default ordinary."""
    return CLASSES[case.get("values")](rng, array)


def draw_uniform(
    case: Case, rng: np.random.Generator, shape: tuple[int, ...], bound: float
) -> np.ndarray:
    """Random entries between -bound and bound, changed to the class of values of the case."""
    return _change_class(case, rng, uniform(rng, shape, bound))


QUARTER = "by quarters"


def random_tree(case: Case, rng: np.random.Generator, arguments: Arguments) -> tuple[int, ...]:
    """The parents of a random tree in which every parent precedes its children."""
    rng = np.random.default_rng([case.seed, 2])
    return (-1, *(int(rng.integers(0, joint)) for joint in range(1, case["joints"])))


def some_joint(case: Case, rng: np.random.Generator, arguments: Arguments) -> int:
    """A joint."""
    return case.seed % case["joints"]


def some_axes(case: Case, rng: np.random.Generator, arguments: Arguments) -> tuple[int, ...]:
    """Different axes of rotation in any order."""
    return tuple(int(axis) for axis in rng.permutation(3)[: case["channels"]])


def some_angles(case: Case, rng: np.random.Generator, arguments: Arguments) -> tuple[float, ...]:
    """An angle in degrees for each channel."""
    return tuple(float(angle) for angle in 90 * spread(rng, (case["channels"],)))


def rotations(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """A rotation of each joint in each frame, by quarter turns about the axes or by any angle."""
    from scipy.spatial.transform import Rotation

    counts = (case["frames"], case["joints"])
    count = int(np.prod(counts))
    if case["turns"] == QUARTER:
        quarter_turns = Rotation.create_group("O").as_matrix().round() + 0.0
        chosen = rng.integers(len(quarter_turns), size=count)
        return quarter_turns[chosen].reshape(*counts, 3, 3)
    return Rotation.from_rotvec(spread(rng, (count, 3))).as_matrix().reshape(*counts, 3, 3)


def translations(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Translations, whole numbers beside quarter turns, so that paper is enough to check them."""
    shape = (case["frames"], case["joints"], 3)
    whole_numbers = rng.choice([-3.0, -2.0, -1.0, 1.0, 2.0, 3.0], shape)
    return whole_numbers if case["turns"] == QUARTER else spread(rng, shape)


def headings(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Angles that grow by up to 1.9 radians per frame, past whole turns."""
    rng = case.rng()
    return spread(rng, (1,), 3.0) + np.cumsum(spread(rng, (case["frames"],), 1.0) + 0.9)


def lines_across(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Lines across a body with these headings."""
    theta = headings(case, rng, arguments)
    rng = np.random.default_rng([case.seed, 4])
    width = rng.uniform(0.3, 0.8, len(theta))
    tilt = rng.uniform(-0.2, 0.2, len(theta))
    return np.stack([width * np.cos(theta), tilt, -width * np.sin(theta)], axis=-1)


def feature_arguments(case: Case) -> Arguments:
    """The features of random positions, and where and facing which way they begin."""
    positions = spread(case.rng(), (case["frames"], 20, 3))
    features = to_features(positions, headings(case, case.rng(), {}))
    rng = np.random.default_rng([case.seed, 5])
    x, z, heading = (float(number) for number in rng.uniform(-2, 2, 3).round(2))
    return {"features": features, "x": x, "z": z, "heading": heading}


LOSS = (
    "lambda x, corrupted, w, b: "
    "((((w - x.mean()) ** 2).sum() + (b**2).sum()) / 2, w - x.mean(), 1.0 * b)"
)
"""A loss with its gradients, as simple as it can be for `train_layer`."""


def corrupted(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Windows with noise: zeros would tie in the pooling."""
    return arguments["x"] + draw_uniform(case, rng, arguments["x"].shape, 0.25)


def first_frames(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Where a value is unpooled to the first frame of its pair."""
    return rng.random((case["batch"], case["frames"] // 2, case["filters"])) < 0.5


def generator(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.random.Generator:
    """What draws the arguments."""
    return rng


def random_layers(case: Case, rng: np.random.Generator, arguments: Arguments) -> list[tuple]:
    """The filters and biases of each layer.

    Where frames tie, a filter of an upper layer has one entry: the sum of several products would
    tie, or not, by its rounding.
    """
    channels = [case["channels"]] + case["layers"] * [case["filters"]]
    layers: list[tuple] = []
    for below, above in pairwise(channels):
        w = draw_uniform(case, rng, (case["taps"], below, above), 0.5)
        b = draw_uniform(case, rng, (above,), 0.25)
        if layers and case.get("values") in TIED_CLASSES:
            w = _keep_one_entry(rng, w)
        layers.append((w, b))
    return layers


def _keep_one_entry(rng: np.random.Generator, w: np.ndarray) -> np.ndarray:
    """The filters with one entry each, 0 in all others."""
    taps, below, above = w.shape
    entries = np.arange(taps * below)[:, None]
    chosen = rng.integers(taps * below, size=above)
    return np.where(entries == chosen, w.reshape(-1, above), 0.0).reshape(w.shape)


def random_windows(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Windows whose frames can be pooled in every layer."""
    frames = case["units"] * 2 ** case["layers"]
    return draw_uniform(case, rng, (case["batch"], frames, case["channels"]), 1.0)


BLURRED = "lambda x: 0.75 * x + 0.25 * np.roll(x, 1, axis=1) + 0.1"
"""A projection, a mean of each frame and the one before it, that changes every window."""


WITH_MEAN = "lambda x, known: np.where(known, x, np.mean(x[known]))"
"""An interpolation as simple as it can be."""


def damaged_arguments(case: Case) -> Arguments:
    """Windows whose values were set to zero, and features that are zero in all frames."""
    rng = case.rng()
    batch, frames, channels = (case[name] for name in ("batch", "frames", "channels"))
    x = spread(rng, (batch, frames, channels))
    for window, channel in np.ndindex(batch, channels):
        lost = rng.permutation(frames)[: rng.integers(1, frames)]
        x[window, lost, channel] = 0.0
    still = np.zeros((batch, frames, case["still"]))
    still[1:, :, :1] = 1.0  # the first of them is still in the first window only
    return {"x": np.concatenate([x, still], axis=2)}


def moment_arguments(case: Case) -> Arguments:
    """The moments of correlated random inputs z and outputs x."""
    rng = case.rng()
    inputs = case["inputs"]
    independent = rng.standard_normal((2 * inputs + 2, inputs))
    z = independent @ rng.standard_normal((inputs, inputs))
    x = z @ rng.standard_normal((inputs, case["outputs"])) + independent[:, :1]
    return {"second": z.T @ z / len(z), "cross": z.T @ x / len(z), "kept": case["tenths"] / 10}


def some_alike(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Which motions are alike."""
    return rng.permutation(np.arange(case["motions"]) < case["alike"])


def linear_pullback(case: Case, rng: np.random.Generator, arguments: Arguments) -> Recorded:
    """The pullback of a recurrence with one matrix for each frame: dh_(t-1) = dh_t · M_t."""
    matrices = spread(rng, (case["frames"], case["hidden"], case["hidden"]), 1.5)
    text = f"lambda t, dh: dh @ np.array({np.round(matrices, 4).tolist()})[t - 1]"
    return Recorded(text)


def clip_arguments(case: Case) -> Arguments:
    """Arrays of several shapes, and a bound of so many quarters of their norm; of 0, zeros."""
    rng = case.rng()
    shapes = [(case["rows"], 2), (2,), (1, case["rows"])][: case["arrays"]]
    gradients = [spread(rng, shape) * (case["quarters"] > 0) + 0.0 for shape in shapes]
    norm = float(np.sqrt(sum(np.sum(gradient**2) for gradient in gradients)))
    return {"gradients": gradients, "bound": case["quarters"] / 4 * norm or 1.0}


OF_ENCODER = ("encoder_", "latent_")


def random_weights(case: Case, rng: np.random.Generator, arguments: Arguments) -> Weights:
    """Every weight of the network by name."""
    shapes = weight_shapes(case["features"], case["hidden"], case["latent"])
    return {name: draw_uniform(case, rng, shape, 1.0) for name, shape in shapes.items()}


def encoder(case: Case, rng: np.random.Generator, arguments: Arguments) -> Weights:
    """The weights from clips to z."""
    weights = random_weights(case, rng, arguments)
    return {name: weight for name, weight in weights.items() if name.startswith(OF_ENCODER)}


def decoder(case: Case, rng: np.random.Generator, arguments: Arguments) -> Weights:
    """The weights from z to clips."""
    weights = random_weights(case, rng, arguments)
    return {name: weight for name, weight in weights.items() if not name.startswith(OF_ENCODER)}


def random_directions(case: Case, rng: np.random.Generator, arguments: Arguments) -> np.ndarray:
    """Unit vectors, one a row."""
    drawn = rng.uniform(-1.0, 1.0, (case["directions"], case["latent"]))
    return drawn / np.linalg.norm(drawn, axis=1, keepdims=True)


@dataclass(frozen=True, eq=False)
class Matrix:
    """A x with the pullback of another matrix, or of A itself if it is right."""

    a: np.ndarray
    of_pullback: np.ndarray = field(repr=False)

    def __call__(self, x: np.ndarray) -> tuple[np.ndarray, Callable]:
        return self.a @ x, lambda dy: self.of_pullback.T @ dy


def cubic(case: Case, rng: np.random.Generator, arguments: Arguments) -> Recorded:
    """L(x) = Σ w x³; its central difference with step h is exactly 3 w x² + w h²."""
    w = spread(rng, (case["rows"], case["columns"]))
    return Recorded(f"lambda x: np.sum(np.array({np.round(w, 4).tolist()}) * x**3)")


def wrong_matrix(case: Case, rng: np.random.Generator, arguments: Arguments) -> Matrix:
    """A matrix with a wrong pullback."""
    a = spread(rng, (case["rows"], case["columns"]))
    return Matrix(a, a + 1)


def seed(case: Case, rng: np.random.Generator, arguments: Arguments) -> int:
    """The seed of the case, from which a check draws everything."""
    return case.seed


MULTIPLY = "lambda a, b: a * b"


def block_arguments(case: Case) -> Arguments:
    """The arguments of a convolution, and the matrices of its blocks."""
    matrices = zip("agc", block_matrices(case["taps"], case["block"]), strict=True)
    return {**OPERATIONS["conv1d"].arguments(case), **dict(matrices)}


def some_frequency(case: Case, rng: np.random.Generator, arguments: Arguments) -> int:
    """A frequency from 0 to half of the points."""
    return case.seed % ((case["frames"] + case["taps"] - 1) // 2 + 1)
