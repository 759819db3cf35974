"""A vehicle made of MAVSDK's server plugins.

The plugins serve parameters, plans, files, arming, modes and takeoff. Flight and telemetry are left to the
program: this vehicle climbs after a takeoff command and publishes its position at 5 Hz.

MAVSDK 4.1 announces MAV_AUTOPILOT_GENERIC, which Python cannot change, so the vehicle has no modes by name.
The plugins do not answer NAV_LAND, NAV_RETURN_TO_LAUNCH, DO_REPOSITION, MISSION_START, standard modes or
unknown commands. They accept every message rate and publish at the program's own.
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.links import open_link
from mavstack.vehicle import connect
from tests.interop.mavsdk_peer import MavsdkError, mavsdk_object, mavsdk_peer

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from mavstack.vehicle import Vehicle
    from tests.interop.mavsdk_peer import MavsdkPeer, Stream

LATITUDE, LONGITUDE = 47.3977415, 8.5455941
INTERVAL = 0.2
#: Climb per interval, in metres.
CLIMB = 2.0
HEIGHT = 10.0
_LANDED = common.MavLandedState


class MavsdkServerVehicle:
    """A vehicle of MAVSDK's server plugins: `server` is the process, `height` the altitude in metres."""

    def __init__(self, server: MavsdkPeer) -> None:
        self.server = server
        self.height = 0.0
        self.target_height = 0.0
        #: Takeoff requests, in the order received.
        self.requests: list[object] = []

    async def call(self, plugin: str, method: str, *arguments):
        """Call a method of a plugin."""
        return await self.server.call(plugin, method, *arguments)

    async def allow(self, *, arming: bool = True, takeoff: bool = True) -> None:
        """Allow or refuse arming and takeoff."""
        await self.call("action_server", "set_armable", arming, arming)
        await self.call("action_server", "set_disarmable", arming, arming)
        await self.call("action_server", "set_allow_takeoff", takeoff)

    async def start(self) -> Stream:
        """Start the server plugins in turn; return the stream of takeoff requests."""
        await self.server.stream("mission_raw_server", "subscribe_clear_all")
        await self._publish()
        return await self.server.stream("action_server", "subscribe_takeoff")

    async def fly(self, takeoffs: Stream) -> None:
        """Climb after takeoff requests and publish telemetry, until cancelled."""
        while True:
            while not takeoffs.values.empty():
                result, allowed = takeoffs.values.get_nowait()
                self.requests.append(("takeoff", result))
                self.target_height = HEIGHT if allowed else self.target_height
            self.height += max(-CLIMB, min(CLIMB, self.target_height - self.height))
            await self._publish()
            await asyncio.sleep(INTERVAL)

    async def _publish(self) -> None:
        for method, arguments in self._telemetry().items():
            await self.call("telemetry_server", f"publish_{method}", *arguments)

    def _telemetry(self) -> dict[str, list]:
        def kind(name: str, **fields):
            return mavsdk_object(f"telemetry_server.{name}", **fields)

        place = {"latitude_deg": LATITUDE, "longitude_deg": LONGITUDE}
        home = kind("Position", **place, absolute_altitude_m=0.0, relative_altitude_m=0.0)
        here = kind("Position", **place, absolute_altitude_m=self.height, relative_altitude_m=self.height)
        landed = _LANDED.IN_AIR if self.height else _LANDED.ON_GROUND
        return {
            "position": [here, kind("VelocityNed", north_m_s=1.5, east_m_s=-2.5, down_m_s=-0.5),
                         kind("Heading", heading_deg=90.0)],
            "home": [home],
            "attitude": [kind("EulerAngle", roll_deg=10.0, pitch_deg=-5.0, yaw_deg=90.0),
                         kind("AngularVelocityBody", roll_rad_s=0.25, pitch_rad_s=0.0, yaw_rad_s=0.0)],
            "battery": [kind("Battery", voltage_v=12.4, remaining_percent=0.87)],
            "extended_sys_state": [0, int(landed)],
            "sys_status": [kind("Battery", voltage_v=12.4, remaining_percent=0.87),
                           True, True, True, True, True],
            "raw_gps": [kind("RawGps", timestamp_us=1, **place, absolute_altitude_m=self.height,
                             hdop=0.5, vdop=0.75, velocity_m_s=2.0, cog_deg=45.0,
                             horizontal_uncertainty_m=1.0, vertical_uncertainty_m=2.0),
                        kind("GpsInfo", num_satellites=14, fix_type=3)],
            "visual_flight_rules_hud": [kind("FixedwingMetrics", airspeed_m_s=5.0, throttle_percentage=40.0,
                                             climb_rate_m_s=0.5, groundspeed_m_s=4.5, heading_deg=90.0,
                                             absolute_altitude_m=self.height)],
        }  # fmt: skip


@asynccontextmanager
async def mavsdk_server_vehicle(system: int = 1) -> AsyncIterator[tuple[Vehicle, MavsdkServerVehicle]]:
    """Yield the `Vehicle` of the vehicle API and the MAVSDK vehicle behind it."""
    link = open_link("udpin://127.0.0.1:0")
    async with (
        connect(link) as connection,
        mavsdk_peer(f"udpout://127.0.0.1:{link.address[1]}", "server", system, 1) as server,
    ):
        served = MavsdkServerVehicle(server)
        flying = asyncio.create_task(served.fly(await served.start()))
        try:
            yield await connection.wait_for_vehicle(), served
        finally:
            flying.cancel()
            with suppress(asyncio.CancelledError, MavsdkError):  # a test may have ended its process
                await flying
