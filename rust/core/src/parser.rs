//! The push parser of one byte stream: bytes in, in any chunks, packets out.

use crate::header::Header;
use crate::layout::Dialect;
use crate::scan::{Found, Scanner, TIMESTAMP, timestamp_microseconds};
use crate::sequence::Sources;
use crate::statistics::Statistics;

/// One packet of a stream, borrowed from it.
#[derive(Clone, Copy, Debug)]
pub struct Packet<'a> {
    /// The packet byte for byte as it came.
    pub raw: &'a [u8],
    pub header: Header,
    pub slot: Option<u16>,
    /// Microseconds since 1970, in a timestamped stream.
    pub timestamp: Option<u64>,
}

impl<'a> Packet<'a> {
    /// The packet that `found` names in the scanned `data`.
    #[inline]
    #[must_use]
    pub fn new(data: &'a [u8], found: &Found) -> Self {
        let timestamp = if found.timestamped {
            data[..found.start].last_chunk::<TIMESTAMP>().map(|stamp| timestamp_microseconds(*stamp))
        } else {
            None
        };
        Self { raw: &data[found.range()], header: found.header, slot: found.slot, timestamp }
    }

    /// The payload as it came: trimmed, whole, or longer than known.
    #[inline]
    #[must_use]
    pub fn payload(&self) -> &'a [u8] {
        &self.raw[self.header.payload()]
    }
}

/// Parser state: the unfinished end of the stream, and what was counted.
#[derive(Debug, Default)]
pub struct Parser {
    timestamped: bool,
    pending: Vec<u8>,
    position: usize,
    statistics: Statistics,
    sources: Sources,
}

impl Parser {
    /// A parser; `timestamped` for a stream with 8 bytes of time before each packet (a tlog).
    #[must_use]
    pub fn new(timestamped: bool) -> Self {
        Self { timestamped, ..Self::default() }
    }

    /// Takes the next bytes of the stream and hands each packet that they complete to `sink`.
    pub fn feed(&mut self, dialect: &Dialect, data: &[u8], sink: impl FnMut(Packet<'_>)) {
        self.run(dialect, data, false, sink);
    }

    /// Ends the stream: hands out what an unfinished packet at its end may have hidden, and starts afresh.
    pub fn flush(&mut self, dialect: &Dialect, sink: impl FnMut(Packet<'_>)) {
        self.run(dialect, &[], true, sink);
    }

    fn run(&mut self, dialect: &Dialect, data: &[u8], at_end: bool, mut sink: impl FnMut(Packet<'_>)) {
        let mut joined = std::mem::take(&mut self.pending);
        let stream = if joined.is_empty() {
            data
        } else {
            joined.extend_from_slice(data);
            &joined
        };
        let mut scanner = Scanner::resume(stream, dialect, self.timestamped, self.position, 0);
        let statistics = &mut self.statistics;
        while let Some(found) =
            if at_end { scanner.next_packet_at_end(statistics) } else { scanner.next_packet(statistics) }
        {
            let Header { system, component, sequence, .. } = found.header;
            self.sources.record(system, component, sequence, found.range().len());
            sink(Packet::new(stream, &found));
        }
        let (position, boundary) = (scanner.position(), scanner.boundary());
        self.retain(stream, position, boundary);
    }

    /// Keeps what may still become a packet, and in a timestamped stream the 8 bytes that may be its time.
    fn retain(&mut self, stream: &[u8], position: usize, boundary: usize) {
        let stamp = if self.timestamped { TIMESTAMP } else { 0 };
        let kept = boundary.max(position.saturating_sub(stamp));
        self.statistics.bad_bytes += (kept - boundary) as u64;
        self.pending = stream[kept..].to_vec();
        self.position = position - kept;
    }

    /// What was counted so far.
    #[must_use]
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Loss per source.
    #[must_use]
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Bytes that wait for more.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.pending.len()
    }
}

#[cfg(test)]
#[path = "parser_tests.rs"]
mod tests;
