"""What a report says of a student's code: exceptions and other text, cut and made printable."""

import traceback

LONGEST_TEXT = 2000


def described(error: BaseException, file: str = "") -> str:
    """An exception's type, message and line in a file, whatever its class does."""
    try:
        text = f"{type(error).__name__}: {error}"[: LONGEST_TEXT // 2]
    except Exception:
        text = f"{type(error).__name__}, whose message cannot be printed"
    if isinstance(error, SystemExit):
        text = "it calls sys.exit"
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == file]
    return f"{text} (line {lines[-1]})" if lines else text


def visible(text: str) -> str:
    """A text of readable length, control characters escaped."""
    shown = (c if c.isprintable() or c == "\n" else f"\\x{ord(c):02x}" for c in text[:LONGEST_TEXT])
    return "".join(shown)
