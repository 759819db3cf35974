"""The serial ports of Betaflight and iNav: names, functions and rates, by the API of the station too."""

from __future__ import annotations

import pytest

from mavstack.bridges.msp import FlightController
from mavstack.bridges.msp.bridge import MspBridge
from mavstack.errors import InvalidArgumentError
from mavstack.links import MemoryNetwork
from mavstack.msp.messages.config import InavSerialFunction, SerialConfig, SerialFunction
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.runner import Runner
from mavstack.sim.simulation import Simulation
from mavstack.sim.virtual import run_virtually
from mavstack.vehicle.setup.msp_ports import msp_changes, msp_functions, msp_ports
from tests.server.asgi import ApiClient

VALUES = {
    "BF_VCP_FUNC": 1, "BF_VCP_B_MSP": 5, "BF_UART1_FUNC": 0, "BF_UART1_B_MSP": 5, "BF_UART2_FUNC": 2,
    "BF_UART2_B_GPS": 4, "BF_SOFT1_FUNC": 1 << 9, "BF_SOFT1_B_TLM": 0,
}  # fmt: skip


def test_ports_by_their_parameters() -> None:
    found = [(each.name, each.protocol, each.number, each.baud) for each in msp_ports(VALUES, "BTFL")]
    assert found == [
        ("VCP", "MSP", 1, 115200),
        ("UART1", "none", 0, 0),
        ("UART2", "GPS", 2, 57600),
        ("SOFTSERIAL1", "TELEMETRY MAVLINK", 512, 0),
    ]


def test_functions_and_rates_of_inav_have_other_numbers() -> None:
    found = {each.name: (each.protocol, each.baud) for each in msp_ports(VALUES, "INAV")}
    assert found["SOFTSERIAL1"] == ("TELEMETRY IBUS", 0)
    assert (found["VCP"], found["UART2"]) == (("MSP", 19200), ("GPS", 9600))
    assert msp_functions("INAV")[1 << 8] == "TELEMETRY MAVLINK"
    assert 1 << 8 not in msp_functions("BTFL")


def change(name: str, functions: int | None, baud: int | None = None) -> dict[str, int]:
    ports = {each.name: each for each in msp_ports(VALUES, "BTFL")}
    return msp_changes(ports, name, "BTFL", functions, baud)


@pytest.mark.parametrize(
    ("functions", "baud", "expected"),
    [
        (2, 115200, {"BF_UART2_FUNC": 2, "BF_UART2_B_GPS": 5}),
        (None, 9600, {"BF_UART2_B_GPS": 1}),
        (64, None, {"BF_UART2_FUNC": 64}),
        (1 | 1 << 9, 57600, {"BF_UART2_FUNC": 513, "BF_UART2_B_MSP": 4, "BF_UART2_B_TLM": 4}),
        (None, None, {}),
    ],
)
def test_changes(functions, baud, expected) -> None:
    assert change("UART2", functions, baud) == expected


@pytest.mark.parametrize(
    ("name", "functions", "baud", "text"),
    [
        ("VCP", 0, None, "VCP keeps the function MSP (1): USB needs MSP"),
        ("UART2", 1 << 8, None, "256 has bits that are not functions"),
        ("UART2", -1, None, "-1 has bits"),
        ("UART2", None, 12345, "a rate must be one of 0, 9600"),
        ("UART2", 64, 9600, "the functions of UART2 have no rate"),
    ],
)
def test_refusals(name, functions, baud, text) -> None:
    with pytest.raises(InvalidArgumentError) as refused:
        change(name, functions, baud)
    assert text in str(refused.value)


def test_the_last_port_keeps_msp() -> None:
    ports = {each.name: each for each in msp_ports({"BF_UART1_FUNC": 1, "BF_UART2_FUNC": 0}, "INAV")}
    with pytest.raises(InvalidArgumentError, match="it is the last port with MSP"):
        msp_changes(ports, "UART1", "INAV", 2, None)
    assert msp_changes(ports, "UART2", "INAV", 2, None) == {"BF_UART2_FUNC": 2}


@pytest.mark.parametrize(
    ("firmware", "mavlink", "rate"),
    [("betaflight", SerialFunction.TELEMETRY_MAVLINK, 4), ("inav", InavSerialFunction.TELEMETRY_MAVLINK, 7)],
)
def test_ports_by_http_outlast_a_power_cycle(firmware, mavlink, rate) -> None:
    simulation = Simulation(seed=5)
    vehicle = simulation.add_flight_controller(firmware)
    path = "/api/vehicles/1/serial-ports"

    async def scenario() -> None:
        line, network = MemoryNetwork(), MemoryNetwork()
        async with Runner(simulation) as runner:
            await runner.connect(line.link(), [vehicle])
            runner.start()
            async with (
                FlightController(line.link()) as controller,
                MspBridge(controller, network.link()),
                Station(telemetry=False) as station,
            ):
                await station.sources.add(network.link())
                await station.connection.wait_for_vehicles(1)
                api = ApiClient(make_app(station, Access(), static=None))
                listed = (await api.get(path)).json
                assert (listed["combined"], listed["ports"][0]["name"]) == (True, "VCP")
                assert {"number": int(mavlink), "name": "TELEMETRY MAVLINK"} in listed["protocols"]
                body = {"protocol": int(mavlink), "baud": 57600}
                answer = (await api.put(f"{path}/UART2", body)).json
                assert (answer["protocol"], answer["baud"]) == ("TELEMETRY MAVLINK", 57600)
                refused = await api.put(f"{path}/VCP", {"protocol": 0})
                assert (refused.status, "USB needs MSP" in refused.problem) == (400, True)

    run_virtually(scenario())
    vehicle.power_cycle()
    port = next(each for each in vehicle.system.settings.get(SerialConfig).ports if each.port in (1, 52))
    assert (port.functions, port.telemetry_baud) == (mavlink, rate)
