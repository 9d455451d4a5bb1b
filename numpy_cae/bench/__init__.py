"""The speed of training and projection, compared with PyTorch and with the paper's minutes."""
