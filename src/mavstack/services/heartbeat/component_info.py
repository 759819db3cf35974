"""The state of a remote component, from its HEARTBEAT or HIGH_LATENCY2."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from mavstack.dialects import common
from mavstack.services.heartbeat.component_types import describe_component, is_vehicle

if TYPE_CHECKING:
    from mavstack.services.addressing import Address

HEARTBEAT_TIMEOUT = 5.0
#: Two intervals of HIGH_LATENCY2 and some: ArduPilot sends it each 5 s, PX4 each 67 s (MAV_0_HL_FREQ).
HIGH_LATENCY_TIMEOUT = 150.0


@dataclass(frozen=True, slots=True)
class ComponentInfo:
    """The last HEARTBEAT (or HIGH_LATENCY2) of a component, and when it was seen.

    Attributes:
        address: The component.
        type: Its MAV_TYPE.
        autopilot: Its MAV_AUTOPILOT; INVALID if it is no flight controller.
        base_mode: Its MAV_MODE_FLAG bits; 0 from HIGH_LATENCY2.
        custom_mode: Its mode, as its firmware numbers it.
        system_status: Its MAV_STATE.
        first_seen: When it was found, Unix seconds.
        last_seen: When its last sign of life arrived, Unix seconds.
        high_latency: True if it sends HIGH_LATENCY2 in place of HEARTBEAT.
        alive: False after it was lost.
        identifier: The identifier of a firmware that speaks MSP, such as "BTFL", from AUTOPILOT_VERSION.
    """

    address: Address
    type: int
    autopilot: int
    base_mode: int
    custom_mode: int
    system_status: int
    first_seen: float
    last_seen: float
    high_latency: bool = False
    alive: bool = True
    identifier: str = ""

    @classmethod
    def from_heartbeat(
        cls, address: Address, heartbeat: common.Heartbeat, now: float, known: ComponentInfo | None = None
    ) -> ComponentInfo:
        """Return the state after a HEARTBEAT; `known` is the state before, if there is one."""
        return cls(
            address,
            heartbeat.type,
            heartbeat.autopilot,
            heartbeat.base_mode,
            heartbeat.custom_mode,
            heartbeat.system_status,
            known.first_seen if known else now,
            now,
            alive=known.alive if known else True,
            identifier=known.identifier if known else "",
        )

    @classmethod
    def from_high_latency(
        cls, address: Address, summary: common.HighLatency2, now: float, known: ComponentInfo | None = None
    ) -> ComponentInfo:
        """Return the state after a HIGH_LATENCY2, which has no base mode and no system status."""
        return cls(
            address,
            summary.type,
            summary.autopilot,
            0,
            summary.custom_mode,
            common.MavState.UNINIT,
            known.first_seen if known else now,
            now,
            high_latency=True,
            identifier=known.identifier if known else "",
        )

    @property
    def is_autopilot(self) -> bool:
        """True if the component controls a vehicle: neither a payload nor a ground station."""
        return is_vehicle(self.type, self.autopilot)

    @property
    def is_ground_station(self) -> bool:
        """True if the component is a ground station."""
        return self.type == common.MavType.GCS

    @property
    def description(self) -> str:
        """The type and the firmware in words: "camera", "quadrotor with PX4"."""
        return describe_component(self.type, self.autopilot)

    @property
    def armed(self) -> bool:
        """True if the component reports that its motors may run."""
        return bool(int(self.base_mode) & common.MavModeFlag.SAFETY_ARMED.value)

    @property
    def timeout(self) -> float:
        """Seconds of silence after which the component counts as lost."""
        return HIGH_LATENCY_TIMEOUT if self.high_latency else HEARTBEAT_TIMEOUT

    @property
    def type_and_autopilot(self) -> tuple[int, int]:
        """MAV_TYPE and MAV_AUTOPILOT."""
        return int(self.type), int(self.autopilot)
