"""The settings of a flight controller as parameters."""

from __future__ import annotations

import pytest

from mavstack.errors import ParameterDenied
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.fake_controller import bridged, run


def test_all_of_them_with_aliases_and_equipment():
    async def scenario(vehicle, controller, bridge):
        found = await vehicle.params.download()
        assert {name: each.value for name, each in found.items()} == {
            "MSP_HAS_OSD": 0,
            "MSP_HAS_VTX": 0,
            "BF_PID_ROLL_P": 45,
            "BF_RC_EXPO": 10,
            "BF_RATE_RC_EXPO": 10,
            "BF_FEATURES": 0xF000_0001,  # 32 bits, which a float has not
        }
        assert vehicle.capabilities.osd is False
        assert vehicle.capabilities.vtx is False

    run(scenario)


def test_a_value_is_read_anew():
    async def scenario(vehicle, controller, bridge):
        assert (await vehicle.params.get("BF_RC_EXPO")).value == 10
        controller.settings.values["BF_RC_EXPO"] = 20
        assert (await vehicle.params.get("BF_RATE_RC_EXPO")).value == 20

    run(scenario)


def test_a_set_is_written_and_read_back():
    async def scenario(vehicle, controller, bridge):
        await vehicle.params.set("BF_PID_ROLL_P", 50)
        assert controller.settings.values["BF_PID_ROLL_P"] == 50
        await vehicle.params.set("BF_RATE_RC_EXPO", 30)
        assert (await vehicle.params.get("BF_RC_EXPO")).value == 30
        assert controller.saved == 0

    run(scenario)


@pytest.mark.parametrize(("name", "value"), [("BF_PID_ROLL_P", 201), ("MSP_HAS_OSD", 1), ("BF_RC_EXPO", 13)])
def test_refused_values(name, value):
    async def scenario(vehicle, controller, bridge):
        await vehicle.params.download()
        before = dict(controller.settings.values)
        with pytest.raises(ParameterDenied):
            await vehicle.params.set(name, value)
        assert controller.settings.values == before

    run(scenario)


def test_a_refusal_of_the_firmware_is_reported():
    async def scenario(vehicle, controller, bridge):
        controller.settings.refused = True
        with pytest.raises(ParameterDenied, match="refused by the firmware"):
            await vehicle.params.set("BF_RC_EXPO", 40)

    run(scenario)


def test_requests_wait_until_the_settings_are_loaded():
    async def work():
        async with bridged() as (connection, _, _):
            vehicle = await connection.wait_for_vehicle()
            assert (await vehicle.params.get("BF_RC_EXPO")).value == 10

    run_virtually(work())
