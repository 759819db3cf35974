from __future__ import annotations

from importlib.metadata import EntryPoint, EntryPoints

import pytest

from mavstack.errors import InvalidArgumentError
from mavstack.plugins import Registry

OWN, OTHER = object(), object()


@pytest.fixture
def registry(monkeypatch):
    """A registry with a built-in object and one of another package, which also has the built-in name."""
    found = Registry[object]("thing", "mavstack.test_things", {"own": f"{__name__}:OWN"})
    entries = [EntryPoint(name, f"{__name__}:OTHER", "mavstack.test_things") for name in ("own", "other")]
    monkeypatch.setattr(found, "plugins", lambda: EntryPoints(entries))
    return found


def test_built_in_objects_come_first_and_are_not_replaced(registry):
    assert registry.names() == ("own", "other")
    assert registry.get("own") is OWN
    assert registry.get("other") is OTHER


def test_a_built_in_object_looks_up_no_packages(registry, monkeypatch):
    monkeypatch.setattr(registry, "plugins", None)
    assert registry.get("own") is OWN


def test_an_unknown_name_is_refused_with_all_names(registry):
    with pytest.raises(InvalidArgumentError, match="thing must be one of own, other, got 'third'"):
        registry.get("third")


def test_without_packages_there_are_only_built_in_objects():
    assert Registry[object]("thing", "mavstack.no_such_group", {"own": f"{__name__}:OWN"}).names() == ("own",)
