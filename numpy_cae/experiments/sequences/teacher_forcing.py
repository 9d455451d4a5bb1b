"""Self-fed against teacher-forced training: what jang2018's "sampling-based method" is for.

Under teacher forcing the decoder's next input is the true frame, not its own. It exists in this
file and nowhere in the network: a contrast, to be measured as the network is used, fed with its
own frames.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from numpy_cae import ops
from numpy_cae.experiments.finding import Finding
from numpy_cae.experiments.sequences.study import Study
from numpy_cae.experiments.table import text_table
from numpy_cae.models import SequentialAutoencoder
from numpy_cae.models.composed_sequence import Losses, encode
from numpy_cae.models.sequence_weights import Weights, gru_weights


class TeacherForced(SequentialAutoencoder):
    """The same network with another loss: true frames go into the decoder while it is trained."""

    def loss_and_gradients(
        self, x: np.ndarray, prior: np.ndarray, directions: np.ndarray, weight: float
    ) -> tuple[Losses, Weights]:
        """As the parent's, of the decoder that is given x_T, …, x_2 where it would feed itself."""
        weights = self.weights
        z, encode_back = encode(weights, x)
        first, state_back = ops.linear(z, weights["state_w"], weights["state_b"])
        written = x[:, ::-1]  # the decoder writes the last frame first
        given = np.concatenate([np.zeros_like(x[:, :1]), written[:, :-1]], axis=1)
        states, gru_back = ops.gru(given, first, *gru_weights(weights, "decoder"))
        frames, frame_back = ops.linear(states, weights["frame_w"], weights["frame_b"])
        error, error_back = ops.mean_squared_error(frames, written)
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


@dataclass(frozen=True)
class TeacherForcing:
    """Held-out error of both, mean square of standardised numbers, decoders fed by themselves."""

    action: str
    self_fed: float
    teacher_forced: float
    title: str = "Self-fed against teacher-forced training"

    def text(self) -> str:
        """For a terminal."""
        rows = [
            ["self-fed", f"{self.self_fed:.3f}"],
            ["teacher-forced", f"{self.teacher_forced:.3f}"],
        ]
        return text_table([f"{self.action}, trained", "mean square, standardised"], rows)

    def findings(self) -> list[Finding]:
        """Whether feeding the decoder its own frames in training is worth it."""
        return [
            Finding(
                "A decoder that is fed its own frames should be trained so (MBR17, jang2018).",
                self.self_fed < self.teacher_forced,
                f"{self.action}: {self.self_fed:.3f} of unit variance trained self-fed, "
                f"{self.teacher_forced:.3f} teacher-forced.",
            )
        ]


def teacher_forcing(self_fed: Study, forced: Study) -> TeacherForcing:
    """Compare two studies of one action; the second was made with `network=TeacherForced`."""
    errors = []
    for each in (self_fed, forced):
        x = each.held_out()
        errors.append(float(np.mean((each.manifold.network.denoise(x) - x) ** 2)))
    return TeacherForcing(self_fed.action.name, *errors)
