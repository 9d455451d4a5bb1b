"""The sequential autoencoder of jang2018: one GRU reads a clip into z, another writes it from z.

The weights are a dict of arrays by name:

    encoder_w, encoder_u, encoder_b, encoder_c    the GRU that reads a clip
    latent_w, latent_b                            from its last state to z
    state_w, state_b                              from z to the decoder's first state
    decoder_w, decoder_u, decoder_b, decoder_c    the GRU that writes a clip
    frame_w, frame_b                              from each of its states to a frame

The four arrays of a GRU are arguments of `ops.gru_step`, the two of a map those of `ops.linear`.
Every value is computed by `numpy_cae.ops`, every gradient by the pullbacks in reverse order.
`numpy_cae.fast` computes the same numbers in less time (`accelerate(model)`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from numpy_cae import ops
from numpy_cae.ops.shapes import Pullback, require_shape

Weights = dict[str, np.ndarray]

FRAMES = 50
"""Frames of a clip in the paper."""

GATES = 3
"""Reset, update and new, side by side in the columns of a GRU's weights."""


class Losses(NamedTuple):
    """The training loss `total`, which is reconstruction + λ · discrepancy, and its two terms.

    `reconstruction` is the mean squared error over every element, independent of the clip's length
    and the batch; `discrepancy` is the sliced Wasserstein distance between the batch's latent
    vectors and draws of the prior.

    Examples
    --------
    >>> Losses(total=0.75, reconstruction=0.5, discrepancy=0.25).reconstruction
    0.5
    """

    total: float
    reconstruction: float
    discrepancy: float


class SequentialAutoencoder:
    """Clips of any length to a latent vector z each, and back.

    >>> model = SequentialAutoencoder(features=54, hidden=128, latent=8)
    >>> z = model.encode(np.zeros((16, 50, 54), np.float32))  # 16 clips of 2 seconds
    >>> z.shape, model.decode(z).shape
    ((16, 8), (16, 50, 54))

    We take the standard normal distribution as prior of z; jang2018 does not state which.

    Every method raises ValueError, naming the argument, if a shape does not fit or is empty.

    Parameters
    ----------
    features : int
        Numbers of a frame, 54 in the paper.
    hidden : int
        Units of each GRU. The paper does not state the number; MBR17 (Martinez, Black and Romero,
        2017), from which it takes the decoder, has 1024.
    latent : int
        Dimensions of z. The paper does not state the number.
    rng : numpy.random.Generator, optional
        Draws the initial weights; by default a generator with seed 0.
    dtype : float32 (for training) or float64 (for checking gradients)
    burn_in : int
        Steps that the decoder makes before the first frame of a clip; see `decode_with_pullback`.

    Attributes
    ----------
    weights : dict of name to array
        Training changes the arrays in place.

    Examples
    --------
    A loss and the gradients, by the names of the weights:

    >>> rng = np.random.default_rng(0)
    >>> model = SequentialAutoencoder(features=3, hidden=4, latent=2)
    >>> x, prior = np.zeros((5, 6, 3), np.float32), rng.standard_normal((5, 2))
    >>> losses, gradients = model.loss_and_gradients(x, prior, directions=np.eye(2), weight=1.0)
    >>> list(gradients) == list(model.weights), gradients["latent_w"].shape
    (True, (4, 2))
    """

    def __init__(
        self,
        features: int = 54,
        hidden: int = 128,
        latent: int = 8,
        rng: np.random.Generator | None = None,
        dtype: np.dtype | type = np.float32,
        burn_in: int = 0,
    ):
        rng = rng or np.random.default_rng(0)
        self.weights: Weights = initial_weights(features, hidden, latent, rng, dtype)
        self.burn_in = burn_in

    @property
    def features(self) -> int:
        """Numbers of a frame."""
        return self.weights["frame_b"].size

    @property
    def hidden(self) -> int:
        """Units of each GRU."""
        return self.weights["state_b"].size

    @property
    def latent(self) -> int:
        """Dimensions of z."""
        return self.weights["latent_b"].size

    def encode(self, x: np.ndarray) -> np.ndarray:
        """Normalised clips (B, T, features), in the order of time, to z (B, latent)."""
        z, _ = self.encode_with_pullback(x)
        return z

    def decode(self, z: np.ndarray, frames: int = FRAMES) -> np.ndarray:
        """z (B, latent) to clips (B, frames, features) in the order of time."""
        x_hat, _ = self.decode_with_pullback(z, frames)
        return x_hat

    def denoise(self, x: np.ndarray) -> np.ndarray:
        """The clip on the manifold that represents x: (B, T, features) to the same."""
        return self.decode(self.encode(x), x.shape[1])

    def sample(self, n: int, rng: np.random.Generator, frames: int = FRAMES) -> np.ndarray:
        """Clips (n, frames, features) of n draws from the prior, the standard normal."""
        z = rng.standard_normal((n, self.latent)).astype(self.weights["state_w"].dtype)
        return self.decode(z, frames)

    def encode_with_pullback(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """z = h_T · W + b, where h_1, …, h_T are the GRU's states over the clip and h_0 = 0.

        z depends on the clip through the last state alone, so its gradient enters there:

            dh_T = dz · Wᵀ,   dh_t = 0 from the loss for every t < T

        and the pullback of `ops.gru` propagates it back through time. dx and dh_0 are not
        returned: x is data, and h_0 is no parameter.

        Parameters
        ----------
        x : (B, T, features) array of float

        Returns
        -------
        z : (B, latent) array
        pullback : dz -> gradients by name
        """
        require_clips("x", x, self.weights)
        h, read_pullback = self._read(x)
        z, latent_pullback = ops.linear(h, self.weights["latent_w"], self.weights["latent_b"])

        def pullback(dz: np.ndarray) -> Weights:
            dh, dw, db = latent_pullback(dz)
            return {**read_pullback(dh), "latent_w": dw, "latent_b": db}

        return z, pullback

    def _read(self, x: np.ndarray) -> tuple[np.ndarray, Pullback]:
        """h_T of the encoder, and the pullback that takes dh_T to the gradients by name."""
        weights = gru_weights(self.weights, "encoder")
        h0 = np.zeros((len(x), self.hidden), weights[0].dtype)
        states, gru_pullback = ops.gru(x, h0, *weights)

        def pullback(dh: np.ndarray) -> Weights:
            d_states = np.zeros_like(states)
            d_states[:, -1] = dh
            _, _, *gradients = gru_pullback(d_states)
            return name_gradients("encoder", gradients)

        return states[:, -1], pullback

    def decode_with_pullback(
        self, z: np.ndarray, frames: int = FRAMES
    ) -> tuple[np.ndarray, Pullback]:
        """Decode z into a clip. The input of each step is the frame that the previous step wrote.

            h_0 = z · W_state + b_state,   y_0 = 0
            h_k = gru_step(y_(k-1), h_(k-1)),   y_k = h_k · W_frame + b_frame    for k = 1, …, S + T
            x̂_t = y_(S+T+1-t)                                                    for t = 1, …, T

        y_0 is zero, the mean pose; the decoder never sees frames of the input clip. It writes the
        last frame first: the last line reverses the order, so callers see the order of time. The
        first S = `burn_in` frames are fed back but not part of the clip: it takes the decoder,
        which starts from a zero frame and a state that is linear in z, a few steps to reach a pose
        and a facing direction.

        The frame y_k acts on the loss along two paths: it is compared with the source, and it is
        the input of step k + 1. The state h_k also acts along two: through its frame y_k, and as
        the state that step k + 1 starts from. So, from the last step to the first,

            dy_k = dx̂_(S+T+1-k) + (the dx that step k + 1's pullback returns; 0 after the last)
            dh_k = dy_k · W_frameᵀ + (the dh that step k + 1's pullback returns; 0 after the last)
            dx, dh, dW, dU, db, dc    from the pullback of step k at dh_k

        The frames up to S are not compared: the first term of their dy_k is 0. dx of step 1 is for
        the constant y_0 and is dropped; dh of step 1 is dh_0, and

            dz = dh_0 · W_stateᵀ

        Every step uses the same weights: their gradients are sums over the steps.

        Parameters
        ----------
        z : (B, latent) array of float
        frames : int
            T, at least 1.

        Returns
        -------
        x_hat : (B, T, features) array
        pullback : dx_hat -> (dz, gradients by name)
        """
        require_latent(z, frames, self.weights)
        h, state_pullback = ops.linear(z, self.weights["state_w"], self.weights["state_b"])
        written, write_pullback = self._write_frames(h, self.burn_in + frames)
        x_hat = np.stack(written[: -frames - 1 : -1], axis=1)  # the last T, the last one first

        def pullback(dx_hat: np.ndarray) -> tuple[np.ndarray, Weights]:
            d_written = [np.zeros_like(dx_hat[:, 0])] * self.burn_in
            d_written += [dx_hat[:, t] for t in reversed(range(frames))]
            dh, step_gradients = write_pullback(d_written)
            dz, d_state_w, d_state_b = state_pullback(dh)
            return dz, {"state_w": d_state_w, "state_b": d_state_b, **step_gradients}

        return x_hat, pullback

    def _write_frames(self, h: np.ndarray, steps: int) -> tuple[Sequence[np.ndarray], Pullback]:
        """y_1, y_2, … from h_0, and the pullback that takes their gradients to dh_0 and the
        gradients by name; the equations are those of `decode_with_pullback`."""
        gru = gru_weights(self.weights, "decoder")
        frame = self.weights["frame_w"], self.weights["frame_b"]
        y = np.zeros((len(h), self.features), h.dtype)
        written = []
        pullbacks = []
        for _ in range(steps):
            h, step_pullback = ops.gru_step(y, h, *gru)
            y, frame_pullback = ops.linear(h, *frame)
            written.append(y)
            pullbacks.append((step_pullback, frame_pullback))

        def pullback(d_written: Sequence[np.ndarray]) -> tuple[np.ndarray, Weights]:
            d_gru = [np.zeros_like(weight) for weight in gru]
            d_frame = [np.zeros_like(weight) for weight in frame]
            dy_fed = np.zeros_like(y)
            dh = np.zeros_like(h)
            for k in reversed(range(steps)):
                step_pullback, frame_pullback = pullbacks[k]
                dh_through_frame, *frame_terms = frame_pullback(d_written[k] + dy_fed)
                dy_fed, dh, *gru_terms = step_pullback(dh + dh_through_frame)
                for total, term in zip(d_gru, gru_terms, strict=True):
                    total += term
                for total, term in zip(d_frame, frame_terms, strict=True):
                    total += term
            d_frame_w, d_frame_b = d_frame
            gradients = name_gradients("decoder", d_gru)
            return dh, {**gradients, "frame_w": d_frame_w, "frame_b": d_frame_b}

        return written, pullback

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """mean((x̂ - x)²) + λ · sliced_wasserstein(z, prior, directions), and its derivatives.

        z acts along two paths, as the input of the decoder and as a point that is compared with
        the prior, so its gradient is the sum of both.

        Parameters
        ----------
        x : (B, T, features) array of float
        prior : (B, latent) array of float, draws of the prior
        directions : (L, latent) array of float, rows of length 1
        weight : float, λ

        Returns
        -------
        losses : Losses
        gradients : dict of name to array
            In the order of `weights`.
        """
        if len(x) == 0:
            raise ValueError(f"x has shape {x.shape}: there is nothing to compare")
        z, encode_pullback = self.encode_with_pullback(x)  # (B, latent)
        x_hat, decode_pullback = self.decode_with_pullback(z, x.shape[1])  # (B, T, features)
        reconstruction, error_pullback = ops.mean_squared_error(x_hat, x)
        discrepancy, prior_pullback = ops.sliced_wasserstein(z, prior, directions)
        total = reconstruction + weight * discrepancy

        # dz is (B, latent), the gradients of the decoder are a dict by the names of its weights.
        dz, decoder_gradients = decode_pullback(error_pullback())
        encoder_gradients = encode_pullback(dz + prior_pullback(weight))
        losses = Losses(float(total), float(reconstruction), float(discrepancy))
        return losses, {**encoder_gradients, **decoder_gradients}


def weight_shapes(features: int, hidden: int, latent: int) -> dict[str, tuple[int, ...]]:
    """The shape of every weight by name, in the order in which they are kept."""
    gates = GATES * hidden
    gru_shapes = {"w": (features, gates), "u": (hidden, gates), "b": (gates,), "c": (gates,)}
    return {
        **{f"encoder_{letter}": shape for letter, shape in gru_shapes.items()},
        "latent_w": (hidden, latent),
        "latent_b": (latent,),
        "state_w": (latent, hidden),
        "state_b": (hidden,),
        **{f"decoder_{letter}": shape for letter, shape in gru_shapes.items()},
        "frame_w": (hidden, features),
        "frame_b": (features,),
    }


def initial_weights(
    features: int, hidden: int, latent: int, rng: np.random.Generator, dtype: np.dtype | type
) -> Weights:
    """Random matrices by fan-in and fan-out; orthogonal recurrent matrices; biases zero, except
    those of the update gates, which are 1.

    As in `ConvLayer.initial`, W is uniform within ±√(6 / (fan_in + fan_out)). Each gate is a map of
    its own, so its fan-out is H and not the 3H columns that the three share. Two choices let a
    gradient survive fifty steps: each gate's recurrent matrix is orthogonal (Saxe et al., 2014),
    and the update gate's bias is 1, so that h' = (1 - z) ∘ n + z ∘ h mostly keeps h at first (here
    z is the update gate, not the latent vector).
    """
    shapes = weight_shapes(features, hidden, latent)
    weights = {name: np.zeros(shape, dtype) for name, shape in shapes.items()}

    def draw_uniform(name: str, fan_out: int) -> None:
        width = np.sqrt(6 / (len(weights[name]) + fan_out))
        weights[name][...] = rng.uniform(-width, width, size=shapes[name])

    def draw_gru(name: str) -> None:
        draw_uniform(f"{name}_w", fan_out=hidden)
        gates = [np.linalg.qr(rng.standard_normal((hidden, hidden)))[0] for _ in range(GATES)]
        weights[f"{name}_u"][...] = np.hstack(gates)
        weights[f"{name}_b"][hidden : 2 * hidden] = 1  # the update gate's

    draw_gru("encoder")
    draw_uniform("latent_w", fan_out=latent)
    draw_uniform("state_w", fan_out=hidden)
    draw_gru("decoder")
    draw_uniform("frame_w", fan_out=features)
    return weights


def gru_weights(weights: Weights, name: str) -> tuple[np.ndarray, ...]:
    """W, U, b and c of the "encoder" or the "decoder", in the order of `ops.gru_step`."""
    return tuple(weights[f"{name}_{letter}"] for letter in "wubc")


def name_gradients(gru: str, gradients: list[np.ndarray]) -> Weights:
    """dW, dU, db and dc of the "encoder" or the "decoder", by name."""
    return {f"{gru}_{letter}": d for letter, d in zip("wubc", gradients, strict=True)}


def require_clips(name: str, x: np.ndarray, weights: Weights) -> None:
    """Raise ValueError unless the encoder can read x."""
    require_shape(name, x, ("batch", "frames", len(weights["encoder_w"])))
    if x.shape[1] == 0:
        raise ValueError(f"{name} has shape {x.shape}: a clip has at least one frame")


def require_latent(z: np.ndarray, frames: int, weights: Weights) -> None:
    """Raise ValueError unless the decoder can write this number of frames from z."""
    require_shape("z", z, ("batch", len(weights["state_w"])))
    if frames < 1:
        raise ValueError(f"frames is {frames}, expected at least 1")
