//! Counters, as Python sees them.

use mavstack_core::sequence::Sources;
use mavstack_core::{signing, statistics};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Totals of one byte stream.
#[pyclass(frozen, get_all, eq, module = "mavstack._core")]
#[derive(PartialEq, Eq)]
pub struct Statistics {
    packets: u64,
    packet_bytes: u64,
    version_1: u64,
    version_2: u64,
    signed: u64,
    unknown: u64,
    bad_bytes: u64,
    bad_checksum: u64,
    bad_flags: u64,
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

/// What was heard of one system and component on one link.
#[pyclass(frozen, get_all, eq, module = "mavstack._core")]
#[derive(PartialEq, Eq)]
pub struct SourceStatistics {
    received: u64,
    bytes: u64,
    lost: u64,
    late: u64,
}

#[pymethods]
impl SourceStatistics {
    /// Share of the packets sent that were lost, 0 to 1.
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
        let heard =
            SourceStatistics { received: source.received, bytes: source.bytes, lost: source.lost, late: source.late };
        dict.set_item((system, component), Py::new(py, heard)?)?;
    }
    Ok(dict)
}

/// How many packets signing refused, by reason.
#[pyclass(frozen, get_all, eq, module = "mavstack._core")]
#[derive(PartialEq, Eq)]
pub struct Refusals {
    unsigned: u64,
    forged: u64,
    replayed: u64,
    stale: u64,
    future: u64,
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
    /// All refusals together.
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
