"""What makes documents, pictures and shipped files: `python -m tools.NAME` in a clone."""
