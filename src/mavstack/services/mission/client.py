"""The mission client: plans up and down, and the progress of the mission."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from mavstack.dialects import common
from mavstack.services.addressing import Address, message_ids
from mavstack.services.mission.download import DownloadPlan
from mavstack.services.mission.manage import ClearPlan, SetCurrentItem
from mavstack.services.mission.plan import Plan, PlanType
from mavstack.services.mission.stale_messages import StaleMessages
from mavstack.services.mission.transfer import Transfer
from mavstack.services.mission.upload import UploadPlan
from mavstack.services.operation import AnyOperation, Client, Operation
from mavstack.services.service import Event
from mavstack.services.timing import RoundTrip

if TYPE_CHECKING:
    from mavstack.wire import Packet

#: Seconds for which requests about an ended transfer are still answered.
ANSWER_AFTER_END = 30.0

_Result = common.MavMissionResult


@dataclass(frozen=True, slots=True)
class MissionProgress(Event):
    """The progress of the mission (MISSION_CURRENT), emitted when it changes.

    Attributes:
        seq: The current item.
        total: The number of items, as the vehicle counts them.
        state: The MISSION_STATE.
        mission_id: The id of the mission; 0 without a plan, or if the vehicle has no ids.
        fence_id: The id of the fence, likewise.
        rally_points_id: The id of the rally points, likewise.
    """

    seq: int
    total: int
    state: int
    mission_id: int
    fence_id: int
    rally_points_id: int

    @property
    def plan_ids(self) -> dict[int, int]:
        """The ids by plan type."""
        return {
            int(PlanType.MISSION): self.mission_id,
            int(PlanType.FENCE): self.fence_id,
            int(PlanType.RALLY): self.rally_points_id,
        }


@dataclass(frozen=True, slots=True)
class ItemReached(Event):
    """The vehicle reached an item of its mission (MISSION_ITEM_REACHED)."""

    seq: int


class MissionClient(Client):
    """The mission client of one vehicle.

    Args:
        local: The local component.
        target: The vehicle's autopilot.
        home_first: True if item 0 of its missions is its home, as on ArduPilot.
    """

    handles = message_ids(
        common.MissionRequest,
        common.MissionRequestInt,
        common.MissionAck,
        common.MissionCount,
        common.MissionItem,
        common.MissionItemInt,
        common.MissionCurrent,
        common.MissionItemReached,
    )

    def __init__(self, local: Address, target: Address, *, home_first: bool = False) -> None:
        super().__init__(local, target)
        self.home_first = home_first
        #: The last MISSION_CURRENT.
        self.progress: MissionProgress | None = None
        self._reached: int | None = None
        self._round_trip = RoundTrip(initial=0.5, minimum=0.02, maximum=1.5)
        self._stale_messages = StaleMessages()
        self._last: dict[tuple[int, type], Transfer[Any]] = {}

    def upload(self, plan: Plan, now: float, *, timeout: float | None = None) -> UploadPlan:
        """Replace the vehicle's plan atomically; the result is the plan with the vehicle's id."""
        return self.begin(UploadPlan(plan, timeout=timeout, home_first=self.home_first), now)

    def download(
        self, now: float, plan_type: int = PlanType.MISSION, *, timeout: float | None = None
    ) -> DownloadPlan:
        """Download the vehicle's plan of a type; the result is a `Plan`."""
        return self.begin(DownloadPlan(plan_type, timeout=timeout), now)

    def clear(
        self, now: float, plan_type: int = PlanType.MISSION, *, timeout: float | None = None
    ) -> ClearPlan:
        """Clear the vehicle's plan of a type, or all with `PlanType.ALL`."""
        return self.begin(ClearPlan(plan_type, timeout=timeout), now)

    def set_current(self, seq: int, now: float, *, timeout: float | None = None) -> SetCurrentItem:
        """Set the current item by MISSION_SET_CURRENT; see `set_current_item` for the command."""
        return self.begin(SetCurrentItem(seq, timeout=timeout), now)

    def clear_cache(self, now: float) -> None:
        """Discard the progress known before a reboot."""
        self.progress = self._reached = None

    def still_held(self, plan: Plan) -> bool | None:
        """Return whether the vehicle still has a plan that was transferred; None if it sends no ids."""
        current = self.progress.plan_ids.get(plan.type, 0) if self.progress else 0
        return None if not current or not plan.plan_id else current == plan.plan_id

    def begin(self, operation: AnyOperation, now: float) -> AnyOperation:
        if isinstance(operation, Transfer):
            operation.join(self._stale_messages, self._round_trip)
            self._last[operation.type, type(operation)] = operation
        return super().begin(operation, now)

    def conflicts(self, new: Operation[Any], running: Operation[Any]) -> bool:
        return isinstance(new, Transfer) and isinstance(running, Transfer)

    def observe(self, packet: Packet, now: float) -> None:
        match packet.message:
            case common.MissionCurrent() as message:
                self._update_progress(message)
            case common.MissionItemReached(seq=seq) if seq != self._reached:  # vehicles send it several times
                self._reached = seq
                self.emit(ItemReached(seq))
            case common.MissionRequest(mission_type=kind) | common.MissionRequestInt(mission_type=kind):
                self._item_requested(int(kind), now)
            case common.MissionAck(type=_Result.OPERATION_CANCELLED, mission_type=kind):
                self._stale_messages.upload_stopped(int(kind))
            case common.MissionItemInt(mission_type=kind) | common.MissionItem(mission_type=kind):
                self._item_received(int(kind), now)

    def _update_progress(self, message: common.MissionCurrent) -> None:
        progress = MissionProgress(
            message.seq,
            message.total,
            int(message.mission_state),
            message.mission_id,
            message.fence_id,
            message.rally_points_id,
        )
        if progress.seq == self._reached and progress.seq != (self.progress.seq if self.progress else None):
            self._reached = None  # the vehicle flies to this item again
        if progress != self.progress:
            self.progress = progress
            self.emit(progress)

    def _item_requested(self, plan_type: int, now: float) -> None:
        """Handle a request for an item: without a running upload, the vehicle is in one that has ended."""
        upload = self._last.get((plan_type, UploadPlan))
        if upload is not None and (upload.done or not upload.begun):
            self._stale_messages.item_requested(plan_type, now)
            self._repeat_result(upload, _Result.OPERATION_CANCELLED, now)

    def _item_received(self, plan_type: int, now: float) -> None:
        """Handle an item after the end of a download: the vehicle missed the last acknowledgement."""
        download = self._last.get((plan_type, DownloadPlan))
        if download is not None and download.done and download.error is None:
            self._repeat_result(download, _Result.ACCEPTED, now)

    def _repeat_result(self, transfer: Transfer[Any], result: int, now: float) -> None:
        """Repeat the result of a transfer, unless it could be mistaken for that of a running one."""
        others = [other for other in self._running if isinstance(other, Transfer) and other.begun]
        disturbed = any(other.writes or other.type == transfer.type for other in others)
        recent = not transfer.done or now - transfer.sent_at < ANSWER_AFTER_END
        if recent and not disturbed:
            transfer.acknowledge(result, now)
