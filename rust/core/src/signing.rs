//! Message signing: 13 bytes after the checksum hold the link id, a 48-bit timestamp and the first 48 bits of
//! SHA-256(key ‖ header ‖ payload ‖ checksum ‖ link id ‖ timestamp).
//!
//! Timestamps count 10 µs since 2015-01-01 00:00 UTC. The order of the checks matters: the hash is verified first, in
//! constant time, and only a packet with a valid hash may change the timestamp of its stream; otherwise one forged
//! packet from the far future would block its stream for ever. For the same reason a packet whose timestamp is far
//! ahead of a known clock is refused even if its hash is valid.
//!
//! All links of one key share the clock and the streams, so that a packet accepted on one link is a replay on every
//! other. The program stores them for its next run. A stream is forgotten only when its packets are too old to be the
//! first of a new stream.

use crate::header::{Header, SIGNATURE};
use crate::parser::Packet;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use subtle::ConstantTimeEq;
use zeroize::{Zeroize, ZeroizeOnDrop};

/// Timestamp units per second.
pub const UNITS_PER_SECOND: u64 = 100_000;
/// Unix time of timestamp 0, in seconds.
pub const EPOCH: u64 = 1_420_070_400;
/// The largest timestamp that 48 bits hold.
pub const MAX_TIMESTAMP: u64 = (1 << 48) - 1;
const HASH: usize = 6;

/// The reason why a packet is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Not signed, and its message id is not accepted unsigned.
    Unsigned,
    /// The hash does not match the key.
    Forged,
    /// Its timestamp is not newer than that of the last packet of its stream.
    Replayed,
    /// The first packet of a stream, too far behind the clock.
    Stale,
    /// Too far ahead of the clock.
    Future,
    /// The table of streams is full.
    TooManyStreams,
}

/// The signing clock has reached its last timestamp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClockExhausted;

/// Number of refused packets by reason.
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

/// The rules for accepting received packets.
#[derive(Clone, Debug)]
pub struct Policy {
    /// Accept all unsigned packets.
    pub accept_unsigned: bool,
    /// Message ids accepted unsigned, such as RADIO_STATUS, which radios send without a key.
    pub unsigned_ids: Vec<u32>,
    /// Maximum age of the first packet of a stream, in timestamp units behind the clock.
    pub max_behind: u64,
    /// Maximum lead of a packet over the clock, in timestamp units.
    pub max_ahead: u64,
    /// Maximum lag of a packet behind the newest of its stream, in timestamp units, for links that reorder packets;
    /// 0 refuses all reordered packets.
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

/// A 32-byte signing key; zeroed when dropped, and never printed.
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

/// Newest timestamp of a stream, and the accepted timestamps shortly before it.
#[derive(Clone, Debug)]
struct Stream {
    newest: u64,
    /// Timestamps up to this one are refused.
    floor: u64,
    /// Accepted timestamps within the reorder slack, oldest first; empty if the slack is 0.
    recent: std::collections::VecDeque<u64>,
}

/// Link id, system and component of a stream.
pub type StreamId = (u8, u8, u8);

/// The state that all links of one key share.
#[derive(Debug, Default)]
struct Shared {
    /// Timestamp of the newest packet signed or accepted; never moves back.
    clock: u64,
    /// The initial clock, from which (with the current time) the lead of a packet is measured. The clock itself cannot
    /// serve, because each accepted packet advances it.
    initial_clock: u64,
    streams: HashMap<StreamId, Stream>,
    /// Streams do not begin with timestamps up to this one.
    floor: u64,
}

/// The signing state of one link: it signs sent packets and verifies received ones.
#[derive(Debug)]
pub struct Signing {
    key: Key,
    link_id: u8,
    policy: Policy,
    shared: Arc<Mutex<Shared>>,
    refusals: Refusals,
}

/// Number of recent timestamps kept per stream, so that the reorder slack never accepts a replay.
const MAX_RECENT: usize = 256;

impl Signing {
    #[must_use]
    pub fn new(key: Key, link_id: u8, clock: u64, policy: Policy) -> Self {
        let shared = Shared { clock, initial_clock: clock, ..Shared::default() };
        Self { key, link_id, policy, shared: Arc::new(Mutex::new(shared)), refusals: Refusals::default() }
    }

    /// Creates the state of another link of the same key, which shares the clock and the streams.
    #[must_use]
    pub fn for_link(&self, link_id: u8) -> Self {
        Self {
            key: self.key.clone(),
            link_id,
            policy: self.policy.clone(),
            shared: Arc::clone(&self.shared),
            refusals: Refusals::default(),
        }
    }

    fn shared(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The timestamp to persist: the next run must start at or after it.
    #[must_use]
    pub fn clock(&self) -> u64 {
        self.shared().clock
    }

    /// Advances the clock to a timestamp that is trusted, such as one that came with the key.
    pub fn advance(&mut self, timestamp: u64) {
        let mut shared = self.shared();
        shared.clock = shared.clock.max(timestamp);
        shared.initial_clock = shared.initial_clock.max(timestamp);
    }

    /// Newest timestamp of each stream, to persist, in the order of their ids.
    #[must_use]
    pub fn newest(&self) -> Vec<(StreamId, u64)> {
        let mut newest: Vec<_> = self.shared().streams.iter().map(|(&id, stream)| (id, stream.newest)).collect();
        newest.sort_unstable();
        newest
    }

    /// Restores persisted streams; no timestamp up to theirs, and in any stream none up to `floor`, is accepted.
    pub fn restore(&mut self, newest: impl IntoIterator<Item = (StreamId, u64)>, floor: u64) {
        let limit = self.policy.max_streams;
        let mut shared = self.shared();
        shared.floor = shared.floor.max(floor);
        for (id, timestamp) in newest {
            if shared.streams.len() < limit || shared.streams.contains_key(&id) {
                let stream = shared.streams.entry(id).or_insert_with(|| Stream::new(timestamp, 0));
                stream.newest = stream.newest.max(timestamp);
                stream.floor = stream.floor.max(timestamp).max(floor);
            }
        }
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
        self.shared().streams.len()
    }

    /// Appends the signature to a packet that ends with its checksum; `now` is the current time as a timestamp, if known.
    ///
    /// Fails, leaving the packet unchanged, when the clock has reached the end of its 48 bits (in the year 2104).
    pub fn sign(&mut self, packet: &mut Vec<u8>, now: Option<u64>) -> Result<(), ClockExhausted> {
        let next = {
            let mut shared = self.shared();
            let next = (shared.clock + 1).max(now.unwrap_or(0));
            if next > MAX_TIMESTAMP {
                return Err(ClockExhausted);
            }
            shared.clock = next;
            next
        };
        packet.push(self.link_id);
        packet.extend_from_slice(&next.to_le_bytes()[..HASH]);
        let hash = hash(&self.key, packet);
        packet.extend_from_slice(&hash);
        Ok(())
    }

    /// Verifies a received packet, and counts a refusal; `now` is the current time as a timestamp, if known.
    pub fn check(&mut self, packet: &Packet<'_>, now: Option<u64>) -> Result<(), Refusal> {
        self.check_with_limit(packet, now, now)
    }

    /// Verifies a received packet like `check`; its lead is measured from `latest` instead of `now`.
    pub fn check_with_limit(
        &mut self,
        packet: &Packet<'_>,
        now: Option<u64>,
        latest: Option<u64>,
    ) -> Result<(), Refusal> {
        let result = self.verify(packet, now, latest);
        if let Err(refusal) = result {
            self.refusals.count(refusal);
        }
        result
    }

    fn verify(&self, packet: &Packet<'_>, now: Option<u64>, latest: Option<u64>) -> Result<(), Refusal> {
        if !packet.header.signed() {
            let allowed = self.policy.accept_unsigned || self.policy.unsigned_ids.contains(&packet.header.message_id);
            return if allowed { Ok(()) } else { Err(Refusal::Unsigned) };
        }
        if !hash_matches(&self.key, packet.raw) {
            return Err(Refusal::Forged);
        }
        let (link_id, timestamp) = link_and_timestamp(packet.raw);
        let Header { system, component, .. } = packet.header;
        self.shared().accept((link_id, system, component), timestamp, now, latest, &self.policy)
    }
}

impl Shared {
    fn accept(
        &mut self,
        id: StreamId,
        timestamp: u64,
        now: Option<u64>,
        latest: Option<u64>,
        policy: &Policy,
    ) -> Result<(), Refusal> {
        if latest.is_some_and(|latest| timestamp > latest.max(self.initial_clock).saturating_add(policy.max_ahead)) {
            return Err(Refusal::Future);
        }
        if let Some(stream) = self.streams.get_mut(&id) {
            if !stream.advance(timestamp, policy.reorder_slack) {
                return Err(Refusal::Replayed);
            }
        } else {
            let clock = now.unwrap_or(0).max(self.clock);
            if timestamp <= self.floor || timestamp.saturating_add(policy.max_behind) < clock {
                return Err(Refusal::Stale);
            }
            if self.streams.len() >= policy.max_streams && !self.forget_stale(policy.max_behind) {
                return Err(Refusal::TooManyStreams);
            }
            self.streams.insert(id, Stream::new(timestamp, policy.reorder_slack));
        }
        self.clock = self.clock.max(timestamp);
        Ok(())
    }

    /// Removes the streams whose packets would be too old for a new stream; returns whether there are any.
    ///
    /// A replay of their packets is then refused as stale.
    #[cold]
    fn forget_stale(&mut self, max_behind: u64) -> bool {
        let (before, clock) = (self.streams.len(), self.clock);
        self.streams.retain(|_, stream| stream.newest.saturating_add(max_behind) >= clock);
        self.streams.len() < before
    }
}

impl Stream {
    fn new(timestamp: u64, slack: u64) -> Self {
        let recent = if slack == 0 { [].into() } else { [timestamp].into() };
        Self { newest: timestamp, floor: 0, recent }
    }

    /// Accepts `timestamp` into the stream, unless it was accepted before or is too old.
    fn advance(&mut self, timestamp: u64, slack: u64) -> bool {
        if timestamp <= self.floor {
            return false;
        }
        if slack == 0 {
            let newer = timestamp > self.newest;
            self.newest = self.newest.max(timestamp);
            return newer;
        }
        let oldest = self.newest.saturating_sub(slack);
        // Timestamps older than the oldest one kept may have been accepted and dropped from a full list.
        let too_old = self.recent.len() >= MAX_RECENT && self.recent.front().is_some_and(|&first| timestamp < first);
        let Err(position) = self.recent.binary_search(&timestamp) else {
            return false;
        };
        if timestamp < oldest || too_old {
            return false;
        }
        self.recent.insert(position, timestamp);
        if self.recent.len() > MAX_RECENT {
            self.recent.pop_front();
        }
        self.newest = self.newest.max(timestamp);
        true
    }
}

/// Returns whether the hash at the end of a signed packet matches `key`, compared in constant time.
#[inline]
#[must_use]
pub fn hash_matches(key: &Key, raw: &[u8]) -> bool {
    let Some((signed, received)) = raw.split_last_chunk::<HASH>() else {
        return false;
    };
    raw.len() > SIGNATURE && bool::from(hash(key, signed).ct_eq(received))
}

/// Returns the link id and timestamp of a signed packet.
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
