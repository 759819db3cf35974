"""python-can and pydronecan at the bus of a simulated vehicle, over real sockets."""

from __future__ import annotations

import time

import pytest

from mavstack.sim import BackgroundSimulator

can = pytest.importorskip("can")


def received(bus, condition, seconds=20.0):
    """The frames until one meets the condition."""
    frames, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        frame = bus.recv(0.5)
        if frame is not None:
            frames.append(frame)
            if condition(frame):
                return frames
    raise AssertionError(frames)


def test_frames_of_the_bus_and_answers_to_own_ones():
    with (
        BackgroundSimulator() as simulator,
        can.Bus(interface="mavlink", channel=simulator.url, bus=1) as bus,
    ):
        (*_, status) = received(bus, lambda frame: frame.arbitration_id & 0x7F == 42)
        assert status.arbitration_id >> 8 & 0xFFFF == 341
        assert status.is_extended_id
        bus.send(can.Message(arbitration_id=0x1E01AAFF, data=b"\xc5", is_extended_id=True))
        (*_, answer) = received(bus, lambda frame: frame.arbitration_id & 0x80)
        assert answer.arbitration_id == 0x10017FAA
        with pytest.raises(can.CanOperationError, match="at most 8 bytes"):
            bus.send(can.Message(arbitration_id=1, data=bytes(12), is_fd=False, check=False))


def test_filters():
    filters = [{"can_id": 43, "can_mask": 0x7F, "extended": True}]
    with (
        BackgroundSimulator() as simulator,
        can.Bus(interface="mavlink", channel=simulator.url, bus=1, can_filters=filters) as bus,
    ):
        frames = received(bus, lambda frame: True)
        assert {frame.arbitration_id & 0x7F for frame in frames} == {43}


def test_a_bus_that_is_not_there():
    with BackgroundSimulator() as simulator:
        with pytest.raises(can.CanInitializationError, match="CAN_FORWARD"):
            can.Bus(interface="mavlink", channel=simulator.url, bus=7)
        with pytest.raises(can.CanInitializationError, match="bus must be from 1"):
            can.Bus(interface="mavlink", channel=simulator.url, bus=0)
    with pytest.raises(can.CanInitializationError):
        can.Bus(interface="mavlink", channel="udpin://127.0.0.1:0", timeout=0.2)


@pytest.mark.interop
@pytest.mark.smoke
def test_pydronecan_finds_the_nodes():
    import dronecan

    with BackgroundSimulator(link="tcpin://127.0.0.1:0") as simulator:
        port = simulator.port
        node = dronecan.make_node(f"mavcan:tcp:127.0.0.1:{port}", node_id=127, bitrate=1_000_000)
        try:
            monitor = dronecan.app.node_monitor.NodeMonitor(node)
            end = time.monotonic() + 40
            names: dict[int, str] = {}
            while time.monotonic() < end and len(names) < 3:
                node.spin(0.2)
                for entry in monitor.find_all(lambda entry: entry.info is not None):
                    names[entry.node_id] = bytes(entry.info.name).decode()
        finally:
            node.close()
    assert names == {10: "org.ardupilot:0", 42: "org.mavstack.gps", 43: "org.mavstack.esc"}
