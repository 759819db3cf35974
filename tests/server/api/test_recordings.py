from __future__ import annotations

import pytest

from mavstack.logs import open_log
from mavstack.server.api import recordings
from mavstack.server.recordings import MAX_RUNNING
from tests.logs.test_replay import dataflash
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
    (folder / "passwords").write_text("secret")

    async def scenario(ground: Ground) -> None:
        assert (await ground.api.get("/api/recordings")).json == []
        for name in ("a.tlog", "passwords"):
            assert (await ground.api.get(f"/api/recordings/{name}")).status == 404
            assert (await ground.api.get(f"/api/reports/{name}")).status == 404
            assert (await ground.api.post("/api/sources", {"recording": name})).status == 404

    serve((), scenario, folder=folder)


def test_a_running_recording_is_downloaded_as_far_as_it_is(tmp_path, monkeypatch) -> None:
    """It grows while it is sent, and the answer must not be longer than its header says."""
    chunks = recordings._chunks

    def growing(path, size):
        with path.open("ab") as file:
            file.write(bytes(1000))
        yield from chunks(path, size)

    monkeypatch.setattr(recordings, "CHUNK_SIZE", 16)
    monkeypatch.setattr(recordings, "_chunks", growing)

    async def scenario(ground: Ground) -> None:
        await ground.api.post("/api/recordings", {"name": "flight"})
        before = ground.station.packets.received
        await ground.wait_until(lambda: ground.station.packets.received > before + 5)
        size = (tmp_path / "flight.tlog").stat().st_size
        answer = await ground.api.get("/api/recordings/flight.tlog")
        assert size == len(answer.data) == int(answer.headers["content-length"]) > 0

    serve(COPTER, scenario, folder=tmp_path)


def test_the_number_of_recordings_is_bounded(tmp_path) -> None:
    async def scenario(ground: Ground) -> None:
        begun = [await ground.api.post("/api/recordings", {"name": f"{n}"}) for n in range(MAX_RUNNING + 1)]
        assert [each.status for each in begun] == [201] * MAX_RUNNING + [409]

    serve((), scenario, folder=tmp_path)


def test_without_a_folder_nothing_is_recorded() -> None:
    async def scenario(ground: Ground) -> None:
        assert (await ground.api.get("/api/recordings")).json == []
        assert (await ground.api.post("/api/recordings")).status == 409

    serve((), scenario)


def test_a_log_of_a_vehicle_is_replayed_whatever_its_format(tmp_path) -> None:
    (tmp_path / "flight.BIN").write_bytes(dataflash())

    async def scenario(ground: Ground) -> None:
        shown = await ground.api.get("/api/replays/flight.BIN")
        assert shown.status == 200
        assert shown.headers["content-disposition"] == 'attachment; filename="flight.tlog"'
        (tmp_path / "shown.tlog").write_bytes(shown.data)
        assert {"HEARTBEAT", "ATTITUDE", "GLOBAL_POSITION_INT"} <= set(open_log(tmp_path / "shown.tlog"))
        sent = await ground.api.request("POST", "/api/replays?name=flight.BIN", data=dataflash())
        assert (sent.status, sent.data) == (200, shown.data)
        refused = await ground.api.request(
            "POST", "/api/replays?name=a.BIN", data=dataflash(positions=False, attitude=False)
        )
        assert refused.problem.startswith("replaying a.BIN failed: the dataflash log has neither")
        assert (await ground.api.get("/api/replays/none.BIN")).status == 404
        answer = await ground.api.request("POST", "/api/replays?name=../x", data=dataflash())
        assert answer.status == 400

    serve((), scenario, folder=tmp_path)
