"""The steps of CONTRIBUTING.md give a service to the API, simulated vehicles, the console and the station."""

from __future__ import annotations

import gc
import re
import sys
from importlib import import_module
from pathlib import Path

import pytest

import mavstack.node
import mavstack.services
from mavstack.cli.shell.runner import run_line
from mavstack.node import RemoteComponent, component
from mavstack.sync.generate import stub
from tests.cli.shell.shell_session import COPTER, in_shell
from tests.server.stations import serve

TEXT = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text("utf-8")
BLOCK = re.compile(r"<!-- service: (\S+) -->\n```python\n(.*?)```", re.DOTALL)
FILES = dict(BLOCK.findall(TEXT))


@pytest.fixture(autouse=True)
def service(tmp_path, monkeypatch):
    """Follow the steps: both modules, and the row in the class."""
    for package in (mavstack.node, mavstack.services):
        folder = tmp_path / package.__name__.rpartition(".")[2]
        folder.mkdir()
        (folder / "registers.py").write_text(FILES[f"{folder.name}/registers.py"], "utf-8")
        monkeypatch.setattr(package, "__path__", [*package.__path__, str(folder)])
    modules = [import_module(f"mavstack.{package}.registers") for package in ("services", "node")]
    names = {**vars(component), **vars(modules[0]), **vars(modules[1])}
    exec(FILES["row"], names)
    names["registers"].__set_name__(RemoteComponent, "registers")
    RemoteComponent.registers = names["registers"]
    yield
    del RemoteComponent.registers, mavstack.node.registers, mavstack.services.registers
    for module in modules:
        del sys.modules[module.__name__]
    del module, modules, names
    gc.collect()  # the classes of the API are those that exist


def test_the_service_needs_max_six_files():
    assert len(FILES) == 3  # besides a test and a page


def test_the_api_and_the_simulated_vehicle_have_it():
    async def scenario(session, world):
        assert await session.vehicle.component.registers.read(0, 0x68, 0x75, 2) == b"\x75\x76"

    in_shell(COPTER, scenario)


def test_the_console_offers_it(capsys):
    async def scenario(session, world):
        await run_line(session, "call")
        await run_line(session, "call registers read 0 0x68 0x75 2")

    in_shell(COPTER, scenario)
    out = capsys.readouterr().out
    assert "registers read BUS ADDRESS REGISTER [COUNT]: Read registers of a chip" in out
    assert "b'uv'" in out


def test_the_station_offers_it():
    async def scenario(ground):
        listed = (await ground.api.get("/api/vehicles/1/calls")).json
        assert {"part": "registers", "call": "read"}.items() <= listed[-1].items()
        arguments = {"bus": 0, "address": 0x68, "register": 0x75, "count": 2}
        answer = await ground.api.post("/api/vehicles/1/calls/registers/read", {"arguments": arguments})
        assert answer.json == {"result": [0x75, 0x76]}

    serve(COPTER, scenario)


def test_the_stub_of_the_blocking_api_has_its_class():
    assert "class Registers:" in stub()
