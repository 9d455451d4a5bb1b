"""Public protocols with published results."""
