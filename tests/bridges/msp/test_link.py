"""Links to flight controllers: a vehicle behind a URL."""

from __future__ import annotations

import tomllib
from importlib import import_module
from pathlib import Path

import pytest

from mavstack.bridges.msp import link as module
from mavstack.errors import LinkError, LinkURLError, MspTimeout
from mavstack.links import LinkURL, parse_url
from mavstack.links.options import Options
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle import connect
from tests.bridges.msp.fake_controller import FakeController

PYPROJECT = Path(__file__).parents[3] / "pyproject.toml"


def msp_link(options: dict[str, str], monkeypatch, controller: FakeController | None = None):
    """Return the link of a URL whose flight controller is a fake, and the link that would carry MSP."""
    carriers = []

    def make(carrier):
        carriers.append(carrier)
        return controller or FakeController()

    monkeypatch.setattr(module, "FlightController", make)
    url = LinkURL("msp+tcp", path="127.0.0.1:5761", options=options)
    reader = Options(url)
    link = module.open_link(url, reader)
    reader.refuse_unknown()
    return link, carriers[0]


def test_the_schemes_are_entry_points():
    groups = tomllib.loads(PYPROJECT.read_text())["project"]["entry-points"]
    schemes = {name: target for name, target in groups["mavstack.links"].items() if name.startswith("msp+")}
    assert set(schemes) == {"msp+serial", "msp+tcp"}
    for scheme, target in schemes.items():
        name, attribute = target.split(":")
        record = getattr(import_module(name), attribute)
        assert record.name == scheme
        assert record.is_network or record.is_device  # clients without a password may open it
        module_name, backend = record.backend.split(":")
        assert callable(getattr(import_module(module_name), backend))
        assert str(parse_url(record.example, {scheme: record})) == record.example


def test_a_vehicle_behind_a_url(monkeypatch):
    controller = FakeController()
    link, carrier = msp_link({"system": "7", "retry": "2s"}, monkeypatch, controller)
    assert carrier.url.scheme == "tcpout"
    assert carrier.backoff.first == 2.0

    async def work():
        async with connect(link) as connection:
            vehicle = await connection.wait_for_vehicle()
            assert vehicle.system == 7
            await vehicle.arm()
        assert not controller.connected
        assert link.closed

    run_virtually(work())


@pytest.mark.parametrize(("name", "value"), [("system", "300"), ("system", "0"), ("baud", "9600")])
def test_wrong_options(name, value, monkeypatch):
    with pytest.raises(LinkURLError, match=name):
        msp_link({name: value}, monkeypatch)


def test_a_serial_port_has_the_baud_rate_of_msp(monkeypatch):
    pytest.importorskip("serial")
    monkeypatch.setattr(module, "FlightController", lambda carrier: FakeController(name=str(carrier.url)))
    url = LinkURL("msp+serial", path="/dev/ttyACM9")
    link = module.open_link(url, Options(url))
    assert link._controller.name == "serial:///dev/ttyACM9?baud=115200"


def test_a_controller_that_does_not_answer_is_a_link_error(monkeypatch):
    controller = FakeController()

    async def fail():
        raise MspTimeout("asking for the version of", "msp+tcp://127.0.0.1:5761", answer="no answer")

    controller.open = fail
    link, _ = msp_link({}, monkeypatch, controller)

    async def work():
        with pytest.raises(LinkError, match=r"cannot open msp\+tcp://127.0.0.1:5761: .*no answer"):
            await link.open()
        assert link.closed

    run_virtually(work())
