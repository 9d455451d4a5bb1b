"""The ablation of holden2015: every choice of its network and training, left out or replaced."""
