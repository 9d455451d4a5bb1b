"""Settings of the documentation site: `pip install '.[docs]'`, then

    python -m sphinx -W -b html -d /tmp/doctrees docs site

The lessons are copied from `lessons/`; the reference of the commands is made from their parsers,
that of the API from the packages' public names; names in the map become links to them.
"""

import inspect
import pkgutil
import re
import shutil
import sys
from collections.abc import Iterator
from importlib import import_module
from itertools import groupby
from pathlib import Path
from types import ModuleType

from numpydoc.xref import DEFAULT_LINKS
from sphinx.pycode import ModuleAnalyzer

import numpy_cae
from numpy_cae import cli

HERE = Path(__file__).parent
REFERENCE = HERE / "reference"
sys.path.append(str(HERE.parent))
from tools.docstring_examples import example_modules, failures  # noqa: E402
from tools.equations import as_tex, is_equation  # noqa: E402
from tools.example_repair import write_example  # noqa: E402
from tools.lesson_pages import write_lessons  # noqa: E402
from tools.moving_pictures import write_moving_pictures  # noqa: E402

PACKAGES = ("public", "ops", "models", "training", "motion", "manifold", "fast", "verify", "course",
            "mocap", "cleanup", "viz", "evaluation", "download")  # fmt: skip

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
# `paper.md` has the form of a journal and is no page of the site.
exclude_patterns = ["paper.md", "site_files", "made", "lessons/downloads"]
html_static_path = ["site_files", "pictures", "../lessons/pictures"]
html_css_files = ["site.css"]
html_js_files = ["names.js"]
html_favicon = "site_files/icon.svg"
html_search_scorer = str(HERE / "site_files" / "scorer.js")
html_copy_source = False
html_extra_path = ["made/page"]  # pages that play motions
html_theme = "pydata_sphinx_theme"
html_title = "numpy_cae"
html_context = {"default_mode": "auto"}
html_theme_options = {
    "header_links_before_dropdown": 7,
    "navbar_end": ["theme-switcher"],
    "footer_start": ["copyright"],
    "footer_end": [],
}
html_sidebars = {"index": [], "install": [], "results": []}  # they have no pages below them
html_show_sourcelink = False
copyright = "the numpy_cae authors. Free to use, change and share under the MIT licence"
nb_execution_mode = "off"  # the lessons are stored executed
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
numpydoc_show_class_members = False
numpydoc_xref_param_type = True
numpydoc_xref_ignore = "all"  # only the names of this package become links
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
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
    write_if_changed(REFERENCE / "commands.md", "\n".join(parts))


def write_api() -> None:
    """A page for each package with its docstring and a line for each public name, and a page for
    each name."""
    write_if_changed(
        REFERENCE / "index.md", toctree("# Reference", ["commands", "api", "../glossary"])
    )
    index = ["# API\n"]
    for package in PACKAGES:
        module = import_module(f"numpy_cae.{package}")
        entries = dict(sorted(public_entries(module)))
        for name, (kind, _) in entries.items():
            write_if_changed(REFERENCE / f"{name}.md", page_of_name(name, kind))
        table = ["| name | what it is |", "|---|---|"]
        for name, (_, line) in entries.items():
            table.append(f"| {{py:obj}}`{name} <{name}>` | {line} |")
        index += [f"## [{module.__name__}](api_{package}.md)\n", f"{first_line(module)}\n"]
        index += [*table, ""]
        docstring = f"```{{eval-rst}}\n.. automodule:: {module.__name__}\n```\n"
        parts = [f"# numpy_cae.{package}\n", docstring, *table, "", toctree("", list(entries))]
        write_if_changed(REFERENCE / f"api_{package}.md", "\n".join(parts))
    index.append(toctree("", [f"api_{package}" for package in PACKAGES]))
    write_if_changed(REFERENCE / "api.md", "\n".join(index))


def page_of_name(name: str, kind: str) -> str:
    """The page of a public name; its title is short, so that the list beside it is."""
    members = "\n   :members:" if kind == "autoclass" else ""
    title = (
        name.removeprefix("numpy_cae.") if ".public." not in name else name.replace("public.", "")
    )
    return f"# {title}\n\n```{{eval-rst}}\n.. {kind}:: {name}{members}\n```\n"


def toctree(title: str, pages: list[str]) -> str:
    """A hidden table of contents below a title."""
    return "\n".join([title, "", "```{toctree}", ":hidden:", "", *pages, "```", ""])


def public_entries(module) -> Iterator[tuple[str, tuple[str, str]]]:
    """Each public name of a package with the directive of its entry and its first line; the modules
    of a package that has no `__all__`."""
    if not hasattr(module, "__all__"):
        for found in pkgutil.walk_packages(module.__path__, f"{module.__name__}."):
            if not found.ispkg and not found.name.endswith("__main__"):
                yield found.name, ("automodule", first_line(import_module(found.name)))
        return
    for name in module.__all__:
        value = getattr(module, name)
        if isinstance(value, type):
            yield f"{module.__name__}.{name}", ("autoclass", first_line(value))
        elif callable(value):
            yield f"{module.__name__}.{name}", ("autofunction", first_line(value))
        elif not isinstance(value, ModuleType):
            home, text = constant(module.__name__, name)
            yield f"{home}.{name}", ("autodata", text)


def constant(package: str, name: str) -> tuple[str, str]:
    """The module of a package that documents a constant, and the first line about it."""
    for home in [each for each in sys.modules if each.startswith(package)]:
        documented = ModuleAnalyzer.for_module(home).find_attr_docs()
        if ("", name) in documented:
            return home, documented["", name][0]
    raise LookupError(f"{package}.{name} has no docstring below it")


def first_line(value) -> str:
    """The first sentence of a docstring, for a cell of a table."""
    text = (inspect.getdoc(value) or "").partition("\n\n")[0].replace("\n", " ")
    return re.split(r"(?<=\w[.:]) ", text)[0].rstrip(":").replace("|", "\\|").replace("*", "\\*")


def link_names(app, docname: str, source: list[str]) -> None:
    """In the map, `numpy_cae.ops.conv1d` becomes a link to its entry in the reference."""
    if docname != "map":
        return
    packages = [import_module(f"numpy_cae.{package}") for package in PACKAGES]
    public = {name for package in packages for name, _ in public_entries(package)}

    def link(found: re.Match) -> str:
        name = found[1]
        known = name in public or name.rpartition(".")[0] in public
        return f"{{py:obj}}`{name}`" if known else found[0]

    source[0] = re.sub(r"`(numpy_cae\.[\w.]+)`", link, source[0])


def keep_spreads_whole(app, docname: str, source: list[str]) -> None:
    """A cell such as 0.40 ± 0.02 is not broken over two lines."""
    source[0] = source[0].replace(" ± ", "\N{NO-BREAK SPACE}±\N{NO-BREAK SPACE}")


def plain_text_to_rst(app, what, name, obj, options, lines: list[str]) -> None:
    """Docstrings are plain text: an indented paragraph in front of the sections is an equation or
    code, and | and * are signs of mathematics, not markup.
    """
    underlined = (at for at, line in enumerate(lines) if re.fullmatch(r"-{3,}", line.strip()))
    sections = max(next(underlined, len(lines)) - 1, 0)
    rst: list[str] = []
    if re.match(r"\w[\w\[\]']* = ", lines[0]):  # an operation begins with its equation
        end = lines.index("")
        rst, lines[:end], sections = [".. math::", "", *equation(lines[:end])], [], sections - end
    for indented, group in groupby(lines[:sections], lambda line: line.startswith("    ")):
        paragraph = list(group)
        if not indented:
            rst += map(escaped, paragraph)
        elif is_equation(paragraph):
            rst += ["", ".. math::", "", *equation(paragraph), ""]
        else:
            rst += ["", "::", "", *paragraph, ""]
    lines[:] = rst + [escaped(line) for line in lines[sections:]]


def equation(paragraph: list[str]) -> list[str]:
    """The body of the directive `math`."""
    return [f"    {as_tex(paragraph)}", ""]


def escaped(line: str) -> str:
    """A line in which | and * are no markup."""
    return re.sub(r"(?<![`\\])([|*])(?!`)", r"\\\1", line)


def without_empty_headings(app, pagename: str, template: str, context: dict, doctree) -> None:
    """The corner of a table that has nothing in it is a plain cell: a heading without text says
    nothing to a reader who hears the page."""
    empty = re.compile(r'<th( class="[^"]*")><p></p></th>')
    context["body"] = empty.sub(r"<td\1><p></p></td>", context.get("body", ""))


def run_examples() -> None:
    """Run the examples that the reference shows; ValueError if one prints something else."""
    for name in example_modules():
        if failures(name):
            raise ValueError(f"an example of {name} does not print what it says")


UNUSED_MATHJAX = ("sre", "node-main*", "output/svg*", "*-full*", "*svg*", "*mml-*")
"""Parts of MathJax for speech, for Node, for SVG and for MathML input, which no page loads."""


def remove_unused_mathjax(app, error: Exception | None) -> None:
    """Keep of MathJax what the pages load."""
    folder = Path(app.outdir) / "_static" / "mathjax"
    for pattern in UNUSED_MATHJAX:
        for path in folder.glob(pattern):
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink()


def linked_types() -> dict[str, str]:
    """A word in the types of a docstring to the name that it links to: the public classes of this
    package. Words that numpydoc would link to Python's and NumPy's sites stand for themselves."""
    links = {word: word for word in DEFAULT_LINKS}
    for package in PACKAGES:
        module = import_module(f"numpy_cae.{package}")
        for name, (kind, _) in public_entries(module):
            if kind == "autoclass":
                links[name.rpartition(".")[2]] = name
    return links


def setup(app) -> None:
    """Run the examples, and make the generated pages before Sphinx looks for pages."""
    app.config.numpydoc_xref_aliases = linked_types()
    run_examples()
    write_commands()
    write_api()
    write_lessons(HERE.parent / "lessons", HERE / "lessons", write_if_changed)
    write_example(HERE / "made", HERE / "site_files")
    write_moving_pictures(HERE / "made" / "page")
    app.connect("source-read", link_names)
    app.connect("source-read", keep_spreads_whole)
    app.connect("build-finished", remove_unused_mathjax)
    app.connect("html-page-context", without_empty_headings)
    app.connect("autodoc-process-docstring", plain_text_to_rst, priority=400)
