"""The reference solutions of the exercises; the operations are in `ops`.

Each function has the text of the solution in the instructor's notebook, which a test compares.
`known_mistakes` has patches of these texts.
"""
