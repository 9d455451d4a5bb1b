"""The colours of motions and curves; orange, blue and green as in figure 1 of holden2015."""

CORRUPTED = "#e8833a"
"""Orange, of damaged motions."""
PROJECTED = "#2f6db5"
"""Blue, of projected and repaired motions."""
TRUTH = "#3f9a4b"
"""Green, of true motions."""
PLAIN = "#444444"
"""Grey, of all others."""
OTHERS = ("#7a4ca0", "#c2378f", "#8c564b", "#6b6b6b", "#9a8a00", "#14908a")
"""Colours of curves that are no projection, no damage and no truth, in their order."""
