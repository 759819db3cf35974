"""The places of the fields that the core compares with those before: boot times, positions and headings."""

from __future__ import annotations

from typing import Final

from mavstack.dialects import common

#: Offset of the boot time in the payload, by message id.
BOOT_FIELDS: Final = {
    kind.__mavlink_row__[0]: offset
    for kind, offset in (
        (common.SystemTime, 8),
        (common.Attitude, 0),
        (common.AttitudeQuaternion, 0),
        (common.GlobalPositionInt, 0),
        (common.LocalPositionNed, 0),
    )
}
#: Id of the position message; offsets of its latitude, longitude, north speed and east speed.
POSITION_FIELDS: Final = (common.GlobalPositionInt.__mavlink_row__[0], 4, 8, 20, 22)
#: Id of the attitude message; offsets of its roll, pitch, yaw and yaw speed.
HEADING_FIELDS: Final = (common.Attitude.__mavlink_row__[0], 4, 8, 12, 24)
