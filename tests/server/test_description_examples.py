"""Every example of the OpenAPI document is a request that works with a simulated vehicle."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

import jsonschema_rs
import pytest

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.sim.simulation import Simulation
from mavstack.sim.vehicle_types import Firmware, VehicleType
from mavstack.sim.virtual import run_virtually
from tests.server.asgi import ApiClient
from tests.sim.running import make_ready, reduce_telemetry, running

if TYPE_CHECKING:
    from pathlib import Path

#: Requests after which others would not work.
LAST = ("/terminate", "/reboot", "/renumber", "/api/sources/{id}")
TIMEOUT = 5.0
#: Values of the query where an operation has them.
QUERY = {"accepted": "true", "count": 1}
#: Virtual seconds for all requests.
LIMIT = 3600.0


def requests(document: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    """Return method, path and operation of the requests without files, those in `LAST` behind the others."""
    found = [
        (method.upper(), path, operation)
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
        if "application/octet-stream" not in operation.get("requestBody", {}).get("content", {})
    ]
    return sorted(found, key=lambda each: each[1].endswith(LAST))


def body_of(document: dict[str, Any], operation: dict[str, Any]) -> dict[str, Any] | None:
    """Return the body of the examples of its fields; None if the operation takes no JSON."""
    content = operation.get("requestBody", {}).get("content", {}).get("application/json")
    if content is None:
        return None
    name = content["schema"]["$ref"].rpartition("/")[2]
    fields = document["components"]["schemas"][name]["properties"]
    body = {name: each["examples"][0] for name, each in fields.items() if "examples" in each}
    # No channel is named as in the example: the choice between several senders is taken back.
    fixed = {"timeout": TIMEOUT, "channel": None}
    return body | {name: value for name, value in fixed.items() if name in fields}


def problem_of(document: dict[str, Any], schema: dict[str, Any], answer: object) -> str | None:
    """Return why an answer does not fit its schema, whose references are those of the document."""
    try:
        jsonschema_rs.validate({**schema, "components": document["components"]}, answer)
    except jsonschema_rs.ValidationError as error:
        return str(error).splitlines()[0]
    return None


async def send(
    api: ApiClient, document: dict[str, Any], method: str, path: str, operation: dict[str, Any]
) -> str | None:
    """Send the request of an example; returns what is wrong with the answer."""
    for each in operation["parameters"]:
        if each["in"] == "path":
            path = path.replace(f"{{{each['name']}}}", str(each["example"]))
    queries = [each for each in operation["parameters"] if each["in"] == "query"]
    query = {each["name"]: each["schema"]["examples"][0] for each in queries if each.get("required")}
    query |= {name: value for name, value in QUERY.items() if any(each["name"] == name for each in queries)}
    path += f"?{urlencode(query)}" if query else ""
    answer = await api.request(method, path, body_of(document, operation))
    if answer.status not in (200, 201, 202, 404, 409, 504):
        return f"{method} {path}: {answer.status} {answer.data[:200]!r}"
    success = operation["responses"].get(str(answer.status), {})
    schema = success.get("content", {}).get("application/json", {}).get("schema", {})
    problem = problem_of(document, schema, answer.json) if schema else None
    return f"{method} {path}: {problem}" if problem else None


@pytest.mark.flight
def test_examples_are_requests_that_work(tmp_path: Path) -> None:
    async def run() -> None:
        simulation = Simulation(seed=5)
        reduce_telemetry(simulation.add(VehicleType.COPTER, Firmware.ARDUPILOT, camera=True))
        make_ready(simulation)
        network = MemoryNetwork()
        async with running(simulation, network.link()), Station(folder=tmp_path, telemetry=False) as station:
            await station.sources.add(network.link())
            vehicle = await station.connection.wait_for_vehicle()
            await vehicle.component.set_message_rate(common.Attitude, 10)  # of the example of a stream
            api = ApiClient(make_app(station, Access(), static=None))
            document = (await api.get("/openapi.json")).json
            events = ("GET", "/api/events", document["paths"]["/api/events"]["get"])
            async with asyncio.timeout(LIMIT), asyncio.TaskGroup() as group:
                following = group.create_task(
                    send(api, document, *events)
                )  # the other requests cause its event
                problems = [await send(api, document, *each) for each in requests(document) if each != events]
            assert [each for each in [*problems, following.result()] if each is not None] == []

    run_virtually(run())
