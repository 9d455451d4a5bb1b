"""People that walk, wait and press up, made by formula, written as motion files."""
