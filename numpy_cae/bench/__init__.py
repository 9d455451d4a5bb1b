"""The speed of training and projection, compared with the machine's limit and with PyTorch.

timing         functions timed alternately: medians and their spread
peak           the speed of a large matrix product on this machine
arithmetic     the operations of a training step in direct form
convolutional  the first network's cases, here and in PyTorch
sequential     the second network's training step, here and in PyTorch
table          the rows and the header of the table
paper          the paper's whole training, compared with the paper's minutes
"""
