"""MAVProxy serves terrain, without a network, to a simulated vehicle, and checks it."""

from __future__ import annotations

import pickle
import zipfile
from array import array

import pytest

from mavstack.files.elevation import HgtFolder
from mavstack.sim import DEFAULT_HOME, Simulation
from tests.interop.mavproxy import mavproxy, needs_mavproxy
from tests.interop.simulated import Flight
from tests.sim.running import running

pytestmark = [pytest.mark.interop, pytest.mark.timeout(240), needs_mavproxy]

#: MAVProxy takes a list of files with fewer entries for a damaged one, and asks the network for another.
MIN_LIST = 14_501
EDGE = 1201
HERE = DEFAULT_HOME.latitude, DEFAULT_HOME.longitude


def make_tiles(directory):
    """Write the cache that MAVProxy looks for at home: a list of files, and one of them."""
    folder = directory / ".tilecache" / "SRTM3"
    folder.mkdir(parents=True)
    files = {(number, 1000): ("/", "none") for number in range(MIN_LIST)}
    files[(47, 8)] = ("/", "N47E008.hgt.zip")
    (folder / "filelist_python").write_bytes(pickle.dumps(files))
    heights = array("h")
    for row in range(EDGE):
        heights.extend(500 + (row * 3 + column * 2) % 900 for column in range(EDGE))
    heights.byteswap()
    with zipfile.ZipFile(folder / "N47E008.hgt.zip", "w") as archive:
        archive.writestr("N47E008.hgt", heights.tobytes())
    return folder


async def test_mavproxy_serves_terrain(tmp_path) -> None:
    heights = HgtFolder(make_tiles(tmp_path))
    simulation = Simulation()
    vehicle = simulation.add("copter", "ardupilot", terrain="request")
    async with (
        running(simulation, "udpin://127.0.0.1:0", speed=4.0) as simulated,
        mavproxy(simulated.link.address[1], tmp_path, modules="terrain") as console,
    ):
        flight = Flight(vehicle, console, simulated)
        await console.wait_for_output("Detected vehicle 1:1")
        console.send_line("terrain set terrain_data_rate 200")
        await flight.wait_until(lambda: vehicle.terrain.height(*HERE) is not None)
        await flight.wait_until(lambda: vehicle.terrain.loaded >= 2 * 56)
        assert vehicle.terrain.height(*HERE) == pytest.approx(heights(*HERE), abs=10)
        await console.send_until_answered(
            f"terrain check {HERE[0]} {HERE[1]}", "TERRAIN_REPORT {", "spacing : 100"
        )
        await console.send_until_answered("terrain status", "blocks_sent: ")
        assert not console.errors()
