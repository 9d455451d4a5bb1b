"""How fast it is, beside what the machine could do and beside PyTorch where that is installed.

timing         functions timed in turns, medians with their spread
peak           what a matrix product reaches here and now
arithmetic     what the direct form of a step would cost
cases          what is timed: steps of training, encoding, projecting
torch_twin     the same network written in PyTorch, and that it computes the same
table          all of it in a table
sequence       a step of training the sequential autoencoder
sequence_twin  the same network in PyTorch, and that it computes the same
paper          the paper's whole training, beside the paper's minutes
growth         how cost grows with windows, frames and channels
"""
