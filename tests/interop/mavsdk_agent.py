"""MAVSDK in a process of its own, controlled by lines of JSON: a crash in C++ must not end the tests.

`python mavsdk_agent.py ROLE SYSTEM COMPONENT` with ROLE `client` or `server`. Each line is a JSON object, to
add a connection, to wait for an autopilot, to call a method of a plugin, to call one with a callback:

    {"id": 1, "connect": "udpout://127.0.0.1:14550"}
    {"id": 2, "discover": 10.0}
    {"id": 3, "plugin": "param", "method": "get_param_int", "arguments": ["P_1"]}
    {"id": 4, "plugin": "telemetry", "method": "subscribe_home", "arguments": [], "stream": true}

The reply is `{"id": 1, "result": …}` or `{"id": 1, "error": "…"}`. The arguments of a callback come as
`{"stream": 4, "values": […]}`. MAVSDK's objects are sent as their fields, with
`"class"` in arguments; enum members as their names. The end of the input ends the process.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from enum import Enum
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

from mavsdk import Configuration, Mavsdk, plugins


class Agent:
    """One MAVSDK instance and its plugins."""

    def __init__(self, role: str, system: int, component: int, replies) -> None:
        self.mavsdk = Mavsdk(Configuration.create_manual(system, component, True))
        self.owner = self.mavsdk.server_component_by_id(component) if role == "server" else None
        self.plugins: dict = {}
        self._replies, self._lock = replies, threading.Lock()

    def answer(self, request: dict) -> None:
        try:
            reply = {"id": request["id"], "result": encode(self.execute(request))}
        except Exception as error:  # noqa: BLE001 (reported to the test)
            reply = {"id": request["id"], "error": f"{type(error).__name__}: {error}"}
        self.send(reply)

    def execute(self, request: dict):
        if "connect" in request:
            return self.mavsdk.add_any_connection(request["connect"])
        if "discover" in request:
            self.owner = self.mavsdk.first_autopilot(request["discover"])
            return self.owner is not None
        if request["plugin"] == "system":
            return getattr(self.owner, request["method"])(*request["arguments"])
        method = getattr(self.plugin(request["plugin"]), request["method"])
        arguments = [decode(argument) for argument in request["arguments"]]
        if request.get("stream"):
            number = request["id"]
            arguments.append(lambda *values: self.send({"stream": number, "values": encode(values[:-1])}))
        return method(*arguments)

    def plugin(self, name: str):
        if name not in self.plugins:
            class_name = "".join(word.capitalize() for word in name.split("_"))
            self.plugins[name] = getattr(module_of(name), class_name)(self.owner)
        return self.plugins[name]

    def send(self, reply: dict) -> None:
        with self._lock:
            self._replies.write(json.dumps(reply) + "\n")
            self._replies.flush()


@cache
def module_of(name: str):
    """Return the module of a plugin."""
    try:
        return import_module(f"mavsdk.plugins.{name}")
    except ImportError:  # the package of component_metadata_server names a class that its module lacks
        path = Path(plugins.__path__[0], name, f"{name}.py")
        spec = spec_from_file_location(f"mavsdk.plugins.{name}.{name}", path)
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
        return module


def encode(value):
    match value:
        case Enum():
            return value.name
        case list() | tuple():
            return [encode(each) for each in value]
        case bytes():
            return value.decode()
        case bool() | int() | float() | str() | None:
            return value
        case _:
            return (
                {name: encode(each) for name, each in vars(value).items()}
                if hasattr(value, "__dict__")
                else None
            )


def decode(value):
    match value:
        case {"class": name, **fields}:
            module, _, class_name = name.partition(".")
            kind = getattr(module_of(module), class_name)
            return kind(**{field: decode(each) for field, each in fields.items()})
        case list():
            return [decode(each) for each in value]
        case _:
            return value


def main() -> None:
    replies = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)  # MAVSDK writes its log to standard output
    role, system, component = sys.argv[1:]
    agent = Agent(role, int(system), int(component), replies)
    for line in sys.stdin:
        threading.Thread(target=agent.answer, args=(json.loads(line),), daemon=True).start()
    os._exit(0)  # plugins may still run callbacks; the operating system frees the rest


if __name__ == "__main__":
    main()
