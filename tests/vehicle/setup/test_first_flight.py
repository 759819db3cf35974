"""The check list before a first flight, of simulated vehicles and of bare parameters."""

from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.vehicle.setup.first_flight import CheckState, parameter_checks
from tests.server.stations import COPTER, PX4_COPTER, Ground, serve

PX4, ARDUPILOT = common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA


def states(autopilot: int, **values: float) -> dict[str, CheckState]:
    return {each.name: each.state for each in parameter_checks(autopilot, values)}


@pytest.mark.parametrize(
    ("autopilot", "values", "name", "state"),
    [
        (PX4, {"SYS_AUTOSTART": 0}, "airframe", CheckState.MISSING),
        (PX4, {"SYS_AUTOSTART": 4001}, "airframe", CheckState.OK),
        (PX4, {"CAL_MAG0_ID": 0}, "compass", CheckState.MISSING),
        (PX4, {"RC_CHAN_CNT": 0, "COM_RC_IN_MODE": 0}, "receiver", CheckState.MISSING),
        (PX4, {"RC_CHAN_CNT": 0, "COM_RC_IN_MODE": 1}, "receiver", CheckState.OK),
        (PX4, {"NAV_DLL_ACT": 0}, "loss of the ground station", CheckState.ADVICE),
        (ARDUPILOT, {"RC1_MIN": 1100, "RC1_MAX": 1900}, "receiver", CheckState.MISSING),
        (ARDUPILOT, {"RC1_MIN": 1012, "RC1_MAX": 1998}, "receiver", CheckState.OK),
        (ARDUPILOT, {"BATT_FS_LOW_ACT": 0}, "low battery", CheckState.MISSING),
        (ARDUPILOT, {"INS_ACCOFFS_X": 0, "INS_ACCOFFS_Y": 0.1}, "accelerometer", CheckState.OK),
    ],
)
def test_items_of_parameters(autopilot, values, name, state) -> None:
    assert states(autopilot, **values) == {name: state}


def test_an_unknown_firmware_has_no_items_of_parameters() -> None:
    assert states(common.MavAutopilot.GENERIC, SYS_AUTOSTART=0) == {}


@pytest.mark.parametrize("kind", [COPTER, PX4_COPTER])
def test_over_http(kind) -> None:
    async def scenario(ground: Ground) -> None:
        await ground.wait_until(lambda: ground.station.connection.vehicles[1].health.ready)
        listed = (await ground.api.get("/api/vehicles/1/first-flight")).json["items"]
        found = {each["name"]: each for each in listed}
        assert found["airframe"]["state"] == "ok"
        assert found["settings"]["state"] == "ok"
        assert found["ready to arm"]["state"] == "ok"
        assert all(each["remedy"] for each in found.values() if each["state"] == "missing")

    serve(kind, scenario, full_telemetry=True)
