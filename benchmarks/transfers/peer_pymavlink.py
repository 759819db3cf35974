"""pymavlink as a client: its `mavftp`, and plain scripts around `mavutil`.

The scripts send one request, receive, and after a second without a message request missing data: ten
parameters at a time, as MAVProxy does, or the next item. In an upload they leave retries to the vehicle.
"""

from __future__ import annotations

import importlib
import os
import struct
from pathlib import Path
from time import monotonic, perf_counter
from typing import TYPE_CHECKING, Any

from .child import Answer, Job, serve

if TYPE_CHECKING:
    from collections.abc import Callable

CONNECT_TIMEOUT = 15.0
RECEIVE_TIMEOUT = 1.0
MAX_REQUESTS = 10
STREAM_RATE = 2  # hertz, of all streams of a vehicle with REQUEST_DATA_STREAM
RESET_SESSIONS = 2
SESSION_TIMEOUT = 3.5
TRANSFERRED = ["PARAM_VALUE", "FILE_TRANSFER_PROTOCOL", "MISSION_REQUEST", "MISSION_REQUEST_INT"]
PX4 = 12  # MAV_AUTOPILOT_PX4, which encodes integers bytewise in the float
INTEGERS = {1: "<B", 2: "<b", 3: "<H", 4: "<h", 5: "<I", 6: "<i"}
MISSION_REQUESTS = ["MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"]


def connect(job: Job) -> Any:  # noqa: ANN401 (the package has no types)
    """Return a MAVLink 2 connection that has received a heartbeat of the vehicle."""
    os.environ["MAVLINK20"] = "1"
    mavutil: Any = importlib.import_module("pymavlink.mavutil")
    link = mavutil.mavlink_connection(
        f"udpout:127.0.0.1:{job['port']}", source_system=255, source_component=190
    )
    deadline = monotonic() + CONNECT_TIMEOUT
    while monotonic() < deadline:
        link.mav.heartbeat_send(6, 8, 0, 0, 0)
        heartbeat = link.recv_match(type="HEARTBEAT", blocking=True, timeout=1)
        if heartbeat is not None and heartbeat.get_srcComponent() == 1:
            link.target_system, link.target_component = heartbeat.get_srcSystem(), 1
            link.is_px4 = heartbeat.autopilot == PX4
            return link
    raise TimeoutError("no autopilot was found")


def _value(link: Any, message: Any) -> float:  # noqa: ANN401
    form = INTEGERS.get(message.param_type)
    if not link.is_px4 or form is None:
        return float(message.param_value)
    return float(struct.unpack_from(form, struct.pack("<f", message.param_value))[0])


def _parameters(job: Job) -> Answer:
    link = connect(job)
    values: dict[str, float] = {}
    seen: set[int] = set()
    count = None
    start = perf_counter()
    link.mav.param_request_list_send(link.target_system, link.target_component)
    while count is None or len(seen) < count:
        message = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=RECEIVE_TIMEOUT)
        if message is None:
            _request_missing(link, seen, count)
        elif message.param_index < message.param_count:
            count = message.param_count
            seen.add(message.param_index)
            values[message.param_id] = _value(link, message)
    return {"seconds": perf_counter() - start, "parameters": values}


def _request_missing(link: Any, seen: set[int], count: int | None) -> None:  # noqa: ANN401
    target = (link.target_system, link.target_component)
    if count is None:
        link.mav.param_request_list_send(*target)
        return
    missing = [index for index in range(count) if index not in seen]
    for index in missing[:MAX_REQUESTS]:
        link.mav.param_request_read_send(*target, b"", index)


def _packed(job: Job) -> Answer:
    link = connect(job)
    mavftp: Any = importlib.import_module("pymavlink.mavftp")
    files: list[bytes] = []
    start = perf_counter()
    ftp = mavftp.MAVFTP(link, link.target_system, link.target_component)
    ftp.cmd_get(["@PARAM/param.pck"], callback=lambda file: files.append(file.read() if file else b""))
    result = ftp.process_ftp_reply("OpenFileRO", timeout=job["timeout"])
    seconds = perf_counter() - start
    decoded = mavftp.MAVFTP.ftp_param_decode(files[0]) if files and files[0] else None
    if decoded is None:
        return {"problem": f"mavftp error {result.return_code}", "seconds": seconds}
    return {
        "seconds": seconds,
        "parameters": {name.decode(): float(value) for name, value, _ in decoded.params},
    }


def _file(job: Job) -> Answer:
    link = connect(job)
    mavftp: Any = importlib.import_module("pymavlink.mavftp")
    local = Path(job["folder"]) / Path(job["remote_file"]).name
    start = perf_counter()
    ftp = mavftp.MAVFTP(link, link.target_system, link.target_component)
    ftp.cmd_get([job["remote_file"], str(local)])
    result = ftp.process_ftp_reply("OpenFileRO", timeout=job["timeout"])
    seconds = perf_counter() - start
    if result.error_code != mavftp.FtpError.Success:
        return {"problem": f"mavftp error {result.return_code}", "seconds": seconds}
    return {"seconds": seconds}


def _mission_up(job: Job) -> Answer:
    link = connect(job)
    target = (link.target_system, link.target_component)
    requested = False
    start = perf_counter()
    link.mav.mission_count_send(*target, len(job["plan"]), 0)
    while True:
        message = link.recv_match(type=MISSION_REQUESTS, blocking=True, timeout=RECEIVE_TIMEOUT)
        if message is None:
            if not requested:
                link.mav.mission_count_send(*target, len(job["plan"]), 0)
        elif message.get_type() == "MISSION_ACK":
            seconds = perf_counter() - start
            return {"seconds": seconds, "problem": f"MISSION_ACK {message.type}" if message.type else ""}
        else:
            f, c, x, y, z = job["plan"][message.seq]
            requested, current = True, int(message.seq == 0)
            link.mav.mission_item_int_send(*target, message.seq, f, c, current, 1, 0, 0, 0, 0, x, y, z, 0)


def _mission_down(job: Job) -> Answer:
    link = connect(job)
    target = (link.target_system, link.target_component)
    items: list[tuple[int, int, int, int, float]] = []
    count = None
    start = perf_counter()
    link.mav.mission_request_list_send(*target, 0)
    while count is None or len(items) < count:
        message = link.recv_match(
            type=["MISSION_COUNT", "MISSION_ITEM_INT"], blocking=True, timeout=RECEIVE_TIMEOUT
        )
        if message is not None and message.get_type() == "MISSION_COUNT":
            count = message.count
        elif message is not None and message.seq == len(items):
            items.append((message.frame, message.command, message.x, message.y, message.z))
        elif message is not None:  # a duplicate must not trigger a request
            continue
        if count is None:
            link.mav.mission_request_list_send(*target, 0)
        elif len(items) < count:
            link.mav.mission_request_int_send(*target, len(items), 0)
    link.mav.mission_ack_send(*target, 0, 0)
    return {"seconds": perf_counter() - start, "plan": items}


def _mission_clear(job: Job) -> Answer:
    link = connect(job)
    start = perf_counter()
    link.mav.mission_clear_all_send(link.target_system, link.target_component, 0)
    if link.recv_match(type="MISSION_ACK", blocking=True, timeout=5) is None:
        return {"problem": "no answer to MISSION_CLEAR_ALL"}
    return {"seconds": perf_counter() - start}


def _settle(job: Job) -> Answer:
    """Close the sessions of an earlier client, wait until nothing is sent for it, and request telemetry.

    PX4 gets a request to reset its sessions. ArduPilot closes a session after three seconds without a
    request, and a reset would make it answer the next client as if it were this one.
    """
    link = connect(job)
    start = perf_counter()
    system, component = link.target_system, link.target_component
    if link.is_px4:
        reset = struct.pack("<HBB", 0, 0, RESET_SESSIONS) + bytes(247)
        link.mav.file_transfer_protocol_send(0, system, component, reset)
    else:
        link.mav.request_data_stream_send(system, component, 0, STREAM_RATE, 1)
    quiet = SESSION_TIMEOUT if job["remote_file"] and not link.is_px4 else RECEIVE_TIMEOUT
    while perf_counter() - start < job["timeout"]:
        if link.recv_match(type=TRANSFERRED, blocking=True, timeout=quiet) is None:
            break
    return {"seconds": perf_counter() - start}


WORKS: dict[str, Callable[[Job], Answer]] = {
    "parameters": _parameters,
    "packed": _packed,
    "file": _file,
    "mission-up": _mission_up,
    "mission-down": _mission_down,
    "mission-clear": _mission_clear,
    "settle": _settle,
}

if __name__ == "__main__":
    serve(WORKS)
