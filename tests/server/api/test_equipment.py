from __future__ import annotations

from tests.server.stations import COPTER, PX4_COPTER, Ground, serve


def test_a_motor_runs_on_the_bench() -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post("/api/vehicles/1/motor-test", {"motor": 2, "duration": 1})
        assert answer.json == {"system": 1, "action": "motor-test", "state": "done"}
        wrong = await ground.api.post("/api/vehicles/1/motor-test", {"motor": 99})
        assert (wrong.status, wrong.kind) == (400, "InvalidArgumentError")

    serve(COPTER, scenario)


def test_outputs_by_firmware() -> None:
    async def scenario(ground: Ground) -> None:
        async def status(system: int, name: str, body: object) -> int:
            return (await ground.api.post(f"/api/vehicles/{system}/{name}", body)).status

        assert await status(1, "servo", {"servo": 9, "pulse": 1700}) == 200
        assert await status(2, "servo", {"servo": 9, "pulse": 1700}) == 409  # PX4 has no servo numbers
        assert await status(2, "actuator", {"actuator": 1, "value": 0.5}) in (200, 409)
        assert await status(1, "relay", {"relay": 0, "on": True}) in (200, 409)
        assert await status(1, "ekf-source", {"set": 1}) == 200
        assert await status(1, "beep", {}) == 200
        assert await status(1, "roi", {"latitude": 47.4, "longitude": 8.55}) == 200
        assert await status(1, "roi/clear", {}) == 200

    serve([COPTER, PX4_COPTER], scenario)
