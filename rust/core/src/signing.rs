//! Signing: 13 bytes behind the checksum: link id, 48-bit timestamp, first 48 bits of
//! SHA-256(key ‖ header ‖ payload ‖ checksum ‖ link id ‖ timestamp).
//!
//! Timestamps count 10 µs since 2015-01-01 00:00 UTC. The order of the checks is the point of this file:
//! the hash comes first, in constant time, and only a packet that passed may touch a stream's timestamp;
//! otherwise one forged packet from the far future would silence its stream for ever. For the same reason
//! a packet that claims a time far ahead of a known clock is refused even if its hash is right.

use crate::header::{Header, SIGNATURE};
use crate::parser::Packet;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use subtle::ConstantTimeEq;
use zeroize::{Zeroize, ZeroizeOnDrop};

/// Units of a timestamp in a second.
pub const UNITS_PER_SECOND: u64 = 100_000;
/// Unix time of timestamp 0, in seconds.
pub const EPOCH: u64 = 1_420_070_400;
/// The largest timestamp that 48 bits hold.
pub const MAX_TIMESTAMP: u64 = (1 << 48) - 1;
const HASH: usize = 6;

/// Why a packet was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Not signed, and its id is not among those let through.
    Unsigned,
    /// The hash does not match the key.
    Forged,
    /// Not newer than the last packet of its stream.
    Replayed,
    /// A new stream that begins too far behind the clock.
    Stale,
    /// Too far ahead of the clock.
    Future,
    /// The table of streams is full.
    TooManyStreams,
}

/// The signing clock has no later timestamp to give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockExhausted;

/// Count of each refusal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    pub unsigned: u64,
    pub forged: u64,
    pub replayed: u64,
    pub stale: u64,
    pub future: u64,
    pub too_many_streams: u64,
}

impl Refusals {
    fn count(&mut self, refusal: Refusal) {
        *match refusal {
            Refusal::Unsigned => &mut self.unsigned,
            Refusal::Forged => &mut self.forged,
            Refusal::Replayed => &mut self.replayed,
            Refusal::Stale => &mut self.stale,
            Refusal::Future => &mut self.future,
            Refusal::TooManyStreams => &mut self.too_many_streams,
        } += 1;
    }
}

/// What a user may decide about received packets.
#[derive(Clone, Debug)]
pub struct Policy {
    /// Let every unsigned packet through.
    pub accept_unsigned: bool,
    /// Ids let through unsigned, such as RADIO_STATUS, which radios make without a key.
    pub unsigned_ids: Vec<u32>,
    /// How far behind the clock a new stream may begin, in timestamp units.
    pub max_behind: u64,
    /// How far ahead of the clock a packet may be, in timestamp units.
    pub max_ahead: u64,
    /// How far behind its stream's newest a packet may be, in timestamp units, for links that reorder;
    /// 0 is strict.
    pub reorder_slack: u64,
    pub max_streams: usize,
}

impl Default for Policy {
    fn default() -> Self {
        Self {
            accept_unsigned: false,
            unsigned_ids: Vec::new(),
            max_behind: 60 * UNITS_PER_SECOND,
            max_ahead: 24 * 3600 * UNITS_PER_SECOND,
            reorder_slack: 0,
            max_streams: 1024,
        }
    }
}

/// A 32-byte signing key; wiped when dropped, and never printed.
#[derive(Clone, Zeroize, ZeroizeOnDrop)]
pub struct Key([u8; 32]);

impl Key {
    #[must_use]
    pub fn new(bytes: [u8; 32]) -> Self {
        Self(bytes)
    }
}

impl std::fmt::Debug for Key {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Key(…)")
    }
}

/// Newest timestamp of a stream, and which of those shortly before it have been seen.
#[derive(Clone, Debug)]
struct Stream {
    newest: u64,
    /// Accepted timestamps within the slack, oldest first; empty when strict.
    recent: std::collections::VecDeque<u64>,
}

/// One end's signing state: it signs what is sent and judges what is received.
#[derive(Clone, Debug)]
pub struct Signing {
    key: Key,
    link_id: u8,
    /// Timestamp of the newest packet signed or accepted; never moves back.
    clock: u64,
    /// The clock at the start: together with the time, what "too far ahead" is measured from. The clock itself
    /// would not do, since each packet accepted moves it.
    started: u64,
    policy: Policy,
    streams: HashMap<(u8, u8, u8), Stream>,
    refusals: Refusals,
}

/// Packets within the slack that a stream remembers, so that slack never admits a replay.
const MAX_RECENT: usize = 256;

impl Signing {
    #[must_use]
    pub fn new(key: Key, link_id: u8, clock: u64, policy: Policy) -> Self {
        Self { key, link_id, clock, started: clock, policy, streams: HashMap::new(), refusals: Refusals::default() }
    }

    /// The timestamp to persist: the next run must start at or after it.
    #[must_use]
    pub fn clock(&self) -> u64 {
        self.clock
    }

    #[must_use]
    pub fn link_id(&self) -> u8 {
        self.link_id
    }

    #[must_use]
    pub fn refusals(&self) -> &Refusals {
        &self.refusals
    }

    #[must_use]
    pub fn streams(&self) -> usize {
        self.streams.len()
    }

    /// Appends the signature to a packet that ends with its checksum; `now` is the timestamp of the time, if known.
    ///
    /// Fails, leaving the packet as it is, when the clock has reached the end of its 48 bits (in the year 2104).
    pub fn sign(&mut self, packet: &mut Vec<u8>, now: Option<u64>) -> Result<(), ClockExhausted> {
        let next = (self.clock + 1).max(now.unwrap_or(0));
        if next > MAX_TIMESTAMP {
            return Err(ClockExhausted);
        }
        self.clock = next;
        packet.push(self.link_id);
        packet.extend_from_slice(&self.clock.to_le_bytes()[..HASH]);
        let hash = hash(&self.key, packet);
        packet.extend_from_slice(&hash);
        Ok(())
    }

    /// Judges a received packet, and counts it if it is refused; `now` is the timestamp of the time, if known.
    pub fn check(&mut self, packet: &Packet<'_>, now: Option<u64>) -> Result<(), Refusal> {
        let verdict = self.judge(packet, now);
        if let Err(refusal) = verdict {
            self.refusals.count(refusal);
        }
        verdict
    }

    fn judge(&mut self, packet: &Packet<'_>, now: Option<u64>) -> Result<(), Refusal> {
        if !packet.header.signed() {
            let allowed = self.policy.accept_unsigned || self.policy.unsigned_ids.contains(&packet.header.message_id);
            return if allowed { Ok(()) } else { Err(Refusal::Unsigned) };
        }
        if !verify(&self.key, packet.raw) {
            return Err(Refusal::Forged);
        }
        let (link_id, timestamp) = link_and_timestamp(packet.raw);
        self.judge_time(link_id, &packet.header, timestamp, now)
    }

    fn judge_time(&mut self, link_id: u8, header: &Header, timestamp: u64, now: Option<u64>) -> Result<(), Refusal> {
        let clock = now.unwrap_or(0).max(self.clock);
        if now.is_some_and(|now| timestamp > now.max(self.started).saturating_add(self.policy.max_ahead)) {
            return Err(Refusal::Future);
        }
        let streams = self.streams.len();
        let slack = self.policy.reorder_slack;
        match self.streams.entry((link_id, header.system, header.component)) {
            std::collections::hash_map::Entry::Occupied(mut entry) => {
                if !entry.get_mut().advance(timestamp, slack) {
                    return Err(Refusal::Replayed);
                }
            }
            std::collections::hash_map::Entry::Vacant(entry) => {
                if timestamp.saturating_add(self.policy.max_behind) < clock {
                    return Err(Refusal::Stale);
                }
                if streams >= self.policy.max_streams {
                    return Err(Refusal::TooManyStreams);
                }
                entry.insert(Stream::new(timestamp, slack));
            }
        }
        self.clock = self.clock.max(timestamp);
        Ok(())
    }
}

impl Stream {
    fn new(timestamp: u64, slack: u64) -> Self {
        let recent = if slack == 0 { [].into() } else { [timestamp].into() };
        Self { newest: timestamp, recent }
    }

    /// Takes `timestamp` into the stream, unless it was seen or is too old.
    fn advance(&mut self, timestamp: u64, slack: u64) -> bool {
        if slack == 0 {
            let newer = timestamp > self.newest;
            self.newest = self.newest.max(timestamp);
            return newer;
        }
        let oldest = self.newest.saturating_sub(slack);
        // A full memory cannot vouch for what is older than all it holds.
        let forgotten = self.recent.len() >= MAX_RECENT && self.recent.front().is_some_and(|&first| timestamp < first);
        let Err(place) = self.recent.binary_search(&timestamp) else {
            return false;
        };
        if timestamp < oldest || forgotten {
            return false;
        }
        self.recent.insert(place, timestamp);
        if self.recent.len() > MAX_RECENT {
            self.recent.pop_front();
        }
        self.newest = self.newest.max(timestamp);
        true
    }
}

/// Whether the hash at the end of a signed packet matches `key`, compared in constant time.
#[inline]
#[must_use]
pub fn verify(key: &Key, raw: &[u8]) -> bool {
    let Some((signed, received)) = raw.split_last_chunk::<HASH>() else {
        return false;
    };
    raw.len() > SIGNATURE && bool::from(hash(key, signed).ct_eq(received))
}

/// Link id and timestamp of a signed packet.
#[must_use]
pub fn link_and_timestamp(raw: &[u8]) -> (u8, u64) {
    let Some([link_id, a, b, c, d, e, f, ..]) = raw.last_chunk::<SIGNATURE>() else {
        return (0, 0);
    };
    (*link_id, u64::from_le_bytes([*a, *b, *c, *d, *e, *f, 0, 0]))
}

#[inline]
fn hash(key: &Key, signed: &[u8]) -> [u8; HASH] {
    let digest = Sha256::new().chain_update(key.0).chain_update(signed).finalize();
    let mut first = [0; HASH];
    first.copy_from_slice(&digest[..HASH]);
    first
}

#[cfg(test)]
#[path = "signing_tests.rs"]
mod tests;
