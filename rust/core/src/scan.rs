//! Finding packets in bytes.
//!
//! A packet begins at a magic byte. The bytes after it are validated as follows:
//!
//! - *known id*: the CRC, with the message's `CRC_EXTRA`, must match. In version 2 the length is not checked against
//!   the definition (trailing zeros are trimmed, newer extensions make it longer); a version 1 packet must not be
//!   shorter than its message.
//! - *unknown id*: its `CRC_EXTRA` is not known, but some byte must satisfy the CRC (1 in 256 damaged packets
//!   passes), and no complete valid packet of a known id may lie inside: garbage that looks like the start of an
//!   unknown packet does not hide valid packets.
//! - *unknown incompatibility flag*: rejected immediately, because the length cannot be trusted.
//!
//! After a rejection the search continues one byte after the false magic. All decisions depend only on the bytes from
//! the magic to the end of the packet, so the result does not depend on how the stream is cut into chunks.
//!
//! A *timestamped* stream (a tlog) has 8 bytes before each packet: big-endian microseconds since 1970. After a packet
//! the next one is first expected 8 bytes later, then searched for anywhere: junk, missing timestamps and a start in
//! the middle of a packet cost no other packet.

use crate::crc;
use crate::header::{CHECKSUM, FLAG_SIGNED, Header, MAGIC_V1, MAGIC_V2};
use crate::layout::Dialect;
use crate::statistics::{Reject, Statistics};
use memchr::memchr2;

pub const TIMESTAMP: usize = 8;

/// Plausible timestamps: the years 2000 to 2099 in microseconds since 1970.
const PLAUSIBLE_TIMES: std::ops::Range<u64> = 946_684_800_000_000..4_102_444_800_000_000;

/// Position and header of one packet: `start..start + header.packet_length()` of the scanned bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameSpan {
    pub start: usize,
    pub header: Header,
    /// Index of the message's layout, `None` if the dialect lacks the id.
    pub slot: Option<u16>,
    /// True if the 8 bytes before the packet are its timestamp.
    pub timestamped: bool,
}

impl FrameSpan {
    /// The byte range of the packet in the scanned bytes.
    #[inline]
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.header.packet_length()
    }
}

/// The classification of the bytes at a magic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Packet(Header, Option<u16>),
    Rejected(Reject),
    Incomplete,
}

#[inline]
fn examine(data: &[u8], dialect: &Dialect) -> Verdict {
    if let [MAGIC_V2, _, flags, ..] = data
        && flags & !FLAG_SIGNED != 0
    {
        return Verdict::Rejected(Reject::IncompatFlags);
    }
    let Some(header) = Header::parse(data) else {
        return Verdict::Incomplete;
    };
    let entry = dialect.entry(header.message_id);
    if let Some(entry) = entry
        && header.version == 1
        && header.payload_length < entry.base_length
    {
        return Verdict::Rejected(Reject::Length);
    }
    let Some(packet) = data.get(..header.packet_length()) else {
        return Verdict::Incomplete;
    };
    let (calculated, received) = checksums(packet, &header);
    let Some(entry) = entry else {
        return examine_unknown(packet, header, calculated, received, dialect);
    };
    if crc::accumulate(calculated, entry.crc_extra) == received {
        Verdict::Packet(header, Some(entry.slot))
    } else {
        Verdict::Rejected(Reject::Checksum)
    }
}

#[inline]
fn checksums(packet: &[u8], header: &Header) -> (u16, u16) {
    let end = header.payload().end;
    let received = u16::from_le_bytes([packet[end], packet[end + CHECKSUM - 1]]);
    (crc::update(crc::INITIAL, &packet[1..end]), received)
}

#[cold]
fn examine_unknown(packet: &[u8], header: Header, calculated: u16, received: u16, dialect: &Dialect) -> Verdict {
    if crc::solve_extra(calculated, received).is_none() || contains_known_packet(&packet[1..], dialect) {
        return Verdict::Rejected(Reject::Checksum);
    }
    Verdict::Packet(header, None)
}

fn contains_known_packet(data: &[u8], dialect: &Dialect) -> bool {
    memchr::memchr2_iter(MAGIC_V1, MAGIC_V2, data).any(|start| {
        let Some(header) = Header::parse(&data[start..]) else {
            return false;
        };
        let Some(entry) = dialect.entry(header.message_id) else {
            return false;
        };
        let Some(packet) = data.get(start..start + header.packet_length()) else {
            return false;
        };
        let (calculated, received) = checksums(packet, &header);
        header.incompat_flags & !FLAG_SIGNED == 0 && crc::accumulate(calculated, entry.crc_extra) == received
    })
}

/// Walks `data` from packet to packet.
#[derive(Debug)]
pub struct Scanner<'a> {
    data: &'a [u8],
    dialect: &'a Dialect,
    timestamped: bool,
    /// Index at which the search continues.
    position: usize,
    /// Index of the first byte that is counted neither as packet nor as bad yet.
    boundary: usize,
}

impl<'a> Scanner<'a> {
    /// Creates a scanner of `data`.
    #[must_use]
    pub fn new(data: &'a [u8], dialect: &'a Dialect, timestamped: bool) -> Self {
        Self::resume(data, dialect, timestamped, 0, 0)
    }

    /// Creates a scanner that continues at `position`; the bytes from `boundary` on are not counted yet.
    #[must_use]
    pub fn resume(data: &'a [u8], dialect: &'a Dialect, timestamped: bool, position: usize, boundary: usize) -> Self {
        Self { data, dialect, timestamped, position, boundary }
    }

    /// Index at which the search continues when more bytes arrive.
    #[must_use]
    pub fn position(&self) -> usize {
        self.position
    }

    /// Index of the first byte that is not counted yet.
    #[must_use]
    pub fn boundary(&self) -> usize {
        self.boundary
    }

    /// Returns the next packet, or `None` when more bytes are needed.
    #[inline]
    pub fn next_packet(&mut self, statistics: &mut Statistics) -> Option<FrameSpan> {
        if self.timestamped && self.position == self.boundary {
            match self.examine_after_timestamp() {
                Verdict::Packet(header, slot) => {
                    return Some(self.accept(self.boundary + TIMESTAMP, header, slot, true, statistics));
                }
                Verdict::Incomplete => return None,
                Verdict::Rejected(_) => {}
            }
        }
        self.search(statistics)
    }

    /// Returns the next packet of a stream that has ended: an incomplete packet no longer delays those inside it.
    pub fn next_packet_at_end(&mut self, statistics: &mut Statistics) -> Option<FrameSpan> {
        loop {
            if let Some(found) = self.next_packet(statistics) {
                return Some(found);
            }
            if let Some(found) = self.search(statistics) {
                return Some(found);
            }
            if self.position >= self.data.len() {
                statistics.bad_bytes += (self.data.len() - self.boundary) as u64;
                self.boundary = self.data.len();
                return None;
            }
            self.position += 1;
        }
    }

    #[inline]
    fn examine_after_timestamp(&self) -> Verdict {
        match self.data.get(self.boundary + TIMESTAMP..) {
            None | Some([]) => Verdict::Incomplete,
            Some(rest @ [MAGIC_V1 | MAGIC_V2, ..]) => examine(rest, self.dialect),
            Some(_) => Verdict::Rejected(Reject::Checksum),
        }
    }

    #[inline]
    fn search(&mut self, statistics: &mut Statistics) -> Option<FrameSpan> {
        loop {
            let rest = self.data.get(self.position..)?;
            // Usually the next byte is a magic, and then the search is not worth its call.
            let skipped = if let [MAGIC_V1 | MAGIC_V2, ..] = rest {
                0
            } else if let Some(skipped) = memchr2(MAGIC_V1, MAGIC_V2, rest) {
                skipped
            } else {
                self.position = self.data.len();
                return None;
            };
            self.position += skipped;
            match examine(&rest[skipped..], self.dialect) {
                Verdict::Packet(header, slot) => {
                    return Some(self.accept(self.position, header, slot, false, statistics));
                }
                Verdict::Incomplete => return None,
                Verdict::Rejected(reason) => {
                    statistics.reject(reason);
                    self.position += 1;
                }
            }
        }
    }

    /// Returns whether the 8 bytes before `start` are a plausible time: after junk they may be junk too.
    fn has_plausible_time_before(&self, start: usize) -> bool {
        let stamp = self.data[..start].last_chunk::<TIMESTAMP>();
        stamp.is_some_and(|stamp| PLAUSIBLE_TIMES.contains(&timestamp_microseconds(*stamp)))
    }

    #[inline]
    fn accept(
        &mut self,
        start: usize,
        header: Header,
        slot: Option<u16>,
        stamped: bool,
        statistics: &mut Statistics,
    ) -> FrameSpan {
        let unaccounted = start - self.boundary;
        let timestamped =
            stamped || (self.timestamped && unaccounted >= TIMESTAMP && self.has_plausible_time_before(start));
        let found = FrameSpan { start, header, slot, timestamped };
        let end = found.range().end;
        statistics.bad_bytes += (unaccounted - if timestamped { TIMESTAMP } else { 0 }) as u64;
        statistics.packets += 1;
        statistics.packet_bytes += (end - start) as u64;
        statistics.unknown += u64::from(slot.is_none());
        statistics.signed += u64::from(header.signed());
        statistics.version_1 += u64::from(header.version == 1);
        statistics.version_2 += u64::from(header.version == 2);
        self.position = end;
        self.boundary = end;
        found
    }
}

/// Decodes a timestamp to microseconds since 1970; the little-endian timestamps of old recorders are recognised.
#[inline]
#[must_use]
pub fn timestamp_microseconds(stamp: [u8; TIMESTAMP]) -> u64 {
    let (big, little) = (u64::from_be_bytes(stamp), u64::from_le_bytes(stamp));
    if !PLAUSIBLE_TIMES.contains(&big) && PLAUSIBLE_TIMES.contains(&little) { little } else { big }
}

/// Returns whether a file that begins with `head` has a timestamp before each packet.
#[must_use]
pub fn looks_timestamped(head: &[u8], dialect: &Dialect) -> bool {
    let mut scanner = Scanner::new(head, dialect, false);
    let mut ignored = Statistics::default();
    let (mut previous, mut apart, mut adjacent) = (0, 0u32, 0u32);
    while let Some(found) = scanner.next_packet(&mut ignored) {
        match found.start - previous {
            0 => adjacent += 1,
            TIMESTAMP => apart += 1,
            _ => {}
        }
        previous = found.range().end;
    }
    apart > adjacent
}

#[cfg(test)]
#[path = "scan_tests.rs"]
pub(crate) mod tests;
