"""Arming, modes, sticks and the beeper by RC channels, and the dead-man rule."""

from __future__ import annotations

import asyncio

import pytest

from mavstack.dialects import common
from mavstack.errors import CommandDenied, RemoteCancelled
from mavstack.msp.messages.modes import ModeRange, ModeRanges
from mavstack.msp.messages.rc import RxMap, SetRawRc
from mavstack.node import Node
from mavstack.services.manual_control import ChannelOverride, ManualInput
from mavstack.sim.virtual import run_virtually
from tests.bridges.msp.fake_controller import bridged, run
from tests.waiting import wait_until


def test_arming_and_disarming():
    async def scenario(vehicle, controller, bridge):
        assert controller.sent_of(SetRawRc) == []
        await vehicle.arm()
        assert controller.armed
        pulses = controller.sent_of(SetRawRc)[-1].channels
        assert pulses[:4] == (1500, 1500, 1000, 1500)  # as the receiver counts: the throttle is the third
        assert 1700 <= pulses[4] < 2100
        await vehicle.disarm()
        assert not controller.armed

    run(scenario)


ARM_SWITCH = 4  # the index of AUX 1
ARM_ON = 1700


def arm_switch_is_on(controller) -> bool:
    return any(message.channels[ARM_SWITCH] >= ARM_ON for message in controller.sent_of(SetRawRc))


async def arming_that_waits(vehicle, controller) -> asyncio.Task[None]:
    """Begin an arming that waits until the vehicle is level."""
    controller.reasons = 1 << 8
    arming = asyncio.create_task(vehicle.arm())
    await asyncio.sleep(1)
    assert not arming.done()
    return arming


def test_disarming_ends_an_arming_that_waits_for_the_firmware():
    async def scenario(vehicle, controller, bridge):
        arming = await arming_that_waits(vehicle, controller)
        await vehicle.disarm()
        with pytest.raises(RemoteCancelled, match="superseded by COMPONENT_ARM_DISARM"):
            await arming
        controller.reasons = 0
        await asyncio.sleep(10)
        assert not arm_switch_is_on(controller)
        await vehicle.arm()
        assert controller.armed

    run(scenario)


@pytest.mark.parametrize(
    "command",
    [(common.MavCmd.COMPONENT_ARM_DISARM, 0), (common.MavCmd.DO_FLIGHTTERMINATION, 1)],
    ids=["disarm", "terminate"],
)
def test_another_component_ends_an_arming_that_waits(command):
    async def scenario(vehicle, controller, bridge):
        arming = await arming_that_waits(vehicle, controller)
        async with Node(vehicle.connection.links[0]._network.link(), system=254) as other:
            remote = await other.wait_for_autopilot(1)
            await remote.command(*command)
            with pytest.raises(CommandDenied, match="CANCELLED"):
                await arming
            controller.reasons = 0
            await asyncio.sleep(10)
        assert not controller.armed

    run(scenario)


def test_disarming_after_the_arm_switch_moved_and_before_the_status_reports_it():
    async def scenario(vehicle, controller, bridge):
        arming = asyncio.create_task(vehicle.arm())
        await wait_until(lambda: arm_switch_is_on(controller), "the arm switch is on", interval=0.001)
        assert not bridge._status.armed
        await vehicle.disarm()
        assert not controller.armed
        assert (await asyncio.gather(arming, return_exceptions=True))[0] is not None
        await asyncio.sleep(5)
        assert not controller.armed

    run(scenario)


def test_disarming_is_not_acknowledged_before_a_slow_receiver_saw_the_switch():
    async def scenario(vehicle, controller, bridge):
        vehicle_is_armed = []
        controller.on_armed = lambda: vehicle_is_armed.append(answered.is_set())  # type: ignore[has-type]
        controller.receiver_delay = 0.15
        answered = asyncio.Event()
        arming = asyncio.create_task(vehicle.arm())
        await wait_until(lambda: arm_switch_is_on(controller), "the arm switch is on", interval=0.001)
        await vehicle.disarm()
        answered.set()
        await asyncio.gather(arming, return_exceptions=True)
        await asyncio.sleep(2)
        assert vehicle_is_armed == [False]
        assert not controller.armed

    run(scenario)


def test_arming_again_after_the_firmware_disarmed_by_itself():
    async def scenario(vehicle, controller, bridge):
        await vehicle.arm()
        controller.disarm_by_itself()
        await asyncio.sleep(1)
        assert not vehicle.armed
        await vehicle.arm()
        assert controller.armed

    run(scenario)


def test_an_arming_that_its_sender_cancels_moves_the_switch_back():
    async def scenario(vehicle, controller, bridge):
        arming = asyncio.create_task(vehicle.arm())
        await wait_until(lambda: arm_switch_is_on(controller), "the arm switch is on", interval=0.001)
        arming.cancel()
        await asyncio.sleep(2)
        assert not controller.armed

    run(scenario)


def test_taking_control_does_not_arm_by_a_switch_that_is_on_when_low():
    async def scenario(vehicle, controller, bridge):
        ranges = controller.messages[ModeRanges].ranges
        controller.messages[ModeRanges] = ModeRanges((ModeRange(0, 0, 900, 1300), *ranges[1:]))
        await vehicle.reboot()
        await vehicle.set_mode("ANGLE")
        assert not controller.armed
        assert {message.channels[ARM_SWITCH] for message in controller.sent_of(SetRawRc)} == {1300}
        await vehicle.arm()
        await vehicle.disarm()
        assert controller.sent_of(SetRawRc)[-1].channels[ARM_SWITCH] == 1300

    run(scenario)


@pytest.mark.parametrize("positions", [(0, 1, 3, 3), (0, 1, 3, 200), (0, 1)])
def test_a_channel_map_that_is_none_is_refused(positions):
    async def scenario(vehicle, controller, bridge):
        controller.messages[RxMap] = RxMap(positions)
        await vehicle.reboot()
        with pytest.raises(CommandDenied, match="its channel map is not known"):
            await vehicle.arm()
        assert controller.sent_of(SetRawRc) == []

    run(scenario)


def test_an_arm_switch_that_is_always_on_is_refused():
    async def scenario(vehicle, controller, bridge):
        controller.messages[ModeRanges] = ModeRanges(
            (ModeRange(0, 0, 900, 2100), ModeRange(1, 1, 1300, 1700))
        )
        await vehicle.reboot()
        for action in (vehicle.arm(), vehicle.set_mode("ANGLE")):
            with pytest.raises(CommandDenied, match="its arm switch has no off position"):
                await action
        assert controller.sent_of(SetRawRc) == []

    run(scenario)


def test_a_mode_or_the_beeper_on_any_channel_that_arms_is_refused():
    async def scenario(vehicle, controller, bridge):
        ranges = (ModeRange(0, 0, 1700, 2100), ModeRange(0, 1, 1900, 2100), ModeRange(1, 1, 1300, 1700))
        controller.messages[ModeRanges] = ModeRanges((*ranges, ModeRange(13, 1, 1900, 2100)))
        await vehicle.reboot()
        with pytest.raises(CommandDenied, match="its channel is that of arming"):
            await vehicle.set_mode("ANGLE")
        await vehicle.actuators.beep()
        await asyncio.sleep(2)
        assert controller.sent_of(SetRawRc) == []
        assert not controller.armed

    run(scenario)


def test_channels_are_sent_at_a_steady_rate_while_parameters_are_read():
    async def scenario(vehicle, controller, bridge):
        await vehicle.arm()
        before = len(controller.sent_of(SetRawRc))
        for _ in range(4):
            await vehicle.params.download()
        await asyncio.sleep(10)
        assert len(controller.sent_of(SetRawRc)) - before >= 240

    run(scenario)


def test_a_reason_not_to_arm_is_reported_and_never_overridden():
    async def scenario(vehicle, controller, bridge):
        controller.reasons = 1 << 8
        with pytest.raises(CommandDenied, match=r"FAILED \(.*PreArm: not level \(ANGLE\)"):
            await vehicle.arm(force=True)
        assert not controller.armed
        assert all(message.channels[4] < 1700 for message in controller.sent_of(SetRawRc))

    run(scenario)


def test_without_an_msp_receiver_nothing_is_sent():
    async def scenario(vehicle, controller, bridge):
        with pytest.raises(CommandDenied, match="only its transmitter can"):
            await vehicle.arm()
        with pytest.raises(CommandDenied, match="only its transmitter can"):
            await vehicle.set_mode("ANGLE")
        assert controller.sent == []

    run(scenario, receives_msp=False)


def test_without_an_arm_switch_arming_is_refused():
    async def scenario(vehicle, controller, bridge):
        controller.messages[ModeRanges] = ModeRanges((ModeRange(1, 1, 1300, 1700),))
        await vehicle.reboot()
        with pytest.raises(CommandDenied, match="no channel is set up as its arm switch"):
            await vehicle.arm()

    run(scenario)


def test_modes():
    async def scenario(vehicle, controller, bridge):
        names = [mode.name for mode in await vehicle.modes.list()]
        assert names == ["ACRO", "ANGLE", "HORIZON", "FAILSAFE", "GPS RESCUE"]
        await vehicle.set_mode("angle")
        assert (vehicle.mode, controller.active_modes()) == ("ANGLE", {1})
        await vehicle.set_mode("ACRO")
        assert controller.active_modes() == set()
        with pytest.raises(CommandDenied, match="no channel is set up for HORIZON"):
            await vehicle.set_mode("HORIZON")
        await vehicle.arm()  # an action that moves it is refused while it is not armed
        await vehicle.rtl(wait=False)
        assert controller.active_modes() == {0, 46}

    run(scenario)


def test_the_standard_mode_of_missions():
    async def scenario(vehicle, controller, bridge):
        await vehicle.arm()
        await vehicle.modes.set_standard(common.MavStandardMode.MISSION)
        assert controller.active_modes() == {0, 28}
        with pytest.raises(CommandDenied, match="no channel is set up for NAV POSHOLD"):
            await vehicle.hold()

    run(scenario, variant="INAV")


def test_the_older_message_for_modes():
    async def scenario(vehicle, controller, bridge):
        vehicle.component.send(common.SetMode(target_system=1, base_mode=1, custom_mode=1))
        await asyncio.sleep(1)
        assert controller.active_modes() == {1}

    run(scenario)


def test_sticks_move_the_channels_and_their_loss_stops_them():
    async def scenario(vehicle, controller, bridge):
        await vehicle.arm()
        async with vehicle.component.manual_control() as sticks:
            sticks.set(ManualInput(x=1000, y=-1000, z=500, r=0))
            await asyncio.sleep(1)
            assert controller.channels[:4] == (1000, 2000, 1500, 1500)
        await asyncio.sleep(3)
        count = len(controller.sent_of(SetRawRc))
        assert not controller.has_signal
        await asyncio.sleep(3)
        assert len(controller.sent_of(SetRawRc)) == count

    run(scenario)


def test_overridden_channels():
    async def scenario(vehicle, controller, bridge):
        async with vehicle.component.override_channels() as channels:
            channels.set(ChannelOverride({6: 1750}))
            await asyncio.sleep(1)
            assert controller.channels[5] == 1750
            assert 46 in controller.active_modes()

    run(scenario)


def test_channels_stop_when_the_component_in_control_is_silent():
    async def work():
        async with bridged() as (connection, controller, _):
            vehicle = await connection.wait_for_vehicle()
            await vehicle.arm()
            await asyncio.sleep(10)  # its heartbeats keep the control
            assert controller.has_signal
            await connection.close()
            await asyncio.sleep(4)
            assert not controller.has_signal

    run_virtually(work())


def test_another_component_is_refused_while_one_is_in_control():
    async def scenario(vehicle, controller, bridge):
        await vehicle.arm()
        network = vehicle.connection.links[0]._network
        async with Node(network.link(), system=254) as other:
            remote = await other.wait_for_autopilot(1)
            for params in ((common.MavCmd.COMPONENT_ARM_DISARM, 0), (common.MavCmd.DO_SET_MODE, 1, 1)):
                with pytest.raises(CommandDenied):
                    await remote.command(*params)
        assert controller.armed

    run(scenario)


def test_the_beeper():
    async def scenario(vehicle, controller, bridge):
        ranges = controller.messages[ModeRanges].ranges
        controller.messages[ModeRanges] = ModeRanges((*ranges, ModeRange(13, 3, 1700, 2100)))
        await vehicle.reboot()
        await vehicle.actuators.beep()
        await asyncio.sleep(0.7)
        assert controller.active_modes() == {13}
        await asyncio.sleep(2)
        assert controller.active_modes() == set()

    run(scenario)


def test_two_tunes_at_once_end():
    async def scenario(vehicle, controller, bridge):
        ranges = controller.messages[ModeRanges].ranges
        controller.messages[ModeRanges] = ModeRanges((*ranges, ModeRange(13, 3, 1700, 2100)))
        await vehicle.reboot()
        await vehicle.actuators.beep()
        await asyncio.sleep(0.5)
        await vehicle.actuators.beep()
        await asyncio.sleep(3)
        assert controller.active_modes() == set()

    run(scenario)


def test_a_mode_that_is_not_entered_does_not_undo_a_later_one():
    async def scenario(vehicle, controller, bridge):
        for mode in (46, 1):
            vehicle.component.send(common.SetMode(target_system=1, base_mode=1, custom_mode=mode))
        await asyncio.sleep(5)
        assert (vehicle.mode, controller.active_modes()) == ("ANGLE", {1})

    run(scenario)


def test_a_beeper_without_a_switch_is_reported():
    async def scenario(vehicle, controller, bridge):
        texts = []
        vehicle.add_listener(common.Statustext, lambda message: texts.append(message.text))
        await vehicle.actuators.beep()
        await asyncio.sleep(1)
        assert any(text.startswith("Beeper refused: no channel") for text in texts)

    run(scenario)
