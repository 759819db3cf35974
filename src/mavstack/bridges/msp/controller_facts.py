"""The facts of a flight controller until it restarts: boxes, switches, receiver, frame, equipment."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeVar

from mavstack.bridges.msp.boxes import Boxes
from mavstack.bridges.msp.mode_switches import ModeSwitches, Switch
from mavstack.bridges.msp.rc_channels import CHANNELS
from mavstack.dialects import common
from mavstack.errors import MspDecodeError, MspDenied
from mavstack.msp.messages.config import Feature, FeatureConfig
from mavstack.msp.messages.identification import BoardInfo
from mavstack.msp.messages.modes import BoxIds, BoxNames, ModeRanges
from mavstack.msp.messages.motors import InavMixer, MixerConfig
from mavstack.msp.messages.rc import RxConfig, RxMap
from mavstack.msp.messages.vtx import VtxConfig, VtxType
from mavstack.services.version import AutopilotVersion
from mavstack.services.version.autopilot_version import FirmwareVersion

if TYPE_CHECKING:
    from mavstack.bridges.msp.flight_controller import FlightController
    from mavstack.msp import FirmwareInfo
    from mavstack.msp.messages.base import MspMessage

AnyMessage = TypeVar("AnyMessage", bound="MspMessage")

_TYPE: Final = common.MavType
_CAPABILITY: Final = common.MavProtocolCapability
#: MAV_TYPE by Betaflight's mixer number; mixers that are not listed count as quadcopters.
_MIXERS: Final = {
    1: _TYPE.TRICOPTER, 6: _TYPE.HEXAROTOR, 7: _TYPE.HEXAROTOR, 8: _TYPE.FIXED_WING, 10: _TYPE.HEXAROTOR,
    11: _TYPE.OCTOROTOR, 12: _TYPE.OCTOROTOR, 13: _TYPE.OCTOROTOR, 14: _TYPE.FIXED_WING,
    15: _TYPE.HELICOPTER, 16: _TYPE.HELICOPTER, 18: _TYPE.HEXAROTOR, 20: _TYPE.COAXIAL, 21: _TYPE.COAXIAL,
    24: _TYPE.FIXED_WING, 25: _TYPE.TRICOPTER, 27: _TYPE.OCTOROTOR,
}  # fmt: skip
#: MAV_TYPE by iNav's platform type; platforms that are not listed count as quadcopters.
_PLATFORMS: Final = {
    1: _TYPE.FIXED_WING, 2: _TYPE.HELICOPTER, 3: _TYPE.TRICOPTER, 4: _TYPE.GROUND_ROVER,
    5: _TYPE.SURFACE_BOAT,
}  # fmt: skip
#: iNav's number of the receiver type that takes RC channels by MSP.
_INAV_RX_MSP: Final = 2
#: The value of `osd` for a board with a chip for an analog display.
_OSD_CHIP: Final = 2
_BOXES_PER_PAGE: Final = 32
_MAX_PAGES: Final = 8
_NO_VTX: Final = frozenset({VtxType.UNSUPPORTED, VtxType.UNKNOWN})
_UID_BYTES: Final = 18
_STICKS: Final = 4


@dataclass(frozen=True, slots=True)
class ControllerFacts:
    """The facts of one flight controller.

    Attributes:
        info: The identity of its firmware.
        boxes: Its boxes.
        switches: The channels that switch them.
        channel_map: For roll, pitch, yaw, throttle, AUX 1 and so on: the index of its channel.
        receives_msp: True if its receiver takes the channels by MSP.
        mav_type: The MAV_TYPE of its frame.
        has_osd: True if it has an on-screen display.
        has_vtx: True if it controls a video transmitter.
    """

    info: FirmwareInfo
    boxes: Boxes
    switches: ModeSwitches = field(default_factory=ModeSwitches)
    channel_map: tuple[int, ...] = (0, 1, 3, 2)
    receives_msp: bool = False
    mav_type: int = _TYPE.QUADROTOR
    has_osd: bool = False
    has_vtx: bool = False

    @property
    def has_channel_map(self) -> bool:
        """True if the channel map is valid: each channel has its own place."""
        places = self.channel_map
        return _STICKS <= len(places) <= CHANNELS and sorted(places) == list(range(len(places)))

    def version(self) -> AutopilotVersion:
        """Return the content of AUTOPILOT_VERSION, with the identifiers of firmware and board."""
        capabilities = _CAPABILITY.MAVLINK2 | _CAPABILITY.PARAM_ENCODE_BYTEWISE | _CAPABILITY.COMMAND_INT
        if self.info.is_inav:
            capabilities |= _CAPABILITY.MISSION_INT
        major, minor, patch = self.info.version
        uid = bytes.fromhex(self.info.uid) if self.info.uid else b""
        return AutopilotVersion(
            capabilities=capabilities,
            flight=FirmwareVersion(major, minor, patch),
            middleware=FirmwareVersion(*self.info.api),
            uid=int.from_bytes(uid[:8], "big"),
            uid2=uid.ljust(_UID_BYTES, b"\0"),
            flight_custom=_custom(self.info.variant),
            operating_system_custom=_custom(self.info.board),
        )


async def read_facts(controller: FlightController) -> ControllerFacts:
    """Ask a flight controller for its facts; what it does not have or does not know gets its default.

    Raises:
        MspTimeout: It does not answer.
        LinkError: The link is down.
    """
    info = controller.info
    ids, names = await _read_boxes(controller)
    ranges = await _get(controller, ModeRanges)
    rx_map = await _get(controller, RxMap)
    features = await _get(controller, FeatureConfig)
    receiver = await _get(controller, RxConfig)
    board = await _get(controller, BoardInfo)
    vtx = await _get(controller, VtxConfig)
    switches = () if ranges is None else ranges.ranges
    bits = 0 if features is None else int(features.features)
    by_feature = not info.is_inav and bool(bits & Feature.RX_MSP)
    by_type = info.is_inav and receiver is not None and receiver.receiver_type == _INAV_RX_MSP
    osd_chip = board is not None and board.osd is not None and board.osd & _OSD_CHIP
    return ControllerFacts(
        info,
        Boxes(is_inav=info.is_inav, ids=ids, names=names),
        ModeSwitches(Switch(each.mode, each.aux_channel, each.start, each.end) for each in switches),
        (0, 1, 3, 2) if rx_map is None else rx_map.positions,
        by_feature or by_type,
        await _mav_type(controller),
        bool(bits & Feature.OSD or osd_chip),
        vtx is not None and vtx.vtx_type not in _NO_VTX,
    )


async def _read_boxes(controller: FlightController) -> tuple[list[int], list[str]]:
    ids: list[int] = []
    names: list[str] = []
    for page in range(1 if controller.info.is_inav else _MAX_PAGES):
        argument = bytes([page]) if page else b""
        found = await _get(controller, BoxIds, argument)
        named = await _get(controller, BoxNames, argument)
        fresh = () if found is None else tuple(each for each in found.ids if each not in ids)
        ids += fresh
        names += named.names if named is not None and fresh else ()
        if found is None or len(found.ids) < _BOXES_PER_PAGE or not fresh:
            break
    return ids, names


async def _mav_type(controller: FlightController) -> int:
    if controller.info.is_inav:
        platform = await _get(controller, InavMixer)
        return (
            _TYPE.QUADROTOR if platform is None else _PLATFORMS.get(platform.platform_type, _TYPE.QUADROTOR)
        )
    mixer = await _get(controller, MixerConfig)
    return _TYPE.QUADROTOR if mixer is None else _MIXERS.get(mixer.mixer, _TYPE.QUADROTOR)


async def _get(
    controller: FlightController, kind: type[AnyMessage], argument: bytes = b""
) -> AnyMessage | None:
    """Request a message; None if the firmware does not know it."""
    try:
        return await controller.get(kind, argument)
    except (MspDenied, MspDecodeError):
        return None


def _custom(text: str) -> bytes:
    return text.encode("ascii", "replace")[:8].ljust(8, b"\0")
