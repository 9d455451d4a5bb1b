"""The two networks of the two papers, built from `numpy_cae.ops` alone."""

from numpy_cae.models.conv_autoencoder import ConvAutoencoder
from numpy_cae.models.conv_layer import ConvLayer
from numpy_cae.models.sequential_autoencoder import Losses, SequentialAutoencoder

__all__ = ["ConvAutoencoder", "ConvLayer", "Losses", "SequentialAutoencoder"]
