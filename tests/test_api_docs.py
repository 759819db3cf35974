"""The contracts of the public API: documented arguments and errors, one meaning for each argument."""

from __future__ import annotations

import re
from inspect import Parameter, getdoc, iscoroutinefunction, signature

import pytest

from mavstack import errors
from mavstack.errors import MavstackError
from mavstack.node import EventListener, EventStream, Node, RemoteComponent
from mavstack.node.camera import Camera
from mavstack.node.camera_settings import CameraSettings
from mavstack.node.extended_params import ExtendedParams
from mavstack.node.ftp import Ftp
from mavstack.node.gimbal import Gimbal
from mavstack.node.logs import Logs
from mavstack.node.modes import Modes
from mavstack.node.params import Params
from mavstack.node.plans import Plans
from mavstack.node.shell import Shell
from mavstack.services import DEFAULT_WAIT_TIMEOUT
from mavstack.vehicle import (
    Actuators,
    Calibration,
    CalibrationSession,
    Connection,
    Group,
    GuidedSession,
    MessageStream,
    Mission,
    RegionOfInterest,
    ValueStream,
    Vehicle,
    VehiclePlan,
)
from mavstack.vehicle.swarm import Swarm

PARTS = (
    EventListener,
    EventStream,
    Camera,
    CameraSettings,
    Gimbal,
    Params,
    ExtendedParams,
    Ftp,
    Logs,
    Modes,
    Plans,
    Shell,
    Mission,
    VehiclePlan,
    GuidedSession,
    Actuators,
    Calibration,
    CalibrationSession,
    RegionOfInterest,
    Swarm,
)
CLASSES = (Node, Connection, RemoteComponent, Vehicle, Group, MessageStream, ValueStream, *PARTS)
#: Coroutines that raise no error of Mavstack.
RAISES_NOTHING = {
    "Node.close": "closing succeeds in every state of the links",
    "Node.serve_forever": "it only waits to be cancelled",
}
ERRORS = {
    name
    for name, value in vars(errors).items()
    if isinstance(value, type) and issubclass(value, MavstackError)
}
SECTION = r"^{}:\n((?:[ ]{{4}}.*\n?|\n)+)"


def public_coroutines():
    seen = set()
    for owner in CLASSES:
        for name in dir(owner):
            function = getattr(owner, name)
            if not name.startswith("_") and iscoroutinefunction(function) and function not in seen:
                seen.add(function)
                owner_name, _, _ = function.__qualname__.rpartition(".")
                yield f"{owner_name or owner.__name__}.{name}", function


COROUTINES = dict(public_coroutines())


def arguments_of(function):
    """Return the arguments without the first one, the object; the classes have no static coroutines."""
    return list(signature(function).parameters.values())[1:]


def section(function, title):
    found = re.search(SECTION.format(title), getdoc(function) or "", re.MULTILINE)
    return "" if found is None else found.group(1)


def test_the_table_is_not_empty():
    assert len(COROUTINES) > 60
    assert set(RAISES_NOTHING) <= set(COROUTINES)


@pytest.mark.parametrize("name", COROUTINES)
def test_every_argument_is_documented(name):
    documented = set(re.findall(r"^ {4}\*{0,2}(\w+):", section(COROUTINES[name], "Args"), re.MULTILINE))
    assert documented == {each.name for each in arguments_of(COROUTINES[name])}


@pytest.mark.parametrize("name", COROUTINES)
def test_the_errors_are_documented(name):
    function = COROUTINES[name]
    if name in RAISES_NOTHING:
        return
    if name.startswith("Group.") and name != "Group.each":
        method = name.replace("Group", "Vehicle")
        flies_together = function.__module__ == "mavstack.vehicle.group_flights"
        if not flies_together or name == "Group.land_all":
            method = "Vehicle.land" if flies_together else method
            assert f"its errors are those of `{method}`" in section(function, "Returns")
            return
    raised = re.findall(r"^ {4}(\w+):", section(function, "Raises"), re.MULTILINE)
    assert raised, "no Raises section"
    assert set(raised) <= ERRORS | {"OSError", "ValueError", "TypeError"}
    assert set(raised) & ERRORS


def is_wait(name):
    return name.rpartition(".")[2].startswith(("wait_for_", "wait_until_"))


@pytest.mark.parametrize("name", COROUTINES)
def test_timeout_and_progress_mean_the_same_everywhere(name):
    for each in arguments_of(COROUTINES[name]):
        if each.name == "timeout":
            assert each.kind is Parameter.KEYWORD_ONLY
            assert each.annotation == "float | None"
            assert each.default == (DEFAULT_WAIT_TIMEOUT if is_wait(name) else None)
        if each.name == "progress":
            assert each.annotation == "Callable[[int, int], None] | None"
            assert each.default is None
        assert each.name not in {"limit", "patience", "what", "at_once", "kinds"}
