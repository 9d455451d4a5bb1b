"""Equations of docstrings, which are plain text, as TeX.

An indented paragraph such as

    dL/dx[2t] = dy[t] where x[2t] >= x[2t + 1], else 0

is an equation if it has a sign of one and is no code. Two spaces or more end a part of a line.
"""

import re
import unicodedata

SIGNS = {"Σ": r"\sum ", "·": r"\cdot ", "∘": r"\circ ", "≤": r"\le ", "<=": r"\le ", ">=": r"\ge ",
         "←": r"\leftarrow ", "…": r"\dots ", "‖": r"\Vert ", "~": r"\sim ", "√": r"\surd ",
         "θ": r"\theta ", "η": r"\eta ", "ε": r"\varepsilon ", "β": r"\beta ", "σ": r"\sigma ",
         "²": "^{2}", "ᵀ": r"^{\mathsf T}", "ᵗ": "^{t}", "₁": "_{1}", "₂": "_{2}"}  # fmt: skip
TOKENS = re.compile(
    r"(?P<accent>\w[\u0302\u0303])|(?P<floor>\w ?// ?\w)|(?P<raised>[_^]\([^()]*\)|_[A-Za-z]{2,})"
    r"|(?P<words>[A-Za-z]{2,}(?:[_-][a-z]{2,})*(?:\s+[a-z][a-z-]+)*)"
    rf"|(?P<sign>{'|'.join(map(re.escape, SIGNS))})"
)
"""Parts of an equation that TeX writes in another way."""


def is_equation(paragraph: list[str]) -> bool:
    """Whether lines of a docstring are an equation, rather than code or a table."""
    text = "\n".join(paragraph)
    return bool(re.search(r"[=←Σ√‖]", text)) and not re.search(r">>>|^\s*\w+\(|\bdef |\n\n", text)


def as_tex(paragraph: list[str]) -> str:
    """The lines of an equation, aligned at their beginning."""
    rows = []
    for line in paragraph:
        parts = re.split(r"\s{2,}", line.strip())
        rows.append(r" \qquad ".join(_tex(part) for part in parts))
    return r"\begin{aligned}" + r" \\ ".join(f"& {row}" for row in rows) + r"\end{aligned}"


def _tex(text: str) -> str:
    return TOKENS.sub(_token, unicodedata.normalize("NFD", text).replace("`", ""))


def _token(token: re.Match) -> str:
    text = token[0]
    match token.lastgroup:
        case "accent":
            return rf"\{'hat' if text[1] == chr(0x302) else 'tilde'}{{{text[0]}}}"
        case "floor":
            return rf"\lfloor {text[0]}/{text[-1]}\rfloor "
        case "raised":
            inner = text[2:-1] if text[1] == "(" else rf"\mathrm{{{text[1:]}}}"
            return f"{text[0]}{{{inner}}}"
        case "sign":
            return SIGNS[text]
    if re.fullmatch("d[A-Za-z]", text):  # a gradient
        return rf"\mathrm{{d}}{text[1]}"
    return rf"\text{{ {text} }}".replace("_", r"\_")
