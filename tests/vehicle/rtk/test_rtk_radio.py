"""Corrections over simulated SiK radios in virtual time: the delay of commands, the share of telemetry."""

from __future__ import annotations

import asyncio
from random import Random
from statistics import quantiles
from typing import NamedTuple

import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.links.radio import sik_radio
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.gnss.test_rtcm import msm, station
from tests.sim.running import make_ready, running

COMMANDS_A_SECOND = 3
#: Seconds of each run: PX4 fills the radio, so that the delay of a command depends on its moment.
SECONDS = {Firmware.ARDUPILOT: 100, Firmware.PX4: 200}
#: Frames of each second beside that of the station: 800 bytes together.
EPOCH_SIZES = ((1074, 420), (1084, 350))
#: The part of the radio that corrections leave: 870 of 5760 bytes a second with the headers of packets.
TELEMETRY_SHARE = 0.85


class Measured(NamedTuple):
    """The delay of commands in seconds (95 %), bytes of telemetry a second, and the final state."""

    delay: float
    telemetry: int
    late: int
    is_fixed: bool


async def measure(firmware: Firmware, *, corrected: bool) -> Measured:
    """Send commands at random times over the radio, with corrections of 800 B/s or without."""
    simulation = Simulation(seed=5)
    simulation.add(VehicleType.COPTER, firmware)
    make_ready(simulation)
    network, loop, random = MemoryNetwork(), asyncio.get_running_loop(), Random(1)
    received: list[int] = []
    delays: list[float] = []
    async with running(simulation, network.link()), connect(sik_radio(network.link())) as node:
        vehicle = await node.wait_for_vehicle(1)
        await asyncio.sleep(10)  # until both ends know the pace of the radio
        node.add_packet_listener(None, lambda packet: received.append(len(packet.raw)))
        begun = loop.time()
        for number in range(COMMANDS_A_SECOND * SECONDS[firmware]):
            second, part = divmod(number, COMMANDS_A_SECOND)
            if corrected and part == 0:
                epoch = [msm(kind, second, size).data for kind, size in EPOCH_SIZES]
                vehicle.rtk.send(station().data + b"".join(epoch))
            due = begun + second + (part + random.random()) / COMMANDS_A_SECOND
            await asyncio.sleep(max(due - loop.time(), 0))
            sent = loop.time()
            await vehicle.component.command(common.MavCmd.DO_SET_HOME, 1)
            delays.append(loop.time() - sent)
        rate = round(sum(received) / (loop.time() - begun))
        delay, status = quantiles(delays, n=20)[18], vehicle.rtk.status
        return Measured(delay, rate, vehicle.rtk.counts.late, status.is_fixed)


@pytest.mark.flight
@pytest.mark.parametrize("firmware", list(Firmware), ids=[each.value for each in Firmware])
@pytest.mark.flight_cases(1)
def test_corrections_delay_commands_little_and_leave_telemetry_its_share(firmware):
    without, corrected = (run_virtually(measure(firmware, corrected=each)) for each in (False, True))
    assert corrected.delay - without.delay <= 0.05, (without, corrected)
    assert without.telemetry > 2000
    assert corrected.telemetry >= TELEMETRY_SHARE * without.telemetry, (without, corrected)
    assert (without.is_fixed, corrected.is_fixed, corrected.late) == (False, True, 0)
