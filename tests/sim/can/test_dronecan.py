"""The simulated nodes, read by pydronecan's own codec."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavstack.services.can import CanFrame
from mavstack.sim.can import DroneCanNode, TransferReceiver, transfer_frames

SIGNATURE = 0xEE468A8121C46A9E


def node() -> DroneCanNode:
    return DroneCanNode(42, "org.mavstack.gps", bytes(range(16)), 1000.0)


def decoded(frames, kind):
    """The transfer of these frames, as pydronecan reads it."""
    from dronecan.transport import Frame, Transfer

    transfer = Transfer()
    transfer.from_frames([Frame(frame.id, bytearray(frame.data)) for frame in frames])
    return transfer.payload


@given(st.binary(max_size=300), st.integers(0, 100), st.integers(0, (1 << 64) - 1))
def test_transfers_are_joined(payload, number, signature):
    receiver = TransferReceiver()
    frames = transfer_frames(1, payload, number, signature)
    *rest, last = [receiver.add(frame, signature) for frame in frames]
    assert last == payload
    assert set(rest) <= {None}


@given(st.lists(st.binary(max_size=8), max_size=30))
def test_any_frames_are_accepted(datas):
    receiver, device = TransferReceiver(), node()
    for data in datas:
        receiver.add(CanFrame(1, data), SIGNATURE)
        device.answer(CanFrame(0x1E01AA7F, data), 1000.0)


def test_a_lost_frame_loses_its_transfer():
    receiver = TransferReceiver()
    frames = transfer_frames(1, bytes(30), 3, SIGNATURE)
    assert [receiver.add(frame, SIGNATURE) for frame in frames[:2] + frames[3:]][-1] is None
    assert [receiver.add(frame, SIGNATURE) for frame in frames][-1] == bytes(30)


def test_status_and_information():
    import dronecan

    assert dronecan.uavcan.protocol.GetNodeInfo.get_data_type_signature() == SIGNATURE
    device = node()
    status = decoded(device.status_frames(1012.5), dronecan.uavcan.protocol.NodeStatus)
    assert (status.uptime_sec, status.health, status.mode) == (12, 0, 0)
    request = CanFrame(0x1E01AAFF, b"\xc5")  # from node 127 to node 42
    frames = device.answer(request, 1012.5)
    information = decoded(frames, dronecan.uavcan.protocol.GetNodeInfo.Response)
    assert bytes(information.name) == b"org.mavstack.gps"
    assert bytes(information.hardware_version.unique_id) == bytes(range(16))
    assert information.software_version.major == 1
    assert frames[0].data[-1] & 0x1F == 5
    assert device.answer(CanFrame(0x1E01ABFF, b"\xc5"), 1012.5) == []  # to another node
