"""The check of one function: its pullback against differences, or against the exact adjoint."""
