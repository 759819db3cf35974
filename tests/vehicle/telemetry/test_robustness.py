"""Whatever bytes a vehicle sends: no reader raises, and every value can be shown."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavstack.dialects import ardupilotmega, common
from tests.vehicle.telemetry.harness import with_telemetry
from tests.vehicle.telemetry.test_readers import VALUES

READ = (
    *(common.Heartbeat, common.GlobalPositionInt, common.LocalPositionNed, common.Attitude, common.VfrHud),
    *(common.AttitudeQuaternion, common.GpsRawInt, common.BatteryStatus, common.SysStatus, common.Odometry),
    *(common.HomePosition, common.ExtendedSysState, common.RcChannels, common.WindCov, ardupilotmega.Wind),
    *(common.HighresImu, common.ScaledImu, common.RawImu, common.HighLatency2, common.EstimatorStatus),
    *(ardupilotmega.EkfStatusReport, common.Statustext, common.CurrentMode, common.SystemTime),
)

payloads = st.binary(max_size=255) | st.binary(min_size=1, max_size=1).map(lambda byte: byte * 255)


@pytest.mark.nightly
@pytest.mark.flight
@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(st.sampled_from(READ), payloads), min_size=1, max_size=8))
def test_no_reader_raises(received):
    async def scenario(harness):
        for kind, payload in received:
            harness.receive(kind.from_payload(payload))
        vehicle = harness.vehicle
        for name in VALUES:
            repr(getattr(vehicle, name))
        for number, battery in vehicle.batteries.items():
            assert number == battery.id
        for value in (vehicle.attitude, vehicle.wind, vehicle.velocity, vehicle.gps):
            for name in ("heading", "direction", "speed", "ground_speed", "has_fix"):
                repr(getattr(value, name, None))
        assert str(vehicle.health)
        assert all(isinstance(text.text, str) for text in vehicle.status_texts)

    with_telemetry(scenario)
