"""Messages from which the health of a vehicle is read."""

from __future__ import annotations

from mavstack.dialects import ardupilotmega, common

BIT = common.MavSysStatusSensor
EKF = ardupilotmega.EkfStatusFlags
#: The flags of an estimator that knows attitude and position.
ESTIMATED = EKF.ATTITUDE | EKF.POS_HORIZ_ABS | EKF.POS_VERT_ABS


def status(enabled=BIT.PREARM_CHECK, health=0, present=None, **others):
    """Return a SYS_STATUS; sensors that are enabled are present, unless `present` is given."""
    return common.SysStatus(enabled if present is None else present, enabled, health, **others)


NOT_READY = status()
READY = status(health=BIT.PREARM_CHECK)


def texts_of(health):
    return [problem.text for problem in health.problems]
