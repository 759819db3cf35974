//! The properties of packets.

use crate::packet::Packet;
use mavstack_core::header::{CHECKSUM, SIGNATURE};
use mavstack_core::signing::link_and_timestamp;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::ffi::CStr;

/// A property getter: called with the packet's parts and its bytes.
pub type Getter = for<'py> fn(Python<'py>, &Packet, &[u8]) -> PyResult<Bound<'py, PyAny>>;

/// Name, getter, documentation.
pub const GETTERS: &[(&CStr, Getter, &CStr)] = &[
    (c"name", name, c"Name of the message, such as \"ATTITUDE\", or None if its id is not in the dialect."),
    (c"version", |py, packet, _| object(py, packet.header.version), c"MAVLink version, 1 or 2."),
    (c"message_id", |py, packet, _| object(py, packet.header.message_id), c"Message id, 0 to 16777215."),
    (c"system", |py, packet, _| object(py, packet.header.system), c"System id of the sender, 0 to 255."),
    (c"component", |py, packet, _| object(py, packet.header.component), c"Component id of the sender, 0 to 255."),
    (c"sequence", |py, packet, _| object(py, packet.header.sequence), c"Sequence number, 0 to 255."),
    (
        c"incompat_flags",
        |py, packet, _| object(py, packet.header.incompat_flags),
        c"Incompatibility flags; 0 in MAVLink 1.",
    ),
    (c"compat_flags", |py, packet, _| object(py, packet.header.compat_flags), c"Compatibility flags; 0 in MAVLink 1."),
    (
        c"signed",
        |py, packet, _| Ok(packet.header.signed().into_pyobject(py)?.to_owned().into_any()),
        c"True if the packet carries a signature; only a parser with signing verifies it.",
    ),
    (
        c"link_id",
        |py, packet, raw| signature(py, packet, || link_and_timestamp(raw).0),
        c"Link id of the signature, or None if unsigned.",
    ),
    (
        c"signature_timestamp",
        |py, packet, raw| signature(py, packet, || link_and_timestamp(raw).1),
        c"Timestamp of the signature in 10 us since 2015-01-01 UTC, or None if unsigned.",
    ),
    (c"signature", signature_bytes, c"The 13 bytes of the signature, or None if unsigned."),
    (
        c"timestamp",
        |py, packet, _| object(py, packet.timestamp),
        c"Recorded time in microseconds since 1970, or None if the stream is not timestamped.",
    ),
    (c"checksum", checksum, c"CRC of the packet as received."),
    (
        c"payload",
        |py, packet, raw| Ok(PyBytes::new(py, &raw[packet.header.payload()]).into_any()),
        c"Payload as received: trimmed, complete, or longer than the definition.",
    ),
    (c"raw", |py, _, raw| Ok(PyBytes::new(py, raw).into_any()), c"All bytes of the packet as received."),
];

pub fn object<'py, T: IntoPyObject<'py>>(py: Python<'py>, value: T) -> PyResult<Bound<'py, PyAny>> {
    value.into_bound_py_any(py)
}

fn signature<'py, T: IntoPyObject<'py>>(
    py: Python<'py>,
    packet: &Packet,
    value: impl Fn() -> T,
) -> PyResult<Bound<'py, PyAny>> {
    object(py, packet.header.signed().then(value))
}

fn name<'py>(py: Python<'py>, packet: &Packet, _: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    object(py, packet.name())
}

fn signature_bytes<'py>(py: Python<'py>, packet: &Packet, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    object(py, packet.header.signed().then(|| PyBytes::new(py, &raw[raw.len() - SIGNATURE..])))
}

fn checksum<'py>(py: Python<'py>, packet: &Packet, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let end = packet.header.payload().end;
    object(py, u16::from_le_bytes([raw[end], raw[end + CHECKSUM - 1]]))
}
