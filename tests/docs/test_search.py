"""The search of the site finds pages by the words of users: they are in titles, which it ranks first.

`make docs` builds the site and then runs this file, so that the index itself is searched.
"""

from __future__ import annotations

import json
import re
from typing import Any

import pytest

from tests.docs.blocks import DOCS, ROOT, pages

QUERIES = [
    ("offboard", "guides/guided-flight.md"),
    ("set parameter", "guides/parameters.md"),
    ("jupyter", "guides/notebooks.md"),
    ("upload mission", "guides/missions.md"),
    ("geofences", "guides/missions.md"),
]
INDEX = ROOT / "site" / "search" / "search_index.json"
#: Places of the list that a user looks at.
SHOWN = 3


@pytest.fixture(scope="module")
def index() -> Any:
    """The index of the built site, searched with the weights that the site's search has."""
    if not INDEX.exists():
        pytest.skip("the site is not built: make docs")
    from lunr import lunr

    built = json.loads(INDEX.read_text("utf-8"))
    fields = [{"field_name": name, **built["config"]["fields"][name]} for name in ("title", "text")]
    return lunr(ref="location", fields=fields, documents=built["docs"])


@pytest.mark.parametrize(("query", "page"), QUERIES)
def test_the_index_of_the_site_leads_to_the_guide(index: Any, query: str, page: str) -> None:
    found = [result["ref"].partition("#")[0] for result in index.search(query)[:SHOWN]]
    assert page.removesuffix(".md") + "/" in found


@pytest.mark.parametrize(("query", "page"), QUERIES)
def test_titles_have_the_words_of_users(query: str, page: str) -> None:
    words = query.split()
    titles = {
        path.relative_to(DOCS).as_posix(): re.findall(r"^#+ (.*)$", path.read_text("utf-8"), re.MULTILINE)
        for path in pages()
    }
    found = {
        name
        for name, lines in titles.items()
        if any(all(word in line.lower() for word in words) for line in lines)
    }
    assert page in found
