"""The pages: their tables are the program's own, their links lead somewhere, and the first is one page."""

import re

import pytest
from docs import PAGES, PLACE, fresh, own_rows
from program import ROOT, skip_without

EVERY = ["README.md", ".github/CONTRIBUTING.md", *sorted(str(page.relative_to(ROOT)) for page in ROOT.glob("*/*.md"))]


@pytest.mark.parametrize("page", PAGES)
def test_tables_are_the_program_s_own(page):
    if page.startswith("algorithms"):
        for row in own_rows():
            skip_without(row["name"])
    text = (ROOT / page).read_text(encoding="utf-8")
    assert PLACE.search(text), "no table stands in it"
    assert text == fresh(page), "scripts/python tests/docs.py --write makes them anew"


@pytest.mark.parametrize("page", EVERY)
def test_links_lead_to_files(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for link in re.findall(r"\]\(([^)#:]+)\)", text):
        assert ((ROOT / page).parent / link).exists(), link


@pytest.mark.parametrize("page", EVERY)
def test_files_that_a_page_names_exist(page):
    """Paths between backticks that begin with a folder of the project; that of the example of an own method aside."""
    text = (ROOT / page).read_text(encoding="utf-8")
    for path in re.findall(r"`((?:geometry|algorithms|pipeline|analysis|tests|configs|scripts)/[\w./]+)`", text):
        if "my_method" not in path:
            assert (ROOT / path).exists() or list(ROOT.glob(path.rstrip(".") + ".*")), path


def test_the_first_page_is_one_page():
    lines = (ROOT / "README.md").read_text(encoding="utf-8").splitlines()
    assert len(lines) <= 150, len(lines)
