from __future__ import annotations

import pytest

from mavstack.dialects import common
from mavstack.errors import LinkError, MavstackError
from mavstack.sim import BackgroundSimulator
from mavstack.sync import Node

pymavlink = pytest.importorskip("pymavlink.mavutil")


def test_a_script_meets_a_vehicle():
    with (
        BackgroundSimulator("rover", "px4", speed=5) as target,
        Node(target.url.replace(":", "://", 1)) as ground,
    ):
        assert ground.wait_for_autopilot().info.type == common.MavType.GROUND_ROVER


def test_a_flying_one_flies():
    with BackgroundSimulator(airborne=True) as target:
        assert target.vehicle.autopilot.altitude > 8
        connection = pymavlink.mavlink_connection(target.url)
        connection.mav.heartbeat_send(6, 8, 0, 0, 0)
        assert connection.wait_heartbeat(timeout=10).base_mode & 128
        connection.close()


def test_faults_are_injected_from_outside():
    with BackgroundSimulator() as target:
        target.call(lambda: target.vehicle.faults.inject("gps off"))
        assert target.call(lambda: dict(target.vehicle.faults.active)) == {"gps": "gps off"}
        with pytest.raises(MavstackError, match="unknown fault"):
            target.call(lambda: target.vehicle.faults.inject("pigs fly"))


def test_it_must_run_to_be_called():
    target = BackgroundSimulator()
    with pytest.raises(MavstackError, match="not running"):
        target.call(lambda: None)
    target.start().stop()
    target.stop()
    with pytest.raises(MavstackError, match="not running"):
        target.call(lambda: None)


def test_a_port_in_use_is_reported():
    with BackgroundSimulator(link="tcpin://127.0.0.1:0") as first, pytest.raises(LinkError):
        BackgroundSimulator(link=f"tcpin://127.0.0.1:{first.port}").start()
