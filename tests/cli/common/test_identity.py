from __future__ import annotations

import pytest

from mavstack.cli.common.identity import Identity, identify
from mavstack.dialects import Dialect, common
from mavstack.wire import Packet, encode

ALL = Dialect.load("all")


def heartbeat(**fields) -> Packet:
    return Packet(encode(common.Heartbeat(**fields), system=1, component=1), ALL)


@pytest.mark.parametrize(
    ("kind", "autopilot", "custom_mode", "mode"),
    [
        (2, 3, 5, "LOITER"),
        (1, 3, 19, "QLOITER"),
        (10, 3, 15, "GUIDED"),
        (12, 3, 19, "MANUAL"),
        (5, 3, 2, "SCAN"),
        (2, 3, 99, "mode 99"),
        (26, 3, 1, "mode 1"),
        (2, 12, 6 << 16, "OFFBOARD"),
        (2, 12, (4 << 16) | (5 << 24), "RTL"),
        (2, 12, 77 << 16, "mode 5046272"),
        (2, 0, 3, "mode 3"),
    ],
)
def test_mode_names(kind, autopilot, custom_mode, mode):
    packet = heartbeat(type=kind, autopilot=autopilot, base_mode=1, custom_mode=custom_mode)
    assert identify(1, packet, ALL).mode == mode


def test_type_autopilot_and_arming():
    armed = heartbeat(type=2, autopilot=12, base_mode=128, system_status=4)
    assert identify(1, armed, ALL) == Identity("quadrotor", "PX4", "", True, "active")
    assert identify(1, heartbeat(type=13, autopilot=3), ALL).armed is False


def test_component_without_autopilot_has_no_mode():
    camera = heartbeat(type=30, autopilot=8, base_mode=129, custom_mode=5, system_status=3)
    assert identify(100, camera, ALL) == Identity("camera", "", "", None, "standby")


def test_identity_without_heartbeat():
    assert identify(68, None, ALL).type_name == "telemetry radio"
    assert identify(199, None, ALL).type_name == ""


def test_unknown_enum_values_are_numbers():
    identity = identify(1, heartbeat(type=250, autopilot=251), ALL)
    assert (identity.type_name, identity.autopilot) == ("250", "251")
