"""Train the network of the finale of lesson 11: that of the lesson, longer, on more walks.

The walks on which the lesson measures are not learned from: they have the seed 10, these 110. It
takes about five minutes of one core.

    python -m tools.longer_walks
"""

import time
from pathlib import Path

from data_synth import make_takes
from numpy_cae.manifold import learn_sequences
from numpy_cae.mocap import angles_of
from numpy_cae.training import SequenceSchedule

FILE = Path(__file__).parents[1] / "numpy_cae" / "course" / "longer_walks.npz"
MINUTES, HIDDEN, LATENT, FRAMES = 30, 64, 8, 25
SCHEDULE = SequenceSchedule(
    epochs=160, steps=50, rate=0.004, batch=64, weight=0.1, optimiser="adam",
    rate_schedule="one-cycle",
)  # fmt: skip

if __name__ == "__main__":
    began, epochs = time.process_time(), SCHEDULE.epochs
    takes = make_takes(MINUTES, seed=110, rate=25, kinds=["walking"])
    manifold = learn_sequences(
        [angles_of(take.motion) for take in takes],
        SCHEDULE,
        report=lambda state: None,
        hidden=HIDDEN,
        latent=LATENT,
        burn_in=0,
        frames=FRAMES,
    )
    manifold.save(FILE, half=True)
    print(f"{FILE}: {time.process_time() - began:.0f} s of processor time")
