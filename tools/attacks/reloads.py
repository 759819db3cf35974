"""Attacks on the configuration of our router, which it reads again while it runs.

Each returns the number of packets that should not have passed, and 1 more if the pilot is cut off.
"""

from __future__ import annotations

from time import monotonic, sleep
from types import MappingProxyType
from typing import TYPE_CHECKING, Final

from mavstack.dialects import common
from tools.attacks.scenarios import injection

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from tools.attacks.range import Range, Station

#: Seconds in which a changed file is read: it must be unchanged for one look, and looks are a second apart.
_READING: Final = 4.0
_PACKETS: Final = 10
_QUARANTINE: Final = 'quarantine = "1 min"'
#: A changed firewall, with a rule that shows that it is in use.
_CHANGED: Final = 'quarantine = "2 min"'
_OTHER_PILOT: Final = """
[[firewall.rule]]
name = "another pilot"
endpoints = ["ground"]
systems = [254]
"""


def empty_file(field: Range) -> int:
    """Truncate the file and inject; then write it again in two steps, of which the first has no firewall."""
    text = field.config.read_text("utf-8")
    field.config.write_text("")
    _wait_until_read(field)
    passed = injection(field) + (not field.command_works())
    field.config.write_text(text.partition("[firewall]")[0])
    passed += injection(field)  # takes less time than one look
    field.config.write_text(text)
    _wait_until_read(field)
    return passed + injection(field) + (not field.command_works())


def quarantined_over_a_change(field: Range) -> int:
    """Earn a quarantine, have the firewall change, and send again; count what passes."""
    stranger, text = field.attacker((255, 191)), field.config.read_text("utf-8")
    if not _passed(field, stranger):
        raise SystemExit("mavstack: the packets of a stranger with an allowed id do not pass")
    stranger.send(common.SerialControl(count=200))
    sleep(1.5)  # alerts are looked at once a second
    if _QUARANTINE not in text or _passed(field, stranger):
        raise SystemExit("mavstack: a malformed packet causes no quarantine")
    field.config.write_text(text.replace(_QUARANTINE, _CHANGED) + _OTHER_PILOT)
    _wait_until_read(field)
    if not _passed(field, field.attacker((254, 190))):
        raise SystemExit("mavstack: the changed firewall is not in use")
    return _passed(field, stranger)


def _wait_until_read(field: Range) -> None:
    """Wait until a changed file is read, while the vehicle sends heartbeats: its route would expire."""
    end = monotonic() + _READING
    while monotonic() < end:
        field.vehicle_heartbeat()
        sleep(0.5)


def _passed(field: Range, station: Station) -> int:
    """Send packets that the rules allow; return how many of them reach the vehicle."""
    field.vehicle.receive(0.1)
    for number in range(_PACKETS):
        station.send(common.Attitude(time_boot_ms=number))
    return field.passed()


#: Attacks on the configuration with the gateway, by their names in the table.
RELOADS: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {"empty configuration, then half of it": empty_file}
)
#: Attacks on the configuration of a firewall alone.
UNSIGNED_RELOADS: Final[Mapping[str, Callable[[Range], int]]] = MappingProxyType(
    {"changed firewall: packets of the quarantined": quarantined_over_a_change}
)
