"""The heartbeat protocol: HEARTBEAT sender and discovery of other components (guide: heartbeat/connection).

`HeartbeatSender` announces the local component. `Discovery` knows the other components: found by their first
HEARTBEAT (or HIGH_LATENCY2), lost after a timeout, returned, rebooted, or in conflict about one address.

A reboot and an address conflict look alike at first: in both, `time_boot_ms` of one address jumps back. Three
modules tell them apart, from the wire upwards:

`boot_time_filter` handles the bulk. A vehicle sends hundreds of messages with a boot time per second, and
nearly all of them continue the last one. Those that do are dropped from further analysis; a jump never is.

`boot_tracker` groups the remaining messages of one address into *boots*: the boot time and the arrival time
of a message give the moment at which its sender booted, and messages that agree on that moment belong to one
boot. Delays, reordering and clock drift shift the moment a little at a time, so each boot is tracked, and a
message belongs to it within `SAME_BOOT` seconds. A message that fits no boot starts another one:

    the old boot was silent, and the new one is not older than that silence     reboot, reported at once
    the old boot stays silent for `BOOT_SILENCE`                                reboot, reported then
    both continue, and the moments differ by less than `MAX_PATH_DELAY`         one vehicle over two links
    both continue for `CONFLICT_AFTER`                                          conflict: two vehicles

A new boot that would be older than the current one is no reboot: a clock jumped, or the machine slept. Nor is
one that continues where the old one stopped (a paused simulator), nor one that left a queue late. So a reboot
is seen even if the vehicle has been up for longer than before when it returns, and a second vehicle
that is switched on beside the first is not reported as a reboot of the first.

`address_conflict` decides whether one sender uses an address. No field of a packet identifies the sender, so
it looks for facts that one vehicle cannot have, from independent sources:

    boot_tracker         two boots, more than `MAX_PATH_DELAY` apart, both continue
    channel_clocks       two channels show boots further apart than the round trip of the slower one explains
    board_ids            two unique ids (AUTOPILOT_VERSION), each heard again after the other one
    interleaved_states   positions or headings that jump to and fro between two paths at the same boot times
    HEARTBEAT            type and autopilot alternate; a single change is a new configuration

`sender_probe` asks for the unique ids and the round trips, on each channel of an autopilot that is heard on
several. The same unique id on all channels outweighs `channel_clocks`: a link may be slower than it was when
its round trip was measured. Two vehicles without unique ids that booted at the same moment, and that are at
the same place with the same heading, stay undetected.
"""

from mavstack.services.heartbeat.component_info import ComponentInfo
from mavstack.services.heartbeat.component_types import describe_component
from mavstack.services.heartbeat.conflicting_sender import Conflict, ConflictingSender
from mavstack.services.heartbeat.discovery import Discovery
from mavstack.services.heartbeat.events import (
    AddressConflict,
    AddressConflictEnded,
    ComponentChanged,
    ComponentFound,
    ComponentLost,
    ComponentRebooted,
    ComponentReturned,
    OwnAddressConflict,
)
from mavstack.services.heartbeat.sender import HeartbeatSender

__all__ = [
    "AddressConflict",
    "AddressConflictEnded",
    "ComponentChanged",
    "ComponentFound",
    "ComponentInfo",
    "ComponentLost",
    "ComponentRebooted",
    "ComponentReturned",
    "Conflict",
    "ConflictingSender",
    "Discovery",
    "HeartbeatSender",
    "OwnAddressConflict",
    "describe_component",
]
