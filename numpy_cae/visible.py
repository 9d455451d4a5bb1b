"""Names as text that cannot disturb what shows them: a terminal, a page, a spreadsheet."""

import unicodedata

FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20")
"""A spreadsheet takes a cell that begins with one of these for a formula; the last four
are the wide forms of the first four."""


def visible(text: str) -> str:
    r"""The text with every character that shows nothing written as an escape such as \x1b.

    These are control characters, marks that turn the direction of writing, and the halves of
    characters that stand for bytes that are not UTF-8. Tabs and ends of lines are unchanged.

    Examples
    --------
    >>> print(visible("walk\x1b[2J\u202e\udce9.bvh"))
    walk\x1b[2J\u202e\udce9.bvh
    """
    hidden = {c for c in set(text) - {"\n", "\t"} if not c.isprintable()}
    hidden = {c for c in hidden if unicodedata.category(c) != "Zs"}  # such as a narrow space
    return text.translate({ord(c): ascii(c)[1:-1] for c in hidden})


def csv_cell(text: str) -> str:
    """The visible text of a cell, quoted if a spreadsheet would take the cell for a formula.

    Examples
    --------
    >>> csv_cell("=1+1"), csv_cell("hips")
    ("'=1+1", 'hips')
    """
    shown = visible(text)
    return f"'{shown}" if text.startswith(FORMULA) else shown
