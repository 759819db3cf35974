"""Motor controllers, generator, engine and modem of simulated vehicles, and messages by instance."""

from __future__ import annotations

import pytest

from mavstack.dialects import common


def run(virtual_vehicle, work):
    virtual_vehicle.run(work)


@pytest.mark.vehicle(firmware="px4")
def test_motor_controllers_of_px4(virtual_vehicle):
    async def flight(vehicle):
        await vehicle.wait_until_ready()
        await vehicle.arm()
        async with vehicle.devices.stream_escs() as escs:
            async for state in escs:
                if len(state) == 4 and state[1].rpm and state[1].online:
                    break
        assert list(state) == [1, 2, 3, 4]
        assert 10 < state[1].voltage < 30
        assert state[1].temperature is not None
        assert vehicle.devices.escs[1].failures == 0
        async with vehicle.devices.stream_modems(rate=1) as modems:
            found = await anext(modems)
        assert (found[1].radio, found[1].quality) == (common.CellularNetworkRadioType.LTE, 76)
        assert vehicle.devices.modems == found

    run(virtual_vehicle, flight)


@pytest.mark.vehicle(firmware="ardupilot")
def test_engine_and_generator_of_ardupilot(virtual_vehicle):
    async def flight(vehicle):
        assert vehicle.devices.generator is vehicle.devices.engine is None
        for name in ("EFI_TYPE", "GEN_TYPE"):
            await vehicle.params.set(name, 1)
        async with vehicle.devices.stream_engine() as engines:
            assert (await anext(engines)).rpm == 0
            await vehicle.wait_until_ready()
            await vehicle.arm()
            async for engine in engines:
                if engine.rpm and engine.fuel_consumed:
                    break
        assert engine.healthy
        assert engine.throttle is not None
        async with vehicle.devices.stream_generator() as generators:
            async for generator in generators:
                if generator.power:
                    break
        assert generator.status & common.MavGeneratorStatusFlag.GENERATING
        assert generator.time_until_maintenance > 0
        async with vehicle.devices.stream_escs() as escs:
            assert list(await anext(escs)) == [1, 2, 3, 4]

    run(virtual_vehicle, flight)


def test_instances_are_kept_apart(virtual_vehicle):
    async def flight(vehicle):
        assert vehicle.devices.escs == {} or len(vehicle.devices.escs) == 4
        services = virtual_vehicle.vehicle.services
        for first in (0, 4):
            info = common.EscInfo(index=first, count=6, info=0b111111, temperature=(2500,) * 4)
            services.send(info)
            services.send(common.EscStatus(index=first, rpm=(first + 1,) * 4, voltage=(12.0,) * 4))
        async with vehicle.devices.stream_escs() as escs:
            async for state in escs:
                if len(state) == 6:
                    break
        assert [state[number].rpm for number in (1, 4, 5, 6)] == [1, 1, 5, 5]
        assert state[6].temperature == 25.0

    run(virtual_vehicle, flight)
