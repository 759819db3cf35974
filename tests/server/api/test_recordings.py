from __future__ import annotations

import pytest

from mavstack.logs import open_log
from tests.server.stations import COPTER, Ground, serve


def test_a_recording_is_begun_ended_downloaded_and_reported(tmp_path) -> None:
    async def scenario(ground: Ground) -> None:
        begun = await ground.api.post("/api/recordings", {"name": "flight"})
        assert (begun.status, begun.json["name"], begun.json["running"]) == (201, "flight.tlog", True)
        assert (await ground.api.post("/api/recordings", {"name": "flight"})).status == 409
        packets = ground.station.packets
        before = packets.received
        await ground.wait_until(lambda: packets.received > before + 20)
        ended = await ground.api.post("/api/recordings/flight.tlog/stop")
        assert (ended.json["running"], ended.json["size"] > 0) == (False, True)
        (listed,) = (await ground.api.get("/api/recordings")).json
        assert listed["name"] == "flight.tlog"
        assert "HEARTBEAT" in open_log(tmp_path / "new" / "flight.tlog")
        assert len((await ground.api.get("/api/recordings/flight.tlog")).data) == ended.json["size"]
        report = await ground.api.get("/api/reports/flight.tlog")
        assert (report.status, b"<html" in report.data) == (200, True)
        assert "sandbox" in report.headers["content-security-policy"]

    serve(COPTER, scenario, folder=tmp_path / "new")


@pytest.mark.parametrize("name", ["..", ".hidden", "a/b", "%2e%2e%2fx", "a\\b", "a" * 200])
def test_names_that_lead_elsewhere_are_refused(tmp_path, name) -> None:
    async def scenario(ground: Ground) -> None:
        answer = await ground.api.post(
            "/api/recordings", {"name": name.replace("%2e", ".").replace("%2f", "/")}
        )
        assert answer.status == 400
        assert (await ground.api.get(f"/api/recordings/{name}")).status in (400, 404)
        assert (await ground.api.get(f"/api/reports/{name}")).status in (400, 404)

    serve((), scenario, folder=tmp_path)


def test_links_of_the_file_system_are_not_followed(tmp_path) -> None:
    (tmp_path / "secret.txt").write_text("secret")
    folder = tmp_path / "recordings"
    folder.mkdir()
    (folder / "a.tlog").symlink_to(tmp_path / "secret.txt")

    async def scenario(ground: Ground) -> None:
        assert (await ground.api.get("/api/recordings")).json == []
        assert (await ground.api.get("/api/recordings/a.tlog")).status == 404

    serve((), scenario, folder=folder)


def test_without_a_folder_nothing_is_recorded() -> None:
    async def scenario(ground: Ground) -> None:
        assert (await ground.api.get("/api/recordings")).json == []
        assert (await ground.api.post("/api/recordings")).status == 409

    serve((), scenario)
