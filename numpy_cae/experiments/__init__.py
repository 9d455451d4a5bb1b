"""Experiments: one file each, a function `run(manifold, material, seed) -> Result`."""
