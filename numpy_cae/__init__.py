"""Learning motion manifolds, every derivative by hand.

Two papers, implemented in NumPy without an automatic differentiation framework:

- holden2015: Holden, Saito, Komura and Joyce, "Learning Motion Manifolds with Convolutional
  Autoencoders", SIGGRAPH Asia 2015 Technical Briefs.
- jang2018: Jang and Lee, "Latent Motion Manifold with Sequential Auto-Encoders", SCA 2018 posters.

Start reading in `numpy_cae.ops`; `docs/map.md` lists where each equation of the papers is.
"""

__version__ = "0.3.0"
