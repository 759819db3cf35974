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


def test_a_plugin_with_a_name_that_is_taken_is_named(registry, caplog):
    assert dict(registry.items()) == {"own": OWN, "other": OTHER}
    assert [record.message for record in caplog.records] == [
        "plug-in own was left out: there is a thing 'own' already"
    ]


def test_a_built_in_object_looks_up_no_packages(registry, monkeypatch):
    monkeypatch.setattr(registry, "plugins", None)
    assert registry.get("own") is OWN


def test_an_unknown_name_is_refused_with_all_names(registry):
    with pytest.raises(InvalidArgumentError, match="thing must be one of own, other, got 'third'"):
        registry.get("third")


def test_without_packages_there_are_only_built_in_objects():
    assert Registry[object]("thing", "mavstack.no_such_group", {"own": f"{__name__}:OWN"}).names() == ("own",)


@pytest.fixture
def broken(monkeypatch):
    """A registry with two plug-ins, one of which cannot be loaded."""
    found = Registry[object]("thing", "mavstack.test_things", objects=lambda: {"own": OWN})
    entries = [
        EntryPoint("broken", "mavstack.no_such_module:THING", "mavstack.test_things"),
        EntryPoint("other", f"{__name__}:OTHER", "mavstack.test_things"),
    ]
    monkeypatch.setattr(found, "plugins", lambda: EntryPoints(entries))
    return found


def test_a_plugin_that_fails_is_named_once_and_left_out(broken, caplog):
    for _ in range(3):
        assert dict(broken.items()) == {"own": OWN, "other": OTHER}
        assert broken.find("broken") is None
    (record,) = caplog.records
    assert (record.name, record.levelname) == ("mavstack.plugins", "WARNING")
    assert record.message.startswith("plug-in broken was left out: ModuleNotFoundError: No module named")


def test_a_plugin_that_fails_is_an_error_for_those_who_ask_for_it(broken):
    with pytest.raises(InvalidArgumentError, match="loading the thing broken failed: ModuleNotFoundError"):
        broken.get("broken")
    assert broken.get("other") is OTHER


def test_a_plugin_that_ends_the_program_is_not_hidden(broken, monkeypatch):
    monkeypatch.setattr(broken, "_convert", interrupt)
    with pytest.raises(KeyboardInterrupt):
        dict(broken.items())


def interrupt(entry, loaded):
    raise KeyboardInterrupt
