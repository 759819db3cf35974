"""A receiver that uses corrections (GPS_RTCM_DATA): its fix becomes RTK float, and soon RTK fixed.

It needs the position of the reference station (1005 or 1006) and observations (MSM, or 1001 to 1012). Float
comes with the first of them, fixed after ten seconds of observations. When they stop, the fix returns to
float after five seconds and to 3D after half a minute.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from mavstack.gnss.rtcm import POSITION_NUMBERS
from mavstack.services.rtk import CorrectionReceived, CorrectionReceiver
from mavstack.services.service import Service

if TYPE_CHECKING:
    from mavstack.services import Address
    from mavstack.sim.motion import Body
    from mavstack.wire import Packet

RTK_FLOAT, RTK_FIXED = 5, 6
#: Seconds of corrections until the fix is RTK fixed.
FIXING_TIME: Final = 10.0
#: Seconds without corrections after which the fix is RTK float, and after which it is 3D.
FLOAT_AGE: Final = 5.0
MAX_AGE: Final = 30.0


class CorrectedGps(Service):
    """The corrections of one receiver.

    Args:
        local: The address of the autopilot.
        body: The body whose receiver it is.
    """

    handles = CorrectionReceiver.handles

    def __init__(self, local: Address, body: Body) -> None:
        super().__init__(local)
        self._body = body
        self._receiver = CorrectionReceiver(local)
        self._has_station = False
        self._since: float | None = None
        self._last: float | None = None
        self._body.correct_gps(0)

    def receive(self, packet: Packet, now: float) -> bool:
        if not self._receiver.receive(packet, now):
            return False
        for event in self._receiver.events():
            if isinstance(event, CorrectionReceived):
                self._has_station |= event.frame.number in POSITION_NUMBERS
                if event.frame.is_observation:
                    self._since = now if self._since is None else self._since
                    self._last = now
        self._update(now)
        return True

    def next_timeout(self) -> float | None:
        if self._last is None or not self._has_station:
            return None
        return self._last + (MAX_AGE if self._since is None else FLOAT_AGE)

    def handle_timeout(self, now: float) -> None:
        self._update(now)

    def _update(self, now: float) -> None:
        """Set the fix from the age and the duration of the observations."""
        if self._last is None or not self._has_station:
            return
        age = now - self._last
        if age >= FLOAT_AGE:
            self._since = None
        if age >= MAX_AGE:
            self._last = None
            self._body.correct_gps(0)
        elif self._since is not None and now - self._since >= FIXING_TIME:
            self._body.correct_gps(RTK_FIXED)
        else:
            self._body.correct_gps(RTK_FLOAT)
