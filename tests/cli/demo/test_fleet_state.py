from __future__ import annotations

from mavstack import Dialect, Parser, encode
from mavstack.cli.demo.fleet_state import FleetState
from mavstack.dialects import common


def test_a_bridge_of_msp_names_the_firmware_and_its_modes():
    dialect = Dialect.load("all")
    fleet, parser = FleetState(dialect), Parser(dialect)
    heartbeat = common.Heartbeat(
        type=common.MavType.QUADROTOR,
        autopilot=common.MavAutopilot.GENERIC,
        base_mode=common.MavModeFlag.CUSTOM_MODE_ENABLED,
        custom_mode=28,
    )
    for message in (
        heartbeat,
        common.AvailableModes(custom_mode=28, mode_name="NAV WP"),
        common.AutopilotVersion(flight_custom_version=b"INAV8.0."),
        heartbeat,
    ):
        for packet in parser.feed(encode(message, system=8, component=1)):
            fleet.update(packet, 0.0)
    identity = fleet.vehicles[8].identity
    assert (identity.autopilot, identity.mode) == ("iNav", "NAV WP")
