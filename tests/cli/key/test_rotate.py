"""`mav key rotate`: a new key for all vehicles of a key, resumable at every step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from mavstack.security import SigningKey, key_store
from tests.cli.harness import COPTER, PX4_COPTER

if TYPE_CHECKING:
    from pathlib import Path

URL = "udpin://127.0.0.1:14550"


@pytest.fixture
def keys(tmp_path, monkeypatch) -> Path:
    directory = tmp_path / "keys"
    monkeypatch.setattr(key_store, "key_directory", lambda: directory)
    return directory


def install(mav, *systems: int) -> SigningKey:
    """Make the key `fleet` and install it on vehicles."""
    mav("key", "new", "fleet")
    for system in systems:
        assert mav("key", "install", "fleet", URL, "--yes", "--system", str(system)).code == 0
    return key_store.load_stored_key("fleet")


def test_vehicles_on_one_link_get_the_new_key_one_after_the_other(mav, keys, simulate):
    vehicles = simulate(COPTER, PX4_COPTER, ready=False).simulation.vehicles
    old = install(mav, 1, 2)
    result = mav("key", "rotate", "fleet", URL, "--all")
    assert (result.code, result.err) == (0, "")
    new = key_store.load_stored_key("fleet")
    assert new != old
    assert [vehicle.signing_keys.key for vehicle in vehicles] == [new, new]
    old_name = f"fleet.old-{old.fingerprint[:8]}"
    assert key_store.key_names() == ["fleet", old_name]
    assert key_store.load_stored_key(old_name) == old
    assert mav("param", "get", "LOG_BACKEND_TYPE", "--url", URL, "--key", "fleet", "--system", "1").code == 0


def test_a_vehicle_that_refuses_keeps_its_key_and_the_command_continues_later(mav, keys, simulate):
    one, two = simulate(COPTER, COPTER, ready=False).simulation.vehicles
    old = install(mav, 1, 2)
    two.autopilot.arm(force=True)
    result = mav("key", "rotate", "fleet", URL, "--all", "--json")
    outcome = json.loads(result.out)
    assert (result.code, outcome["finished"], outcome["changed"]) == (1, False, [1])
    assert "armed" in outcome["failed"]["2"]
    new = key_store.load_stored_key("fleet.next")
    assert (one.signing_keys.key, two.signing_keys.key) == (new, old)
    assert key_store.load_stored_key("fleet") == old
    two.autopilot.disarm("a test")
    result = mav("key", "rotate", "fleet", URL, "--systems", "1,2")
    assert (result.code, "continues" in result.out) == (0, True)
    assert (one.signing_keys.key, two.signing_keys.key) == (new, new)
    assert key_store.load_stored_key("fleet") == new


def test_a_vehicle_without_this_key_is_left_alone(mav, keys, simulate):
    vehicle = simulate(ready=False).vehicle
    mav("key", "new", "fleet")
    result = mav("key", "rotate", "fleet", URL)
    assert (result.code, "mav key install" in result.err) == (1, True)
    mav("key", "new", "other")
    mav("key", "install", "other", URL, "--yes")
    result = mav("key", "rotate", "fleet", URL)
    assert (result.code, "signs with another key" in result.err) == (1, True)
    assert vehicle.signing_keys.key == key_store.load_stored_key("other")


def test_a_key_that_is_not_stored_or_is_in_the_url_is_refused(mav, keys):
    assert "there is no signing key 'fleet'" in mav("key", "rotate", "fleet", URL).err
    mav("key", "new", "fleet")
    assert mav("key", "rotate", "fleet", f"{URL}?signing_key=fleet").code == 2
