"""The exercises of lesson 07."""

from __future__ import annotations

from numpy_cae.verify.exercises.exercise import Exercise

EXERCISES: tuple[Exercise, ...] = ()
