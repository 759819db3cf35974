//! The push parser of one byte stream: it takes bytes in any chunks and yields packets.

use crate::header::Header;
use crate::layout::Dialect;
use crate::scan::{FrameSpan, Scanner, State};
use crate::sequence::Sources;
use crate::statistics::Statistics;
use crate::timestamps::{TIMESTAMP, timestamp_microseconds};

/// One packet of a stream, borrowed from it.
#[derive(Clone, Copy, Debug)]
pub struct Packet<'a> {
    /// The bytes of the packet, unchanged.
    pub raw: &'a [u8],
    pub header: Header,
    pub slot: Option<u16>,
    /// Timestamp in microseconds since 1970, if the stream is timestamped.
    pub timestamp: Option<u64>,
}

impl<'a> Packet<'a> {
    /// Creates the packet at `found` in the scanned `data`.
    #[inline]
    #[must_use]
    pub fn new(data: &'a [u8], found: &FrameSpan) -> Self {
        let timestamp = if found.timestamped {
            data[..found.start].last_chunk::<TIMESTAMP>().map(|stamp| timestamp_microseconds(*stamp))
        } else {
            None
        };
        Self { raw: &data[found.range()], header: found.header, slot: found.slot, timestamp }
    }

    /// The payload as received: trimmed, complete, or longer than the definition.
    #[inline]
    #[must_use]
    pub fn payload(&self) -> &'a [u8] {
        &self.raw[self.header.payload()]
    }
}

/// Maximum number of sources with statistics: forged packets of all 65,536 addresses must not fill the memory.
const MAX_SOURCES: usize = 1024;
/// Maximum capacity in bytes of the buffer that is kept for pending bytes.
const MAX_KEPT_CAPACITY: usize = 4096;

/// Parser state: the incomplete packet at the end of the stream, and the statistics.
#[derive(Debug)]
pub struct Parser {
    timestamped: bool,
    /// The bytes of a possible incomplete packet, or the signature of the last packet.
    pending: Vec<u8>,
    /// State of the scanner in the pending bytes.
    state: State,
    statistics: Statistics,
    sources: Sources,
}

impl Default for Parser {
    fn default() -> Self {
        Self::new(false)
    }
}

impl Parser {
    /// Creates a parser; `timestamped` is for a stream with an 8-byte timestamp before each packet (a tlog).
    #[must_use]
    pub fn new(timestamped: bool) -> Self {
        Self {
            timestamped,
            pending: Vec::new(),
            state: State::default(),
            statistics: Statistics::default(),
            sources: Sources::bounded(MAX_SOURCES),
        }
    }

    /// Parses the next bytes of the stream and passes each completed packet to `sink`.
    pub fn feed(&mut self, dialect: &Dialect, data: &[u8], mut sink: impl FnMut(Packet<'_>)) {
        let is_between_packets = self.pending.is_empty() && self.state == State::default() && !self.timestamped;
        if is_between_packets && let Some(found) = Scanner::whole_packet(data, dialect, &mut self.statistics) {
            self.record(&found);
            return sink(Packet::new(data, &found));
        }
        self.run(dialect, data, false, sink);
    }

    #[inline]
    fn record(&mut self, found: &FrameSpan) {
        let Header { system, component, sequence, .. } = found.header;
        self.sources.record(system, component, sequence, found.header.packet_length());
    }

    /// Ends the stream: passes the packets inside an incomplete one at its end to `sink`, and resets the parser.
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
        let mut scanner = Scanner::resume(stream, dialect, self.timestamped, self.state);
        while let Some(found) = if at_end {
            scanner.next_packet_at_end(&mut self.statistics)
        } else {
            scanner.next_packet(&mut self.statistics)
        } {
            self.record(&found);
            sink(Packet::new(stream, &found));
        }
        let state = scanner.state();
        let first_needed = state.first_needed(self.timestamped);
        self.statistics.bad_bytes += first_needed.saturating_sub(state.boundary) as u64;
        self.state = state.after_removing(first_needed);
        if joined.is_empty() {
            joined.extend_from_slice(&data[first_needed..]);
        } else {
            joined.drain(..first_needed);
        }
        if joined.capacity() > MAX_KEPT_CAPACITY {
            joined.shrink_to_fit();
        }
        self.pending = joined;
    }

    /// Totals of the stream so far.
    #[must_use]
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Statistics of each source.
    #[must_use]
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Number of bytes kept until more arrive.
    #[must_use]
    pub fn pending(&self) -> usize {
        self.pending.len() - self.state.boundary
    }
}

#[cfg(test)]
#[path = "parser_tests.rs"]
pub(crate) mod tests;
