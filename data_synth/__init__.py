"""People that walk, wait and press up, made by formula, written as motion files."""

from data_synth.body import Body, draw_body, make_body
from data_synth.kinds import KINDS, make_take
from data_synth.take import Take

__all__ = ["KINDS", "Body", "Take", "draw_body", "make_body", "make_take"]
