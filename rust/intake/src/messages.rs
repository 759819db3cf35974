//! The messages of each source: who waits for them, and the latest packet of each.

use mavstack_core::header::Header;
use mavstack_core::parser::Packet;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Latest packets of one system; beyond it the older half is dropped.
pub const MAX_STORED: usize = 2048;
/// Entries of the table; beyond it those without a packet are dropped, since ids and addresses can be forged.
const MAX_ENTRIES: usize = 1 << 17;

/// The interest of the program in a message of a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interest {
    /// The program did not decide yet: it gets the packet, and decides.
    #[default]
    Unknown,
    /// As before, and the program was asked.
    Asked,
    Nothing,
    /// Only packets whose boot time or position does not continue that of the packets before.
    NewBoot,
    /// Every packet, together with others.
    Soon,
    /// Every packet, at once.
    Now,
}

/// Who takes a message of a source.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Decision {
    /// The interest of services.
    pub interest: Interest,
    /// Listeners and subscriptions take every packet.
    pub is_listened: bool,
}

/// The latest packet of a message.
#[derive(Clone, Debug)]
pub struct Latest {
    pub raw: Vec<u8>,
    pub header: Header,
    pub slot: Option<u16>,
    /// Time of arrival in seconds of the program's clock.
    pub at: f64,
    /// Number of packets that were kept before, of all messages: it differs for each packet.
    pub number: u64,
}

#[derive(Debug, Default)]
struct Entry {
    decision: Decision,
    latest: Option<Latest>,
}

/// Hashes a key by one multiplication.
#[derive(Debug, Default)]
pub struct KeyHasher(u64);

impl Hasher for KeyHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(u64::from(byte));
        }
    }

    fn write_u32(&mut self, key: u32) {
        self.write_u64(u64::from(key));
    }

    fn write_u64(&mut self, key: u64) {
        let mixed = (self.0 ^ key).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 32);
    }
}

/// A map by small numbers, of which the hash is one multiplication.
pub type KeyMap<Key, Value> = HashMap<Key, Value, BuildHasherDefault<KeyHasher>>;

/// Returns the key of a message of a source.
#[must_use]
pub fn key(system: u8, component: u8, message_id: u32) -> u64 {
    u64::from(system) << 32 | u64::from(component) << 24 | u64::from(message_id)
}

fn system_of(key: u64) -> u8 {
    (key >> 32) as u8
}

fn message_of(key: u64) -> u32 {
    key as u32 & 0x00FF_FFFF
}

/// Returns whether a key is of a message (`None`: all messages) of a system (0: all systems).
#[must_use]
pub fn matches(key: u64, message_id: Option<u32>, system: u8) -> bool {
    message_id.is_none_or(|id| id == message_of(key)) && (system == 0 || system == system_of(key))
}

/// The table of messages.
#[derive(Debug)]
pub struct Messages {
    entries: KeyMap<u64, Entry>,
    /// Followers of each system: packets of others are not kept.
    followers: [u32; 256],
    stored: [usize; 256],
    kept: u64,
    undecided: Vec<((u8, u8), u32)>,
    /// The program decided since the last call of `take_decided` that no part of it takes some message.
    has_decided: bool,
}

impl Default for Messages {
    fn default() -> Self {
        let (entries, undecided) = (HashMap::default(), Vec::new());
        Self { entries, followers: [0; 256], stored: [0; 256], kept: 0, undecided, has_decided: false }
    }
}

impl Messages {
    /// Keeps a packet, if its system is followed; returns who takes it.
    #[inline]
    pub fn keep(&mut self, packet: &Packet<'_>, now: f64) -> Decision {
        let Header { system, component, message_id, .. } = packet.header;
        let key = key(system, component, message_id);
        if self.followers[usize::from(system)] == 0 {
            return self.entries.get(&key).map(|entry| entry.decision).unwrap_or_default();
        }
        self.kept += 1;
        let entry = self.entries.entry(key).or_default();
        if let Some(latest) = &mut entry.latest {
            latest.raw.clear();
            latest.raw.extend_from_slice(packet.raw);
            (latest.header, latest.slot, latest.at, latest.number) = (packet.header, packet.slot, now, self.kept);
            return entry.decision;
        }
        let (raw, header, slot) = (packet.raw.to_vec(), packet.header, packet.slot);
        entry.latest = Some(Latest { raw, header, slot, at: now, number: self.kept });
        let decision = entry.decision;
        self.stored[usize::from(system)] += 1;
        self.make_room(system);
        decision
    }

    #[cold]
    fn make_room(&mut self, system: u8) {
        if self.stored[usize::from(system)] > MAX_STORED {
            let of_system = self.entries.iter().filter(|(key, _)| system_of(**key) == system);
            let mut numbers: Vec<u64> =
                of_system.filter_map(|(_, entry)| entry.latest.as_ref().map(|latest| latest.number)).collect();
            numbers.sort_unstable();
            let oldest_kept = numbers[numbers.len() / 2];
            self.forget_packets(system, |latest| latest.number < oldest_kept);
        }
        self.bound_entries();
    }

    fn bound_entries(&mut self) {
        if self.entries.len() > MAX_ENTRIES {
            self.entries.retain(|_, entry| entry.latest.is_some());
        }
    }

    fn forget_packets(&mut self, system: u8, is_old: impl Fn(&Latest) -> bool) {
        for (_, entry) in self.entries.iter_mut().filter(|(key, _)| system_of(**key) == system) {
            if entry.latest.as_ref().is_some_and(&is_old) {
                entry.latest = None;
                self.stored[usize::from(system)] -= 1;
            }
        }
    }

    /// Returns the latest packet of a message.
    #[must_use]
    pub fn latest(&self, system: u8, component: u8, message_id: u32) -> Option<&Latest> {
        self.entries.get(&key(system, component, message_id))?.latest.as_ref()
    }

    /// Returns the time of the latest packet of a system.
    #[must_use]
    pub fn newest_time(&self, system: u8) -> Option<f64> {
        let of_system = self.entries.iter().filter(|(key, _)| system_of(**key) == system);
        of_system.filter_map(|(_, entry)| entry.latest.as_ref().map(|latest| latest.at)).reduce(f64::max)
    }

    /// Number of packets that are kept of a system.
    #[must_use]
    pub fn stored(&self, system: u8) -> usize {
        self.stored[usize::from(system)]
    }

    /// Keeps the packets of a system from now on.
    pub fn follow(&mut self, system: u8) {
        self.followers[usize::from(system)] += 1;
    }

    /// Ends one `follow`; without followers the packets are dropped.
    pub fn unfollow(&mut self, system: u8) {
        let followers = &mut self.followers[usize::from(system)];
        *followers = followers.saturating_sub(1);
        if *followers == 0 {
            self.clear(system);
        }
    }

    /// Drops the packets of a system.
    pub fn clear(&mut self, system: u8) {
        self.forget_packets(system, |_| true);
    }

    /// Asks the program who waits for a message of a source.
    #[cold]
    pub fn ask(&mut self, source: (u8, u8), message_id: u32) {
        self.decide(source, message_id, Decision { interest: Interest::Asked, is_listened: true });
        self.undecided.push((source, message_id));
    }

    /// Returns what the program was asked since the last call.
    pub fn take_undecided(&mut self) -> Vec<((u8, u8), u32)> {
        std::mem::take(&mut self.undecided)
    }

    /// Returns whether packets that wait may be unwanted.
    pub fn take_decided(&mut self) -> bool {
        std::mem::take(&mut self.has_decided)
    }

    /// Decides who takes a message of a source.
    pub fn decide(&mut self, source: (u8, u8), message_id: u32, decision: Decision) {
        self.entries.entry(key(source.0, source.1, message_id)).or_default().decision = decision;
        self.has_decided |= decision.interest == Interest::Nothing;
        self.bound_entries();
    }

    /// Returns whether the program decided that no part of it takes the message of a packet.
    #[must_use]
    pub fn is_unwanted(&self, header: &Header) -> bool {
        let known = self.entries.get(&key(header.system, header.component, header.message_id));
        known.is_some_and(|entry| entry.decision == Decision { interest: Interest::Nothing, is_listened: false })
    }

    /// Forgets the decisions about a message (`None`: all messages) of a system (0: all systems).
    pub fn forget_interest(&mut self, message_id: Option<u32>, system: u8) {
        for (&key, entry) in &mut self.entries {
            if matches(key, message_id, system) {
                entry.decision = Decision::default();
            }
        }
    }
}
