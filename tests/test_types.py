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


@pytest.fixture(scope="module")
def check_types(tmp_path_factory):
    """A function that runs mypy --strict on files, as if numpy_cae were installed."""
    api = pytest.importorskip("mypy.api")
    cache = tmp_path_factory.mktemp("mypy")

    def check(folder: Path) -> str:
        # Errors within the package are not shown to a user, nor are libraries that he lacks.
        options = ["--strict", "--follow-imports=silent", "--ignore-missing-imports"]
        paths = sorted(map(str, folder.glob("*.py")))
        empty = folder / "mypy.ini"
        empty.write_text("[mypy]\n")
        output, errors, _ = api.run(
            [*options, f"--config-file={empty}", f"--cache-dir={cache}", *paths]
        )
        return output + errors

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MYPYPATH", str(ROOT))
        yield check


@pytest.mark.parametrize("page", PAGES)
def test_the_examples_of_a_page_pass_mypy_strict(page, tmp_path, check_types):
    blocks = BLOCK.findall((ROOT / page).read_text(encoding="utf-8"))
    for number, block in enumerate(blocks):
        name = re.match(r"# (\w+\.py)\n", block)
        path = tmp_path / (name[1] if name else f"example_{number}.py")
        path.write_text(block, encoding="utf-8")
    assert check_types(tmp_path).startswith("Success: no issues found in"), page


def test_a_name_that_numpy_cae_lacks_is_an_error(tmp_path, check_types):
    (tmp_path / "user.py").write_text("import numpy_cae\n\nnumpy_cae.repiar('take.bvh')\n")
    assert 'Module has no attribute "repiar"' in check_types(tmp_path)


def test_a_wrong_argument_is_an_error(tmp_path, check_types):
    (tmp_path / "user.py").write_text("import numpy_cae\n\nnumpy_cae.repair(7)\n")
    assert 'Argument 1 to "repair" has incompatible type "int"' in check_types(tmp_path)


def test_every_page_with_examples_is_checked():
    pages = {"README.md", "data_synth/README.md"}
    pages |= {path.relative_to(ROOT).as_posix() for path in (ROOT / "docs").glob("*.md")}
    assert {page for page in pages if BLOCK.search((ROOT / page).read_text("utf-8"))} == set(PAGES)
