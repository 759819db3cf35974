from __future__ import annotations

from importlib.metadata import EntryPoints

import pytest

from mavstack.codegen import Language, language, language_names
from mavstack.errors import InvalidArgumentError
from tests.codegen.languages_for_tests import NAMES, TEXT, registry


@pytest.mark.usefixtures("plugins")
def test_languages_of_other_packages_follow_the_built_in_ones():
    assert language_names() == (*registry.LANGUAGES, *sorted(NAMES))
    assert language("text") is TEXT


def test_an_unknown_language_is_refused_with_all_names(monkeypatch):
    monkeypatch.setattr(registry._REGISTRY, "plugins", lambda: EntryPoints(()))
    with pytest.raises(InvalidArgumentError, match=r"language must be one of .*got 'fortran'"):
        language("fortran")


@pytest.mark.parametrize("name", registry.LANGUAGES)
def test_built_in_languages_are_complete(name):
    found = language(name)
    assert isinstance(found, Language)
    assert found.name == name
    assert found.title
    # Names are data in the dissector; fields begin with an upper-case letter in Go and C#, unlike all words.
    assert bool(found.reserved_words) == (name not in ("wireshark", "go", "csharp"))
