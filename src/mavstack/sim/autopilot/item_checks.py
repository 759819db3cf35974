"""Checks of the params of plan items, shared by missions and rally points."""

from __future__ import annotations

from math import isfinite, isinf, isnan
from typing import TYPE_CHECKING

from mavstack.dialects import common

if TYPE_CHECKING:
    from mavstack.services.mission import MissionItem

_RESULT = common.MavMissionResult


def check_numbers(item: MissionItem, *, may_be_nan: frozenset[int] = frozenset()) -> int:
    """Check params 1 to 4 of an item.

    Args:
        item: The item.
        may_be_nan: The numbers of the params that may be NaN.

    Returns:
        ACCEPTED, or the MAV_MISSION_RESULT of the first param that is infinite or NaN.
    """
    for index in range(1, 5):
        value: float = getattr(item, f"param{index}")
        if isinf(value) or (isnan(value) and index not in may_be_nan):
            return int(_RESULT.INVALID_PARAM1) + index - 1
    return _RESULT.ACCEPTED


def check_position(item: MissionItem, *, highest: float, may_be_left_out: bool = False) -> int:
    """Check params 5 to 7 of an item: latitude, longitude and altitude.

    Args:
        item: The item.
        highest: The limit of the altitude, in metres.
        may_be_left_out: True if a param may be NaN.

    Returns:
        ACCEPTED, or the MAV_MISSION_RESULT of the first param that is no position on Earth.
    """
    limits = ((item.param5, 90.0, _RESULT.INVALID_PARAM5_X), (item.param6, 180.0, _RESULT.INVALID_PARAM6_Y))
    for value, limit, result in limits:
        if not abs(value) <= limit and not (may_be_left_out and isnan(value)):
            return result
    if (isfinite(item.param7) and abs(item.param7) < highest) or (may_be_left_out and isnan(item.param7)):
        return _RESULT.ACCEPTED
    return _RESULT.INVALID_PARAM7
