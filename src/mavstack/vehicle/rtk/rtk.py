"""The corrections of a vehicle's satellite navigation: `vehicle.rtk`.

    async with vehicle.rtk.corrections("ntrip://me:secret@caster.example.org:2101/MOUNT") as feed:
        await vehicle.rtk.wait_for_fix()

Corrections go to all vehicles of a connection, once over each link.
"""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from mavstack.errors import HealthTimeout
from mavstack.gnss import Fix, format_gga
from mavstack.node.api_object import ReadOnly
from mavstack.vehicle.rtk.feed import CorrectionFeed

if TYPE_CHECKING:
    from mavstack.gnss.ublox import FixedPosition, SurveyIn
    from mavstack.services.rtk import CorrectionCounts
    from mavstack.vehicle.vehicle import Vehicle

_FIX = common.GpsFixType
_POLL_INTERVAL: Final = 0.2
_NAMES: Final = {
    0: "no receiver", 1: "no fix", 2: "2D", 3: "3D", 4: "differential", 5: "RTK float", 6: "RTK fixed",
    7: "static", 8: "PPP",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class RtkStatus:
    """The state of a vehicle's satellite navigation.

    Attributes:
        fix: The GPS_FIX_TYPE; None before the first GPS_RAW_INT.
        name: Its name, such as "RTK fixed".
        satellites: The number of satellites; None if not known.
        horizontal_accuracy: Metres; None if not known.
    """

    fix: int | None
    name: str
    satellites: int | None = None
    horizontal_accuracy: float | None = None

    @property
    def is_fixed(self) -> bool:
        """True with whole carrier phases: centimetres."""
        return self.fix == _FIX.RTK_FIXED

    @property
    def is_corrected(self) -> bool:
        """True if the receiver uses corrections."""
        return self.fix in (_FIX.DGPS, _FIX.RTK_FLOAT, _FIX.RTK_FIXED)


class Rtk(ReadOnly):
    """The corrections of a vehicle's satellite navigation; `vehicle.rtk`."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    @property
    def status(self) -> RtkStatus:
        """The state of the vehicle's satellite navigation (GPS_RAW_INT)."""
        gps = self._vehicle.gps
        if gps is None:
            return RtkStatus(None, "not known")
        name = _NAMES.get(int(gps.fix), str(int(gps.fix)))
        return RtkStatus(int(gps.fix), name, gps.satellites, gps.horizontal_accuracy)

    @property
    def counts(self) -> CorrectionCounts:
        """The frames that this connection received from sources and sent to its vehicles."""
        return self._vehicle.connection.corrections.counts

    def send(self, data: bytes) -> int:
        """Send corrections to all vehicles of the connection (GPS_RTCM_DATA).

        Args:
            data: Bytes of RTCM 3, cut anywhere.

        Returns:
            The number of frames that the bytes completed. What is not RTCM is counted and dropped.

        Raises:
            InvalidStateError: The connection is closed.
        """
        connection = self._vehicle.connection
        sender = connection.corrections
        frames = sender.feed(bytes(data), self._vehicle.component.now())
        connection.wake(sender)
        return len(frames)

    def corrections(self, url: str, *, base: SurveyIn | FixedPosition | None = None) -> CorrectionFeed:
        """Return a source of corrections; an async context manager that runs it.

        Args:
            url: A caster (`ntrip://USER:PASSWORD@HOST:PORT/MOUNTPOINT`, `ntrips://` over TLS), or the
                link to a base: `serial:///dev/ttyACM0?baud=115200`, `tcpout://HOST:PORT`.
            base: How a u-blox receiver at a link becomes a base; None: it sends RTCM already.

        Returns:
            The source, not started.

        Raises:
            LinkURLError: The URL is malformed.
            MissingExtraError: pyubx2, which `base` needs, is not installed.
        """
        return CorrectionFeed(url, self.send, self._gga, base=base)

    async def wait_for_fix(self, fix: int = _FIX.RTK_FIXED, *, timeout: float | None = None) -> RtkStatus:
        """Wait until the receiver has a fix of at least this quality.

        Args:
            fix: RTK_FIXED, or RTK_FLOAT, which RTK_FIXED satisfies too.
            timeout: Seconds to wait; None waits for ever.

        Returns:
            The status.

        Raises:
            HealthTimeout: It had no such fix in time.
        """
        wanted = [_FIX.RTK_FLOAT, _FIX.RTK_FIXED] if fix == _FIX.RTK_FLOAT else [fix]
        try:
            async with asyncio.timeout(timeout):
                while (status := self.status).fix not in wanted:  # noqa: ASYNC110 (values of messages)
                    await asyncio.sleep(_POLL_INTERVAL)
        except TimeoutError:
            target = str(self._vehicle.address)
            answer = f"the fix is {self.status.name}; {self._reason()}"
            raise HealthTimeout("waiting for corrections of", target, answer=answer) from None
        return status

    def _reason(self) -> str:
        counts = self.counts
        if not counts.frames:
            return "no corrections were received from a source"
        return f"{counts.frames} frames were received from the source and {counts.sent} sent"

    def _gga(self) -> bytes:
        """Return the position of the vehicle as a GGA sentence; empty if it is not known."""
        gps = self._vehicle.gps
        if gps is None or gps.latitude is None or gps.longitude is None:
            return b""
        fix = Fix(
            self._vehicle.component.now(), gps.latitude, gps.longitude, gps.altitude or 0.0, int(gps.fix),
            gps.satellites or 0, 1.0 if gps.hdop is None else gps.hdop,
        )  # fmt: skip
        return format_gga(fix)
