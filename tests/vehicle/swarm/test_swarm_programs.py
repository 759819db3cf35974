"""More vehicles than a network has system ids: several simulators, and a connection to each of them."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from contextlib import contextmanager

import pytest

from mavstack.vehicle import connect
from mavstack.vehicle.swarm.launch import take_off

pytestmark = [pytest.mark.nightly, pytest.mark.timeout(600)]
#: Vehicles of each program; together there are more than 255.
COUNT = 130
MEMBERS = (1, 2, 3, 4)


@contextmanager
def simulators(number):
    """Run programs of `COUNT` vehicles each; yield the URL of each."""
    words = [sys.executable, "-m", "tests.vehicle.swarm.fleet_program", str(COUNT)]
    programs = [
        subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(number)
    ]
    try:
        yield [program.stdout.readline().strip() for program in programs]
    finally:
        for program in programs:
            program.communicate(timeout=60)


async def fly_formation(url):
    """Fly a formation; return all system ids that are received, and places and separation of its members."""
    async with connect(url) as connection:
        vehicles = await connection.wait_for_vehicles(COUNT, timeout=120.0)
        group = connection.group(*MEMBERS)
        (await take_off(group, 10.0)).check()
        async with connection.swarm(*MEMBERS) as swarm:
            await swarm.formation("diamond", spacing=12)
            return {each.system for each in vehicles}, swarm.places, swarm.smallest_separation


async def test_swarms_of_two_programs_fly_at_once():
    with simulators(2) as urls:
        found = await asyncio.gather(*map(fly_formation, urls))
    for systems, places, separation in found:
        assert systems == set(range(1, COUNT + 1))
        assert places[:, 2] == pytest.approx([10.0] * len(MEMBERS), abs=1.5)
        assert separation > 4.0
