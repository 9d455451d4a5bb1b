"""What the training loop calls between its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from numpy_cae.training.loop import Loop


class Callback:
    """Called by `Loop.run`; each method does nothing unless it is overridden."""

    def begin(self, loop: Loop) -> None:
        """A stage begins, or continues after an interruption."""

    def after_step(self, loop: Loop) -> None:
        """A step was made: `loop.loss` and `loop.rate` are its own."""

    def after_epoch(self, loop: Loop, loss: float) -> None:
        """An epoch ended with this mean loss; `loop.at.epoch` epochs are done."""

    def end(self) -> None:
        """The stage has ended, perhaps with an error."""
