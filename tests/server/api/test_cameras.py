from __future__ import annotations

from mavstack.dialects import common
from mavstack.links import MemoryNetwork
from mavstack.node import Node
from mavstack.server.access import Access
from mavstack.server.app import make_app
from mavstack.server.station import Station
from mavstack.services.camera import CameraDevice, CameraInformation, VideoStream
from mavstack.sim.virtual import run_virtually
from tests.server.asgi import ApiClient

CAMERAS = "/api/vehicles/1/cameras"
URI = "rtsp://192.168.1.10:554/live"


def with_cameras(scenario) -> None:
    """Run a scenario with a vehicle that has an attached camera, and one with a component of its own."""

    async def run() -> None:
        network = MemoryNetwork()
        kind, autopilot = common.MavType.QUADROTOR, common.MavAutopilot.PX4
        vehicle = Node(network.link(), system=1, component=1, type=kind, autopilot=autopilot)
        camera = Node(network.link(), system=1, component=101, type=common.MavType.CAMERA)
        vehicle.serve_camera(CameraDevice(CameraInformation("Maker", "Attached", device_id=2)))
        camera.serve_camera(CameraDevice(CameraInformation("Maker", "Own"), streams=[VideoStream(uri=URI)]))
        station = Station(telemetry=False)
        async with vehicle, camera, station:
            await station.sources.add(network.link())
            found = await station.connection.wait_for_vehicle()
            await found.wait_for_camera()
            await scenario(ApiClient(make_app(station, Access(), static=None)))

    run_virtually(run())


def test_cameras_with_their_streams() -> None:
    async def scenario(api: ApiClient) -> None:
        (known,) = (await api.get(f"{CAMERAS}?cached=true")).json
        assert (known["id"], known["information"]) == (101, None)
        own, attached = (await api.get(CAMERAS)).json
        assert (own["id"], own["information"]["model"], attached["id"]) == (101, "Own", 2)
        assert attached["information"]["model"] == "Attached"
        (stream,) = own["streams"]
        assert (stream["uri"], stream["type"], stream["running"]) == (URI, "RTSP", True)

    with_cameras(scenario)


def test_photos_and_videos() -> None:
    async def scenario(api: ApiClient) -> None:
        photo = (await api.post(f"{CAMERAS}/101/photo")).json
        assert photo["image"]["index"] == 0
        assert (await api.post(f"{CAMERAS}/101/video/start")).status == 409  # it takes photos
        assert (await api.post(f"{CAMERAS}/101/mode", {"mode": "video"})).status == 200
        assert (await api.post(f"{CAMERAS}/101/video/start")).status == 200
        assert (await api.post(f"{CAMERAS}/101/video/stop")).status == 200
        assert (await api.post(f"{CAMERAS}/0/photo")).status == 404

    with_cameras(scenario)
