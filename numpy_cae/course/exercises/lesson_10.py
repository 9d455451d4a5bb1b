"""The exercises of lesson 10, a manifold in sequences: reading a clip, writing one, the loss."""

from __future__ import annotations

import numpy as np

from numpy_cae import ops
from numpy_cae.course.exercises.exercise import Claim, Exercise, exercise, operation_exercise
from numpy_cae.course.exercises.lesson_05 import scattered
from numpy_cae.course.exercises.weights_by_name import (
    REACH,
    by_name,
    defined_read,
    defined_write,
    drawn_clips,
    drawn_weights,
    fed,
    keeps_float32,
    two,
    unaltered_by_name,
)
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.models.sequential_autoencoder import weight_shapes
from numpy_cae.verify import definitions
from numpy_cae.verify.case import Case
from numpy_cae.verify.gradients import check_gradients
from numpy_cae.verify.operation import Operation
from numpy_cae.verify.property import require_equal

SIZES = {"batch": (1, 2), "frames": (1, 2, 3), "features": (1, 2), "hidden": (1, 2)}
LATENT = {**SIZES, "latent": (1, 2, 3)}
WHOLE = {**LATENT, "frames": (1, 2), "hidden": (1,)}  # its parts have been tried wider
OF_READING = ("encoder_w", "encoder_u", "encoder_b", "encoder_c", "latent_w", "latent_b")
OF_GRU = ("decoder_w", "decoder_u", "decoder_b", "decoder_c")
OF_FRAME = ("frame_w", "frame_b")
OF_WRITING = ("state_w", "state_b", *OF_GRU, *OF_FRAME)
TWICE = "a frame acts twice: it is compared, and it is fed to the next step"
SUMMED = "The same map writes every frame: add up over the steps"


def self_fed(h, frames, w, u, b, c, frame_w, frame_b):
    """The decoder's loop and its pullback, as in `SequentialAutoencoder.decode_with_pullback`."""
    y = np.zeros((len(h), len(frame_b)), h.dtype)
    written, step_backs, frame_backs = [], [], []
    for _ in range(frames):
        h, step_back = ops.gru_step(y, h, w, u, b, c)
        y, frame_back = ops.linear(h, frame_w, frame_b)
        written.append(y)
        step_backs.append(step_back)
        frame_backs.append(frame_back)

    def pullback(d_written):
        totals = [np.zeros_like(each) for each in (w, u, b, c, frame_w, frame_b)]
        dy_fed, dh = np.zeros_like(y), np.zeros_like(h)
        for k in reversed(range(frames)):
            dh_through_frame, *of_frame = frame_backs[k](d_written[:, k] + dy_fed)
            dy_fed, dh, *of_step = step_backs[k](dh + dh_through_frame)
            totals = [total + d for total, d in zip(totals, of_step + of_frame, strict=True)]
        return (dh, *totals)

    return np.stack(written, axis=1), pullback


def read_clips(weights, x):
    """From clips to z, from the package."""
    return SequentialAutoencoder.from_weights(weights).encode_with_pullback(x)


def write_clips(weights, z, frames):
    """From z to clips, from the package."""
    return SequentialAutoencoder.from_weights(weights).decode_with_pullback(z, frames)


def reconstruction_loss(weights, x):
    """The mean squared error of clips read and written, and its derivatives, from the package."""
    model = SequentialAutoencoder.from_weights(weights)
    z, read_back = model.encode_with_pullback(x)
    x_hat, write_back = model.decode_with_pullback(z, x.shape[1])
    loss, error_back = ops.mean_squared_error(x_hat, x)
    dz, of_writing = write_back(error_back())
    return loss, {**read_back(dz), **of_writing}


def _loop(case: Case) -> dict[str, object]:
    rng = case.rng()
    features, hidden = case["features"], case["hidden"]
    shapes = weight_shapes(features, hidden, 1)
    return {
        "h": scattered(rng, (case["batch"], hidden), 1.0),
        "frames": case["frames"],
        **{name[-1]: scattered(rng, shapes[name], REACH) for name in OF_GRU},
        **{name: scattered(rng, shapes[name], REACH) for name in OF_FRAME},
    }


def _to_read(case: Case) -> dict[str, object]:
    rng = case.rng()
    weights = drawn_weights(case, rng)
    return {
        "weights": {name: weights[name] for name in OF_READING},
        "x": drawn_clips(case, rng),
    }


def _to_write(case: Case) -> dict[str, object]:
    rng = case.rng()
    weights = drawn_weights(case, rng)
    return {
        "weights": {name: weights[name] for name in OF_WRITING},
        "z": scattered(rng, (case["batch"], case["latent"]), 1.0),
        "frames": case["frames"],
    }


def _to_compare(case: Case) -> dict[str, object]:
    rng = case.rng()
    return {"weights": drawn_weights(case, rng), "x": drawn_clips(case, rng)}


def _read(function, case: Case) -> None:
    arguments = _to_read(case)
    z, _ = two(function(*arguments.values()), "z and the pullback")
    require_equal("z", z, defined_read(**arguments))


def _write(function, case: Case) -> None:
    arguments = _to_write(case)
    x_hat, _ = two(function(*arguments.values()), "the clips and the pullback")
    require_equal("the value", x_hat, defined_write(**arguments))


def _gradients_of_reading(function, case: Case) -> None:
    weights, x = _to_read(case).values()

    def f(*arrays):
        named = dict(zip(weights, arrays, strict=True))
        z, back = two(function(named, x), "z and the pullback")
        return z, lambda dz: by_name(back(dz), weights)

    check_gradients(f, *weights.values(), rng=case.rng(), names=tuple(weights))


def _gradients_of_writing(only: tuple[str, ...]):
    def check(function, case: Case) -> None:
        weights, z, frames = _to_write(case).values()

        def f(z, *arrays):
            named = dict(zip(weights, arrays, strict=True))
            x_hat, back = two(function(named, z, frames), "the clips and the pullback")

            def pullback(dx_hat):
                dz, gradients = two(back(dx_hat), "dz and the gradients by name")
                return dz, *by_name(gradients, weights)

            return x_hat, pullback

        names = ("z", *weights)
        check_gradients(f, z, *weights.values(), rng=case.rng(), names=names, only=only)

    return check


def _compared(function, case: Case) -> None:
    weights, x = _to_compare(case).values()
    loss, _ = two(function(weights, x), "the loss and the gradients by name")
    x_hat = defined_write(weights, defined_read(weights, x), x.shape[1])
    require_equal("the loss", loss, definitions.mean_squared_error(x_hat, x))


def gradients_of_loss(arguments, only: tuple[str, ...]):
    """A check of the gradients for some weights, by finite differences of the whole loss.

    Parameters
    ----------
    arguments : callable
        As the exercise has it; the weights come first.
    only : tuple of str
        The weights to check.
    """

    def check(function, case: Case) -> None:
        weights, *others = arguments(case).values()

        def f(*arrays):
            named = dict(zip(weights, arrays, strict=True))
            loss, gradients = two(function(named, *others), "the loss and the gradients by name")
            return np.float64(loss), lambda d: tuple(d * g for g in by_name(gradients, weights))

        names = tuple(weights)
        check_gradients(f, *weights.values(), rng=case.rng(), names=names, only=only)

    return check


def _read_back(returned):
    z, back = two(returned, "z and the pullback")
    return z, by_name(back(np.ones_like(z)), OF_READING)


def _written_back(returned):
    x_hat, back = two(returned, "the clips and the pullback")
    dz, gradients = two(back(np.ones_like(x_hat)), "dz and the gradients by name")
    return x_hat, (dz, *by_name(gradients, OF_WRITING))


def loss_back(returned):
    """The loss and the gradients of all weights, in order."""
    loss, gradients = two(returned, "the loss and the gradients by name")
    return loss, by_name(gradients, (*OF_READING, *OF_WRITING))


EXERCISES: tuple[Exercise, ...] = (
    exercise(
        "read_clips",
        "run the GRU from a state of zeros, take its state after the last frame, and map it. On "
        "the way back the states of all other frames get a gradient of zero",
        read_clips,
        _to_read,
        LATENT,
        (
            Claim("value", "z is that of the definition, loop by loop", _read, 2),
            Claim(
                "gradients",
                "every gradient is that of central differences",
                _gradients_of_reading,
                4,
                "the pullback of gru wants a gradient for the state of every frame: zeros, and "
                "at the last frame what the map to z returns",
            ),
            keeps_float32(_to_read, _read_back),
            unaltered_by_name(_to_read),
        ),
        given=("gru", "linear"),
    ),
    operation_exercise(
        Operation(
            "self_fed",
            SIZES,
            _loop,
            ("h", "w", "u", "b", "c", "frame_w", "frame_b"),
            fed,
        ),
        "keep both pullbacks of every step. On the way back carry two things from step k + 1 to "
        "step k: the gradient of the frame that it was fed and that of the state it began with",
        self_fed,
        hints={
            "value": "the first frame that is fed is zeros; after that each step is fed the frame "
            "that the one before wrote",
            "gradient for h": "what is left of the state's gradient once step 1 has passed it on",
            "gradient for w": TWICE,
            "gradient for frame_w": f"{TWICE}. {SUMMED}",
            "gradient for frame_b": f"{TWICE}. {SUMMED}",
            "independence": "the totals begin at zero each time the pullback is called",
        },
        given=("gru_step", "linear"),
    ),
    exercise(
        "write_clips",
        "map z to a state, let self_fed write, turn the frames round. Turning round is undone by "
        "turning round",
        write_clips,
        _to_write,
        LATENT,
        (
            Claim(
                "value",
                "the clips are those of the definition, loop by loop",
                _write,
                2,
                "the decoder writes the last frame of the clip first",
            ),
            Claim(
                "gradient for z",
                "dz is that of central differences",
                _gradients_of_writing(("z",)),
                2,
                "the gradient that comes in is in the order of time, self_fed's is not",
            ),
            Claim(
                "gradients for the weights",
                "every other gradient is that of central differences",
                _gradients_of_writing(OF_WRITING),
                2,
            ),
            keeps_float32(_to_write, _written_back),
            unaltered_by_name(_to_write),
        ),
        given=("linear",),
    ),
    exercise(
        "reconstruction_loss",
        "read, write, compare; then the three pullbacks in reverse. The two dicts of gradients "
        "share no name: {**one, **other} is both",
        reconstruction_loss,
        _to_compare,
        WHOLE,
        (
            Claim("value", "the loss is that of the definition, loop by loop", _compared, 2),
            Claim(
                "gradients of writing",
                "the decoder's gradients are those of central differences of your own loss",
                gradients_of_loss(_to_compare, OF_WRITING),
                2,
            ),
            Claim(
                "gradients of reading",
                "the encoder's gradients are those of central differences of your own loss",
                gradients_of_loss(_to_compare, OF_READING),
                3,
                "the clip is the target too, but a target gets no gradient: all that reaches the "
                "encoder comes through z",
            ),
            keeps_float32(_to_compare, loss_back),
            unaltered_by_name(_to_compare),
        ),
        given=("mean_squared_error",),
    ),
)
