"""Setting and listing modes: client against server, and against autopilots that differ."""

from __future__ import annotations

from itertools import islice
from random import Random
from typing import Any

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, ModeTimeout, RemoteDenied
from mavstack.services import OperationEnded
from mavstack.services.command import CommandClient, CommandServer
from mavstack.services.heartbeat import HeartbeatSender
from mavstack.services.modes import (
    AvailableMode,
    ListModes,
    ModeMonitor,
    ModeSeen,
    ModeServer,
    ModesOutdated,
    SetMode,
    SetStandardMode,
    modes_of,
)
from tests.services.network import GROUND, VEHICLE, Network
from tests.services.single_service import deliver, random_message

PX4, ARDUPILOT = common.MavAutopilot.PX4, common.MavAutopilot.ARDUPILOTMEGA
ARDUPILOT_MODES = modes_of(ARDUPILOT, 2, [0, 4, 5, 6], {6: 5})


class ModeHarness:
    """A vehicle with modes and a ground station, joined by a perfect wire."""

    def __init__(self, modes=ARDUPILOT_MODES, *, autopilot=ARDUPILOT, commands=True, obeys=True, **options):
        self.network = Network(keep_packets=True)
        self.vehicle = self.network.node(VEHICLE)
        self.ground = self.network.node(GROUND)
        engine = self.vehicle.engine
        self.beacon = engine.add(HeartbeatSender(VEHICLE, 2, autopilot))
        self.modes = engine.add(
            ModeServer(VEHICLE, modes, modes[0].custom_mode, autopilot=autopilot, **options)
        )
        self.commands = engine.add(CommandServer(VEHICLE))
        if commands:
            self.modes.register(self.commands)
        if obeys:
            self.network.at(0.0, self.send_available_modes)
        self.client = self.ground.engine.add(CommandClient(GROUND, VEHICLE))
        self.network.connect(self.vehicle, self.ground)

    def send_available_modes(self):
        self.beacon.base_mode = 129
        self.beacon.custom_mode = self.modes.current.custom_mode
        self.network.at(0.1, self.send_available_modes)

    def run(self, operation, timeout=100.0):
        self.client.begin(operation, self.network.now)
        self.ground.engine.touch(self.client)
        assert self.network.run(lambda: operation.done, timeout=timeout)
        return operation


@pytest.mark.parametrize("mode", ["GUIDED", "guided", 4])
def test_a_mode_by_name_or_number_is_confirmed_by_heartbeat(mode):
    harness = ModeHarness()
    assert harness.run(SetMode(mode)).result() == 4
    assert harness.modes.current.custom_mode == 4
    heartbeats = [p.message for p in harness.ground.received if p.name == "HEARTBEAT"]
    assert heartbeats[-1].custom_mode == 4


def test_px4_gets_main_and_sub_mode_and_stays_armed():
    harness = ModeHarness(modes_of(PX4, 2, [1 << 16, 4 << 16 | 5 << 24]), autopilot=PX4)
    assert harness.run(SetMode("RTL")).result() == 4 << 16 | 5 << 24
    command = next(p.message for p in harness.vehicle.received if p.name == "COMMAND_LONG")
    assert (command.param1, command.param2, command.param3) == (129.0, 4.0, 5.0)


def test_accepted_but_never_entered_is_an_error_that_is_reported():
    harness = ModeHarness(obeys=False)
    operation = harness.run(SetMode("GUIDED"))
    with pytest.raises(ModeTimeout, match="accepted, but not entered: the vehicle reports STABILIZE"):
        operation.result()


def test_a_heartbeat_from_before_the_command_proves_nothing():
    harness = ModeHarness(obeys=False)
    harness.beacon.custom_mode = 4
    operation = SetMode("GUIDED")
    harness.client.begin(operation, harness.network.now)
    harness.ground.engine.touch(harness.client)
    assert harness.network.run(
        lambda: any(p.name == "HEARTBEAT" for p in harness.ground.received), timeout=5.0
    )
    harness.beacon.custom_mode = 5
    assert harness.network.run(lambda: operation.done, timeout=60.0)
    assert isinstance(operation.error, ModeTimeout)


def test_a_refused_mode_is_denied_with_the_vehicles_result():
    harness = ModeHarness(may_enter=lambda mode, source: "no GPS")
    error = harness.run(SetMode("LOITER")).error
    assert isinstance(error, CommandDenied)
    assert error.code == common.MavResult.FAILED


def test_an_old_autopilot_gets_the_message_set_mode():
    harness = ModeHarness(commands=False)
    assert harness.run(SetMode("GUIDED")).result() == 4
    message = next(p.message for p in harness.vehicle.received if p.name == "SET_MODE")
    assert (message.target_system, message.base_mode, message.custom_mode) == (1, 129, 4)


def test_one_that_takes_neither_is_denied():
    """ArduCopter 4.1 says UNSUPPORTED of every mode that it refuses."""
    harness = ModeHarness(commands=False, obeys=False)
    began = harness.network.now
    error = harness.run(SetMode("GUIDED")).error
    assert isinstance(error, CommandDenied)
    assert error.code == common.MavResult.UNSUPPORTED
    assert harness.network.now - began < 5.0


def test_a_name_that_only_the_vehicle_knows_is_found_in_its_list():
    harness = ModeHarness([*ARDUPILOT_MODES, AvailableMode(77, "My Script")])
    assert harness.run(SetMode("my script")).result() == 77


def test_a_name_that_no_client_knows_is_denied_with_those_that_there_are():
    error = ModeHarness().run(SetMode("HOVERCRAFT")).error
    assert isinstance(error, RemoteDenied)
    assert "GUIDED" in str(error)


STANDARD_PX4 = [
    AvailableMode(1 << 16, "Manual"),
    AvailableMode(3 << 16, "", common.MavStandardMode.POSITION_HOLD),
    AvailableMode(4 << 16 | 3 << 24, "Hold", common.MavStandardMode.ORBIT),
    AvailableMode(4 << 16 | 5 << 24, "", common.MavStandardMode.SAFE_RECOVERY),
    AvailableMode(4 << 16 | 11 << 24, "Follow the Bees"),
]


def test_a_refusal_lists_every_mode_by_the_one_name_that_it_has():
    error = ModeHarness(STANDARD_PX4, autopilot=PX4).run(SetMode("HOVERCRAFT")).error
    assert "the vehicle has MANUAL, POSCTL, LOITER, RTL, Follow the Bees" in str(error)


@pytest.mark.parametrize(
    ("name", "number"),
    [("hold", 0x03040000), ("Loiter", 0x03040000), ("position", 0x30000), ("follow-the bees", 0x0B040000)],
)
def test_the_names_of_px4_and_of_the_vehicle_are_accepted(name, number):
    assert ModeHarness(STANDARD_PX4, autopilot=PX4).run(SetMode(name)).result() == number


@pytest.mark.parametrize("changed", [False, True])
def test_an_unknown_name_is_refused_soon_by_a_vehicle_that_lists_its_modes_slowly(changed):
    harness = ModeHarness([*modes_of(ARDUPILOT, 2, range(20)), AvailableMode(77, "My Script")])
    send, due = harness.modes.bulk_messages, [0]

    def tick():
        due[0] = 1
        harness.vehicle.engine.touch(harness.modes)
        harness.network.at(0.3, tick)

    def slowly(now, has_room):
        if due[0]:
            due[0] = 0
            yield from islice(send(now, has_room), 1)

    harness.modes.bulk_messages = slowly
    tick()
    began = harness.network.now
    error = harness.run(SetMode("HOVERCRAFT", changed=changed), timeout=60).error
    assert isinstance(error, RemoteDenied)
    assert "STABILIZE" in str(error)
    took = harness.network.now - began
    assert 6 < took < 60 if changed else took < 3.5


def test_the_monitor_names_a_mode_that_the_tables_do_not_have():
    monitor = ModeMonitor(GROUND, VEHICLE)
    script = AvailableMode(77, "My Script")
    deliver(monitor, common.Heartbeat(type=2, autopilot=3, custom_mode=77), VEHICLE, 0)
    assert monitor.name is None
    deliver(monitor, script.to_message(1, 2), VEHICLE, 0)
    deliver(monitor, AvailableMode(5, "Loiter!").to_message(2, 2), VEHICLE, 0)
    assert monitor.name == "My Script"
    deliver(monitor, common.Heartbeat(type=2, autopilot=3, custom_mode=5), VEHICLE, 0)
    assert monitor.name == "LOITER"
    assert not monitor.changed
    deliver(monitor, common.AvailableModesMonitor(seq=1), VEHICLE, 0)
    assert monitor.changed
    assert not monitor.reported


def test_without_a_heartbeat_nothing_is_sent():
    harness = ModeHarness()
    harness.vehicle.engine.remove(harness.beacon)
    harness.beacon = HeartbeatSender(VEHICLE)
    assert isinstance(harness.run(SetMode("GUIDED")).error, ModeTimeout)
    assert not [p for p in harness.vehicle.received if p.name == "COMMAND_LONG"]


def test_a_standard_mode_is_confirmed_by_current_mode():
    harness = ModeHarness()
    assert harness.run(SetStandardMode(common.MavStandardMode.SAFE_RECOVERY)).result() == 6
    assert isinstance(harness.run(SetStandardMode(common.MavStandardMode.ORBIT)).error, CommandDenied)


def test_all_modes_are_listed():
    modes = [AvailableMode(n, f"Mode {n}", properties=n % 4) for n in range(100)]
    assert pair_list(ModeHarness(modes)) == modes


def pair_list(harness):
    return list(harness.run(ListModes()).result())


def test_gaps_in_the_list_are_requested_by_index():
    harness = ModeHarness()
    original = harness.modes._list

    def lossy(index, target):
        result = original(index, target)
        if index == 0:
            for waiting in harness.modes._listings.values():
                waiting.remove(3)
        return result

    harness.modes._list = lossy
    assert pair_list(harness) == ARDUPILOT_MODES
    asked = [p.message.param2 for p in harness.vehicle.received if p.name == "COMMAND_LONG"]
    assert asked == [0.0, 3.0]


def test_a_set_that_changes_while_it_is_listed_is_never_mixed():
    harness = ModeHarness()
    new = modes_of(ARDUPILOT, 2, [0, 1, 2, 3])
    original = harness.modes._list

    def change(index, target):
        result = original(index, target)
        if index == 0 and harness.modes.modes != tuple(new):
            for waiting in harness.modes._listings.values():
                waiting.pop()
            harness.network.at(0.5, lambda: (harness.modes.offer(new, harness.network.now), None))
            harness.network.at(0.5, lambda: harness.vehicle.engine.touch(harness.modes))
        return result

    harness.modes._list = change
    assert pair_list(harness) == new


def test_modes_of_two_sets_are_not_put_together():
    client = CommandClient(GROUND, VEHICLE)
    operation = client.begin(ListModes(), 0.0)
    old, new = modes_of(ARDUPILOT, 2, [0, 1]), modes_of(ARDUPILOT, 2, [4, 5, 6])
    for mode, index, total in ((old[1], 2, 2), (new[0], 1, 3), (new[2], 3, 3)):
        deliver(client, mode.to_message(index, total), VEHICLE, 0.1)
    deliver(client, common.CommandAck(command=512, result=0), VEHICLE, 0.1)
    assert not operation.done
    deliver(client, new[1].to_message(2, 3), VEHICLE, 0.2)
    assert list(operation.result()) == new


def test_the_monitor_reports_modes_and_changed_sets_once():
    monitor = ModeMonitor(GROUND, VEHICLE)
    heartbeat = common.Heartbeat(type=2, autopilot=3, base_mode=1, custom_mode=5)
    for message in (
        heartbeat,
        heartbeat,
        common.Heartbeat(type=30, autopilot=8, custom_mode=9),
        common.CurrentMode(standard_mode=5, custom_mode=6, intended_custom_mode=5),
        common.AvailableModesMonitor(seq=0),
        common.AvailableModesMonitor(seq=1),
        common.AvailableModesMonitor(seq=1),
    ):
        deliver(monitor, message, VEHICLE, 0)
    assert monitor.events() == [ModeSeen(5, "LOITER"), ModeSeen(6, "RTL"), ModesOutdated(1)]
    assert (monitor.standard_mode, monitor.intended, monitor.name) == (5, 5, "RTL")


def test_garbage_from_the_wire_never_raises():
    random = Random(2)
    client, monitor = CommandClient(GROUND, VEHICLE), ModeMonitor(GROUND, VEHICLE)
    kinds = (
        common.Heartbeat, common.CurrentMode, common.AvailableModes,
        common.AvailableModesMonitor, common.CommandAck,
    )  # fmt: skip
    for number in range(200):
        operations: list[Any] = [SetMode("GUIDED"), SetMode(3), SetStandardMode(6), ListModes()]
        client.begin(random.choice(operations), number)
        for _ in range(5):
            message = random_message(random.choice(kinds), random)
            deliver(client, message, VEHICLE, number)
            deliver(monitor, message, VEHICLE, number)
        client.handle_timeout(number + 0.9)
    client.handle_timeout(1000.0)
    while client.busy:
        client.handle_timeout(client.next_timeout())
    assert len([event for event in client.events() if isinstance(event, OperationEnded)]) == 200
