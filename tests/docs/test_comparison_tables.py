"""The calls of other libraries in the comparison tables exist in those libraries."""

from __future__ import annotations

import ast
import inspect
from importlib import import_module
from types import SimpleNamespace

import pytest

from tests.docs.blocks import comparison_rows

MAVSDK_PLUGINS = (
    "action", "ftp", "info", "log_files", "mavlink_direct", "mission", "mission_raw", "offboard", "param",
    "shell", "telemetry",
)  # fmt: skip


def pymavlink_names() -> SimpleNamespace:
    mavutil = pytest.importorskip("pymavlink.mavutil")
    dialect = import_module("pymavlink.dialects.v20.common")
    return SimpleNamespace(
        mavutil=mavutil,
        master=mavutil.mavfile,
        mav=dialect.MAVLink,
        mavlink=dialect,
        msg=dialect.MAVLink_message,
    )


def mavsdk_names() -> SimpleNamespace:
    package = pytest.importorskip("mavsdk.asyncio")
    plugins = {}
    for name in MAVSDK_PLUGINS:
        class_name = "".join(word.capitalize() for word in name.split("_")) + "Async"
        plugins[name] = getattr(import_module(f"mavsdk.asyncio.plugins.{name}"), class_name)
    return SimpleNamespace(
        mavsdk=package.Mavsdk, system=import_module("mavsdk.asyncio.system").System, **plugins
    )


def dronekit_names() -> SimpleNamespace:
    dronekit = pytest.importorskip("dronekit")
    parts = {"commands": dronekit.CommandSequence, "parameters": dronekit.Parameters}
    return SimpleNamespace(vehicle=dronekit.Vehicle, **vars(dronekit) | parts)


def has(owner: object, name: str) -> bool:
    """Return whether a class or module has a name, as a class attribute or one that its methods set."""
    if hasattr(owner, name):
        return True
    return inspect.isclass(owner) and any(
        f"self.{name}" in inspect.getsource(base) for base in owner.__mro__ if base is not object
    )


def missing(call: str, names: SimpleNamespace) -> list[str]:
    """The first attributes in a line of code that the library does not have."""
    if " " in call.partition("(")[0] and "=" not in call:
        return []
    found = []
    for node in ast.walk(ast.parse(call)):
        if (
            isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and hasattr(names, node.value.id)
        ):
            if not has(getattr(names, node.value.id), node.attr):
                found.append(f"{node.value.id}.{node.attr}")
        elif (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Name)
            and not hasattr(names, node.func.id)
        ):
            found.append(node.func.id)
    return found


@pytest.mark.parametrize(
    ("page", "names"),
    [("pymavlink.md", pymavlink_names), ("mavsdk.md", mavsdk_names), ("dronekit.md", dronekit_names)],
)
def test_calls_of_other_libraries_exist(page, names):
    library = names()
    rows = comparison_rows(page)
    assert len(rows) > 25
    for row in rows:
        for call in row.theirs:
            if call.endswith((".py", ".xml")) or call.startswith("mavgen"):
                continue
            assert not missing(call, library), f"{page}:{row.line}: {call}"
