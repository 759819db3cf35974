"""Corrections for satellite navigation (GPS_RTCM_DATA): the sender, and the receiver of a vehicle."""

from mavstack.services.rtk.fragments import MAX_FRAME, FrameAssembler, fragment
from mavstack.services.rtk.receiver import CorrectionReceived, CorrectionReceiver
from mavstack.services.rtk.sender import ChannelPace, CorrectionCounts, CorrectionSender

__all__ = [
    "MAX_FRAME",
    "ChannelPace",
    "CorrectionCounts",
    "CorrectionReceived",
    "CorrectionReceiver",
    "CorrectionSender",
    "FrameAssembler",
    "fragment",
]
