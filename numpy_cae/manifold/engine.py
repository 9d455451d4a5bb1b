"""The choice of what computes a manifold's network."""

from __future__ import annotations

from typing import TypeVar

from numpy_cae.fast import accelerate

Network = TypeVar("Network")


def with_engine(network: Network, engine: str) -> Network:
    """The network accelerated for "fast", unchanged for "ops", the definitions.

    Raises
    ------
    ValueError
        For another engine.
    """
    if engine not in ("fast", "ops"):
        raise ValueError(f"engine is {engine!r}, expected 'fast' or 'ops'")
    return accelerate(network) if engine == "fast" else network
