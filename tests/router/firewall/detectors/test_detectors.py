"""Each detector: an attack, and ordinary use that it must not disturb."""

from __future__ import annotations

from importlib.metadata import EntryPoint, EntryPoints

import pytest

from mavstack.dialects import Dialect, common
from mavstack.errors import InvalidArgumentError
from mavstack.plugins import Registry
from mavstack.router.config import Table
from mavstack.router.firewall import Traffic, detector_names, make_detector
from mavstack.router.firewall.detector import Origin
from mavstack.security import SigningKey, senders
from mavstack.security.acting import acting_names
from mavstack.wire import Packet
from tests.router.firewall.packets import Sender, command, ground_heartbeat, heartbeat, texts

ARM, RTL, FORCE = 400, 20, 21196


def detector(name: str, **options):
    made = make_detector(name)
    made.configure(Table.of(options))
    return made


def feed(made, packets, *, origin: str = "ground", now: float = 0.0, step: float = 1.0):
    """Inspect packets, one each `step` seconds."""
    return [
        alert
        for index, each in enumerate(packets)
        for alert in made.inspect(origin, each, now + index * step)
    ]


def test_an_address_that_is_in_use_on_another_link_is_refused():
    made, vehicle, attacker = detector("spoofed-ids"), Sender(1, 1), Sender(1, 1)
    assert feed(made, [vehicle.packet(heartbeat())], origin="cable") == []
    (alert,) = feed(made, [attacker.packet(heartbeat())], origin="radio", now=1.0)
    assert (alert.refuse, alert.text) == (True, "the address is in use on cable")
    assert feed(made, [vehicle.packet(heartbeat())], origin="radio", now=10.0) == []  # it moved
    two = feed(made, [attacker.packet(heartbeat(kind=common.MavType.SUBMARINE))], origin="radio", now=11.0)
    assert texts(two) == ["two senders of different type have this address"]


@pytest.mark.parametrize("message", [command(ARM, 1), common.SetMode(), common.ParamSet()], ids=repr)
def test_a_command_from_an_address_of_another_link_is_refused(message):
    made, pilot, attacker = detector("spoofed-ids"), Sender(), Sender()
    assert feed(made, [attacker.packet(message)], origin="radio") == []  # no link has the address yet
    assert feed(made, [pilot.packet(ground_heartbeat()), pilot.packet(message)], origin="cable") == []
    (alert,) = feed(made, [attacker.packet(message)], origin="radio", now=1.0)
    assert (alert.refuse, alert.text) == (True, "the address is in use on cable")
    assert feed(made, [pilot.packet(message)], origin="radio", now=10.0) == []  # it moved


def peer(port: int, **attributes) -> Origin:
    """The origin of a packet from one peer of a UDP port."""
    sender = senders.Sender("ground", f"10.0.0.{port}:14550", **attributes)
    return Origin("ground", sender)


def acting_messages() -> list:
    """One message of each acting kind, for vehicle 1."""
    ardupilot = Dialect.load("all")
    return [ardupilot[name]() for name in sorted(acting_names())]


@pytest.mark.parametrize("message", acting_messages(), ids=lambda message: type(message).__name__)
@pytest.mark.parametrize("place", ["another endpoint", "another peer of the port"])
def test_no_acting_message_passes_in_the_name_of_the_pilot(message, place):
    made, pilot, attacker = detector("spoofed-ids"), Sender(), Sender()
    stranger = "radio" if place == "another endpoint" else peer(9)
    assert feed(made, [pilot.packet(ground_heartbeat()), pilot.packet(message)], origin=peer(1)) == []
    (alert,) = feed(made, [attacker.packet(message)], origin=stranger, now=1.0)
    assert alert.refuse
    assert alert.text == "the address is in use on ground from 10.0.0.1:14550"
    assert feed(made, [pilot.packet(message)], origin=peer(1), now=2.0) == []


def test_links_of_a_group_count_as_one_sender_with_one_peer_each():
    made = detector("spoofed-ids")

    def on(link: str, port: int) -> Origin:
        return Origin("radios", senders.Sender(link, f"10.0.0.{port}:1", group="radios"))

    vehicle = Sender(1, 1)
    for step in range(4):
        assert feed(made, [vehicle.packet(heartbeat())], origin=on("a", 1), now=step) == []
        assert feed(made, [vehicle.packet(heartbeat())], origin=on("b", 1), now=step) == []
        (alert,) = feed(made, [Sender(1, 1).packet(heartbeat())], origin=on("a", 2), now=step)
        assert "in use on a from 10.0.0.1:1" in alert.text


def test_an_authenticated_sender_takes_its_address_from_a_stranger_who_came_first():
    made = detector("spoofed-ids")
    pilot = peer(1, authority=senders.Authority.KEY)
    assert feed(made, [Sender().packet(ground_heartbeat())], origin=peer(9)) == []
    assert feed(made, [Sender().packet(ground_heartbeat())], origin=pilot, now=0.5) == []
    for now in (1.0, 100.0):
        (alert,) = feed(made, [Sender().packet(command(ARM, 1))], origin=peer(9), now=now)
        assert alert.refuse
    assert feed(made, [Sender().packet(command(ARM, 1))], origin=pilot, now=100.0) == []


@pytest.mark.parametrize("name", sorted(acting_names("flight", "plan", "settings")))
def test_a_flying_vehicle_is_changed_by_its_pilot_only(name):
    made, pilot, other = detector("behaviour"), Sender(255, 190), Sender(254, 190)
    message = Dialect.load("all")[name]
    target = {"target_system": 1} if "target_system" in message.definition.by_name else {}
    feed(made, [Sender(1, 1).packet(heartbeat(armed=True))], origin="vehicle")
    assert feed(made, [pilot.packet(command(ARM, 1))]) == []
    assert feed(made, [pilot.packet(message(**target))]) == []
    (alert,) = feed(made, [other.packet(message(**target))])
    assert alert.refuse


def test_malformed_counts_of_the_dialect_in_use_are_refused():
    made = detector("malformed")
    ardupilot = Dialect.load("all")
    write = ardupilot["DEVICE_OP_WRITE"]
    assert write.definition.id not in made.messages
    made.use_dialect(ardupilot)
    assert write.definition.id in made.messages
    (alert,) = feed(made, [Packet(Sender().packet(write(count=129)).raw, ardupilot)])
    assert alert.text == "DEVICE_OP_WRITE: count is 129, more than the 128 of its array"
    assert feed(made, [Packet(Sender().packet(write(count=128)).raw, ardupilot)]) == []


def test_positions_pass_only_from_named_senders():
    made = detector("injected-positions", allow=["1/195"])
    for message in (common.HilGps(), common.GpsInput()):
        assert "not allowed" in feed(made, [Sender(255, 190).packet(message)])[0].text
        assert feed(made, [Sender(1, 195).packet(message)]) == []


def test_a_recorded_command_is_refused():
    made, sender = detector("replays"), Sender()
    arm = sender.packet(command(ARM, 1))
    assert feed(made, [arm, *(sender.packet(ground_heartbeat()) for _ in range(20))]) == []
    (alert,) = feed(made, [arm], now=30.0)
    assert "COMMAND_LONG was sent before" in alert.text
    assert feed(made, [sender.packet(command(ARM, 1))], now=31.0) == []  # the same command, given again


def test_a_recorded_command_is_refused_also_where_its_sender_would_be_now():
    made, sender, alerts = detector("replays"), Sender(), []
    arm = sender.packet(command(ARM, 1))
    alerts += feed(made, [arm, *(sender.packet(ground_heartbeat()) for _ in range(255))])
    assert len(feed(made, [arm], now=300.0)) == 1
    assert feed(made, [arm], now=1200.0) == []  # after the window


def test_a_copy_over_a_redundant_link_is_no_replay_and_a_signed_copy_is():
    made, sender = detector("replays"), Sender(signing=SigningKey.generate().signing())
    arm = sender.packet(command(ARM, 1))
    assert feed(made, [arm, arm], step=0.3) == []
    assert len(feed(made, [arm], now=5.0)) == 1


def test_repetitions_over_many_wraps_of_the_sequence_are_no_replays():
    made, sender, alerts = detector("replays"), Sender(), []
    for second in range(1024):
        alerts += feed(made, [sender.packet(ground_heartbeat())], now=float(second))
        if second % 4 == 0:
            alerts += feed(made, [sender.packet(command(512, 148))], now=float(second))
    assert alerts == []


def test_two_senders_with_one_address_are_noticed_and_loss_is_not():
    one, two = Sender(1, 1), Sender(1, 1)
    for _ in range(60):
        two.packet(heartbeat())
    mixed = [sender.packet(common.Attitude()) for _ in range(200) for sender in (one, two)]
    (first, *_) = feed(detector("sequence"), mixed, step=0.01)
    assert not first.refuse
    assert "two senders?" in first.text
    alone = [packet for packet in (one.packet(common.Attitude()) for _ in range(3000)) if packet.sequence % 3]
    alone[50], alone[51] = alone[51], alone[50]
    assert feed(detector("sequence"), alone, step=0.01) == []


def test_floods_are_measured():
    made = detector("floods", max_packets=100, max_bad_bytes="1 kB/s")
    alerts = []
    for second, (packets, bad) in enumerate([(0, 0), (90, 900), (180, 1800), (400, 1800), (400, 9000)]):
        alerts += made.measure("radio", Traffic(packets, bad), float(second))
    assert texts(alerts) == ["220 packets/s, more than 100", "7200 bad bytes/s, more than 1000"]


MALFORMED = [
    common.TrajectoryRepresentationWaypoints(valid_points=6),
    common.TrajectoryRepresentationBezier(valid_points=255),
    common.SerialControl(count=71),
    common.GpsRtcmData(len=181),
    common.LogData(count=91),
    common.Tunnel(payload_length=129),
    common.CanfdFrame(len=65),
    common.FileTransferProtocol(payload=bytes([0, 0, 0, 3, 240]).ljust(251, b"\0")),
    common.SetPositionTargetGlobalInt(lat_int=900_000_001),
    common.SetHomePosition(longitude=-1_800_000_001),
]


@pytest.mark.parametrize("message", MALFORMED, ids=lambda message: type(message).__name__)
def test_malformed_fields_are_refused(message):
    assert len(feed(detector("malformed"), [Sender().packet(message)])) == 1
    assert feed(detector("malformed"), [Sender().packet(type(message)())]) == []


def test_only_the_pilot_commands_a_flying_vehicle():
    made, pilot, other, vehicle = detector("behaviour"), Sender(255, 190), Sender(254, 190), Sender(1, 1)
    ground = [vehicle.packet(heartbeat()), other.packet(command(RTL)), pilot.packet(command(ARM, 1))]
    assert feed(made, [*ground, vehicle.packet(heartbeat()), vehicle.packet(heartbeat(armed=True))]) == []
    upload = common.MissionCount(target_system=1, target_component=1, count=3)
    alerts = feed(made, [other.packet(command(RTL)), other.packet(upload), other.packet(command(ARM, 0))])
    assert [alert.text.split()[0] for alert in alerts] == [
        "NAV_RETURN_TO_LAUNCH", "MISSION_COUNT", "COMPONENT_ARM_DISARM",
    ]  # fmt: skip
    assert (
        feed(made, [pilot.packet(command(RTL)), pilot.packet(upload), other.packet(command(512, 148))]) == []
    )
    assert len(feed(made, [other.packet(command(ARM, 0, FORCE))])) == 1
    assert feed(made, [pilot.packet(command(ARM, 0, FORCE))]) == []  # nothing keeps turning against its wish
    assert (
        feed(made, [vehicle.packet(heartbeat()), other.packet(command(ARM, 1))]) == []
    )  # on the ground again


def test_a_pilot_may_be_kept_from_disarming_by_force():
    made, pilot, vehicle = detector("behaviour", forced_disarm=False), Sender(255, 190), Sender(1, 1)
    assert feed(made, [pilot.packet(command(ARM, 1)), vehicle.packet(heartbeat(armed=True))]) == []
    (forced,) = feed(made, [pilot.packet(command(ARM, 0, FORCE))])
    assert "by force" in forced.text
    assert feed(made, [pilot.packet(command(ARM, 0))]) == []


def test_operators_are_named():
    made, vehicle = detector("behaviour", operators=["254/190"]), Sender(1, 1)
    feed(made, [vehicle.packet(heartbeat(armed=True))])
    assert len(feed(made, [Sender(255, 190).packet(command(RTL))])) == 1
    assert feed(made, [Sender(254, 190).packet(command(RTL))]) == []
    assert len(feed(made, [Sender(255, 190).packet(command(RTL, target=0))])) == 1  # to all systems


def test_forged_sources_do_not_fill_the_memory():
    made = detector("spoofed-ids")
    for system in range(1, 256):
        for component in range(1, 40):
            feed(made, [Sender(system, component).packet(heartbeat())])
    assert len(made._vehicles) <= 4096
    assert len(made._claims.addresses()) <= 4096


def test_detectors_are_found_by_name():
    assert {type(make_detector(name)).name for name in detector_names()} == set(detector_names())
    with pytest.raises(InvalidArgumentError, match="must be one of spoofed-ids"):
        make_detector("nosuch")


@pytest.mark.parametrize(
    ("target", "problem"),
    [("no_such_module:X", "ModuleNotFoundError"), ("json:loads", "not a class of detectors")],
)
def test_a_plugin_that_cannot_be_loaded_is_an_error_only_for_those_who_name_it(monkeypatch, target, problem):
    entry = EntryPoint("broken", target, "mavstack.router_filters")
    monkeypatch.setattr(Registry, "plugins", lambda registry: EntryPoints([entry]))
    assert make_detector("floods").name == "floods"
    with pytest.raises(InvalidArgumentError, match=f"loading the detector broken failed: .*{problem}"):
        make_detector("broken")
