from __future__ import annotations

import pytest

from mavstack.cli.demo.fleet_display import render
from mavstack.cli.demo.fleet_state import FleetState
from mavstack.dialects import Dialect, ardupilotmega, common
from mavstack.wire import Encoder, Parser

DIALECT = Dialect.load("all")


def receive(watch: FleetState, system: int, *messages, now: float = 0.0) -> None:
    encoder, parser = Encoder(system, 1), Parser(DIALECT)
    for message in messages:
        for packet in parser.feed(encoder.encode(message)):
            watch.update(packet, now)


def beat(**fields):
    usual = {"type": 2, "autopilot": 3, "base_mode": 209, "custom_mode": ardupilotmega.CopterMode.AUTO}
    return common.Heartbeat(**{**usual, **fields}, mavlink_version=3)


@pytest.fixture
def watch() -> FleetState:
    watch = FleetState(DIALECT)
    for system in (1, 12):
        place = common.GlobalPositionInt(lat=470_000_000 + 1000 * system, lon=80_000_000, relative_alt=12_300)
        receive(watch, system, beat(), place, common.VfrHud(groundspeed=4.5, heading=270))
    receive(watch, 1, common.SysStatus(battery_remaining=17), common.MissionCurrent(seq=3, total=9))
    receive(watch, 12, common.Statustext(severity=4, text="GCS Failsafe"))
    return watch


def lines(watch: FleetState, width: int, height: int, now: float = 1.0) -> list[str]:
    return [line.plain for line in render(watch.snapshot(now), "seven vehicles", width, height, 65.0)]


@pytest.mark.parametrize(("width", "height"), [(120, 40), (80, 24), (100, 30), (40, 10), (200, 60)])
def test_lines_fit_the_terminal(watch, width, height):
    drawn = lines(watch, width, height)
    assert len(drawn) <= height
    assert all(len(line) <= width for line in drawn)
    assert "seven vehicles" in drawn[0]


@pytest.mark.parametrize("width", [80, 120])
def test_vehicle_line(watch, width):
    line = next(line for line in lines(watch, width, 30) if line.startswith("  1  "))
    for word in ("ArduPilot", "AUTO", "ARMED", "12.3 m", "4.5 m/s", "17%", "3/9"):
        assert word in line
    assert ("270°" in line) == (width >= 100)


def test_status_texts(watch):
    assert any("GCS Failsafe" in line and line.strip().startswith("C") for line in lines(watch, 100, 30))
    assert any(line.startswith("C12") for line in lines(watch, 100, 30))


def test_silent_vehicle(watch):
    receive(watch, 1, beat(), now=20.0)
    drawn = lines(watch, 120, 30, now=21.0)
    assert any("silent for 21 s" in line for line in drawn)
    assert sum("AUTO" in line for line in drawn) == 1


def test_unknown_position_is_not_on_the_map():
    watch = FleetState(DIALECT)
    receive(watch, 1, beat(), common.GlobalPositionInt(lat=0, lon=0))
    assert watch.vehicles[1].latitude is None
    assert not watch.vehicles[1].track


def test_ground_stations_are_ignored():
    watch = FleetState(DIALECT)
    receive(watch, 255, beat(autopilot=common.MavAutopilot.INVALID, type=common.MavType.GCS))
    assert not watch.vehicles


def test_snapshot_does_not_change():
    watch = FleetState(DIALECT)
    receive(watch, 1, beat(), common.GlobalPositionInt(lat=1000, lon=1000, relative_alt=1000))
    moment = watch.snapshot(0.0)
    receive(watch, 1, common.GlobalPositionInt(lat=90000, lon=1000, relative_alt=9000))
    assert moment.vehicles[0].height == 1.0
    assert len(moment.vehicles[0].track) == 1
