"""Services and actions of a simulated vehicle as calls with JSON."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavstack.bridges.core.calls import CALLS, VehicleCalls, request_fields
from mavstack.bridges.core.row import Action
from mavstack.bridges.core.services.context import ServiceContext
from mavstack.errors import InvalidArgumentError
from mavstack.security.roles import Role
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
        assert (await call("action/goto", here | {"altitude": None, "yaw": None}))["ok"]
        assert vehicle.position.relative_altitude == pytest.approx(5, abs=0.7)

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
        request_fields("mavros_msgs/srv/CommandBool_Request", {})
    with pytest.raises(InvalidArgumentError, match="must be true or false"):
        request_fields("mavros_msgs/srv/CommandBool_Request", {"value": 1})
    with pytest.raises(InvalidArgumentError, match="needs the field 'altitude'"):
        request_fields(
            "mavstack_msgs/action/Goto_Goal", {"latitude": 1, "longitude": 2, "yaw": 0}, all_required=True
        )
    with pytest.raises(InvalidArgumentError, match="a sequence must be a list, got 4000000000"):
        request_fields("mavros_msgs/srv/FileWrite_Request", {"data": 4_000_000_000})
    with pytest.raises(InvalidArgumentError, match="no field 'mode'"):
        request_fields("mavros_msgs/srv/SetMode_Request", {"mode": "AUTO"})


@pytest.mark.parametrize("name", CALLS)
@given(
    request=st.dictionaries(
        st.sampled_from(["value", "altitude", "custom_mode", "waypoints", "param_id", "data", "broadcast"]),
        st.none() | st.booleans() | st.integers() | st.text(max_size=3) | st.lists(st.none(), max_size=2),
        max_size=3,
    )
)
def test_bad_requests_are_refused_or_valid(name: str, request: dict[str, Any]) -> None:
    row = CALLS[name]
    suffix = "_Goal" if isinstance(row, Action) else "_Request"
    with suppress(InvalidArgumentError):
        assert isinstance(request_fields(row.type + suffix, request), dict)
