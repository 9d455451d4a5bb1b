"""What a sensible person would try instead of a network."""

from numpy_cae.baselines.pca import PCA

__all__ = ["PCA"]
