from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import MavstackError
from mavstack.sim import DEFAULT_HOME, Firmware, Home, Simulation, VehicleType
from mavstack.sim.scenarios import execute_command, run_until, take_off
from mavstack.wire import Parser


def everything_sent(seed: int, seconds: float = 6.0) -> bytes:
    simulation = Simulation(seed=seed)
    for firmware in Firmware:
        for kind in (VehicleType.COPTER, VehicleType.PLANE, VehicleType.SUB):
            simulation.add(kind, firmware).open_port("ground")
    simulation.world.set_wind(speed=5, direction=200, turbulence=0.3)
    sent = bytearray()
    while simulation.now < simulation._start + seconds:
        simulation.step()
        for vehicle in simulation.vehicles:
            if vehicle.uptime > 2.5 and not vehicle.autopilot.armed:
                vehicle.autopilot.arm()
        sent += b"".join(data for _, _, data in simulation.data_to_send())
    return bytes(sent)


@pytest.mark.nightly
def test_the_same_seed_gives_the_same_bytes():
    first = everything_sent(7)
    assert len(first) > 50_000
    assert first == everything_sent(7)
    assert first != everything_sent(8)


def test_time_goes_in_equal_steps():
    simulation = Simulation(rate=50, start=1000.0)
    simulation.advance(1000.0999)
    assert simulation.now == pytest.approx(1000.08)
    simulation.advance(1000.1 - 1e-9)  # a rounding error before the step
    assert simulation.now == pytest.approx(1000.1)
    simulation.advance(1000.0)  # time never goes back
    assert simulation.now == pytest.approx(1000.1)


def test_system_ids_are_free_ones():
    simulation = Simulation()
    simulation.add(system=2)
    assert [simulation.add().address.system for _ in range(3)] == [1, 3, 4]
    with pytest.raises(MavstackError, match="system id"):
        simulation.add(system=3)
    with pytest.raises(MavstackError, match="system id"):
        simulation.add(system=256)


def test_types_are_named_by_their_words():
    simulation = Simulation()
    vehicle = simulation.add("rover", "px4")
    assert (vehicle.vehicle_type, vehicle.firmware) == (VehicleType.ROVER, Firmware.PX4)
    with pytest.raises(ValueError, match="spaceship"):
        simulation.add("spaceship")


def test_a_vehicle_stands_where_it_was_put():
    simulation = Simulation()
    home = Home(-33.9, 151.2, 30.0, 90.0)
    vehicle = simulation.add(home=home)
    run_until(simulation, lambda: vehicle.autopilot.home is not None)
    assert vehicle.autopilot.home.latitude == pytest.approx(home.latitude, abs=1e-4)
    assert vehicle.autopilot.home.longitude == pytest.approx(home.longitude, abs=1e-4)
    assert vehicle.autopilot.home.altitude == pytest.approx(home.altitude, abs=3)
    assert vehicle.body.truth.yaw == pytest.approx(1.5708, abs=0.02)


@pytest.mark.fast_cases(1)
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize("firmware", Firmware)
@pytest.mark.parametrize("kind", VehicleType)
def test_a_target_in_the_air_is_there_at_once(kind, firmware):
    simulation = Simulation()
    vehicle = simulation.add(kind, firmware)
    take_off(simulation, vehicle)
    assert vehicle.autopilot.armed
    assert (vehicle.autopilot.altitude > 8) == kind.flies
    assert vehicle.uptime < 60
    simulation.advance(simulation.now + 20)
    assert (vehicle.autopilot.altitude > 8) == kind.flies
    assert vehicle.autopilot.armed or not kind.flies


@pytest.mark.flight
def test_waiting_for_what_never_comes_ends():
    simulation = Simulation()
    simulation.add()
    with pytest.raises(MavstackError, match="10 simulated seconds"):
        run_until(simulation, lambda: False, timeout=10)


def test_an_order_that_is_not_known():
    vehicle = Simulation().add()
    assert execute_command(vehicle, 31_999) == common.MavResult.UNSUPPORTED


def test_a_vehicle_without_peers_keeps_nothing_to_send():
    simulation = Simulation()
    vehicle = simulation.add()
    simulation.advance(simulation.now + 5)
    assert vehicle.data_to_send() == []
    port = vehicle.open_port("late")
    simulation.advance(simulation.now + 1.5)
    sent = vehicle.data_to_send()
    assert {known for known, _ in sent} == {port}
    names = {packet.name for _, data in sent for packet in Parser(common).feed(data)}
    assert "HEARTBEAT" in names


def test_a_closed_port_receives_nothing():
    simulation = Simulation()
    vehicle = simulation.add()
    gone, stays = vehicle.open_port("gone"), vehicle.open_port("stays")
    simulation.advance(simulation.now + 2)
    vehicle.close_port(gone)
    simulation.advance(simulation.now + 2)
    assert {port for port, _ in vehicle.data_to_send()} == {stays}


def test_home_is_read_from_text():
    assert Home.parse("47.5,8.25,400,90") == (47.5, 8.25, 400.0, 90.0)
    assert Home.parse(" -1 , 2") == (-1.0, 2.0, 0.0, 0.0)
    for wrong in ("", "47", "91,0", "0,181,0,0", "a,b", "1,2,3,4,5", "nan,0", "0,0,1e9,0", "0,0,0,361"):
        with pytest.raises(MavstackError):
            Home.parse(wrong)
    assert DEFAULT_HOME.latitude


@pytest.mark.fast_cases(1)
@pytest.mark.parametrize(("firmware", "suffix"), [("ardupilot", "BIN"), ("px4", "ulg")])
def test_flights_are_kept_in_a_folder(tmp_path, firmware, suffix):
    for flights in (1, 2):
        simulation = Simulation(storage=tmp_path)
        vehicle = simulation.add(firmware=firmware, system=7)
        take_off(simulation, vehicle)
        simulation.advance(simulation.now + 5)
        simulation.close()
        logs = list((tmp_path / "7").rglob(f"*.{suffix}"))
        assert len(logs) == flights
        assert all(log.stat().st_size > 10_000 for log in logs)
        assert len(vehicle.storage.logs.logs()) == flights
