"""`SequentialAutoencoder` at speed: both GRUs by one recurrence, each thread with some clips.

`ops.gru_step` with a = x · W + b and s = h · U + c, where every column is a clip. What a step
computes from is v, (4H, B), whose four parts are

    v = (s_n, a_r + s_r, a_z + s_z, a_n)

so its first three are rows of Uᵀ h + c, with those of "new" first, and its last three rows of
Wᵀ x + b. A step stores in place of v the factors of its gradient; with d = h - n and dh the
gradient for the state after the step,

    factors = (r,  s_n ∘ r ∘ (1 - r),  d ∘ z ∘ (1 - z),  (1 - z) ∘ (1 - n²))
    dv      = factors ∘ (da_n, da_n, dh, dh)
    dh      ← z ∘ dh + U · ds

where ds is the first three parts of dv, and da the last three.

**The frames of all steps are one product.** The encoder's are known before its first step: Wᵀ x + b
of all of them are `input_terms`. The decoder's are a map of its states, y = Fᵀ h + e, so a step
needs no frame, only more columns beside U:

    Wᵀ y + b = (F W)ᵀ h + (Wᵀ e + b)

Its first input is zero, not the frame of h_0, so what that frame adds is subtracted from the first
step's `input_terms`. The gradients of all weights are products over every step and clip at once.
"""

from collections.abc import Callable, Sequence

import numpy as np

from numpy_cae.fast.products import aligned_empty, multiply_rows
from numpy_cae.fast.thread_team import one_blas_thread, share, thread_team
from numpy_cae.models import Losses, SequentialAutoencoder, sequential_autoencoder
from numpy_cae.models.sequential_autoencoder import FRAMES, Weights, gru_weights
from numpy_cae.ops.shapes import Pullback

MIN_STATES_PER_THREAD = 2048
"""A thread has at least this many numbers of states. With fewer, one thread alone is faster: the
threads wait for the interpreter lock, and a product of 8 columns takes as long as one of 16.
Measured on one machine, with AVX-512."""

MAX_CLIPS = 128
"""At most this many clips are computed at a time when no gradient is needed."""


class FastSequentialAutoencoder(SequentialAutoencoder):
    """The methods of a `SequentialAutoencoder` on its own weights.

    See `accelerate` for the parameters. `weights` is the model's own dict.
    """

    def __init__(self, model: SequentialAutoencoder, threads: int | None = None):
        self.weights = model.weights
        self.burn_in = model.burn_in
        self._threads = threads

    def encode(self, x: np.ndarray) -> np.ndarray:
        """z of clips, as `SequentialAutoencoder.encode`."""
        sequential_autoencoder.require_clips("x", x, self.weights)
        return _in_parts(super().encode, x)

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """Clips of z, as `SequentialAutoencoder.decode`."""
        sequential_autoencoder.require_latent(z, frames, self.weights)
        decode = super().decode
        return _in_parts(lambda part: decode(part, frames), z)

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """The loss and its derivatives, as `SequentialAutoencoder.loss_and_gradients`."""
        with one_blas_thread():
            return super().loss_and_gradients(x, prior, directions, weight)

    def _read(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        h, pullback = self._by_threads(lambda clips: read(clips, self.weights), x)
        return h, lambda dh: pullback(dh)[1]

    def _write_frames(self, h: np.ndarray, steps: int) -> tuple[Sequence[np.ndarray], Pullback]:
        y, pullback = self._by_threads(lambda h0: write(h0, steps, self.weights), h)
        return list(y.swapaxes(0, 1)), lambda d_written: pullback(np.stack(d_written, axis=1))

    def _by_threads(self, compute: Callable, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """`compute`, which returns a value and a pullback to dh_0 and gradients, of clips x."""
        most = len(x) * self.hidden // MIN_STATES_PER_THREAD
        team = thread_team(max(1, min(thread_team(self._threads).size, most, len(x))))
        clips = [share(len(x), number, team.size) for number in range(team.size)]
        results = team.run(lambda number: compute(x[clips[number]]))
        values = [value for value, _ in results]
        pullbacks = [pullback for _, pullback in results]

        def pullback(dy: np.ndarray) -> tuple[np.ndarray, Weights]:
            pulled = team.run(lambda number: pullbacks[number](dy[clips[number]]))
            totals = pulled[0][1]
            for _, gradients in pulled[1:]:
                for name, gradient in gradients.items():
                    totals[name] += gradient
            return np.concatenate([dh0 for dh0, _ in pulled]), totals

        return np.concatenate(values), pullback


def _in_parts(compute: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    with one_blas_thread():
        starts = range(0, max(len(x), 1), MAX_CLIPS)
        return np.concatenate([compute(x[start : start + MAX_CLIPS]) for start in starts])


def read(x: np.ndarray, weights: Weights) -> tuple[np.ndarray, Pullback]:
    """h_T (B, H) of clips (B, T, F), and dh_T -> (dh_0, gradients by name)."""
    w, u, b, c = gru_weights(weights, "encoder")
    hidden = len(u)
    frames = x.transpose(1, 2, 0)
    input_terms = aligned_empty((len(frames), 4 * hidden, len(x)), np.result_type(x, w))
    input_terms[...] = _biases(b, c)
    input_terms[:, hidden:] += w.T @ frames
    states, states_pullback = recurrence(input_terms, _new_first(u), np.zeros((hidden, len(x))))

    def pullback(dh: np.ndarray) -> tuple[np.ndarray, Weights]:
        dh0, dv = states_pullback([0] * (len(frames) - 1) + [dh.T])
        return dh0.T, _gradients("encoder", frames, states, dv)

    return states[-1].T, pullback


def write(h0: np.ndarray, steps: int, weights: Weights) -> tuple[np.ndarray, Pullback]:
    """y_1, …, y_T (B, T, F) from h_0 (B, H), and dy -> (dh_0, gradients by name)."""
    w, u, b, c = gru_weights(weights, "decoder")
    frame_w = weights["frame_w"]
    frame_b = weights["frame_b"]
    batch, hidden = h0.shape
    input_terms = aligned_empty((steps, 4 * hidden, batch), np.result_type(h0, w))
    input_terms[...] = _biases(b + frame_b @ w, c)
    input_terms[0, hidden:] -= w.T @ (frame_w.T @ h0.T + frame_b[:, None])
    u_and_fed = aligned_empty((hidden, 4 * hidden), input_terms.dtype)
    u_and_fed[:, : 3 * hidden] = _new_first(u)
    u_and_fed[:, 3 * hidden :] = 0
    u_and_fed[:, hidden:] += frame_w @ w
    states, states_pullback = recurrence(input_terms, u_and_fed, h0.T)
    frames = frame_w.T @ states + frame_b[:, None]
    frames[0] = 0

    def pullback(dy: np.ndarray) -> tuple[np.ndarray, Weights]:
        dy = dy.transpose(1, 2, 0)
        dh0, dv = states_pullback(frame_w @ dy)
        d_fed = w @ dv[hidden:].reshape(3 * hidden, -1)
        dh0 -= frame_w @ d_fed[:, :batch]
        dy = _over_steps(dy)
        dy[:, :-batch] += d_fed[:, batch:]
        of_frame = {"frame_w": _over_steps(states[1:]) @ dy.T, "frame_b": dy.sum(axis=1)}
        return dh0.T, _gradients("decoder", frames[:-1], states, dv) | of_frame

    return frames[1:].transpose(2, 0, 1), pullback


def recurrence(
    input_terms: np.ndarray, u: np.ndarray, h0: np.ndarray
) -> tuple[np.ndarray, Pullback]:
    """The states (T + 1, H, B) from h_0 (H, B); a product with uᵀ is added to `input_terms`.

    Parameters
    ----------
    input_terms : (T, 4H, B) array
        Becomes the factors of the gradients.
    u : (H, 3H or 4H) array

    Returns
    -------
    states : (T + 1, H, B) array
    pullback : d_states -> (dh_0, dv)
        From what the loss adds to the gradients of h_1, …, h_T; dv is (4H, T, B).
    """
    steps, rows, batch = input_terms.shape
    factors = input_terms.reshape(steps, 4, len(u), batch)
    states = aligned_empty((steps + 1, len(u), batch), input_terms.dtype)
    states[0] = h0
    updates = aligned_empty((steps, len(u), batch), input_terms.dtype)
    u_transposed = aligned_empty(u.shape[::-1], input_terms.dtype)
    for start in range(0, len(u), 16):  # all in one call take two to three times as long
        u_transposed[:, start : start + 16] = u[start : start + 16].T
    product = aligned_empty((u.shape[1], batch), input_terms.dtype)
    for k in range(steps):
        multiply_rows(u_transposed, states[k], product)
        input_terms[k, : u.shape[1]] += product
        states[k + 1], updates[k] = _step(factors[k], states[k])

    def pullback(d_states: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        dv = aligned_empty((rows, steps, batch), input_terms.dtype)
        dv_step = aligned_empty((4, len(u), batch), input_terms.dtype)
        dh_through_s = aligned_empty((len(u), batch), input_terms.dtype)
        dh = np.zeros_like(dh_through_s)
        for k in reversed(range(steps)):
            dh += d_states[k]
            np.multiply(factors[k, 2:], dh, out=dv_step[2:])
            np.multiply(factors[k, :2], dv_step[3], out=dv_step[:2])
            dv[:, k] = dv_step.reshape(rows, batch)
            multiply_rows(u, dv_step.reshape(rows, batch)[: u.shape[1]], dh_through_s)
            dh *= updates[k]
            dh += dh_through_s
        return dh, dv

    return states, pullback


def _step(v: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """h after the step, and z; v becomes the factors."""
    s_n, of_r, of_z, of_n = v
    r_and_z = 0.5 * np.tanh(0.5 * v[1:3]) + 0.5
    r, z = r_and_z
    n = np.tanh(of_n + r * s_n)
    d = h - n
    rest = 1 - r_and_z
    np.multiply(r_and_z, rest, out=v[1:3])
    of_r *= s_n
    of_z *= d
    np.multiply(1 - n * n, rest[1], out=of_n)
    s_n[...] = r
    return n + z * d, z


def _new_first(columns: np.ndarray) -> np.ndarray:
    """The columns of reset, update and new in the order new, reset, update."""
    return np.roll(columns, columns.shape[-1] // 3, axis=-1)


def _biases(b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """What b and c add to v, (4H, 1)."""
    hidden = len(b) // 3
    return (np.pad(_new_first(c), (0, hidden)) + np.pad(b, (hidden, 0)))[:, None]


def _gradients(name: str, frames: np.ndarray, states: np.ndarray, dv: np.ndarray) -> Weights:
    """dW, dU, db and dc by name; `frames` (T, F, B) are the inputs of the steps."""
    hidden = states.shape[1]
    dv = dv.reshape(len(dv), -1)
    sums = dv.sum(axis=1)
    du = _over_steps(states[:-1]) @ dv[: 3 * hidden].T
    return {
        f"{name}_w": _over_steps(frames) @ dv[hidden:].T,
        f"{name}_u": np.roll(du, -hidden, axis=1),
        f"{name}_b": sums[hidden:],
        f"{name}_c": np.roll(sums[: 3 * hidden], -hidden),
    }


def _over_steps(array: np.ndarray) -> np.ndarray:
    """(T, rows, B) as (rows, T · B)."""
    return array.swapaxes(0, 1).reshape(array.shape[1], -1)
