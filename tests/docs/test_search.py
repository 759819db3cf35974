"""The search of the site finds pages by the words of users: they are in titles, which it ranks first."""

from __future__ import annotations

import re

import pytest

from tests.docs.blocks import DOCS, pages


@pytest.mark.parametrize(
    ("query", "page"),
    [
        ("offboard", "guides/guided-flight.md"),
        ("set parameter", "guides/parameters.md"),
        ("jupyter", "guides/notebooks.md"),
        ("upload mission", "guides/missions.md"),
    ],
)
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
