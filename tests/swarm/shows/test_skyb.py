"""Files of vehicles, written and read back."""

from __future__ import annotations

import struct
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.errors import InvalidArgumentError
from mavstack.swarm.shows.reading import parse_show
from mavstack.swarm.shows.show import Curve, ShowVehicle, Trajectory
from mavstack.swarm.shows.skyb import read_skyb, write_skyb
from tests.swarm.shows.samples import LIGHTS, csv_archive, skyc

coordinates = st.tuples(*[st.floats(-300.0, 300.0)] * 3)


@pytest.mark.parametrize("make", [skyc, csv_archive])
def test_a_file_holds_trajectory_and_lights(make):
    for vehicle in parse_show(make(3)).vehicles:
        found = read_skyb(write_skyb(vehicle), vehicle.name)
        times = np.arange(0.0, vehicle.trajectory.end, 0.1)
        difference = found.trajectory.positions(times) - vehicle.trajectory.positions(times)
        assert np.abs(difference).max() < 0.003
        assert found.lights == vehicle.lights


@given(st.lists(st.lists(coordinates, min_size=1, max_size=7), min_size=1, max_size=4), st.floats(0.5, 150.0))
def test_any_trajectory_is_kept(parts, duration):
    curves, here = [], (0.0, 0.0, 0.0)
    for index, part in enumerate(parts):
        curves.append(Curve(index * duration, duration, [here, *part]))
        here = part[-1]
    trajectory = Trajectory(curves)
    found = read_skyb(write_skyb(ShowVehicle("one", trajectory))).trajectory
    times = np.linspace(0.0, trajectory.end, 60)
    difference = np.abs(found.positions(times) - trajectory.positions(times)).max()
    assert (
        difference < 0.02 + 300.0 * 50 * 0.0006 / duration
    )  # units of 10 mm, and times of whole milliseconds


def test_the_bytes_are_those_of_the_format():
    vehicle = ShowVehicle("one", Trajectory([Curve(0.0, 2.0, [(1.0, 0.0, 0.0), (1.0, 0.0, 5.0)])]), b"\x00")
    body = struct.pack("<Bhhhh", 1, 1000, 0, 0, 0) + struct.pack("<BHh", 1 << 4, 2000, 5000)
    blocks = struct.pack("<BH", 1, len(body)) + body + struct.pack("<BH", 2, 1) + b"\x00"
    blank = b"skyb\x02\x01" + bytes(4) + blocks
    checksum = 0
    for byte in blank:  # bit by bit, without zlib's inversions
        checksum ^= byte
        for _ in range(8):
            checksum = checksum >> 1 ^ (0xEDB88320 if checksum & 1 else 0)
    assert write_skyb(vehicle) == blank[:6] + struct.pack("<I", checksum) + blank[10:]
    assert zlib.crc32(blank) != checksum


def test_damaged_and_impossible_files_are_refused():
    data = write_skyb(parse_show(skyc(1)).vehicles[0])
    for end in range(len(data)):
        with pytest.raises(InvalidArgumentError):
            read_skyb(data[:end])
    with pytest.raises(InvalidArgumentError, match="checksum"):
        read_skyb(data[:-1] + bytes([data[-1] ^ 1]))
    far = Trajectory([Curve(0.0, 1.0, [(0, 0, 0), (9000, 0, 0)])])
    with pytest.raises(InvalidArgumentError, match="reaches 9000 m"):
        write_skyb(ShowVehicle("far", far))
    with pytest.raises(InvalidArgumentError, match="the format holds"):
        write_skyb(ShowVehicle("long", parse_show(skyc(1)).vehicles[0].trajectory, LIGHTS * 9000))
