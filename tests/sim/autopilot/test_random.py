"""Whatever is asked of a vehicle in whatever order: nothing raises, and it stays in its world."""

from __future__ import annotations

from math import isfinite, sqrt
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavstack.dialects import common
from mavstack.errors import SetpointError
from mavstack.services import Address
from mavstack.services.setpoints import AttitudeSetpoint, GlobalSetpoint, LocalSetpoint, SetpointReceived
from mavstack.sim.autopilot.behaviours import (
    Acro,
    AltitudeHold,
    Brake,
    Circle,
    Hold,
    Land,
    Manual,
    Offboard,
    PositionHold,
    ReturnToLaunch,
    Stabilize,
    Stop,
    Takeoff,
)
from mavstack.sim.autopilot.radio import Sticks
from mavstack.sim.vehicle_types import VehicleType
from tests.sim.autopilot.harness import GUIDED, AutopilotHarness

F = common.MavFrame
FRAMES = [F.LOCAL_NED, F.LOCAL_OFFSET_NED, F.BODY_NED, F.BODY_OFFSET_NED]
ENTERED = (
    Acro, AltitudeHold, Brake, Circle, Hold, Land, Manual, Offboard, PositionHold, ReturnToLaunch,
    Stabilize, Stop, Takeoff,
)  # fmt: skip

sane = st.floats(-60, 60)
wild = st.one_of(sane, st.floats(allow_nan=False, allow_infinity=False, width=32), st.just(0.0))
axis = st.one_of(st.none(), wild)
axes = st.tuples(axis, axis, axis)
stick = st.floats(-1, 1)


@st.composite
def attitudes(draw: st.DrawFn) -> AttitudeSetpoint:
    parts = [draw(stick) for _ in range(4)]
    size = sqrt(sum(part * part for part in parts))
    quaternion = tuple(part / size for part in parts) if size > 0.1 else None
    return AttitudeSetpoint(quaternion, draw(axes), draw(st.one_of(st.none(), stick)))


setpoints = st.one_of(
    st.builds(
        LocalSetpoint,
        position=axes, velocity=axes, acceleration=axes, yaw=axis, yaw_rate=axis,
        frame=st.sampled_from(FRAMES),
    ),
    st.builds(
        GlobalSetpoint,
        latitude=st.one_of(st.none(), st.floats(47.39, 47.41), st.floats(-90, 90)),
        longitude=st.one_of(st.none(), st.floats(8.54, 8.55), st.floats(-180, 180)),
        altitude=axis, velocity=axes, acceleration=axes, yaw=axis, yaw_rate=axis,
        frame=st.sampled_from([F.GLOBAL, F.GLOBAL_RELATIVE_ALT, F.GLOBAL_TERRAIN_ALT]),
    ),
    attitudes(),
)  # fmt: skip
commands = st.one_of(
    st.tuples(st.just("go_to"), st.tuples(st.tuples(wild, wild, wild))),
    st.tuples(st.just("orbit"), st.tuples(st.tuples(wild, wild, wild), wild)),
    st.tuples(st.just("take_off"), st.tuples(st.floats(-10, 60))),
    st.tuples(st.just("fly_velocity"), st.tuples(wild, wild, wild)),
)
events = st.one_of(
    setpoints,
    commands,
    st.sampled_from(ENTERED),
    st.builds(Sticks, stick, stick, st.floats(0, 1), stick),
    st.sampled_from(["guided", "arm", "disarm", "forward", "hover", "gps", "no gps"]),
)


def happen(flight: AutopilotHarness, event: Any) -> None:
    autopilot, body = flight.autopilot, flight.body
    match event:
        case LocalSetpoint() | GlobalSetpoint() | AttitudeSetpoint():
            try:
                event.check()
            except SetpointError:
                return  # the receiver refuses it
            flight.vehicle.handle_event(SetpointReceived(Address(255, 190), event))
        case Sticks():
            flight.radio.sticks = event
        case (name, given_values):
            getattr(autopilot.guided, name)(*given_values)
        case "guided":
            autopilot.enter(GUIDED, "test")
        case "arm":
            autopilot.arm()
        case "disarm":
            autopilot.disarm("test")
        case "forward" | "hover":
            body.transition_to(event == "forward")
        case "gps" | "no gps":
            body.fail_gps(event == "no gps")
        case _:
            flight.fly(event)


@pytest.mark.nightly
@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    kind=st.sampled_from(list(VehicleType)),
    flown=st.lists(st.tuples(events, st.floats(0.1, 3.0)), min_size=1, max_size=12),
    climbs=st.booleans(),
)
def test_anything_may_be_asked_at_any_time(kind: VehicleType, flown: list[Any], climbs: bool) -> None:
    flight = AutopilotHarness(kind, thrust_is_climb=climbs, forward_beyond=150.0 if climbs else 1e9)
    flight.arm()
    for event, seconds in flown:
        happen(flight, event)
        flight.run(seconds)
        truth = flight.body.truth
        assert all(isfinite(value) for value in truth)
        assert truth.down <= (40.0 if kind is VehicleType.SUB else 0.0)
        if kind.on_surface:
            assert truth.down == 0.0


@pytest.mark.nightly
@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(kind=st.sampled_from(list(VehicleType)), targets=st.lists(setpoints, min_size=1, max_size=15))
def test_a_guided_vehicle_follows_any_setpoints(kind: VehicleType, targets: list[Any]) -> None:
    flight = AutopilotHarness(kind)
    flight.arm()
    flight.enter(GUIDED)
    if kind is VehicleType.COPTER:
        flight.autopilot.guided.take_off(5.0)
        flight.run(6)
    for setpoint in targets:
        happen(flight, setpoint)
        flight.run(0.7)
        assert all(isfinite(value) for value in flight.body.truth)
        assert flight.body.truth.down <= (40.0 if kind is VehicleType.SUB else 0.0)
