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
//! After a rejection the search continues one byte after the false magic. All decisions depend only on the bytes of the
//! stream, so the result does not depend on how it is cut into chunks.
//!
//! The checksum of a *signed* packet does not cover its signature. A signature that lacks bytes is filled with the first
//! bytes of the next packet, whose rest then looks like junk. Therefore, if no packet directly follows a signed one, the
//! search goes back and starts again at its signature.
//!
//! The work per byte is bounded: after a few rejections CRCs come from a [`RunningCrc`], so that bytes full of false
//! magics do not cost a CRC over a whole packet each.
//!
//! A *timestamped* stream (a tlog) has 8 bytes before each packet: big-endian microseconds since 1970. After a packet
//! the next one is first expected 8 bytes later, then searched for anywhere: junk, missing timestamps and a start in
//! the middle of a packet cost no other packet.

use crate::crc;
use crate::header::{CHECKSUM, FLAG_SIGNED, Header, MAGIC_V1, MAGIC_V2, SIGNATURE};
use crate::layout::Dialect;
use crate::running_crc::RunningCrc;
use crate::statistics::{Reject, Statistics};
use crate::timestamps::{TIMESTAMP, ends_with_plausible_time};
use memchr::memchr2;

/// Number of rejected checksums in a row after which CRCs are shared by overlapping candidates.
const MAX_SEPARATE_CHECKSUMS: u32 = 2;

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

/// The state of a scanner between two packets, as indices into its bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct State {
    /// Index at which the search continues.
    pub position: usize,
    /// Index of the first byte that is counted neither as packet nor as bad yet.
    pub boundary: usize,
    /// Index of the first byte that may belong to a later packet: the boundary, or the signature before it.
    floor: usize,
    /// True if the search went back to the signature before the boundary.
    went_back: bool,
}

impl State {
    /// Creates the state at `boundary`, after anything but a signed packet.
    #[must_use]
    pub fn at(boundary: usize) -> Self {
        Self { position: boundary, boundary, floor: boundary, went_back: false }
    }

    /// Creates the state in which the bytes before `position` are searched, and not counted yet.
    pub(crate) fn searching_from(position: usize) -> Self {
        Self { position, ..Self::default() }
    }

    /// True if the search goes back to a signature unless a packet follows directly.
    #[inline]
    fn may_go_back(&self) -> bool {
        self.floor < self.boundary && !self.went_back
    }

    /// Returns the index of the first byte that later calls need.
    pub(crate) fn first_needed(&self, timestamped: bool) -> usize {
        let stamp = if timestamped { TIMESTAMP } else { 0 };
        if self.may_go_back() { self.floor } else { self.floor.max(self.position.saturating_sub(stamp)) }
    }

    /// Returns the state in the bytes from `start` on.
    pub(crate) fn after_removing(self, start: usize) -> Self {
        Self {
            position: self.position - start,
            boundary: self.boundary.saturating_sub(start),
            floor: self.floor.saturating_sub(start),
            ..self
        }
    }
}

/// Walks `data` from packet to packet.
#[derive(Debug)]
pub struct Scanner<'a> {
    data: &'a [u8],
    dialect: &'a Dialect,
    timestamped: bool,
    state: State,
    /// Number of rejected checksums since the last packet.
    rejected: u32,
    running_crc: Option<Box<RunningCrc>>,
}

impl<'a> Scanner<'a> {
    /// Creates a scanner of `data`.
    #[must_use]
    pub fn new(data: &'a [u8], dialect: &'a Dialect, timestamped: bool) -> Self {
        Self::resume(data, dialect, timestamped, State::default())
    }

    /// Creates a scanner that continues in `state`; the bytes from its boundary on are not counted yet.
    #[must_use]
    pub fn resume(data: &'a [u8], dialect: &'a Dialect, timestamped: bool, state: State) -> Self {
        Self { data, dialect, timestamped, state, rejected: 0, running_crc: None }
    }

    /// Returns the packet that all of `data` is, if its message is known and it has no signature, as in most datagrams.
    ///
    /// A scan from and to the initial state would find it too, in more steps.
    #[inline]
    pub(crate) fn whole_packet(data: &'a [u8], dialect: &'a Dialect, statistics: &mut Statistics) -> Option<FrameSpan> {
        let header = Header::parse(data)?;
        if header.packet_length() != data.len() || header.incompat_flags != 0 {
            return None;
        }
        let Verdict::Packet(header, slot @ Some(_)) = Self::new(data, dialect, false).examine(0) else {
            return None;
        };
        statistics.packets += 1;
        statistics.packet_bytes += data.len() as u64;
        statistics.version_1 += u64::from(header.version == 1);
        statistics.version_2 += u64::from(header.version == 2);
        Some(FrameSpan { start: 0, header, slot, timestamped: false })
    }

    /// The state with which another scanner of the same stream continues.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// Returns the next packet, or `None` when more bytes are needed.
    #[allow(clippy::inline_always, reason = "a call for each packet costs a tenth of the scan")]
    #[inline(always)]
    pub fn next_packet(&mut self, statistics: &mut Statistics) -> Option<FrameSpan> {
        if self.timestamped && self.state.position == self.state.boundary && !self.state.went_back {
            match self.examine_after_timestamp() {
                Verdict::Packet(header, slot) => {
                    return Some(self.accept(self.state.boundary + TIMESTAMP, header, slot, true, statistics));
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
            if self.state.position >= self.data.len() {
                statistics.bad_bytes += (self.data.len() - self.state.boundary) as u64;
                self.state = State::at(self.data.len());
                return None;
            }
            self.state.position += 1;
        }
    }

    #[allow(clippy::inline_always, reason = "a call for each packet costs a tenth of the scan")]
    #[inline(always)]
    fn examine_after_timestamp(&mut self) -> Verdict {
        let start = self.state.boundary + TIMESTAMP;
        match self.data.get(start) {
            None => Verdict::Incomplete,
            Some(&(MAGIC_V1 | MAGIC_V2)) => self.examine(start),
            Some(_) => Verdict::Rejected(Reject::Checksum),
        }
    }

    // Inlined, the parts of the packet stay in registers: copies of bytes that were just written stall.
    #[allow(clippy::inline_always, reason = "a call for each packet costs a tenth of the scan")]
    #[inline(always)]
    fn search(&mut self, statistics: &mut Statistics) -> Option<FrameSpan> {
        loop {
            let rest = self.data.get(self.state.position..)?;
            // Usually the next byte is a magic, and then the search is not worth its call.
            let skipped = if let [MAGIC_V1 | MAGIC_V2, ..] = rest {
                0
            } else if self.state.may_go_back() && !rest.is_empty() {
                self.go_back();
                continue;
            } else if let Some(skipped) = memchr2(MAGIC_V1, MAGIC_V2, rest) {
                skipped
            } else {
                self.state.position = self.data.len();
                return None;
            };
            self.state.position += skipped;
            match self.examine(self.state.position) {
                Verdict::Packet(header, slot) => {
                    return Some(self.accept(self.state.position, header, slot, false, statistics));
                }
                Verdict::Incomplete => return None,
                Verdict::Rejected(_) if self.state.may_go_back() => self.go_back(),
                Verdict::Rejected(reason) => {
                    statistics.reject(reason);
                    self.state.position += 1;
                }
            }
        }
    }

    /// Continues the search at the signature of the last packet.
    #[cold]
    fn go_back(&mut self) {
        self.state.position = self.state.floor;
        self.state.went_back = true;
    }

    #[allow(clippy::inline_always, reason = "a call for each packet costs a tenth of the scan")]
    #[inline(always)]
    fn examine(&mut self, start: usize) -> Verdict {
        let data = &self.data[start..];
        if let [MAGIC_V2, _, flags, ..] = data
            && flags & !FLAG_SIGNED != 0
        {
            return Verdict::Rejected(Reject::IncompatFlags);
        }
        let Some(header) = Header::parse(data) else {
            return Verdict::Incomplete;
        };
        let entry = self.dialect.entry(header.message_id);
        if let Some(entry) = entry
            && header.version == 1
            && header.payload_length < entry.base_length
        {
            return Verdict::Rejected(Reject::Length);
        }
        if data.len() < header.packet_length() {
            return Verdict::Incomplete;
        }
        let (calculated, received) = self.checksums(start, &header);
        let Some(entry) = entry else {
            return self.examine_unknown(start, header, calculated, received);
        };
        if crc::accumulate(calculated, entry.crc_extra) == received {
            Verdict::Packet(header, Some(entry.slot))
        } else {
            self.rejected += 1;
            Verdict::Rejected(Reject::Checksum)
        }
    }

    /// Returns the calculated checksum, without `CRC_EXTRA`, and the received one of a complete packet.
    #[inline]
    fn checksums(&mut self, start: usize, header: &Header) -> (u16, u16) {
        let end = start + header.payload().end;
        let received = u16::from_le_bytes([self.data[end], self.data[end + CHECKSUM - 1]]);
        let calculated = if self.rejected < MAX_SEPARATE_CHECKSUMS {
            crc::update(crc::INITIAL, &self.data[start + 1..end])
        } else {
            self.shared_checksum(start + 1, end)
        };
        (calculated, received)
    }

    #[cold]
    fn shared_checksum(&mut self, start: usize, end: usize) -> u16 {
        self.running_crc.get_or_insert_with(|| Box::new(RunningCrc::new())).of_range(self.data, start, end)
    }

    #[cold]
    fn examine_unknown(&mut self, start: usize, header: Header, calculated: u16, received: u16) -> Verdict {
        let end = start + header.packet_length();
        if crc::solve_extra(calculated, received).is_none() || self.contains_known_packet(start + 1, end) {
            self.rejected += 1;
            return Verdict::Rejected(Reject::Checksum);
        }
        Verdict::Packet(header, None)
    }

    fn contains_known_packet(&mut self, first: usize, end: usize) -> bool {
        memchr::memchr2_iter(MAGIC_V1, MAGIC_V2, &self.data[first..end]).any(|offset| {
            let start = first + offset;
            let Some(header) = Header::parse(&self.data[start..end]) else {
                return false;
            };
            let Some(entry) = self.dialect.entry(header.message_id) else {
                return false;
            };
            if header.incompat_flags & !FLAG_SIGNED != 0 || end - start < header.packet_length() {
                return false;
            }
            let (calculated, received) = self.checksums(start, &header);
            crc::accumulate(calculated, entry.crc_extra) == received
        })
    }

    #[allow(clippy::inline_always, reason = "a call for each packet costs a tenth of the scan")]
    #[inline(always)]
    fn accept(
        &mut self,
        start: usize,
        header: Header,
        slot: Option<u16>,
        stamped: bool,
        statistics: &mut Statistics,
    ) -> FrameSpan {
        let State { boundary, floor, .. } = self.state;
        let timestamped = stamped
            || (self.timestamped && start - floor >= TIMESTAMP && ends_with_plausible_time(&self.data[..start]));
        let found = FrameSpan { start, header, slot, timestamped };
        let end = found.range().end;
        let stamp = if timestamped { TIMESTAMP } else { 0 };
        statistics.bad_bytes += start.saturating_sub(boundary).saturating_sub(stamp) as u64;
        statistics.packets += 1;
        // Bytes that were taken for the signature of the packet before are counted once.
        statistics.packet_bytes += end.saturating_sub(start.max(boundary)) as u64;
        statistics.unknown += u64::from(slot.is_none());
        statistics.signed += u64::from(header.signed());
        statistics.version_1 += u64::from(header.version == 1);
        statistics.version_2 += u64::from(header.version == 2);
        self.rejected = 0;
        self.state = State { position: end, boundary: end.max(boundary), floor: end, went_back: end < boundary };
        if header.signed() && end > boundary {
            self.state.floor = end - SIGNATURE;
            if self.contains_known_packet(end - SIGNATURE, end) {
                self.go_back(); // nothing follows that could show the fault
            }
        }
        found
    }
}

/// Number of pairs of neighbouring packets that show whether a file has timestamps.
const MAX_PAIRS: u32 = 1000;

/// Returns whether a file that begins with `head` has a timestamp before each packet.
#[must_use]
pub fn looks_timestamped(head: &[u8], dialect: &Dialect) -> bool {
    let mut scanner = Scanner::new(head, dialect, false);
    let mut ignored = Statistics::default();
    let (mut previous, mut apart, mut adjacent) = (0, 0u32, 0u32);
    while apart + adjacent < MAX_PAIRS
        && let Some(found) = scanner.next_packet(&mut ignored)
    {
        match found.start.checked_sub(previous) {
            Some(0) => adjacent += 1,
            Some(TIMESTAMP) => apart += 1,
            _ => {}
        }
        previous = found.range().end;
    }
    apart > adjacent
}

#[cfg(test)]
#[path = "scan_tests.rs"]
pub(crate) mod tests;
