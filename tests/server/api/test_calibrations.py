from __future__ import annotations

import asyncio

from mavstack.security.roles import Role
from mavstack.server.access import Access
from mavstack.sim.ardupilot.sensor_calibration import calibrations_of
from tests.server.stations import COPTER, Ground, serve

ALL = "/api/vehicles/1/calibrations"
PASSWORDS = {Role.OPERATE: "may fly it", Role.ADMINISTER: "may do it all"}


def test_the_calibrations_of_a_vehicle_are_listed() -> None:
    async def scenario(ground: Ground) -> None:
        listed = {each["kind"]: each for each in (await ground.api.get(ALL)).json}
        assert listed["accelerometer"] == {
            "kind": "accelerometer",
            "needs_confirmation": True,
            "can_cancel": False,
            "running": False,
            "step": None,
        }
        assert listed["gyroscope"]["needs_confirmation"] is False

    serve(COPTER, scenario)


def test_a_calibration_shows_its_steps_and_waits_for_confirmations() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        started = (await api.post(f"{ALL}/accelerometer?wait=false")).json
        task = ground.station.tasks.find(started["task"])
        await ground.wait_until(lambda: ground.station.calibrations.session(1))
        second = await api.post(f"{ALL}/gyroscope")
        assert (second.status, second.problem) == (
            409,
            "the accelerometer calibration of vehicle 1 runs already",
        )
        confirmed = []
        async for values in task.follow():
            step = values.get("step")
            if step is not None and step["needs_confirmation"] and step["pose"] not in confirmed:
                confirmed.append(step["pose"])
                answer = await api.post(f"{ALL}/accelerometer/confirm")
                assert (answer.status, answer.json["kind"]) == (200, "accelerometer")
        assert len(confirmed) == 6
        result = (await api.get(started["result"])).json
        assert {"system": 1, "kind": "accelerometer"}.items() <= result.items()
        late = await api.post(f"{ALL}/accelerometer/confirm")
        assert (late.status, late.problem) == (409, "no accelerometer calibration of vehicle 1 runs")

    serve(COPTER, scenario)


def test_a_calibration_is_cancelled() -> None:
    async def scenario(ground: Ground) -> None:
        api = ground.api
        started = (await api.post(f"{ALL}/compass?wait=false")).json
        await ground.wait_until(lambda: ground.station.calibrations.session(1, "compass"))
        assert (await api.delete(f"{ALL}/compass")).json["cancelled"] is True
        await ground.wait_until(lambda: "error" in ground.station.tasks.find("1").values())
        answer = await api.get(started["result"])
        assert answer.problem == "the compass calibration of vehicle 1 was cancelled"
        again = (await api.post(f"{ALL}/compass?wait=false")).json["task"]
        await ground.wait_until(lambda: ground.station.calibrations.session(1))
        assert (await api.delete(f"/api/tasks/{again}")).json["state"] == "cancelled"
        assert ground.station.calibrations.session(1) is None

    serve(COPTER, scenario)


def test_a_calibration_that_the_vehicle_cannot_cancel_is_followed_no_more() -> None:
    async def scenario(ground: Ground) -> None:
        await ground.api.post(f"{ALL}/accelerometer?wait=false")
        await ground.wait_until(lambda: ground.station.calibrations.session(1))
        assert (await ground.api.delete(f"{ALL}/accelerometer")).json["cancelled"] is False
        assert ground.station.calibrations.session(1) is None

    serve(COPTER, scenario)


def test_a_calibration_ends_with_the_connection_of_its_client() -> None:
    async def scenario(ground: Ground) -> None:
        leave = asyncio.Event()
        request = asyncio.ensure_future(ground.api.post(f"{ALL}/compass", leave=leave))
        sensors = calibrations_of(ground.simulation.vehicles[0].autopilot)
        await ground.wait_until(lambda: sensors.compass_started)
        leave.set()
        assert (await request).status == 400  # which no client reads
        assert ground.station.calibrations.session(1) is None
        assert (sensors.compass_started, sensors.compass_ready) == (None, False)
        assert (await ground.api.post(f"{ALL}/gyroscope")).status == 200

    serve(COPTER, scenario)


def test_a_calibration_of_a_task_continues_without_its_client() -> None:
    async def scenario(ground: Ground) -> None:
        leave = asyncio.Event()
        leave.set()
        started = (await ground.api.post(f"{ALL}/accelerometer?wait=false", leave=leave)).json
        await ground.wait_until(lambda: ground.station.calibrations.session(1))
        assert ground.station.tasks.find(started["task"]).values()["state"] == "running"
        await ground.api.delete(f"/api/tasks/{started['task']}")

    serve(COPTER, scenario)


def test_wrong_requests() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post(f"{ALL}/clock")
        assert answer.status == 404
        assert "there is no calibration 'clock': accelerometer" in answer.problem
        assert (await ground.api.post(f"{ALL}/airspeed")).status in (404, 409)
        idle = await ground.api.post(f"{ALL}/compass/confirm")
        assert idle.status == 409

    serve(COPTER, scenario)


def test_calibrations_need_the_highest_role() -> None:
    async def scenario(ground: Ground) -> None:
        began = await ground.api.post("/api/session", {"password": PASSWORDS[Role.OPERATE]})
        headers = {"authorization": f"Bearer {began.json['token']}"}
        assert (await ground.api.post(f"{ALL}/level", headers=headers)).status == 403
        assert (await ground.api.get(ALL, headers=headers)).status == 200

    serve(COPTER, scenario, access=Access(passwords=PASSWORDS, local=False))
