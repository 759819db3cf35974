//! Python interface of the counters.

use mavstack_core::sequence::Sources;
use mavstack_core::{signing, statistics};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Totals of one byte stream.
#[pyclass(frozen, get_all, eq, module = "mavstack._core")]
#[derive(PartialEq, Eq)]
pub struct Statistics {
    /// Number of packets.
    packets: u64,
    /// Total length of the packets in bytes.
    packet_bytes: u64,
    /// Number of MAVLink 1 packets.
    version_1: u64,
    /// Number of MAVLink 2 packets.
    version_2: u64,
    /// Number of packets with a signature, valid or not.
    signed: u64,
    /// Number of packets whose message id is not in the dialect.
    unknown: u64,
    /// Number of bytes outside any packet.
    bad_bytes: u64,
    /// Number of false magics and damaged packets, rejected by their checksum.
    bad_checksum: u64,
    /// Number of false magics and packets rejected for an unknown incompatibility flag.
    bad_flags: u64,
    /// Number of MAVLink 1 packets shorter than their message.
    bad_length: u64,
}

impl From<&statistics::Statistics> for Statistics {
    fn from(totals: &statistics::Statistics) -> Self {
        Self {
            packets: totals.packets,
            packet_bytes: totals.packet_bytes,
            version_1: totals.version_1,
            version_2: totals.version_2,
            signed: totals.signed,
            unknown: totals.unknown,
            bad_bytes: totals.bad_bytes,
            bad_checksum: totals.bad_checksum,
            bad_flags: totals.bad_flags,
            bad_length: totals.bad_length,
        }
    }
}

#[pymethods]
impl Statistics {
    fn __repr__(&self) -> String {
        format!(
            "Statistics(packets={}, unknown={}, bad_bytes={}, bad_checksum={})",
            self.packets, self.unknown, self.bad_bytes, self.bad_checksum
        )
    }
}

/// Statistics of one source: the packets of one system and component on one link.
#[pyclass(frozen, get_all, eq, module = "mavstack._core")]
#[derive(PartialEq, Eq)]
pub struct SourceStatistics {
    /// Number of packets received.
    received: u64,
    /// Total length of the packets in bytes.
    bytes: u64,
    /// Number of packets lost, from gaps in the sequence numbers.
    lost: u64,
    /// Number of late or duplicate packets.
    late: u64,
}

#[pymethods]
impl SourceStatistics {
    /// Fraction of the sent packets that were lost, 0 to 1.
    #[getter]
    fn loss(&self) -> f64 {
        let sent = self.received + self.lost;
        if sent == 0 { 0.0 } else { self.lost as f64 / sent as f64 }
    }

    fn __repr__(&self) -> String {
        format!("SourceStatistics(received={}, lost={}, late={})", self.received, self.lost, self.late)
    }
}

/// `{(system, component): SourceStatistics}`
pub fn sources_to_dict<'py>(py: Python<'py>, sources: &Sources) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (system, component, source) in sources.all() {
        let statistics =
            SourceStatistics { received: source.received, bytes: source.bytes, lost: source.lost, late: source.late };
        dict.set_item((system, component), Py::new(py, statistics)?)?;
    }
    Ok(dict)
}

/// Number of packets refused by signing, by reason.
#[pyclass(frozen, get_all, eq, module = "mavstack._core")]
#[derive(PartialEq, Eq)]
pub struct Refusals {
    /// Unsigned packets whose message id is not accepted unsigned.
    unsigned: u64,
    /// Packets whose hash does not match the key.
    forged: u64,
    /// Packets whose timestamp is not newer than the last of their stream.
    replayed: u64,
    /// First packets of a stream that are too far behind the clock.
    stale: u64,
    /// Packets too far ahead of the clock.
    future: u64,
    /// First packets of a stream beyond the maximum number of streams.
    too_many_streams: u64,
}

impl From<&signing::Refusals> for Refusals {
    fn from(refusals: &signing::Refusals) -> Self {
        Self {
            unsigned: refusals.unsigned,
            forged: refusals.forged,
            replayed: refusals.replayed,
            stale: refusals.stale,
            future: refusals.future,
            too_many_streams: refusals.too_many_streams,
        }
    }
}

#[pymethods]
impl Refusals {
    /// Total number of refused packets.
    #[getter]
    fn total(&self) -> u64 {
        self.unsigned + self.forged + self.replayed + self.stale + self.future + self.too_many_streams
    }

    fn __repr__(&self) -> String {
        format!(
            "Refusals(unsigned={}, forged={}, replayed={}, stale={}, future={}, too_many_streams={})",
            self.unsigned, self.forged, self.replayed, self.stale, self.future, self.too_many_streams
        )
    }
}
