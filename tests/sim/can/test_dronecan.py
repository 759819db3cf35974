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


def exchange(device, request, number):
    """The answer of node 42 to a request of node 127 of a service, by pydronecan's codec on both sides."""
    from dronecan.transport import Transfer

    asked = Transfer(
        transfer_id=3, source_node_id=127, dest_node_id=42, payload=request, service_not_message=True,
        request_not_response=True,
    )  # fmt: skip
    frames = [CanFrame(frame.message_id, bytes(frame.bytes)) for frame in asked.to_frames()]
    *rest, answer = [device.answer(frame, 1000.0) for frame in frames]
    assert not any(rest)
    assert {frame.id >> 16 & 0xFF for frame in answer} == {number}
    return answer


def test_parameters():
    import dronecan

    param = dronecan.uavcan.protocol.param
    device = node()
    device.parameters.update({"GPS_RATE_HZ": 5, "OFFSET": -70_000_000_000})
    answer = exchange(device, param.GetSet.Request(index=1), 11)
    found = decoded(answer, param.GetSet.Response)
    assert (bytes(found.name), found.value.integer_value) == (b"OFFSET", -70_000_000_000)
    value = param.Value(integer_value=10)
    changed = decoded(
        exchange(device, param.GetSet.Request(name="GPS_RATE_HZ", value=value), 11), param.GetSet.Response
    )
    assert changed.value.integer_value == device.parameters["GPS_RATE_HZ"] == 10
    for missing in (param.GetSet.Request(index=2), param.GetSet.Request(name="NOTHING", value=value)):
        end = decoded(exchange(device, missing, 11), param.GetSet.Response)
        assert bytes(end.name) == b""
        assert dronecan.get_active_union_field(end.value) == "empty"
    assert len(device.parameters) == 2
    saved = exchange(device, param.ExecuteOpcode.Request(opcode=0), 10)
    assert decoded(saved, param.ExecuteOpcode.Response).ok


def test_a_parameter_with_a_high_index():
    import dronecan

    param = dronecan.uavcan.protocol.param
    device = node()
    device.parameters.update({f"P{number}": number for number in range(300)})
    found = decoded(exchange(device, param.GetSet.Request(index=260), 11), param.GetSet.Response)
    assert (bytes(found.name), found.value.integer_value) == (b"P260", 260)
