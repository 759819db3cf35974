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
from tests.vehicle.failures.scripted import CMD, Scene


async def up(scene: Scene) -> None:
    scene.script.altitude = 0.0


async def disarmed(scene: Scene) -> None:
    scene.script.arm(False)


async def with_mission(scene: Scene) -> None:
    await scene.vehicle.mission.upload(ITEMS)


async def in_mission(scene: Scene) -> None:
    await with_mission(scene)
    scene.script.enter("MISSION")


async def not_ready(scene: Scene) -> None:
    scene.script.ready = False


async def guided(scene: Scene) -> None:
    async with scene.vehicle.guided():
        pass


async def leave_guided(scene: Scene) -> None:
    guided = scene.guided
    await guided.__aexit__(None, None, None)


async def enter_guided(scene: Scene) -> None:
    scene.guided = scene.vehicle.guided()
    await scene.guided.__aenter__()


async def first(scene: Scene) -> None:
    async with scene.vehicle.stream(common.Attitude) as messages:
        await anext(messages)


async def stream_at_rate(scene: Scene) -> None:
    async with scene.vehicle.stream(common.Attitude, rate=5.0):
        pass


async def speak(scene: Scene) -> None:
    async with scene.vehicle.shell() as shell:
        await anext(shell)


async def open_shell(scene: Scene) -> None:
    async with scene.vehicle.shell():
        pass


PART_OF_ACTIONS = "it fails as the actions that use it"
NOT_WAITED = "it does not wait for the effect"
VEHICLE = [
    command(
        "Vehicle.arm",
        lambda s: s.vehicle.arm(),
        CMD.COMPONENT_ARM_DISARM,
        stuck=(ActionTimeout, "arming 1/1 failed: no progress for 10 s"),
        armed=False,
    ),
    command(
        "Vehicle.disarm",
        lambda s: s.vehicle.disarm(),
        CMD.COMPONENT_ARM_DISARM,
        stuck=(ActionTimeout, "disarming 1/1 failed: no progress for 10 s"),
    ),
    mode("Vehicle.set_mode", lambda s: s.vehicle.set_mode("RTL")),
    command(
        "Vehicle.takeoff",
        lambda s: s.vehicle.takeoff(30),
        CMD.NAV_TAKEOFF,
        stuck=(ActionTimeout, "takeoff to 30 m of 1/1 failed: no progress for 30 s, 30 m to go"),
        interrupted=True,
        before=up,
    ),
    command(
        "Vehicle.land",
        lambda s: s.vehicle.land(),
        CMD.NAV_LAND,
        stuck=(ActionTimeout, "landing 1/1 failed: no progress for 30 s, 20 m to go"),
        interrupted=True,
    ),
    command(
        "Vehicle.rtl",
        lambda s: s.vehicle.rtl(),
        CMD.NAV_RETURN_TO_LAUNCH,
        stuck=(ActionTimeout, "return to launch of 1/1 failed: no progress for 90 s, 20 m to go"),
        interrupted=True,
    ),
    mode("Vehicle.hold", lambda s: s.vehicle.hold(), before=in_mission),
    command(
        "Vehicle.goto",
        lambda s: s.vehicle.goto(*PLACE),
        CMD.DO_REPOSITION,
        stuck=(ActionTimeout, "going to 47.399000, 8.547000 with 1/1 failed: no progress for 30 s, 18"),
        interrupted=True,
    ),
    command(
        "Vehicle.move",
        lambda s: s.vehicle.move(north=100),
        CMD.DO_REPOSITION,
        stuck=(ActionTimeout, "1/1 failed: no progress for 30 s, 100 m to go"),
        interrupted=True,
    ),
    command(
        "Vehicle.orbit",
        lambda s: s.vehicle.orbit(*PLACE),
        CMD.DO_ORBIT,
        stuck=(ActionTimeout, "orbit of 20 m radius with 1/1 failed: no progress for 30 s"),
        interrupted=True,
    ),
    command("Vehicle.set_speed", lambda s: s.vehicle.set_speed(5), CMD.DO_CHANGE_SPEED, why_not=NOT_WAITED),
    command(
        "Vehicle.set_yaw",
        lambda s: s.vehicle.set_yaw(90),
        CMD.DO_REPOSITION,
        stuck=(ActionTimeout, "turn to 90 degrees of 1/1 failed: no progress for 30 s, 90 degrees"),
        interrupted=True,
    ),
    command("Vehicle.set_home", lambda s: s.vehicle.set_home(), CMD.DO_SET_HOME, why_not=NOT_WAITED),
    command(
        "Vehicle.reboot",
        lambda s: s.vehicle.reboot(),
        CMD.PREFLIGHT_REBOOT_SHUTDOWN,
        silent=ActionTimeout,
        stuck=(ActionTimeout, "rebooting 1/1 failed: did not come back in 60 s"),
    ),
    Call(
        "Vehicle.wait_until_ready",
        lambda s: s.vehicle.wait_until_ready(),
        silent=HealthTimeout,
        stuck=(HealthTimeout, "waiting for the readiness of 1/1 failed: not in 60 s: not ready"),
        before=not_ready,
        why_not="it sends no request that could be refused",
    ),
    rate(
        "Vehicle.wait_for_message",
        lambda s: s.vehicle.wait_for_message(common.Attitude),
        4,
        silent=MessageTimeout,
    ),
    rate(
        "Vehicle.wait_for_telemetry",
        lambda s: s.vehicle.wait_for_telemetry("attitude"),
        4,
        silent=MessageTimeout,
    ),
    rate(
        "Vehicle.set_message_rate",
        lambda s: s.vehicle.set_message_rate(common.Attitude, 5.0),
        5,
        why_not=NOT_WAITED,
    ),
    Call("Vehicle.get_home", lambda s: s.vehicle.get_home(), silent=None, why_not=PART_OF_ACTIONS),
    Call(
        "Vehicle.get_home_altitude",
        lambda s: s.vehicle.get_home_altitude(),
        silent=None,
        why_not=PART_OF_ACTIONS,
    ),
    Call("Vehicle.get_position", lambda s: s.vehicle.get_position(), silent=None, why_not=PART_OF_ACTIONS),
    Call(
        "Vehicle.get_relative_altitude",
        lambda s: s.vehicle.get_relative_altitude(),
        silent=None,
        why_not=PART_OF_ACTIONS,
    ),
]
TELEMETRY = [
    rate(
        "Telemetry.wait_for_message",
        lambda s: s.vehicle.telemetry.wait_for_message(common.Attitude),
        4,
        silent=MessageTimeout,
    ),
    rate(
        "Telemetry.set_message_rate",
        lambda s: s.vehicle.telemetry.set_message_rate(common.Attitude, 5.0),
        5,
        why_not=NOT_WAITED,
    ),
    Call(
        "Telemetry.ensure",
        lambda s: s.vehicle.telemetry.ensure(common.Attitude, 5.0),
        silent=None,
        why_not="it returns False if the vehicle refuses or is silent",
    ),
    Call(
        "Telemetry.request_home",
        lambda s: s.vehicle.telemetry.request_home(),
        silent=None,
        why_not="it stores that the vehicle has no home",
    ),
    Call(
        "Telemetry.close", lambda s: s.vehicle.telemetry.close(), silent=None, why_not="it sends no request"
    ),
    rate("MessageStream.__anext__", first, 4, silent=None, why_not="it waits for messages"),
    Call("MessageStream.__aenter__", stream_at_rate, silent=None, why_not="it requests in the background"),
    Call("MessageStream.__aexit__", stream_at_rate, silent=None, why_not="it does not wait for the vehicle"),
]
MISSION = [
    plan("Mission.upload", lambda s: s.vehicle.mission.upload(ITEMS), "uploading the mission"),
    plan(
        "Mission.download",
        lambda s: s.vehicle.mission.download(),
        "downloading the mission",
        refuse=no_plan,
        codes=(MISSION_RESULT.UNSUPPORTED,),
        before=with_mission,
    ),
    plan("Mission.clear", lambda s: s.vehicle.mission.clear(), "clearing the mission", before=with_mission),
    command(
        "Mission.set_current",
        lambda s: s.vehicle.mission.set_current(3),
        CMD.DO_SET_MISSION_CURRENT,
        codes=FALLING_BACK,
        silent=MissionTimeout,
        before=with_mission,
        why_not=NOT_WAITED,
    ),
    mode("Mission.start", lambda s: s.vehicle.mission.start(), before=with_mission),
    mode("Mission.pause", lambda s: s.vehicle.mission.pause(), before=in_mission),
    mode(
        "Mission.fly",
        lambda s: s.vehicle.mission.fly(timeout=50),
        before=with_mission,
        stuck=(ModeTimeout, "accepted, but not entered"),
        interrupted=True,
    ),
    plan("VehiclePlan.upload", lambda s: s.vehicle.fence.upload(ITEMS), "uploading the fence"),
    plan(
        "VehiclePlan.download",
        lambda s: s.vehicle.rally.download(),
        "downloading the rally points",
        refuse=no_plan,
        codes=(MISSION_RESULT.UNSUPPORTED,),
    ),
    plan("VehiclePlan.clear", lambda s: s.vehicle.fence.clear(), "clearing the fence"),
]
GUIDANCE = [
    mode("GuidedSession.__aenter__", guided),
    mode("GuidedSession.__aexit__", leave_guided, before=enter_guided),
]
PARAMETERS = [
    Call(
        "Params.get",
        lambda s: s.vehicle.params.get("NO_SUCH"),
        "parameter NO_SUCH",
        nothing,
        ParameterDenied,
        (PARAM.DOES_NOT_EXIST,),
        waits=False,
        silent=ParameterTimeout,
    ),
    Call(
        "Params.set",
        lambda s: s.vehicle.params.set("P_00", 7),
        "P_00",
        read_only,
        ParameterDenied,
        (PARAM.READ_ONLY,),
        waits=False,
        silent=ParameterTimeout,
    ),
    Call(
        "Params.download",
        lambda s: s.vehicle.params.download(),
        silent=ParameterTimeout,
        why_not="only requests for single parameters are refused",
    ),
    Call(
        "Params.download_metadata",
        lambda s: s.vehicle.params.download_metadata(cache=None),
        silent=MessageTimeout,
        why_not="a vehicle that refuses has no metadata",
    ),
]
FILES = [
    file("Ftp.list", lambda s: s.vehicle.ftp.list("/none"), "/none"),
    file("Ftp.download", lambda s: s.vehicle.ftp.download("/none"), "/none"),
    file("Ftp.upload", lambda s: s.vehicle.ftp.upload("/logs", b"x" * 900), "/logs", FTP.FAILERRNO),
    file("Ftp.checksum", lambda s: s.vehicle.ftp.checksum("/none"), "/none"),
    file("Ftp.remove", lambda s: s.vehicle.ftp.remove("/none"), "/none"),
    file("Ftp.rename", lambda s: s.vehicle.ftp.rename("/none", "/some"), "/none"),
    file("Ftp.truncate", lambda s: s.vehicle.ftp.truncate("/none", 4), "/none"),
    file("Ftp.make_directory", lambda s: s.vehicle.ftp.make_directory("/logs"), "/logs", FTP.FILEEXISTS),
    file("Ftp.remove_directory", lambda s: s.vehicle.ftp.remove_directory("/none"), "/none"),
]
LOGS = [
    Call(
        "Logs.list",
        lambda s: s.vehicle.logs.list(),
        silent=LogTimeout,
        why_not="a vehicle that refuses to list its logs does not answer",
    ),
    Call(
        "Logs.download",
        lambda s: s.vehicle.logs.download(9),
        "log 9",
        nothing,
        RemoteDenied,
        (0,),
        waits=False,
        silent=LogTimeout,
    ),
    Call(
        "Logs.erase",
        lambda s: s.vehicle.logs.erase(),
        "erasing all logs",
        keeps_logs,
        RemoteDenied,
        (0,),
        waits=False,
        silent=LogTimeout,
    ),
]
MODES = [
    mode("Modes.set", lambda s: s.vehicle.modes.set("RTL"), waits=False),
    command(
        "Modes.set_standard",
        lambda s: s.vehicle.modes.set_standard(common.MavStandardMode.MISSION),
        CMD.DO_SET_STANDARD_MODE,
        waits=False,
    ),
    Call(
        "Modes.list",
        lambda s: s.vehicle.modes.list(),
        silent=CommandTimeout,
        why_not="the modes of PX4 and ArduPilot are known",
    ),
]
SHELL = [
    Call("Shell.__anext__", speak, silent=None, why_not="it waits for the output of the shell"),
    Call("Shell.__aenter__", open_shell, silent=None, why_not="opening a shell has no acknowledgement"),
    Call("Shell.__aexit__", open_shell, silent=None, why_not="closing a shell has no acknowledgement"),
]
CALLS = [*VEHICLE, *TELEMETRY, *MISSION, *GUIDANCE, *PARAMETERS, *FILES, *LOGS, *MODES, *SHELL]
CALLS += [*PAYLOAD_CALLS, *OUTPUT_CALLS]
