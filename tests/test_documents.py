"""Documents agree with the code, with each other, and with the files that they name."""

import importlib
import re
from pathlib import Path

import pytest

import numpy_cae
from numpy_cae.cleanup.kinds import KINDS
from numpy_cae.mocap import t_pose

ROOT = Path(__file__).parents[1]
LAB_BOOK = ROOT / "docs" / "lab_book"
PAGES = sorted(
    path
    for pattern in ("*.md", "docs/*.md", "docs/lab_book/*.md", "lessons/*.md", "data_synth/*.md")
    for path in ROOT.glob(pattern)
)
CHANGELOG = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


def read(path: str) -> str:
    return (ROOT / path).read_text(encoding="utf-8")


def resolve(name: str) -> object:
    """The module or the attribute of this full name; AttributeError if there is none."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            value = importlib.import_module(".".join(parts[:count]))
        except ImportError:
            continue
        for part in parts[count:]:
            value = getattr(value, part)
        return value
    raise AttributeError(name)


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_files_that_a_page_links_to_exist(page):
    written = page.read_text(encoding="utf-8")
    text = re.sub(r"```.*?```|^ {4}.*?$|``?[^`\n]*``?", "", written, flags=re.DOTALL | re.MULTILINE)
    links = re.findall(r"\]\(([^)#\s]+)[^)]*\)|(?:src|srcset)=\"([^\"]+)\"", text)
    links += [(link, "") for link in re.findall(r"\{download\}`[^<`]*<([^>]+)>`", written)]
    made = ("made/", "_static/", "reference/", "lessons/index", "../reference/")
    for markdown_link, source in links:
        link = markdown_link or source
        if "://" in link or link.startswith(("mailto:", *made)) or link.endswith(".html"):
            continue
        assert (page.parent / link).exists(), link


@pytest.mark.parametrize("folder", ["numpy_cae", "studies", "tools", "data_synth"])
def test_pages_that_the_code_names_exist(folder):
    for path in (ROOT / folder).rglob("*.py"):
        for page in re.findall(r"docs/[\w/]+\.md", path.read_text(encoding="utf-8")):
            assert (ROOT / page).is_file(), f"{path.name}: {page}"


def test_the_lab_book_lists_every_page_with_its_question():
    index = (LAB_BOOK / "index.md").read_text(encoding="utf-8")
    for page in LAB_BOOK.glob("*.md"):
        if page.stem != "index":
            question = page.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ")
            assert f"[{question}]({page.name})" in index
            assert f"\n{page.stem}\n" in index.rpartition("```{toctree}")[2]


@pytest.mark.parametrize("page", sorted(set(LAB_BOOK.glob("*.md")) - {LAB_BOOK / "index.md"}))
def test_a_page_of_the_lab_book_begins_with_question_and_answer(page):
    question, _, answer = page.read_text(encoding="utf-8").splitlines()[:3]
    assert question.endswith("?")
    assert answer.startswith("**Answer: ") and answer.endswith("**")


def test_the_citation_has_the_version_and_the_date_of_the_changelog():
    citation = read("CITATION.cff")
    version, _, date = re.search(r"^## (.*)$", CHANGELOG, re.MULTILINE)[1].partition(" - ")
    assert version == numpy_cae.__version__
    assert f"\nversion: {version}\n" in citation
    dated = re.search(r"^date-released: (.*)$", citation, re.MULTILINE)
    assert (dated and dated[1]) == (None if date == "unreleased" else date)


def test_new_names_of_the_changelog_exist():
    table = CHANGELOG.split("### Renamed")[1].split("###")[0]
    rows = [row.split(" | ")[1] for row in table.splitlines() if row.startswith("| `")]
    names = re.findall(r"`(numpy_cae[\w.]+)`", " ".join(rows))
    assert len(names) > 20
    for name in names:
        resolve(name)


def test_names_in_the_map_are_in_the_package_of_their_row():
    rows = read("docs/map.md").split("## Other public names")[1].splitlines()
    for row in rows[4:]:
        if not row.startswith("| `numpy_cae"):
            continue
        packages, names = (re.findall(r"`([\w.]+)`", cell) for cell in row.split(" | "))
        for name in names:
            candidates = [name, *(f"{package}.{name}" for package in packages)]
            assert any(exists(candidate) for candidate in candidates), (name, packages)


def exists(name: str) -> bool:
    try:
        resolve(name)
    except AttributeError:
        return False
    return True


def test_the_map_says_how_long_its_reading_list_is():
    text = read("docs/map.md")
    reading = text.split("## An afternoon's reading")[1].split("\n## ")[0]
    files = re.findall(r"^\d+\. `(numpy_cae/[\w/]+\.py)`", reading, re.MULTILINE)
    lines = sum(len(read(file).splitlines()) for file in files)
    said = int(re.search(r"about ([\d,]+) lines", reading)[1].replace(",", ""))
    assert abs(lines - said) <= 0.1 * said  # "about"


def test_the_page_about_the_t_pose_has_the_thresholds_of_the_code():
    page = read("docs/lab_book/t_pose.md")
    assert t_pose.JUMP_RATIO == 4 and "four times the largest" in page
    assert f"within {t_pose.ARM_DEGREES:.0f}°" in page
    assert f"at most {t_pose.LONGEST_SECONDS:.0f} s" in page
    assert f"over {t_pose.BLEND_SECONDS} s" in page


def test_the_guide_to_repair_has_every_kind_of_damage():
    table = read("docs/repair.md").split("## What it finds")[1].split("\n\n")[1]
    words = [word for row in table.splitlines() for word in re.findall(r"`([^`]+)`", row[:45])]
    assert sorted(words) == sorted(KINDS)


def test_the_comparison_counts_the_questions_of_the_quiz():
    questions = len(re.findall(r"^\d+\. ", read("lessons/QUIZ.md"), re.MULTILINE))
    assert f"{questions} quiz questions" in read("docs/need.md")


@pytest.mark.parametrize("page", ["docs/course.md", "lessons/README.md"])
def test_pages_name_the_plans_that_there_are(page):
    plans = re.findall(r"^## (\w+) weeks", read("lessons/TEACHING.md"), re.MULTILINE)
    assert sorted(plan.lower() for plan in plans) == ["eight", "six", "twelve", "two"]
    assert "plans of two, six, eight and twelve weeks" in read(page)
