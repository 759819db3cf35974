"""Services and actions of a simulated vehicle as calls with JSON."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.core.calls import CALLS, VehicleCalls, request_fields
from mavstack.bridges.core.services.context import ServiceContext
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role
from mavstack.services.mission import MissionItem
from mavstack.sim.vehicle_types import VehicleType
from tests.vehicle.world import ARDUPILOT, World, fly

if TYPE_CHECKING:
    from mavstack.vehicle import Vehicle

COPTER = (VehicleType.COPTER, ARDUPILOT)


def calls(vehicle: Vehicle, role: Role = Role.ADMINISTER) -> VehicleCalls:
    return VehicleCalls(vehicle, role, ServiceContext(lambda name, values: None))


def test_calls_fly() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        call = calls(vehicle).call
        assert (await call("set_mode", {"custom_mode": "GUIDED"}))["ok"]
        armed = await call("arm", {})
        assert armed == {"ok": True, "result": {"success": True}}
        assert await call("action/takeoff", {"altitude": 5.0}) == {"ok": True, "result": {}}
        assert vehicle.position.relative_altitude == pytest.approx(5, abs=0.7)
        here = {"latitude": vehicle.position.latitude + 1e-4, "longitude": vehicle.position.longitude}
        assert (await call("action/goto", here))["ok"]
        assert vehicle.position.relative_altitude == pytest.approx(5, abs=0.7)

    fly(COPTER, scenario)


def test_requests_without_their_fields_leave_plan_and_home() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        await vehicle.fence.clear()
        await vehicle.mission.upload([MissionItem(16, param5=47.3977, param6=8.5456, param7=10.0)])
        call, home = calls(vehicle).call, vehicle.home
        for name in ("mission/push", "geofence/push", "mission/set_current", "cmd/takeoff", "ftp/truncate"):
            answer = await call(name, {})
            assert not answer["ok"]
            assert "needs the field" in answer["reason"]
        assert not (await call("cmd/set_home", {"current_gps": False, "latitude": 47.0}))["ok"]
        assert not (await call("cmd/set_home", {"current_gps": 1}))["ok"]
        assert len(await vehicle.mission.download()) == 1
        assert vehicle.home == home
        assert (await call("cmd/set_home", {"current_gps": True}))["ok"]
        assert vehicle.home != home

    fly(COPTER, scenario)


def test_refusals_hold_the_reason_of_the_vehicle() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        refused = await calls(vehicle).call("action/takeoff", {"altitude": -5})
        assert not refused["ok"]
        assert "altitude" in refused["reason"]
        refused = await calls(vehicle).call("set_mode", {"custom_mode": "SLEEP"})
        assert not refused["ok"]
        assert "SLEEP" in refused["reason"]

    fly(COPTER, scenario)


def test_an_observer_changes_nothing() -> None:
    async def scenario(world: World, vehicle: Vehicle) -> None:
        call = calls(vehicle, Role.OBSERVE).call
        for name, row in CALLS.items():
            if row.role > Role.OBSERVE:
                assert await call(name, {}) == {
                    "ok": False,
                    "reason": "control is not allowed: start the bridge with --allow-control",
                }
        assert (await call("vehicle_info_get", {"get_all": True}))["result"]["vehicles"][0]["sysid"] == 1

    fly(COPTER, scenario)


def test_fields_that_do_not_fit_are_refused() -> None:
    with pytest.raises(InvalidArgumentError, match="needs the field 'value'"):
        request_fields(CALLS["cmd/arming"], {})
    for wrong in (1, None, "true"):
        with pytest.raises(InvalidArgumentError, match="must be true or false"):
            request_fields(CALLS["cmd/arming"], {"value": wrong})
    with pytest.raises(InvalidArgumentError, match="needs the field 'longitude'"):
        request_fields(CALLS["action/goto"], {"latitude": 1, "altitude": 2, "yaw": 0})
    with pytest.raises(InvalidArgumentError, match="a sequence must be a list, got 4000000000"):
        request_fields(CALLS["ftp/write"], {"data": 4_000_000_000})
    with pytest.raises(InvalidArgumentError, match="no field 'mode'"):
        request_fields(CALLS["set_mode"], {"mode": "AUTO"})


def test_only_fields_whose_default_would_act_are_required() -> None:
    required = {name: row.required for name, row in CALLS.items() if row.required}
    assert required == {
        "cmd/arming": ("value",),
        "cmd/takeoff": ("altitude",),
        "cmd/takeoff_local": ("position",),
        "cmd/land_local": ("position",),
        "cmd/set_home": ("current_gps", "latitude", "longitude", "altitude"),
        "cmd/trigger_control": ("trigger_enable",),
        "set_stream_rate": ("stream_id", "message_rate", "on_off"),
        "mission/push": ("waypoints",),
        "mission/set_current": ("wp_seq",),
        "geofence/push": ("waypoints",),
        "rallypoint/push": ("waypoints",),
        "ftp/truncate": ("length",),
        "gimbal_control/manager/configure": (
            "sysid_primary",
            "compid_primary",
            "sysid_secondary",
            "compid_secondary",
        ),
        "gimbal_control/manager/pitchyaw": ("pitch", "yaw"),
        "gimbal_control/manager/set_roi": ("mode",),
        "gimbal_control/manager/camera_track": ("mode",),
        "mount_control/configure": ("mode",),
        "action/takeoff": ("altitude",),
        "action/goto": ("latitude", "longitude"),
    }
    command = request_fields(CALLS["cmd/command"], {"command": 511, "param1": 30})
    assert (command["command"], command["param1"], command["param7"]) == (511, 30.0, 0.0)
    assert command["broadcast"] is False
    goal = request_fields(CALLS["action/goto"], {"latitude": 1, "longitude": 2})
    assert (goal["latitude"], goal["longitude"]) == (1.0, 2.0)
    assert math.isnan(goal["altitude"])
    assert math.isnan(goal["yaw"])


@pytest.mark.parametrize("name", ["action/land", "action/rtl", "action/mission", "arm", "param/pull"])
def test_requests_without_fields(name: str) -> None:
    assert request_fields(CALLS[name], {})


@pytest.mark.parametrize("name", CALLS)
@given(
    request=st.dictionaries(
        st.sampled_from(["value", "altitude", "custom_mode", "waypoints", "param_id", "data", "broadcast"]),
        st.none() | st.booleans() | st.integers() | st.text(max_size=3) | st.lists(st.none(), max_size=2),
        max_size=3,
    )
)
def test_bad_requests_are_refused_or_valid(name: str, request: dict[str, Any]) -> None:
    with suppress(InvalidArgumentError):
        assert isinstance(request_fields(CALLS[name], request), dict)
