"""The solutions of lesson 10, a manifold in sequences."""

import numpy as np

from numpy_cae.ops import gru, gru_step, linear, mean_squared_error


def read_clips(weights, x):
    """From clips to z: the last state of a GRU, made linear; and its pullback."""
    w, u, b, c = (weights[f"encoder_{letter}"] for letter in "wubc")
    start = np.zeros((len(x), len(u)), dtype=u.dtype)
    states, gru_back = gru(x, start, w, u, b, c)
    z, latent_back = linear(states[:, -1], weights["latent_w"], weights["latent_b"])

    def pullback(dz):
        d_states = np.zeros_like(states)
        d_states[:, -1], d_latent_w, d_latent_b = latent_back(dz)
        _, _, dw, du, db, dc = gru_back(d_states)
        return {
            "encoder_w": dw,
            "encoder_u": du,
            "encoder_b": db,
            "encoder_c": dc,
            "latent_w": d_latent_w,
            "latent_b": d_latent_b,
        }

    return z, pullback


def self_fed(h, frames, w, u, b, c, frame_w, frame_b):
    """The frames of a GRU that reads its own last frame, first zeros; and its pullback."""
    frame = np.zeros((len(h), len(frame_b)), dtype=h.dtype)
    written, step_backs, frame_backs = [], [], []
    for _ in range(frames):
        h, step_back = gru_step(frame, h, w, u, b, c)
        frame, frame_back = linear(h, frame_w, frame_b)
        written.append(frame)
        step_backs.append(step_back)
        frame_backs.append(frame_back)

    def pullback(dy):
        totals = [np.zeros_like(each) for each in (w, u, b, c, frame_w, frame_b)]
        d_fed, dh = np.zeros_like(frame), np.zeros_like(h)
        for k in reversed(range(frames)):
            dh_of_frame, *of_frame = frame_backs[k](dy[:, k] + d_fed)
            d_fed, dh, *of_step = step_backs[k](dh_of_frame + dh)
            for total, part in zip(totals, of_step + of_frame, strict=True):
                total += part
        return (dh, *totals)

    return np.stack(written, axis=1), pullback


def write_clips(weights, z, frames):
    """From z to clips, written from the last frame to the first; and its pullback."""
    names = [f"decoder_{letter}" for letter in "wubc"] + ["frame_w", "frame_b"]
    h, state_back = linear(z, weights["state_w"], weights["state_b"])
    written, loop_back = self_fed(h, frames, *(weights[name] for name in names))

    def pullback(dx_hat):
        dh, *of_loop = loop_back(dx_hat[:, ::-1])
        dz, d_state_w, d_state_b = state_back(dh)
        gradients = dict(zip(names, of_loop, strict=True))
        return dz, {"state_w": d_state_w, "state_b": d_state_b, **gradients}

    return written[:, ::-1], pullback


def reconstruction_loss(weights, x):
    """The mean squared error of reconstructed clips, and its gradients by name."""
    z, read_back = read_clips(weights, x)
    x_hat, write_back = write_clips(weights, z, x.shape[1])
    loss, error_back = mean_squared_error(x_hat, x)
    dz, of_writing = write_back(error_back())
    return loss, {**read_back(dz), **of_writing}
