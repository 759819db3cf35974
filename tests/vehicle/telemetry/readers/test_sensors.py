"""Radio control: RC_CHANNELS, and the ports of RC_CHANNELS_RAW."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.vehicle.telemetry.values import Rc
from tests.vehicle.telemetry.harness import with_telemetry


def test_radio_channels_of_two_ports():
    async def scenario(harness):
        harness.heartbeat()
        harness.receive(common.RcChannelsRaw(0, 1, *range(1009, 1017), rssi=9))
        assert harness.vehicle.rc.channels == (*(None,) * 8, *range(1009, 1017))
        harness.receive(common.RcChannelsRaw(0, 0, *range(1001, 1009), rssi=80))
        harness.receive(common.RcChannelsRaw(0, 200, *range(8), rssi=7))
        assert harness.vehicle.rc == Rc(tuple(range(1001, 1017)), 80)
        harness.receive(common.RcChannels(0, 1, 1700, rssi=90))
        assert harness.vehicle.rc == Rc((1700,), 90)

    with_telemetry(scenario)
