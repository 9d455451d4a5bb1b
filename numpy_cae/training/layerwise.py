"""Layer by layer, then all together: the training of holden2015, section 6.

To train a layer, the layers before it first encode the clean motion; the layer then learns to
restore this encoding from a corrupted copy (Vincent 2010). Fine tuning then trains the whole stack
at once. What is random in a step is drawn by `corruption`.
"""

from collections.abc import Callable, Iterator

import numpy as np

from numpy_cae.models import ConvAutoencoder
from numpy_cae.training.corruption import corrupted_copy, unpooling_mask
from numpy_cae.training.loop import Checkpoint, TrainingState
from numpy_cae.training.optimisers import clip_norm
from numpy_cae.training.schedule import Schedule


def train_autoencoder(
    model: ConvAutoencoder,
    windows: np.ndarray,
    schedule: Schedule | None = None,
    rng: np.random.Generator | int = 0,
    report: Callable[[TrainingState], None] | None = None,
    checkpoint: Checkpoint | None = None,
) -> TrainingState:
    """Train a `ConvAutoencoder` in place.

    Runs with one seed on the same number of threads are bit-identical, and so is a run that was
    interrupted and continued from its checkpoint.

    Parameters
    ----------
    model : ConvAutoencoder
        Or what `fast.accelerate` makes of it, which trains faster.
    windows : (N, T, C) array of float
        Normalised motion in the dtype of the model; T is a multiple of `model.stride`.
    schedule : Schedule, optional
        The paper's by default; see `recipe`.
    rng : numpy.random.Generator or int
        Or its seed. It draws the order of the windows, the corruption and the unpooling.
    report : function (TrainingState), optional
        Called after every step, such as `ProgressPrinter()`; it must not draw from `rng`.
    checkpoint : Checkpoint, optional
        Saves the state; an interrupted run continues from it.

    Returns
    -------
    state : TrainingState
        Its `losses` are those of every epoch, by stage.

    Raises
    ------
    DivergedError
        If a loss or a weight is not finite.
    CheckpointError
        If the checkpoint is of another run or cannot be written.

    Examples
    --------
    >>> from numpy_cae.training import Stage
    >>> windows = np.sin(np.arange(320) / 9).reshape(4, 16, 5).astype(np.float32)
    >>> model = ConvAutoencoder(features=5, filters=(6,), taps=3)
    >>> schedule = Schedule(layer=Stage(epochs=3), fine_tuning=Stage(epochs=0))
    >>> losses = train_autoencoder(model, windows, schedule).losses["layer 1"]
    >>> len(losses), losses[-1] < losses[0]
    (3, True)
    """
    schedule = schedule or Schedule()
    state = TrainingState(model.parameters, np.random.default_rng(rng))
    if checkpoint is not None:
        checkpoint.load_into(state, windows, schedule, [layer.bound for layer in model.layers])
    for _ in autoencoder_steps(model, windows, schedule, state):
        if report is not None:
            report(state)
    return state


def autoencoder_steps(
    model: ConvAutoencoder, windows: np.ndarray, schedule: Schedule, state: TrainingState
) -> Iterator[None]:
    """Train from `state` on, and yield after every step: the loop of `train_autoencoder`.

    A step computes the loss of restoring x from X_c, equation 3, and its gradients, and updates the
    weights; if the loss is not finite, no weight is changed. x are clean windows or, when one layer
    is trained, what the layers below it make of them. The paper unpools at random while one layer
    is trained, and evenly while all are.
    """
    by_layer = ((f"layer {n + 1}", n, schedule.layer) for n in range(len(model.layers)))
    stages = (*by_layer, ("fine tuning", None, schedule.fine_tuning))
    for name, number, stage in [each for each in stages if each[-1].epochs][state.stage :]:
        layer = None if number is None else model.layers[number]
        parameters = state.weights if layer is None else {"w": layer.w, "b": layer.b}
        x = hidden_below(model, windows, number) if number else windows
        for step, rate in state.steps_of(name, stage, parameters, len(x)):
            if step == 0:
                state.order = state.rng.permutation(len(x))
            batch = x[state.order[step * stage.batch : (step + 1) * stage.batch]]
            corrupted = corrupted_copy(batch, stage, state.rng)
            first = None if layer is None else [unpooling_mask(batch, layer.b.size, state.rng)]
            loss, of_layers = model.loss_and_gradients(batch, corrupted, stage.alpha, first, number)
            if np.isfinite(loss):
                # dw1, db1, dw2, db2, …: the order of the parameters.
                gradients = [gradient for of_layer in of_layers for gradient in of_layer]
                if stage.norm is not None:
                    clip_norm(gradients, stage.norm)
                state.optimiser.update(gradients, rate)
            state.end_step(loss, batch, rate)
            yield


def hidden_below(model: ConvAutoencoder, windows: np.ndarray, layer: int) -> np.ndarray:
    """The input of a layer but the lowest: what the layers below it make of clean windows.

    They encode 64 windows at a time to save memory.
    """
    parts = [windows[start : start + 64] for start in range(0, len(windows), 64)]
    return np.concatenate([model.encode(part, layer) for part in parts])
