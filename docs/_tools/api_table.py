"""One table of the whole public API: every class with its methods, their arguments and defaults."""

from __future__ import annotations

import inspect
from dataclasses import dataclass, fields, is_dataclass
from enum import Enum
from functools import cached_property
from importlib import import_module
from typing import TYPE_CHECKING, Any

from mavstack.node import RemoteComponent
from mavstack.node.api_object import is_api_class
from mavstack.node.camera_settings import CameraSettings
from mavstack.node.control import ControlStream
from mavstack.node.forwarding import Forwarding
from mavstack.node.parts import Part, parts_of
from mavstack.node.shell import Shell

if TYPE_CHECKING:
    from collections.abc import Iterator


@dataclass(frozen=True)
class Section:
    """A part of the table: the public names of some modules, and further classes as `module:Class`."""

    title: str
    modules: tuple[str, ...] = ()
    classes: tuple[str, ...] = ()


def path_of(kind: type) -> str:
    """Return the place of a class, as `module:Class`."""
    return f"{kind.__module__}:{kind.__name__}"


SECTIONS = (
    Section("Connections and vehicles", ("mavstack.vehicle",)),
    Section("Swarms", ("mavstack.vehicle.swarm",)),
    Section("Telemetry values", ("mavstack.vehicle.telemetry.values",)),
    Section("Nodes and remote components", ("mavstack.node",)),
    Section(
        "Parts of a remote component",
        classes=(
            *dict.fromkeys(
                path_of(part.kind) for part in parts_of(RemoteComponent) if is_api_class(part.kind)
            ),
            *map(path_of, (CameraSettings, ControlStream, Forwarding, Shell)),
        ),
    ),
    Section(
        "Values of services",
        classes=(
            "mavstack.services:Address",
            "mavstack.services.mission:MissionItem",
            "mavstack.services.mission:Plan",
            "mavstack.services.mission:MissionProgress",
            "mavstack.services.mission:ItemReached",
            "mavstack.services.parameters:Parameter",
            "mavstack.services.parameters:ParameterChanged",
            "mavstack.services.parameters:ParameterMetadata",
            "mavstack.services.parameters:MetadataTable",
            "mavstack.services.parameters:Snapshot",
            "mavstack.services.ftp:Entry",
            "mavstack.services.log:LogEntry",
            "mavstack.services.modes:AvailableMode",
            "mavstack.services.message_request:Interval",
            "mavstack.services.command:Command",
            "mavstack.services.command:CommandRequest",
            "mavstack.services.command:CommandResult",
            "mavstack.services.heartbeat:ComponentInfo",
            "mavstack.services.setpoints:LocalSetpoint",
            "mavstack.services.setpoints:GlobalSetpoint",
            "mavstack.services.setpoints:AttitudeSetpoint",
            "mavstack.services.camera:CameraDevice",
            "mavstack.services.camera:CameraInformation",
            "mavstack.services.camera:CameraStatus",
            "mavstack.services.camera:CaptureStatus",
            "mavstack.services.camera:CapturedImage",
            "mavstack.services.camera:Storage",
            "mavstack.services.camera:VideoStream",
            "mavstack.services.camera:TrackedTarget",
            "mavstack.services.camera:CameraDefinition",
            "mavstack.services.camera:CameraSetting",
            "mavstack.services.gimbal:GimbalInformation",
            "mavstack.services.gimbal:GimbalStatus",
            "mavstack.services.gimbal:GimbalAttitude",
            "mavstack.services.gimbal:GimbalSetpoint",
            "mavstack.services.gimbal:GimbalSticks",
            "mavstack.services.gimbal:GimbalMotion",
            "mavstack.services.version:AutopilotVersion",
            "mavstack.services.version:ProtocolVersion",
        ),
    ),
    Section(
        "Planning of swarms",
        classes=(
            "mavstack.swarm.formations:Formation",
            "mavstack.swarm.separation:Margins",
            "mavstack.swarm.transitions:Limits",
            "mavstack.swarm.transitions:Transition",
            "mavstack.swarm.avoidance:Avoidance",
            "mavstack.swarm.guard:GuardLimits",
            "mavstack.swarm.search.areas:Area",
            "mavstack.swarm.search.division:Searcher",
            "mavstack.swarm.search.camera:Camera",
            "mavstack.swarm.search.missions:MissionOptions",
        ),
    ),
    Section("Plan files", ("mavstack.files.plans",)),
    Section("Parameter files", ("mavstack.files.parameters",)),
    Section("Parameter metadata files", ("mavstack.files.parameter_metadata",)),
    Section("Packets", ("mavstack.wire",)),
    Section("Dialects", ("mavstack.dialects",)),
    Section("Links", ("mavstack.links",)),
    Section("Logs on disk", ("mavstack.logs",)),
    Section("Signing keys", ("mavstack.security",)),
    Section("Simulated vehicles", ("mavstack.sim",)),
)
_HIDDEN = ("__init__",)


@dataclass(frozen=True)
class Member:
    """One row: a method, a property or a field."""

    signature: str
    kind: str
    summary: str


def render() -> str:
    """Return the sections with a table per class and one of the functions."""
    lines: list[str] = []
    for section in SECTIONS:
        lines += [f"## {section.title}", ""]
        functions, others = [], []
        for name, item in public_names(section):
            if inspect.isclass(item):
                lines += _class_lines(name, item)
            elif inspect.isroutine(item) or hasattr(item, "__wrapped__"):
                functions.append((name, item))
            else:
                others.append(f"`{name}`")
        if functions:
            lines += ["### Functions", "", *_table([_function(name, item) for name, item in functions]), ""]
        if others:
            lines += ["### Other names", "", ", ".join(others), ""]
    return "\n".join(lines)


def render_top_level() -> str:
    """Return a table of the names that `mavstack` itself exports."""
    module = import_module("mavstack")
    lines = ["| name | package | meaning |", "|---|---|---|"]
    for name in sorted(module.__all__):
        item = getattr(module, name)
        home = ".".join(getattr(item, "__module__", "mavstack").split(".")[:2]).replace("_core", "wire")
        lines.append(f"| `mavstack.{name}` | `{home}` | {_summary(item)} |")
    return "\n".join(lines)


def public_names(section: Section) -> list[tuple[str, Any]]:
    """Return the public names of a section and what they stand for."""
    found: dict[str, Any] = {}
    for module_name in section.modules:
        module = import_module(module_name)
        names = getattr(module, "__all__", None) or _own_names(module)
        found |= {name: getattr(module, name) for name in names}
    for path in section.classes:
        module_name, name = path.split(":")
        found[name] = getattr(import_module(module_name), name)
    return list(found.items())


def _own_names(module: Any) -> list[str]:  # noqa: ANN401 (a module)
    return [
        name
        for name, item in vars(module).items()
        if not name.startswith("_") and inspect.isclass(item) and item.__module__.startswith(module.__name__)
    ]


def _class_lines(name: str, item: type) -> list[str]:
    lines = [f"### {name}", "", _summary(item), ""]
    if issubclass(item, Enum):
        return [*lines, "Values: " + ", ".join(f"`{member}`" for member in item.__members__), ""]
    rows = [*_constructor(name, item), *members(item)]
    return [*lines, *_table(rows), ""] if rows else lines


def _constructor(name: str, item: type) -> list[Member]:
    if getattr(item, "_is_protocol", False) or issubclass(item, BaseException):
        return []
    if is_dataclass(item):
        names = ", ".join(field.name for field in fields(item))
        return [Member(_code(name, _signature(item)), "constructor", f"fields {names}")] if names else []
    return [Member(_code(name, _signature(item)), "constructor", "")]


def members(item: type) -> Iterator[Member]:
    """Yield the public methods and properties of a class, inherited ones of the package too."""
    seen: set[str] = set()
    for base in item.__mro__:
        if not base.__module__.startswith("mavstack"):
            continue
        for name, member in vars(base).items():
            if name.startswith("_") or name in seen or name in _HIDDEN:
                continue
            seen.add(name)
            row = _member(name, member)
            if row is not None:
                yield row


def _member(name: str, member: object) -> Member | None:
    if isinstance(member, (property, cached_property, Part)) or inspect.isgetsetdescriptor(member):
        return Member(f"`{name}`", "property", _summary(member))
    if isinstance(member, staticmethod):
        return _function(name, member.__func__)
    if isinstance(member, classmethod):
        return _function(name, member.__func__, is_method=True)
    return (
        _function(name, member, is_method=True) if callable(member) and not inspect.isclass(member) else None
    )


def _function(name: str, function: Any, *, is_method: bool = False) -> Member:  # noqa: ANN401 (anything callable)
    kind = "async" if inspect.iscoroutinefunction(function) else ""
    return Member(_code(name, _signature(function, is_method=is_method)), kind, _summary(function))


def _signature(function: Any, *, is_method: bool = False) -> str:  # noqa: ANN401
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return "(…)"
    bare = [
        parameter.replace(annotation=inspect.Parameter.empty)
        for parameter in list(signature.parameters.values())[int(is_method) :]
    ]
    return str(inspect.Signature(bare))


def _code(name: str, signature: str) -> str:
    return f"`{name}{signature}`"


def _summary(item: object) -> str:
    text = (inspect.getdoc(item) or "").partition("\n\n")[0].replace("\n", " ")
    return text.replace("|", "\\|")


def _table(rows: list[Member]) -> list[str]:
    lines = ["| name, arguments, defaults | kind | meaning |", "|---|---|---|"]
    return lines + [
        f"| {row.signature.replace('|', chr(92) + '|')} | {row.kind} | {row.summary} |" for row in rows
    ]
