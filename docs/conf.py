"""Settings of the documentation site: `pip install '.[docs]'`, then

    python -m sphinx -W -b html docs site

The lessons are copied from `lessons/`; the reference of the commands is made from their parsers,
that of the API from the packages' public names; names in the map become links to them.
"""

import re
import shutil
from importlib import import_module
from pathlib import Path

import numpy_cae
from numpy_cae import cli

HERE = Path(__file__).parent
PACKAGES = ("public", "ops", "models", "training", "motion", "manifold", "fast", "verify",
            "evaluation", "viz", "beyond", "course")  # fmt: skip

project = "numpy_cae"
author = "the numpy_cae authors"
release = version = numpy_cae.__version__
extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.viewcode",
    "sphinx-mathjax-offline",
    "numpydoc",
    "myst_nb",
]
exclude_patterns = ["paper.md"]  # in the form of a journal, not a page of the site
html_theme = "pydata_sphinx_theme"
html_title = "numpy_cae"
html_context = {"default_mode": "auto"}
html_theme_options = {
    "navbar_end": ["theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
PLAIN = ("repair", "course", "verify", "own_operation", "map", "starter_model")
html_sidebars = {page: [] for page in PLAIN}
html_show_sourcelink = False
copyright = "the numpy_cae authors, MIT licence"
nb_execution_mode = "off"  # the lessons are stored executed
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
numpydoc_show_class_members = False
autodoc_typehints = "none"
nitpicky = False


def write_if_changed(path: Path, text: str) -> None:
    """Write a generated page, unless it is there already: an unchanged page is not built again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def write_commands() -> None:
    """A section for each subcommand: its help."""
    parts = ["# Commands\n"]
    for name, line in cli.SUBCOMMANDS.items():
        parser = cli.subcommand_parser(name)
        parts.append(f"## {name}\n\n{line}.\n")
        parts.append(f"```text\n{parser.format_help()}```\n")
    write_if_changed(HERE / "reference" / "commands.md", "\n".join(parts))


def write_api() -> None:
    """A page for each package: its docstring and its public names. `public` is a module, with the
    functions of `import numpy_cae`."""
    index = ["# API\n", "Public names of each package. [source] leads to the lines.\n"]
    index += ["```{toctree}", *(f"api_{package}" for package in PACKAGES), "```\n"]
    reference = "# Reference\n\n```{toctree}\n:maxdepth: 2\n\ncommands\napi\n```\n"
    write_if_changed(HERE / "reference" / "index.md", reference)
    write_if_changed(HERE / "reference" / "api.md", "\n".join(index))
    for package in PACKAGES:
        module = import_module(f"numpy_cae.{package}")
        parts = [
            f"# numpy_cae.{package}\n",
            "```{eval-rst}",
            f".. automodule:: {module.__name__}\n",
        ]
        for name in module.__all__:
            if not callable(getattr(module, name)):
                continue  # a constant: its value is in the source
            kind = "autoclass" if isinstance(getattr(module, name), type) else "autofunction"
            parts.append(f".. {kind}:: {module.__name__}.{name}")
            if kind == "autoclass":
                parts.append("   :members:")
            parts.append("")
        write_if_changed(HERE / "reference" / f"api_{package}.md", "\n".join([*parts, "```\n"]))


def copy_lessons() -> None:
    """The notebooks, with a page that lists them."""
    listed = "# Lessons\n\n```{toctree}\n:maxdepth: 1\n:glob:\n\n[0-9]*\n```\n"
    write_if_changed(HERE / "lessons" / "index.md", listed)
    for notebook in sorted((HERE.parent / "lessons").glob("*.ipynb")):
        shutil.copy2(notebook, HERE / "lessons" / notebook.name)


def link_names(app, docname: str, source: list[str]) -> None:
    """In the map, `numpy_cae.ops.conv1d` becomes a link to its entry in the reference."""
    if docname != "map":
        return
    public = {
        f"numpy_cae.{package}.{name}"
        for package in PACKAGES
        for name in import_module(f"numpy_cae.{package}").__all__
    }

    def link(found: re.Match) -> str:
        name = found[1]
        known = name in public or name.rpartition(".")[0] in public
        return f"{{py:obj}}`{name}`" if known else found[0]

    source[0] = re.sub(r"`(numpy_cae\.[\w.]+)`", link, source[0])


def plain_text_to_rst(app, what, name, obj, options, lines: list[str]) -> None:
    """Docstrings are plain text: an indented paragraph in front of the sections is an equation or
    code, and | and * are signs of mathematics, not markup.
    """
    rst, in_sections = [], False
    for number, line in enumerate(lines):
        underlined = number + 1 < len(lines) and re.fullmatch(r"-{3,}", lines[number + 1].strip())
        in_sections = in_sections or bool(underlined)
        literal = not in_sections and line.startswith("    ")
        if literal and not (rst and (rst[-1].startswith("    ") or rst[-1] == "")):
            rst.append("")
        if literal and not any(each.startswith("    ") for each in rst[-2:]):
            rst += ["::", ""]
        rst.append(line if literal else re.sub(r"(?<![`\\])([|*])(?!`)", r"\\\1", line))
    lines[:] = rst


def setup(app) -> None:
    """Make the generated pages before Sphinx looks for pages."""
    write_commands()
    write_api()
    copy_lessons()
    app.connect("source-read", link_names)
    app.connect("autodoc-process-docstring", plain_text_to_rst, priority=400)
