"""Motion files as a network can use them: Y up, the floor at 0, the twenty joints found."""
