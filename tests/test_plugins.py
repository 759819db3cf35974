from __future__ import annotations

import sys
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


@pytest.fixture
def look_up(monkeypatch):
    """Return the names of plug-ins; the second value says whether all metadata had to be parsed."""
    from importlib import metadata

    calls, original = [], metadata.entry_points
    monkeypatch.setattr(metadata, "entry_points", lambda **group: calls.append(group) or original(**group))

    def look_up():
        calls.clear()
        return Registry[object]("thing", "mavstack.test_things").names(), bool(calls)

    return look_up


def test_metadata_is_not_parsed_if_no_distribution_names_the_group(look_up):
    assert look_up() == ((), False)


@pytest.mark.parametrize("folder", ["thing-1.0.dist-info", "thing.egg-info"])
def test_a_plugin_of_a_distribution_on_the_path_is_found(look_up, folder, tmp_path, monkeypatch):
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "METADATA").write_text("Name: thing\n")
    (tmp_path / folder / "PKG-INFO").write_text("Name: thing\n")
    monkeypatch.syspath_prepend(tmp_path)
    points = tmp_path / folder / "entry_points.txt"
    points.write_text("[console_scripts]\nthing = mavstack.test_things:main\n")
    assert look_up() == ((), False)
    points.write_text("[mavstack.test_things]\nthing = thing:THING\n")
    assert look_up() == (("thing",), True)


def test_metadata_in_an_archive_is_parsed(look_up, tmp_path, monkeypatch):
    archive = tmp_path / "thing.egg"
    archive.write_bytes(b"")
    monkeypatch.setattr(sys, "path", [*sys.path, str(archive)])
    assert look_up() == ((), True)


def test_metadata_of_other_finders_is_parsed(look_up, monkeypatch):
    class Finder:
        @staticmethod
        def find_spec(*arguments):
            return None

        @staticmethod
        def find_distributions(context):
            return ()

    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Finder])
    assert look_up() == ((), True)
