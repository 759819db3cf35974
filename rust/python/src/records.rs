//! Packets as records of a tlog, joined as they come.

use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Records and their number, or one packet.
#[derive(IntoPyObject)]
pub enum RecordPart<'py> {
    Records((Bound<'py, PyBytes>, usize)),
    Packet(Bound<'py, PyAny>),
}

/// The records of one call, in runs between the packets that are returned as such.
pub struct Records {
    /// The time of each record.
    stamp: [u8; 8],
    bytes: Vec<u8>,
    /// End of the bytes of each run, and its number of records.
    runs: Vec<(usize, usize)>,
    count: usize,
}

impl Records {
    /// Creates records of a time in microseconds since 1970.
    pub fn new(time: u64, size: usize) -> Self {
        Self { stamp: time.to_be_bytes(), bytes: Vec::with_capacity(size), runs: Vec::new(), count: 0 }
    }

    /// Adds the record of a packet.
    #[inline]
    pub fn push(&mut self, raw: &[u8]) {
        self.bytes.extend_from_slice(&self.stamp);
        self.bytes.extend_from_slice(raw);
        self.count += 1;
    }

    /// Ends a run, which may be empty: a packet follows, or the end.
    pub fn end_run(&mut self) {
        self.runs.push((self.bytes.len(), std::mem::take(&mut self.count)));
    }

    /// Returns the runs with a packet after each, in order.
    pub fn with_packets<'py>(self, py: Python<'py>, packets: Vec<Bound<'py, PyAny>>) -> Vec<RecordPart<'py>> {
        let (mut parts, mut packets, mut start) = (Vec::new(), packets.into_iter(), 0);
        for (end, count) in self.runs {
            if count > 0 {
                parts.push(RecordPart::Records((PyBytes::new(py, &self.bytes[start..end]), count)));
            }
            start = end;
            parts.extend(packets.next().map(RecordPart::Packet));
        }
        parts
    }
}
