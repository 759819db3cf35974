"""Every parameter that the package uses by name on ArduPilot, and its name in 4.7."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import mavstack
from mavstack.services.parameters import RENAMED, renaming_of

#: The names of ArduPilot's parameters that actions and commands use, with those of 4.7, from its parameter
#: tables (ArduCopter, ArduPlane, Rover and ArduSub 4.7.0).
USED = {
    "AUTO_OPTIONS": "AUTO_OPTIONS",
    "CIRCLE_OPTIONS": "CIRCLE_OPTIONS",
    "CIRCLE_RADIUS": "CIRCLE_RADIUS_M",
    "CIRCLE_RATE": "CIRCLE_RATE",
    "Q_ENABLE": "Q_ENABLE",
    "Q_OPTIONS": "Q_OPTIONS",
    "RCMAP_THROTTLE": "RCMAP_THROTTLE",
    "RTL_ALT": "RTL_ALT_M",
    "TKOFF_ALT": "TKOFF_ALT",
}
_BEFORE_NAME = (
    r"\b(?:params|parameters)(?:\.cached)?\.(?:get|set)\(|\bset_parameter\(|\b_options\(|RENAMED\[|"
    r"QUADPLANE_PARAMETER: Final = "
)
_NAME_IN_CALL = re.compile(rf'(?:{_BEFORE_NAME})"([A-Z][A-Z0-9_]+)"')
_PACKAGES = ("vehicle", "cli", "node", "files")


def names_used():
    root = Path(mavstack.__file__).parent
    modules = [module for package in _PACKAGES for module in (root / package).rglob("*.py")]
    return {name for module in modules for name in _NAME_IN_CALL.findall(module.read_text("utf-8"))}


def test_each_name_used_has_its_counterpart():
    assert names_used() == set(USED)
    for earlier, name in USED.items():
        renamed = RENAMED.get(earlier)
        assert (earlier if renamed is None else renamed.name) == name


@pytest.mark.parametrize(
    ("earlier", "value", "name", "expected"),
    [
        ("CIRCLE_RADIUS", 1500, "CIRCLE_RADIUS_M", 15),
        ("RTL_ALT", 3000, "RTL_ALT_M", 30),
        ("WPNAV_SPEED", 500, "WP_SPD", 5),
        ("PILOT_TKOFF_ALT", 250, "PILOT_TKO_ALT_M", 2.5),
        ("ANGLE_MAX", 3000, "ATC_ANGLE_MAX", 30),
        ("SYSID_THISMAV", 7, "MAV_SYSID", 7),
    ],
)
def test_names_and_units(earlier, value, name, expected):
    renamed = RENAMED[earlier]
    assert renamed.name == name
    assert value * renamed.factor == pytest.approx(expected)
    assert renaming_of(earlier) is renaming_of(name) is renamed


def test_names_are_names_of_parameters():
    assert len({renamed.name for renamed in RENAMED.values()} | set(RENAMED)) == 2 * len(RENAMED)
    for renamed in RENAMED.values():
        assert max(len(renamed.earlier), len(renamed.name)) <= 16
    assert renaming_of("RTL_SPEED_X") is None


def test_the_hint_contains_both_names():
    assert RENAMED["RTL_ALT"].hint == "RTL_ALT is RTL_ALT_M since ArduPilot 4.7, 0.01 times the value"
    assert RENAMED["SYSID_THISMAV"].hint == "SYSID_THISMAV is MAV_SYSID since ArduPilot 4.7"
