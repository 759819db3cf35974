from __future__ import annotations

from random import Random

import pytest

from mavstack.dialects import common
from mavstack.errors import InvalidArgumentError
from mavstack.services import Address, Priority
from mavstack.services.command import Command, CommandServer
from mavstack.services.modes import AvailableMode, ModeChanged, ModeRefused, ModeServer, modes_of
from mavstack.services.modes.server import MAX_LISTINGS, MAX_MODES
from tests.services.network import GROUND, VEHICLE
from tests.services.single_service import deliver, random_message, run_timers, sent_by

R = common.MavResult
COPTER = modes_of(3, 2, [0, 4, 5, 6, 9], {6: common.MavStandardMode.SAFE_RECOVERY})
MODES, CURRENT = 435, 436


class Copter:
    def __init__(self, **options):
        self.commands = CommandServer(VEHICLE)
        self.modes = ModeServer(VEHICLE, COPTER, 0, **options)
        self.modes.register(self.commands)
        sent_by(self.modes, 0)
        self.sequence = 0

    def ask(self, command, *params, now=0.0, source=GROUND):
        self.sequence += 1
        deliver(self.commands, Command.of(command, params).to_long(VEHICLE), source, now, self.sequence)
        return sent_by(self.commands, now)[0].result


def test_do_set_mode_changes_the_mode_and_reports_it_immediately():
    copter = Copter()
    assert copter.ask(common.MavCmd.DO_SET_MODE, 1, 4) == R.ACCEPTED
    assert copter.modes.current.name == "GUIDED"
    event = copter.modes.events()[0]
    assert (event.mode.custom_mode, event.previous.custom_mode, event.source) == (4, 0, GROUND)
    assert [type(message) for message in sent_by(copter.modes, 0)] == [common.CurrentMode]


def test_px4_takes_main_and_sub_mode():
    modes = modes_of(12, 2, [1 << 16, 5 << 24 | 4 << 16])
    copter = Copter()
    copter.modes = ModeServer(VEHICLE, modes, 1 << 16, autopilot=common.MavAutopilot.PX4)
    copter.modes.register(copter.commands)
    assert copter.ask(common.MavCmd.DO_SET_MODE, 1, 4, 5) == R.ACCEPTED
    assert copter.modes.current.name == "RTL"


def test_a_missing_standard_mode_fails_with_the_result_of_the_guide():
    copter = Copter()
    assert copter.ask(common.MavCmd.DO_SET_STANDARD_MODE, common.MavStandardMode.ORBIT) == R.FAILED
    assert copter.ask(common.MavCmd.DO_SET_STANDARD_MODE, 0) == R.FAILED
    assert copter.ask(common.MavCmd.DO_SET_STANDARD_MODE, 5) == R.ACCEPTED
    assert copter.modes.current.name == "RTL"


@pytest.mark.parametrize(
    "params", [(0, 4), (1, 99), (1, float("nan")), (float("inf"), 4), (1, -4), (1, 1e30)]
)
def test_impossible_requests_are_refused_and_change_nothing(params):
    copter = Copter()
    assert copter.ask(common.MavCmd.DO_SET_MODE, *params) == R.FAILED
    assert copter.modes.current.custom_mode == 0
    assert isinstance(copter.modes.events()[0], ModeRefused)


def test_the_programs_veto_is_reported_to_the_asker():
    copter = Copter(may_enter=lambda mode, source: "no GPS" if mode.name == "LOITER" else None)
    assert copter.ask(common.MavCmd.DO_SET_MODE, 1, 5) == R.FAILED
    assert copter.modes.intended.custom_mode == copter.modes.current.custom_mode == 0
    (refused,) = copter.modes.events()
    assert (refused.custom_mode, refused.source, refused.reason) == (5, GROUND, "no GPS")
    assert "no GPS" in sent_by(copter.modes, 0)[0].text
    assert copter.ask(common.MavCmd.DO_SET_MODE, 1, 6) == R.ACCEPTED


def test_set_mode_of_old_ground_stations_is_obeyed():
    copter = Copter()
    deliver(copter.modes, common.SetMode(target_system=1, base_mode=1, custom_mode=9), GROUND, 1)
    assert copter.modes.current.name == "LAND"
    deliver(copter.modes, common.SetMode(target_system=1, base_mode=64, custom_mode=0), GROUND, 1)
    deliver(copter.modes, common.SetMode(target_system=7, base_mode=1, custom_mode=0), GROUND, 1)
    assert copter.modes.current.name == "LAND"


def test_a_failsafe_leaves_what_was_intended():
    copter = Copter()
    copter.ask(common.MavCmd.DO_SET_MODE, 1, 5)
    sent_by(copter.modes, 0)
    copter.modes.enter(6, 3.0)
    (message,) = sent_by(copter.modes, 3.0)
    assert (message.custom_mode, message.intended_custom_mode, message.standard_mode) == (6, 5, 5)
    assert copter.modes.events()[-1] == ModeChanged(copter.modes.modes[3], copter.modes.modes[2], None)


def test_all_modes_are_listed_on_request_and_one_by_its_index():
    copter = Copter()
    assert copter.ask(common.MavCmd.REQUEST_MESSAGE, MODES, 0) == R.ACCEPTED
    listed = sent_by(copter.modes, 0)
    assert [(message.mode_index, message.number_modes) for message in listed] == [
        (index, 5) for index in range(1, 6)
    ]
    assert [AvailableMode.read(message) for message in listed] == COPTER
    assert copter.ask(common.MavCmd.REQUEST_MESSAGE, MODES, 3) == R.ACCEPTED
    assert [message.mode_index for message in sent_by(copter.modes, 0)] == [3]
    assert copter.ask(common.MavCmd.REQUEST_MESSAGE, MODES, 6) == R.DENIED


def test_listing_waits_for_room_and_sends_each_mode_once():
    copter = Copter()
    copter.ask(common.MavCmd.REQUEST_MESSAGE, MODES, 0)
    copter.ask(common.MavCmd.REQUEST_MESSAGE, MODES, 0)
    room = iter([True, True, False])
    assert len(sent_by(copter.modes, 0, lambda target, priority=Priority.BULK: next(room))) == 2
    assert [message.mode_index for message in sent_by(copter.modes, 0)] == [3, 4, 5]


def test_a_flood_of_listings_is_bounded():
    copter = Copter()
    results = [
        copter.ask(common.MavCmd.REQUEST_MESSAGE, MODES, 0, source=Address(number, 190))
        for number in range(2, MAX_LISTINGS + 4)
    ]
    assert results.count(R.ACCEPTED) == MAX_LISTINGS
    assert results[-1] == R.TEMPORARILY_REJECTED


def test_current_mode_is_streamed_and_sent_on_request():
    copter = Copter()
    times = [time for time, message in run_timers(copter.modes, 10.0)]
    assert times == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    copter.ask(common.MavCmd.REQUEST_MESSAGE, CURRENT)
    assert [type(message) for message in sent_by(copter.modes, 10)] == [common.CurrentMode]


def test_a_changed_set_of_modes_is_reported_from_then_on():
    copter = Copter()
    assert not [m for _, m in run_timers(copter.modes, 30) if isinstance(m, common.AvailableModesMonitor)]
    copter.modes.offer(COPTER[:2], 31.0)
    assert [message.seq for message in sent_by(copter.modes, 31)] == [1]
    later = [
        (t, m.seq) for t, m in run_timers(copter.modes, 60) if isinstance(m, common.AvailableModesMonitor)
    ]
    assert later == [(41.0, 1), (51.0, 1)]
    copter.modes.sequence = 255
    copter.modes.offer(COPTER, 61.0)
    assert copter.modes.sequence == 1  # 0 means that it never changed


def test_requests_for_other_messages_go_to_who_answered_them_before():
    commands = CommandServer(VEHICLE)
    commands.support(common.MavCmd.REQUEST_MESSAGE, lambda request: (R.ACCEPTED, 77))
    ModeServer(VEHICLE, COPTER, 0).register(commands)
    deliver(commands, Command.of(512, (148,)).to_long(VEHICLE), GROUND, 0)
    assert sent_by(commands, 0)[0].result_param2 == 77


def test_wrong_tables_are_our_own_misuse():
    with pytest.raises(InvalidArgumentError, match="1 to 255"):
        ModeServer(VEHICLE, [], 0)
    with pytest.raises(InvalidArgumentError, match="1 to 255"):
        ModeServer(VEHICLE, [AvailableMode(n) for n in range(MAX_MODES + 1)], 0)
    with pytest.raises(InvalidArgumentError, match="same"):
        ModeServer(VEHICLE, [AvailableMode(1), AvailableMode(1)], 1)


def test_a_long_name_is_cut_between_characters():
    message = AvailableMode(1, "ä" * 20).to_message(1, 1)
    assert message.mode_name == "ä" * 17


def test_garbage_from_the_wire_never_raises():
    random = Random(1)
    copter = Copter()
    for number in range(400):
        deliver(copter.modes, random_message(common.SetMode, random), GROUND, number, number % 256)
        message = random_message(random.choice([common.CommandLong, common.CommandInt]), random)
        message = message.replace(command=random.choice([176, 262, 512]))
        deliver(copter.commands, message, GROUND, number, number % 256)
        sent_by(copter.modes, number)
    assert copter.modes.current in COPTER
