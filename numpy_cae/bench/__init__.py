"""The speed of training and projection, compared with PyTorch and with the paper's minutes.

timing         functions timed alternately: medians and their spread
peak           the speed of a large matrix product on this machine
convolutional  the first network's cases, here and in PyTorch
sequential     the second network's training step, here and in PyTorch
table          the rows and the header of the table
paper          the paper's whole training
quality        the times that trainings need to the same held-out error
convolutional_quality  the first network's training, here and in PyTorch
sequential_quality     the second network's
"""
