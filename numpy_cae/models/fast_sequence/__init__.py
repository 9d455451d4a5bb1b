"""The sequential autoencoder at speed: the numbers of `models.composed_sequence` in another order.

Arrays are (units, batch) here, one after the other in time: a step of a GRU is then U · h with h
narrow, which BLAS does at twice the speed of h · U. From the inside out:

recurrence   a GRU's steps, forwards and backwards, in buffers that are allocated once
matrices     the weights, laid out for one product a step
member       one thread's share of the clips: reads, writes, compares, and goes back
network      encode, decode, and the loss with its gradients, over all members
"""

from numpy_cae.models.fast_sequence.network import FastSequence

__all__ = ["FastSequence"]
