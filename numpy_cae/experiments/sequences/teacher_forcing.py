"""Self-fed against teacher-forced training: the benefit of jang2018's "sampling-based method".

Under teacher forcing the decoder's next input is the true frame instead of its own. Both networks
are measured in the way they are used: fed with their own frames.
"""

import numpy as np

from numpy_cae import ops
from numpy_cae.experiments.result import Claim, Result, Table
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.models.sequential_autoencoder import Losses, Weights, gru_weights


class TeacherForced(SequentialAutoencoder):
    """The same network whose loss feeds the decoder the true frames; without a burn-in, which has
    no true frames."""

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """As the parent's, but the decoder's inputs are 0, x_T, …, x_2."""
        weights = self.weights
        z, encode_back = self.encode_with_pullback(x)
        first, state_back = ops.linear(z, weights["state_w"], weights["state_b"])
        target = x[:, ::-1]  # the decoder writes the last frame first
        inputs = np.concatenate([np.zeros_like(x[:, :1]), target[:, :-1]], axis=1)
        states, gru_back = ops.gru(inputs, first, *gru_weights(weights, "decoder"))
        frames, frame_back = ops.linear(states, weights["frame_w"], weights["frame_b"])
        error, error_back = ops.mean_squared_error(frames, target)
        distance, distance_back = ops.sliced_wasserstein(z, prior, directions)

        d_states, frame_w, frame_b = frame_back(error_back())
        _, d_first, *of_gru = gru_back(d_states)
        dz, state_w, state_b = state_back(d_first)
        gradients = encode_back(dz + distance_back(weight))
        gradients |= {f"decoder_{n}": d for n, d in zip("wubc", of_gru, strict=True)}
        gradients |= {"state_w": state_w, "state_b": state_b}
        gradients |= {"frame_w": frame_w, "frame_b": frame_b}
        losses = Losses(float(error + weight * distance), float(error), float(distance))
        return losses, {name: gradients[name] for name in weights}


def teacher_forcing(self_fed: Study, forced: Study) -> Result:
    """Compare two studies of one action; the second was trained with `network=TeacherForced`."""
    action = self_fed.action.name
    own, given = self_fed.squared_error(), forced.squared_error()
    rows = [["self-fed", own], ["teacher-forced", given]]
    claim = Claim(
        "A decoder that is fed its own frames should be trained so (MBR17, jang2018).",
        own < given,
        f"{action}: {own:.3f} of unit variance trained self-fed, {given:.3f} teacher-forced.",
    )
    table = Table("", [f"{action}, trained", "mean square, standardised"], rows, ".3f")
    return Result("Self-fed against teacher-forced training", [table], [claim])
