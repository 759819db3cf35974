"""Mavstack as the vehicle: 955 parameters, files of 300 kB and 10 MB, a mission, slow telemetry.

`python -m benchmarks.transfers.our_vehicle PORT CONDITION` is started like any other vehicle program.
"""

from __future__ import annotations

import asyncio
import sys
from time import monotonic

from mavstack.dialects import common
from mavstack.node import Node
from mavstack.services.ftp import FtpServer, MemoryStore
from mavstack.services.mission import MissionServer
from mavstack.services.parameters import ParameterServer
from mavstack.services.version import AutopilotVersion, provide_versions

from .vehicles import LARGE_FILE, REMOTE_FILE, file_content, link_url

PARAMETERS = 955


def telemetry(node: Node, rate: float) -> None:
    """Publish four telemetry messages at `rate` hertz each."""
    begun = monotonic()

    def attitude(_now: float) -> common.Attitude:
        return common.Attitude(time_boot_ms=round(1000 * (monotonic() - begun)), roll=0.1, yaw=1.0)

    def position(_now: float) -> common.GlobalPositionInt:
        return common.GlobalPositionInt(lat=-353632610, lon=1491652300, alt=600_000, relative_alt=20_000)

    for kind, producer in ((common.Attitude, attitude), (common.GlobalPositionInt, position)):
        node.publish(kind, producer, interval=1 / rate)
    node.publish(common.SysStatus, lambda _: common.SysStatus(voltage_battery=12_000), interval=1 / rate)
    node.publish(common.VfrHud, lambda _: common.VfrHud(airspeed=15, throttle=40), interval=1 / rate)


async def fly(port: int, condition: str) -> None:
    """Run the vehicle until the process is ended."""
    capability = common.MavProtocolCapability
    async with Node(
        link_url(port, condition),
        system=1,
        component=1,
        type=common.MavType.QUADROTOR,
        autopilot=common.MavAutopilot.PX4,
    ) as node:
        provide_versions(
            node.message_server,
            AutopilotVersion(
                capabilities=capability.FTP | capability.MISSION_INT | capability.PARAM_ENCODE_BYTEWISE
            ),
        )
        parameters = node.serve(ParameterServer(node.address))
        for number in range(PARAMETERS):
            parameters.add(f"TEST_PARAM_{number}", number if number % 2 else number / 7)
        node.serve(MissionServer(node.address))
        files = {name: file_content(name) for name in (REMOTE_FILE, LARGE_FILE)}
        node.serve(FtpServer(node.address, MemoryStore(files)))
        telemetry(node, rate=2.0 if condition == "c" else 10.0)
        await node.serve_forever()


if __name__ == "__main__":
    asyncio.run(fly(int(sys.argv[1]), sys.argv[2]))
