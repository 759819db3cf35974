"""Message intervals, and the groups of data streams.

MAV_CMD_SET_MESSAGE_INTERVAL takes microseconds for one message, with two special values: 0 requests the
default rate, -1 turns the message off. The older REQUEST_DATA_STREAM takes a rate in whole hertz for a group
of messages; the groups are those of ArduPilot.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import isfinite
from typing import TYPE_CHECKING

from mavstack.dialects import ardupilotmega, common
from mavstack.errors import InvalidArgumentError
from mavstack.services.addressing import message_ids

if TYPE_CHECKING:
    from typing import Self

    from mavstack.dialects import Message

MAX_INTERVAL = 0x7FFFFFFF


@dataclass(frozen=True, slots=True)
class Interval:
    """The interval of a message in microseconds; see `DEFAULT` and `OFF`."""

    microseconds: int

    def __post_init__(self) -> None:
        if not -1 <= self.microseconds <= MAX_INTERVAL:
            raise InvalidArgumentError(
                f"an interval must be from -1 to {MAX_INTERVAL} us, got {self.microseconds}"
            )

    @classmethod
    def hertz(cls, rate: float) -> Self:
        """Return the interval of a rate in hertz."""
        if not isfinite(rate) or rate <= 0:
            raise InvalidArgumentError(
                f"a message rate must be positive and finite, got {rate} Hz; OFF turns a message off"
            )
        return cls(min(max(round(1e6 / rate), 1), MAX_INTERVAL))

    @property
    def seconds(self) -> float:
        """The interval in seconds; 0 for the default rate, negative if off."""
        return self.microseconds / 1e6

    @property
    def rate(self) -> float:
        """The rate in hertz; 0 if off or unknown."""
        return 1e6 / self.microseconds if self.microseconds > 0 else 0.0


#: The default rate of the sender.
DEFAULT = Interval(0)
#: The message is not sent.
OFF = Interval(-1)


def message_id_of(message: type[Message] | int) -> int:
    """Return the id of a message class, or the id itself."""
    return message if isinstance(message, int) else next(iter(message_ids(message)))


def name_of(message: type[Message] | int) -> str:
    """Return the name of a message for errors."""
    return f"message {message}" if isinstance(message, int) else str(message.__mavlink_row__[1])


@cache
def stream_groups() -> dict[int, frozenset[int]]:
    """Return the messages of each MAV_DATA_STREAM, as ArduPilot groups them."""
    stream, dialect = common.MavDataStream, ardupilotmega
    groups: dict[int, tuple[type[Message], ...]] = {
        stream.RAW_SENSORS: (
            *(dialect.RawImu, dialect.ScaledImu, dialect.ScaledImu2, dialect.ScaledImu3),
            *(dialect.ScaledPressure, dialect.ScaledPressure2, dialect.ScaledPressure3),
        ),
        stream.EXTENDED_STATUS: (
            *(dialect.SysStatus, dialect.PowerStatus, dialect.McuStatus, dialect.Meminfo),
            *(dialect.MissionCurrent, dialect.GpsRawInt, dialect.GpsRtk, dialect.Gps2Raw, dialect.Gps2Rtk),
            *(dialect.NavControllerOutput, dialect.FenceStatus, dialect.PositionTargetGlobalInt),
        ),
        stream.RC_CHANNELS: (dialect.ServoOutputRaw, dialect.RcChannels, dialect.RcChannelsRaw),
        stream.RAW_CONTROLLER: (dialect.RcChannelsScaled,),
        stream.POSITION: (dialect.GlobalPositionInt, dialect.LocalPositionNed),
        stream.EXTRA1: (dialect.Attitude, dialect.Simstate, dialect.Ahrs2, dialect.PidTuning),
        stream.EXTRA2: (dialect.VfrHud,),
        stream.EXTRA3: (
            *(dialect.Ahrs, dialect.Hwstatus, dialect.SystemTime, dialect.Rangefinder),
            *(dialect.DistanceSensor, dialect.TerrainReport, dialect.BatteryStatus, dialect.OpticalFlow),
            *(dialect.MagCalReport, dialect.MagCalProgress, dialect.EkfStatusReport, dialect.Vibration),
            dialect.Rpm,
        ),
    }
    return {int(group): message_ids(*members) for group, members in groups.items()}


def group_of(message_id: int) -> int | None:
    """Return the MAV_DATA_STREAM of a message, if there is one."""
    return next((group for group, members in stream_groups().items() if message_id in members), None)
