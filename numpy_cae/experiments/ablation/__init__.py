"""Experiments: ablation."""
