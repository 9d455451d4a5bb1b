"""Motion files as text and a `Motion`: in the axes of the file, on its own joints."""
