"""Learning motion manifolds, every derivative by hand.

Two papers, implemented whole in NumPy without an autodiff framework:

- holden2015: Holden, Saito, Komura and Joyce, "Learning Motion Manifolds with Convolutional
  Autoencoders", SIGGRAPH Asia 2015 Technical Briefs.
- jang2018: Jang and Lee, "Latent Motion Manifold with Sequential Auto-Encoders", SCA 2018 posters.

Start reading in `numpy_cae.ops`; `lessons/papers_to_code.md` maps every equation to its name here.
"""
