"""The definitions of interfaces, read from texts in the form of ROS 2.

A service has the messages `X_Request`, `X_Response` and `X_Event`. An action has `X_Goal`, `X_Result` and
`X_Feedback`, the services `X_SendGoal` and `X_GetResult`, and the message `X_FeedbackMessage`, as in rosidl.
A structure without fields gets one byte, since the languages that ROS supports have no empty ones.
"""

from __future__ import annotations

import re
from functools import cache
from importlib.resources import files
from typing import Final

from mavstack.bridges.core.types.model import PRIMITIVES, Constant, Container, Definition, Field, FieldType
from mavstack.errors import InvalidArgumentError

_ROOT: Final = "mavstack.bridges.core.types"
_FIELD: Final = re.compile(
    r"(?P<base>[\w/]+?)(?:<=(?P<text>\d+))?(?P<array>\[(?P<bound><=)?(?P<size>\d*)\])? "
    r"(?P<name>[a-z]\w*)(?: (?P<default>.+))?"
)
_CONSTANT: Final = re.compile(r"(?P<type>\w+(?:<=\d+)?) (?P<name>[A-Z]\w*)=(?P<value>.*)")
_EMPTY: Final = Field("structure_needs_at_least_one_member", FieldType("uint8"))
_UUID: Final = Field("goal_id", FieldType("unique_identifier_msgs/msg/UUID"))
_PARTS: Final = {"msg": ("",), "srv": ("_Request", "_Response"), "action": ("_Goal", "_Result", "_Feedback")}


def definition_of(name: str) -> Definition:
    """Return the definition of an interface.

    Args:
        name: The full name, such as "sensor_msgs/msg/Imu" or "std_srvs/srv/Trigger_Request".

    Returns:
        The definition; a service or an action is the structure of its messages from which its hash follows.

    Raises:
        InvalidArgumentError: There is no such interface.
    """
    package, _, rest = name.partition("/")
    found = _package(package).get(rest)
    if found is None:
        raise InvalidArgumentError(f"there is no definition of the interface {name!r}")
    return found


def interface_names(*kinds: str) -> tuple[str, ...]:
    """Return the full names of all interfaces of these kinds: "msg", "srv", "action"."""
    return tuple(
        f"{package}/{name}"
        for package in package_names()
        for name in sorted(_texts(package))
        if name.split("/")[0] in kinds
    )


@cache
def package_names() -> tuple[str, ...]:
    """Return the names of all packages."""
    names = (path.name for path in files(_ROOT).joinpath("definitions").iterdir())
    return tuple(sorted(name.removesuffix(".txt") for name in names if name.endswith(".txt")))


def definition_text(name: str) -> str:
    """Return the text of a message, service or action, as in the file of its package."""
    package, _, rest = name.partition("/")
    return _texts(package)[rest]


@cache
def _texts(package: str) -> dict[str, str]:
    path = files(_ROOT).joinpath("definitions", f"{package}.txt")
    if package not in package_names():
        return {}
    parts = re.split(r"^== (.+)\n", path.read_text("utf-8"), flags=re.MULTILINE)[1:]
    return {name: text.strip() + "\n" for name, text in zip(parts[::2], parts[1::2], strict=True)}


@cache
def _package(package: str) -> dict[str, Definition]:
    found: dict[str, Definition] = {}
    for name, text in _texts(package).items():
        kind, _, _ = name.partition("/")
        parts = re.split(r"^---\n?", text, flags=re.MULTILINE)
        for part, suffix in zip(parts, _PARTS[kind], strict=True):
            found[name + suffix] = _parse(package, name + suffix, part)
        if kind == "srv":
            found |= _service(package, name)
        elif kind == "action":
            found |= _action(package, name)
    return found


def _parse(package: str, name: str, text: str) -> Definition:
    fields: list[Field] = []
    constants: list[Constant] = []
    for line in filter(None, map(str.strip, text.splitlines())):
        if constant := _CONSTANT.fullmatch(line):
            constants.append(Constant(*constant.groups()))
            continue
        match = _FIELD.fullmatch(line)
        if match is None:
            raise InvalidArgumentError(f"{package}/{name}: {line!r} is not a field")
        fields.append(Field(match["name"], _field_type(package, match), match["default"] or ""))
    return Definition(f"{package}/{name}", tuple(fields) or (_EMPTY,), tuple(constants))


def _field_type(package: str, match: re.Match[str]) -> FieldType:
    base = match["base"]
    if base not in PRIMITIVES:
        owner, _, name = base.rpartition("/")
        base = f"{owner or package}/msg/{name}"
        base = "std_msgs/msg/Header" if match["base"] == "Header" else base
    container, size = Container.ONE, 0
    if match["array"]:
        size = int(match["size"] or 0)
        container = Container.ARRAY if size else Container.SEQUENCE
        container = Container.BOUNDED if match["bound"] else container
    return FieldType(base, container, size, int(match["text"] or 0))


def _service(package: str, name: str) -> dict[str, Definition]:
    full = f"{package}/{name}"
    request, response, event = (f"{full}_{part}" for part in ("Request", "Response", "Event"))
    event_fields = (
        Field("info", FieldType("service_msgs/msg/ServiceEventInfo")),
        Field("request", FieldType(request, Container.BOUNDED, 1)),
        Field("response", FieldType(response, Container.BOUNDED, 1)),
    )
    fields = (
        Field("request_message", FieldType(request)),
        Field("response_message", FieldType(response)),
        Field("event_message", FieldType(event)),
    )
    return {f"{name}_Event": Definition(event, event_fields), name: Definition(full, fields)}


def _action(package: str, name: str) -> dict[str, Definition]:
    full = f"{package}/{name}"
    made = {
        "SendGoal_Request": (_UUID, Field("goal", FieldType(f"{full}_Goal"))),
        "SendGoal_Response": (
            Field("accepted", FieldType("bool")),
            Field("stamp", FieldType("builtin_interfaces/msg/Time")),
        ),
        "GetResult_Request": (_UUID,),
        "GetResult_Response": (
            Field("status", FieldType("int8")),
            Field("result", FieldType(f"{full}_Result")),
        ),
        "FeedbackMessage": (_UUID, Field("feedback", FieldType(f"{full}_Feedback"))),
    }
    found = {f"{name}_{part}": Definition(f"{full}_{part}", fields) for part, fields in made.items()}
    for service in ("SendGoal", "GetResult"):
        found |= _service(package, f"{name}_{service}")
    parts = {
        "goal": "Goal",
        "result": "Result",
        "feedback": "Feedback",
        "send_goal_service": "SendGoal",
        "get_result_service": "GetResult",
        "feedback_message": "FeedbackMessage",
    }
    fields = tuple(Field(field, FieldType(f"{full}_{part}")) for field, part in parts.items())
    return {**found, name: Definition(full, fields)}
