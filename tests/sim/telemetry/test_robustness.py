"""Random bodies and all states of a flight: every message can be built and encoded."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import nan
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.geodesy import LocalFrame
from mavstack.sim.motion.readings import (
    AttitudeSetpoint,
    BatteryState,
    EstimateHealth,
    Motion,
    SensorReadings,
    Wind,
)
from mavstack.sim.telemetry.ardupilot import TYPES_SENDING, ardupilot_producers
from mavstack.sim.telemetry.producers import Producers
from mavstack.sim.telemetry.px4 import px4_producers
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.wire import Encoder
from tests.sim.autopilot.harness import GUIDED, LAND, RETURN
from tests.sim.telemetry.flight import VEHICLE_IDS, VEHICLES, Flight

if TYPE_CHECKING:
    from mavstack.dialects import Message

NUMBER = st.floats(-1e7, 1e7) | st.sampled_from([0.0, -0.0, 1e9, -1e9])
UNKNOWN = NUMBER | st.just(nan)
INTEGERS = {
    "gps_fix": st.integers(0, 8),
    "gps_satellites": st.integers(-1, 1000),
    "cells": st.integers(1, 14),
}


@dataclass
class AnyBody:
    """A body as telemetry reads it, with arbitrary values."""

    truth: Motion
    estimate: Motion
    attitude_setpoint: AttitudeSetpoint
    sensors: SensorReadings
    battery: BatteryState
    health: EstimateHealth
    wind: Wind
    airspeed: float
    throttle: float
    transition: float
    on_ground: bool
    flies_forward: bool
    servos: tuple[int, ...]
    frame: LocalFrame


def _tuples(record_type, numbers):
    fields = {
        name: INTEGERS.get(name, st.booleans() if hint in (bool, "bool") else numbers)
        for name, hint in record_type.__annotations__.items()
    }
    return st.builds(record_type, **fields)


BODIES = st.builds(
    AnyBody,
    truth=_tuples(Motion, NUMBER),
    estimate=_tuples(Motion, NUMBER),
    attitude_setpoint=_tuples(AttitudeSetpoint, NUMBER),
    sensors=_tuples(SensorReadings, UNKNOWN),
    battery=_tuples(BatteryState, UNKNOWN),
    health=_tuples(EstimateHealth, NUMBER),
    wind=_tuples(Wind, NUMBER),
    airspeed=UNKNOWN,
    throttle=NUMBER,
    transition=st.floats(0.0, 1.0),
    on_ground=st.booleans(),
    flies_forward=st.booleans(),
    servos=st.tuples(*[st.integers(-1, 70_000)] * 16),
    frame=st.builds(LocalFrame, st.floats(-90, 90), st.floats(-180, 180), st.floats(-1000, 10_000)),
)


@cache
def _flight(vehicle_type: VehicleType, firmware: Firmware) -> Flight:
    flight = (
        Flight(vehicle_type, firmware, RNGFND1_TYPE=1)
        if firmware is Firmware.ARDUPILOT
        else Flight(vehicle_type, firmware)
    )
    return flight.fly(3.0)


def _producers(flight: Flight):
    producers = Producers(flight.vehicle)
    return (px4_producers if flight.vehicle.firmware is Firmware.PX4 else ardupilot_producers)(producers)


def _send_all(flight: Flight) -> set[type[Message]]:
    """Build and encode every message that the vehicle can send; return the types of those that exist."""
    encoder, types = Encoder(1, 1), set()
    for message_type, produce in _producers(flight).items():
        message = produce(flight.now)
        if message is not None:
            assert type(message).__mavlink_row__[0] == message_type.__mavlink_row__[0]
            assert encoder.encode(message, flight.now)
            types.add(message_type)
    return types


@pytest.mark.nightly
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    body=BODIES,
    vehicle_and_firmware=st.sampled_from(VEHICLES),
    target=st.none() | st.tuples(NUMBER, NUMBER, NUMBER),
)
def test_random_bodies(body, vehicle_and_firmware, target):
    flight = _flight(*vehicle_and_firmware)
    vehicle, autopilot = flight.vehicle, flight.vehicle.autopilot
    original_body, vehicle.body = vehicle.body, body
    autopilot.target, before = target, autopilot.target
    try:
        types = _send_all(flight)
    finally:
        vehicle.body, autopilot.target = original_body, before
    assert len(types) >= 25


@pytest.mark.fast_cases(1)
@pytest.mark.flight_cases(1)
@pytest.mark.parametrize(("vehicle_type", "firmware"), VEHICLES, ids=VEHICLE_IDS)
def test_every_state_of_a_flight(vehicle_type, firmware):
    """Boot, ready, armed, guided, without GPS, returning, landed; over a MAVLink 2 link."""
    flight = Flight(vehicle_type, firmware)
    states = [
        lambda: None,
        lambda: flight.run(3.0),
        flight.vehicle.autopilot.arm,
        lambda: flight.vehicle.autopilot.enter(GUIDED, "test"),
        lambda: flight.fly(6.0),
        lambda: flight.body.fail_gps(True),
        lambda: flight.vehicle.autopilot.enter(RETURN, "test"),
        lambda: flight.body.fail_gps(False),
        lambda: flight.vehicle.autopilot.enter(LAND, "test"),
        lambda: flight.vehicle.autopilot.disarm("test"),
        flight.vehicle.reboot,
    ]
    sent_types = set()
    for begin in states:
        begin()  # type: ignore[operator]
        flight.step()
        sent_types |= _send_all(flight)
        flight.run(2.0)
        sent_types |= _send_all(flight)
    assert flight.port.state.unsendable == 0
    rare = {
        "OrbitExecutionStatus",
        "FenceStatus",
        "PositionTargetLocalNed",
        "NavControllerOutput",
        "RcChannels",
    }
    rare |= {
        "PositionTargetGlobalInt",
        "EscInfo",
        "EscStatus",
        "EscTelemetry1To4",
        "DistanceSensor",
        "EfiStatus",
        "GeneratorStatus",
        "Rangefinder",
        "WinchStatus",
    }
    missing = {
        message_type.__name__
        for message_type in _producers(flight).keys() - sent_types
        if flight.vehicle.vehicle_type in TYPES_SENDING.get(message_type, VehicleType)
    }
    assert missing <= rare
