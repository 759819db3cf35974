"""The failure table: one row for every call of the vehicle API that waits."""

from __future__ import annotations

from mavstack.dialects import common
from mavstack.errors import (
    ActionTimeout,
    CommandTimeout,
    HealthTimeout,
    LogTimeout,
    MessageTimeout,
    MissionTimeout,
    ModeTimeout,
    ParameterDenied,
    ParameterTimeout,
    RemoteDenied,
)
from tests.vehicle.failures.output_calls import OUTPUT_CALLS
from tests.vehicle.failures.payload_calls import PAYLOAD_CALLS
from tests.vehicle.failures.rows import (
    FALLING_BACK,
    FTP,
    ITEMS,
    MISSION_RESULT,
    PARAM,
    PLACE,
    Call,
    command,
    file,
    keeps_logs,
    mode,
    no_plan,
    nothing,
    plan,
    rate,
    read_only,
)
from tests.vehicle.failures.scripted_autopilot import CMD, ScriptedHarness


async def on_ground(harness: ScriptedHarness) -> None:
    harness.autopilot.altitude = 0.0
    harness.autopilot.land()


async def disarmed(harness: ScriptedHarness) -> None:
    harness.autopilot.arm(False)


async def with_mission(harness: ScriptedHarness) -> None:
    await harness.vehicle.mission.upload(ITEMS)


async def in_mission(harness: ScriptedHarness) -> None:
    await with_mission(harness)
    harness.autopilot.enter("MISSION")


async def not_ready(harness: ScriptedHarness) -> None:
    harness.autopilot.ready = False


async def guided(harness: ScriptedHarness) -> None:
    async with harness.vehicle.guided():
        pass


async def leave_guided(harness: ScriptedHarness) -> None:
    guided = harness.guided
    await guided.__aexit__(None, None, None)


async def enter_guided(harness: ScriptedHarness) -> None:
    harness.guided = harness.vehicle.guided()
    await harness.guided.__aenter__()


async def first_of_stream(harness: ScriptedHarness) -> None:
    async with harness.vehicle.stream(common.Attitude) as messages:
        await anext(messages)


async def stream_at_rate(harness: ScriptedHarness) -> None:
    async with harness.vehicle.stream(common.Attitude, rate=5.0):
        pass


async def iterate_shell(harness: ScriptedHarness) -> None:
    async with harness.vehicle.shell() as shell:
        await anext(shell)


async def open_shell(harness: ScriptedHarness) -> None:
    async with harness.vehicle.shell():
        pass


PART_OF_ACTIONS = "it fails as the actions that use it"
NOT_WAITED = "it does not wait for the effect"
VEHICLE = [
    command(
        "Vehicle.arm",
        lambda h: h.vehicle.arm(),
        CMD.COMPONENT_ARM_DISARM,
        operation="arming",
        stuck=(ActionTimeout, "arming 1/1 failed: no progress for 10 s"),
        armed=False,
    ),
    command(
        "Vehicle.disarm",
        lambda h: h.vehicle.disarm(),
        CMD.COMPONENT_ARM_DISARM,
        operation="disarming",
        stuck=(ActionTimeout, "disarming 1/1 failed: no progress for 10 s"),
    ),
    mode("Vehicle.set_mode", lambda h: h.vehicle.set_mode("RTL")),
    command(
        "Vehicle.takeoff",
        lambda h: h.vehicle.takeoff(30),
        CMD.NAV_TAKEOFF,
        stuck=(ActionTimeout, "takeoff to 30 m of 1/1 failed: no progress for 30 s, 30 m to go"),
        interrupted=True,
        before=on_ground,
    ),
    command(
        "Vehicle.land",
        lambda h: h.vehicle.land(),
        CMD.NAV_LAND,
        stuck=(ActionTimeout, "landing 1/1 failed: no progress for 30 s, 20 m to go"),
        interrupted=True,
    ),
    command(
        "Vehicle.rtl",
        lambda h: h.vehicle.rtl(),
        CMD.NAV_RETURN_TO_LAUNCH,
        stuck=(ActionTimeout, "return to launch of 1/1 failed: no progress for 90 s, 20 m to go"),
        interrupted=True,
    ),
    mode("Vehicle.hold", lambda h: h.vehicle.hold(), before=in_mission),
    command(
        "Vehicle.goto",
        lambda h: h.vehicle.goto(*PLACE),
        CMD.DO_REPOSITION,
        stuck=(ActionTimeout, "going to 47.399000, 8.547000 with 1/1 failed: no progress for 30 s, 18"),
        interrupted=True,
    ),
    command(
        "Vehicle.move",
        lambda h: h.vehicle.move(north=100),
        CMD.DO_REPOSITION,
        stuck=(ActionTimeout, "1/1 failed: no progress for 30 s, 100 m to go"),
        interrupted=True,
    ),
    command(
        "Vehicle.orbit",
        lambda h: h.vehicle.orbit(*PLACE),
        CMD.DO_ORBIT,
        stuck=(ActionTimeout, "orbit of 20 m radius with 1/1 failed: no progress for 30 s"),
        interrupted=True,
    ),
    command("Vehicle.set_speed", lambda h: h.vehicle.set_speed(5), CMD.DO_CHANGE_SPEED, why_not=NOT_WAITED),
    command(
        "Vehicle.set_yaw",
        lambda h: h.vehicle.set_yaw(90),
        CMD.DO_REPOSITION,
        stuck=(ActionTimeout, "turn to 90 degrees of 1/1 failed: no progress for 30 s, 90 degrees"),
        interrupted=True,
    ),
    command("Vehicle.set_home", lambda h: h.vehicle.set_home(), CMD.DO_SET_HOME, why_not=NOT_WAITED),
    command(
        "Vehicle.reboot",
        lambda h: h.vehicle.reboot(),
        CMD.PREFLIGHT_REBOOT_SHUTDOWN,
        silent=ActionTimeout,
        stuck=(ActionTimeout, "rebooting 1/1 failed: did not come back in 60 s"),
    ),
    Call(
        "Vehicle.wait_until_ready",
        lambda h: h.vehicle.wait_until_ready(),
        silent=HealthTimeout,
        stuck=(HealthTimeout, "waiting for the readiness of 1/1 failed: not in 60 s: not ready"),
        before=not_ready,
        why_not="it sends no request that could be refused",
    ),
    rate(
        "Vehicle.wait_for_message",
        lambda h: h.vehicle.wait_for_message(common.Attitude),
        4,
        silent=MessageTimeout,
    ),
    rate(
        "Vehicle.wait_for_telemetry",
        lambda h: h.vehicle.wait_for_telemetry("attitude"),
        4,
        silent=MessageTimeout,
    ),
    rate(
        "Vehicle.set_message_rate",
        lambda h: h.vehicle.set_message_rate(common.Attitude, 5.0),
        5,
        why_not=NOT_WAITED,
    ),
    Call(
        "Vehicle.renumber",
        lambda h: h.vehicle.renumber(7),
        armed=False,
        silent=None,
        why_not="it fails as Params.set and Vehicle.reboot, of which it consists",
    ),
    Call("Vehicle.get_home", lambda h: h.vehicle.get_home(), silent=None, why_not=PART_OF_ACTIONS),
    Call(
        "Vehicle.get_home_altitude",
        lambda h: h.vehicle.get_home_altitude(),
        silent=None,
        why_not=PART_OF_ACTIONS,
    ),
    Call("Vehicle.get_position", lambda h: h.vehicle.get_position(), silent=None, why_not=PART_OF_ACTIONS),
    Call(
        "Vehicle.get_relative_altitude",
        lambda h: h.vehicle.get_relative_altitude(),
        silent=None,
        why_not=PART_OF_ACTIONS,
    ),
]
TELEMETRY = [
    Call(
        "Telemetry.ensure",
        lambda h: h.vehicle.telemetry.ensure(common.Attitude, 5.0),
        silent=None,
        why_not="it returns False if the vehicle refuses or is silent",
    ),
    Call(
        "Telemetry.request_home",
        lambda h: h.vehicle.telemetry.request_home(),
        silent=None,
        why_not="it stores that the vehicle has no home",
    ),
    Call(
        "Telemetry.close", lambda h: h.vehicle.telemetry.close(), silent=None, why_not="it sends no request"
    ),
    rate("MessageStream.__anext__", first_of_stream, 4, silent=None, why_not="it waits for messages"),
    Call("MessageStream.__aenter__", stream_at_rate, silent=None, why_not="it requests in the background"),
    Call("MessageStream.__aexit__", stream_at_rate, silent=None, why_not="it does not wait for the vehicle"),
]
MISSION = [
    plan("Mission.upload", lambda h: h.vehicle.mission.upload(ITEMS), "uploading the mission"),
    plan(
        "Mission.download",
        lambda h: h.vehicle.mission.download(),
        "downloading the mission",
        refuse=no_plan,
        codes=(MISSION_RESULT.UNSUPPORTED,),
        before=with_mission,
    ),
    plan("Mission.clear", lambda h: h.vehicle.mission.clear(), "clearing the mission", before=with_mission),
    command(
        "Mission.set_current",
        lambda h: h.vehicle.mission.set_current(3),
        CMD.DO_SET_MISSION_CURRENT,
        codes=FALLING_BACK,
        silent=MissionTimeout,
        before=with_mission,
        why_not=NOT_WAITED,
    ),
    mode("Mission.start", lambda h: h.vehicle.mission.start(), before=with_mission),
    mode("Mission.pause", lambda h: h.vehicle.mission.pause(), before=in_mission),
    mode(
        "Mission.fly",
        lambda h: h.vehicle.mission.fly(timeout=50),
        before=with_mission,
        stuck=(ModeTimeout, "accepted, but not entered"),
        interrupted=True,
    ),
    plan("VehiclePlan.upload", lambda h: h.vehicle.fence.upload(ITEMS), "uploading the fence"),
    plan(
        "VehiclePlan.download",
        lambda h: h.vehicle.rally.download(),
        "downloading the rally points",
        refuse=no_plan,
        codes=(MISSION_RESULT.UNSUPPORTED,),
    ),
    plan("VehiclePlan.clear", lambda h: h.vehicle.fence.clear(), "clearing the fence"),
]
GUIDANCE = [
    mode("GuidedSession.__aenter__", guided),
    mode("GuidedSession.__aexit__", leave_guided, before=enter_guided),
]
PARAMETERS = [
    Call(
        "Params.get",
        lambda h: h.vehicle.params.get("NO_SUCH"),
        "parameter NO_SUCH",
        nothing,
        ParameterDenied,
        (PARAM.DOES_NOT_EXIST,),
        waits=False,
        silent=ParameterTimeout,
    ),
    Call(
        "Params.set",
        lambda h: h.vehicle.params.set("P_00", 7),
        "P_00",
        read_only,
        ParameterDenied,
        (PARAM.READ_ONLY,),
        waits=False,
        silent=ParameterTimeout,
    ),
    command("Params.commit", lambda h: h.vehicle.params.commit(), CMD.PREFLIGHT_STORAGE, waits=False),
    Call(
        "Params.download",
        lambda h: h.vehicle.params.download(),
        silent=ParameterTimeout,
        why_not="only requests for single parameters are refused",
    ),
    Call(
        "Params.download_metadata",
        lambda h: h.vehicle.params.download_metadata(cache=None),
        silent=MessageTimeout,
        why_not="a vehicle that refuses has no metadata",
    ),
]
FILES = [
    file("Ftp.list", lambda h: h.vehicle.ftp.list("/none"), "/none"),
    file("Ftp.download", lambda h: h.vehicle.ftp.download("/none"), "/none"),
    file("Ftp.upload", lambda h: h.vehicle.ftp.upload("/logs", b"x" * 900), "/logs", FTP.FAILERRNO),
    file("Ftp.checksum", lambda h: h.vehicle.ftp.checksum("/none"), "/none"),
    file("Ftp.remove", lambda h: h.vehicle.ftp.remove("/none"), "/none"),
    file("Ftp.rename", lambda h: h.vehicle.ftp.rename("/none", "/some"), "/none"),
    file("Ftp.truncate", lambda h: h.vehicle.ftp.truncate("/none", 4), "/none"),
    file("Ftp.make_directory", lambda h: h.vehicle.ftp.make_directory("/logs"), "/logs", FTP.FILEEXISTS),
    file("Ftp.remove_directory", lambda h: h.vehicle.ftp.remove_directory("/none"), "/none"),
]
LOGS = [
    Call(
        "Logs.list",
        lambda h: h.vehicle.logs.list(),
        silent=LogTimeout,
        why_not="a vehicle that refuses to list its logs does not answer",
    ),
    Call(
        "Logs.download",
        lambda h: h.vehicle.logs.download(9),
        "log 9",
        nothing,
        RemoteDenied,
        (0,),
        waits=False,
        silent=LogTimeout,
    ),
    Call(
        "Logs.erase",
        lambda h: h.vehicle.logs.erase(),
        "erasing all logs",
        keeps_logs,
        RemoteDenied,
        (0,),
        waits=False,
        silent=LogTimeout,
    ),
]
MODES = [
    mode("Modes.set", lambda h: h.vehicle.modes.set("RTL"), waits=False),
    command(
        "Modes.set_standard",
        lambda h: h.vehicle.modes.set_standard(common.MavStandardMode.MISSION),
        CMD.DO_SET_STANDARD_MODE,
        waits=False,
    ),
    Call(
        "Modes.list",
        lambda h: h.vehicle.modes.list(),
        silent=CommandTimeout,
        why_not="the modes of PX4 and ArduPilot are known",
    ),
]
SHELL = [
    Call("Shell.__anext__", iterate_shell, silent=None, why_not="it waits for the output of the shell"),
    Call("Shell.__aenter__", open_shell, silent=None, why_not="opening a shell has no acknowledgement"),
    Call("Shell.__aexit__", open_shell, silent=None, why_not="closing a shell has no acknowledgement"),
]
CALLS = [*VEHICLE, *TELEMETRY, *MISSION, *GUIDANCE, *PARAMETERS, *FILES, *LOGS, *MODES, *SHELL]
CALLS += [*PAYLOAD_CALLS, *OUTPUT_CALLS]
