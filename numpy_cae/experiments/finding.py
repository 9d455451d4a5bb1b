"""What an experiment found: a claim of a paper, whether it held on our data, and the figure."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Finding:
    """One claim, weighed.

    Parameters
    ----------
    claim : str
        In a sentence, with its source: "After projection the motion is effectively recovered
        (holden2015, section 7)."
    held : bool
    measured : str
        The figures that decide, in a sentence.
    """

    claim: str
    held: bool
    measured: str

    def text(self) -> str:
        """One line for a terminal."""
        return f"{'held' if self.held else 'not held'}: {self.claim} Measured: {self.measured}"
