"""The colours of holden2015, figure 1."""

CORRUPTED = "#e8833a"
PROJECTED = "#2f6db5"
TRUTH = "#3f9a4b"
PLAIN = "#444444"
