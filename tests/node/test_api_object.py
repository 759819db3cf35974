"""Assignments to attributes of the API objects, in the async and the blocking API."""

from __future__ import annotations

import pytest

import mavstack
import mavstack.sync
from mavstack.dialects import common
from mavstack.node import Node
from mavstack.services import Address
from mavstack.services.setpoints import LocalSetpoint
from mavstack.vehicle.vehicle import Vehicle


@pytest.fixture
def vehicle():
    connection = mavstack.connect("udpin://127.0.0.1:0")
    return Vehicle(connection, connection.component(1))


def parts_of(vehicle):
    component = vehicle.component
    names = ("params", "extended_params", "ftp", "logs", "modes", "mission", "fence", "rally")
    yield from (getattr(component, name) for name in names)
    yield from (component, component.shell(), component.setpoints(), vehicle.connection)
    yield from (vehicle, vehicle.mission, vehicle.fence, vehicle.connection.group())
    yield from (vehicle.guided(first=LocalSetpoint(velocity=(0, 0, 0))), vehicle.stream(common.Attitude))
    yield from (vehicle.connection.stream(common.Attitude), vehicle.connection.commands)


def public_names(part):
    names = set(dir(type(part))) | set(vars(part)) | {"nonsense", "speed", "altitude"}
    return sorted(name for name in names if not name.startswith("_"))


async def test_no_attribute_of_an_api_object_can_be_assigned(vehicle):
    for part in parts_of(vehicle):
        before = dict(vars(part))
        for name in public_names(part):
            with pytest.raises(AttributeError, match=f"has no settable attribute '{name}'"):
                setattr(part, name, 7)
        assert vars(part) == before


def test_the_error_names_the_call_that_sets(vehicle):
    with pytest.raises(AttributeError, match=r"'mode'; call set_mode\(\)"):
        vehicle.mode = "GUIDED"
    with pytest.raises(AttributeError, match="'armed'; it is read-only"):
        vehicle.armed = True
    with pytest.raises(AttributeError, match=r"'moed'$"):
        vehicle.moed = "GUIDED"


def test_a_subclass_may_have_a_setter_and_private_attributes():
    class Own(Node):
        def __init__(self) -> None:
            super().__init__("udpin://127.0.0.1:0")
            self._altitude = 0.0
            self.winch = "up"

        @property
        def altitude(self) -> float:
            return self._altitude

        @altitude.setter
        def altitude(self, value: float) -> None:
            self._altitude = value

    own = Own()
    own.altitude = 5.0
    assert own.altitude == 5.0
    own.winch = "down"
    assert (own.winch, own.address) == ("down", Address(255, 190))
    with pytest.raises(AttributeError, match="'address'; it is read-only"):
        own.address = Address(1, 1)


def test_blocking_objects_refuse_the_same_assignments():
    with mavstack.sync.connect("udpin://127.0.0.1:0") as connection:
        component = connection.component(1)
        for part in (connection, component, component.params, component.mission, component.ftp):
            for name in public_names(part._inner):
                with pytest.raises(AttributeError, match=f"has no settable attribute '{name}'"):
                    setattr(part, name, 7)
        assert component.address == Address(1, 1)
        assert connection.links
