"""Manual control: MANUAL_CONTROL and RC_CHANNELS_OVERRIDE (guide: manual control protocol)."""

from mavstack.services.manual_control.inputs import RELEASE, ChannelOverride, ManualInput
from mavstack.services.manual_control.receiver import (
    ManualControlReceiver,
    ManualInputLost,
    ManualInputReceived,
    OverrideLost,
    OverrideReceived,
)
from mavstack.services.manual_control.sender import ManualControlSender, OverrideSender

__all__ = [
    "RELEASE",
    "ChannelOverride",
    "ManualControlReceiver",
    "ManualControlSender",
    "ManualInput",
    "ManualInputLost",
    "ManualInputReceived",
    "OverrideLost",
    "OverrideReceived",
    "OverrideSender",
]
