"""The examples of README and of the guides pass mypy --strict, as files of a user."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = (
    "README.md",
    "data_synth/README.md",
    "docs/layers_of_other_forms.md",
    "docs/own_operation.md",
    "docs/reproduce_the_paper.md",
    "docs/verify.md",
)
BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


WRONG = {
    "wrong_name.py": "import numpy_cae\n\nnumpy_cae.repiar('take.bvh')\n",
    "wrong_argument.py": "import numpy_cae\n\nnumpy_cae.repair(7)\n",
}


def files_of(page: str) -> dict[str, str]:
    """The examples of a page by the name that their first line gives, or by the page's name."""
    files = {}
    for number, block in enumerate(BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))):
        name = re.match(r"# (\w+\.py)\n", block)
        page_name = re.sub(r"\W", "_", page)
        files[name[1] if name else f"{page_name}_{number}.py"] = block
    return files


@pytest.fixture(scope="module")
def errors_of(tmp_path_factory):
    """The errors by file of mypy --strict, run once on all files, as if numpy_cae were installed.

    Two wrong files are among them.
    """
    api = pytest.importorskip("mypy.api")
    folder = tmp_path_factory.mktemp("types")
    files = dict(WRONG)
    for page in PAGES:
        of_page = files_of(page)
        assert not set(of_page) & set(files)
        files |= of_page
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    empty = folder / "mypy.ini"
    empty.write_text("[mypy]\n")
    # Errors within the package are not shown to a user, nor are libraries that he lacks.
    options = ["--strict", "--follow-imports=silent", "--ignore-missing-imports"]
    options += [f"--config-file={empty}", f"--cache-dir={folder / 'cache'}"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MYPYPATH", str(ROOT))
        patch.chdir(folder)
        output, problems, _ = api.run([*options, *sorted(files)])
    *lines, last = output.splitlines()
    assert last.endswith(f"(checked {len(files)} source files)"), output + problems
    errors = {name: "" for name in files}
    for line in lines:
        errors[line.partition(":")[0]] += f"{line}\n"
    return errors


@pytest.mark.parametrize("page", PAGES)
def test_the_examples_of_a_page_pass_mypy_strict(page, errors_of):
    assert "".join(errors_of[name] for name in files_of(page)) == ""


def test_a_name_that_numpy_cae_lacks_is_an_error(errors_of):
    assert 'Module has no attribute "repiar"' in errors_of["wrong_name.py"]


def test_a_wrong_argument_is_an_error(errors_of):
    assert 'Argument 1 to "repair" has incompatible type "int"' in errors_of["wrong_argument.py"]


def test_every_page_with_examples_is_checked():
    pages = {"README.md", "data_synth/README.md"}
    pages |= {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md")}
    assert {page for page in pages if BLOCK.search((ROOT / page).read_text("utf-8"))} == set(PAGES)
