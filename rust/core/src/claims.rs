//! Who is speaking: the claims of senders on addresses, in one bounded table.
//!
//! A *sender* is an index that the caller gives to one channel: a stream, or one peer of a socket. It claims an address
//! (system, component) by each packet that names it. One sender holds an address:
//!
//! - An authenticated claim outranks one that is not, also when it has been silent: nothing unauthenticated costs an
//!   authenticated sender anything.
//! - Among equals the sender that was heard first holds the address while it is heard. After [`SILENCE`] microseconds
//!   without a packet another one takes over, and packets for the address go to both, so that an outage costs no
//!   vehicle its route. When the first sender is heard again, within [`MEMORY`] microseconds, it holds the address again.
//! - Redundant links share an address: senders of one group at different places, senders whose signatures were verified,
//!   and ground stations, which have one default address.
//!
//! Any other claim is *contested*: it leads nowhere. One whose boot clock agrees with that of the holder is a *path* of
//! the same source; clocks can be copied, so it leads nowhere either while the holder is heard, but is no conflict.
//!
//! System 0 is never claimed. Component 0 stands for all components of its system. If the table is full, addresses that
//! were heard for a moment only are forgotten first, then silent ones, and authenticated ones last. Of the claims on one
//! address, contested ones are forgotten before others, and newer ones before older ones.

mod address;
mod conflict;
mod roster;

pub use address::{Claim, MAX_CLAIMS};
pub use conflict::{CONFLICT_END, Conflict, Contradiction};
pub use roster::{MAX_SENDERS, Party, Roster};

use crate::index_set::IndexSet;
use crate::sequence::SourceHasher;
use address::Entry;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;

/// Addresses in the table, and how many are forgotten at once when it is full.
pub const MAX_ADDRESSES: usize = 4096;
const FORGOTTEN_AT_ONCE: usize = 512;
/// Microseconds without a packet after which another sender may hold an address.
pub const SILENCE: u64 = 2_500_000;
/// Microseconds for which a silent sender keeps its place before those that were heard later.
pub const MEMORY: u64 = 60_000_000;

/// How the identity of a sender is proven.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Authority {
    #[default]
    None,
    /// A session of a server, opened by a password.
    Session,
    Ticket,
    Certificate,
    /// A signing key.
    Key,
}

impl Authority {
    #[inline]
    #[must_use]
    pub fn is_authenticated(self) -> bool {
        self != Self::None
    }
}

/// The standing of a sender's claim on an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// It holds the address.
    Held,
    /// It holds the address, which no other sender claimed before.
    New,
    /// It is a redundant link of the holder, or has its clock.
    Shared,
    /// Another sender, which is no better proven, holds the address.
    Contested,
    /// An authenticated sender holds the address, and this one is not authenticated: it is not to be trusted.
    Outranked,
}

/// The comparison of the boot time of a packet with those before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BootClock {
    Agrees,
    /// The source rebooted; the sender of the packet holds the address now.
    Rebooted,
    /// Another clock, of a sender that does not hold the address.
    Differs,
}

/// The links of the senders, which the caller knows.
pub trait Paths {
    /// The link that a sender belongs to: the socket of a peer.
    fn place(&self, sender: usize) -> usize;

    /// Returns whether two senders are redundant links of one group.
    fn shares_group(&self, one: usize, other: usize) -> bool;
}

/// The senders that lead to one system.
#[derive(Clone, Debug, Default)]
struct System {
    leading: IndexSet,
    authenticated: IndexSet,
}

impl System {
    fn routes(&self) -> Option<&IndexSet> {
        let routes = if self.authenticated.is_empty() { &self.leading } else { &self.authenticated };
        (!routes.is_empty()).then_some(routes)
    }
}

/// All claims. Times are monotonic, in microseconds.
#[derive(Debug)]
pub struct Claims {
    entries: HashMap<u16, Entry, BuildHasherDefault<SourceHasher>>,
    systems: Vec<System>,
    /// The senders with claims.
    claimants: IndexSet,
    silence: u64,
}

impl Default for Claims {
    fn default() -> Self {
        Self::new(SILENCE)
    }
}

fn key(system: u8, component: u8) -> u16 {
    u16::from_be_bytes([system, component])
}

impl Claims {
    /// Creates a table in which an address may change its holder after `silence` microseconds.
    #[must_use]
    pub fn new(silence: u64) -> Self {
        Self {
            entries: HashMap::default(),
            systems: vec![System::default(); 256],
            claimants: IndexSet::default(),
            silence,
        }
    }

    /// Records a packet of an address that came from a sender; `authority`: how this packet, or the sender, is proven.
    #[inline]
    pub fn hear(
        &mut self,
        (system, component): (u8, u8),
        sender: usize,
        authority: Authority,
        now: u64,
        paths: &impl Paths,
    ) -> Standing {
        if let Some(entry) = self.entries.get_mut(&key(system, component)) {
            if entry.hear_holder(sender, authority, now) {
                return Standing::Held;
            }
            return self.hear_other((system, component), sender, authority, now, paths);
        }
        if system == 0 {
            return Standing::Held;
        }
        self.insert((system, component), sender, authority, now);
        Standing::New
    }

    #[cold]
    fn hear_other(
        &mut self,
        (system, component): (u8, u8),
        sender: usize,
        authority: Authority,
        now: u64,
        paths: &impl Paths,
    ) -> Standing {
        let Some(entry) = self.entries.get_mut(&key(system, component)) else {
            return Standing::Held;
        };
        self.claimants.insert(sender);
        let (standing, is_changed) = entry.hear(sender, authority, now, self.silence, paths);
        if is_changed {
            self.update_system(system);
        }
        standing
    }

    #[cold]
    fn insert(&mut self, (system, component): (u8, u8), sender: usize, authority: Authority, now: u64) {
        if self.entries.len() >= MAX_ADDRESSES {
            self.make_room();
        }
        self.claimants.insert(sender);
        self.entries.insert(key(system, component), Entry::new(Claim::new(sender, authority, now)));
        let routes = &mut self.systems[usize::from(system)];
        routes.leading.insert(sender);
        if authority.is_authenticated() {
            routes.authenticated.insert(sender);
        }
    }

    /// Returns the standing that a packet would have, and records nothing.
    #[must_use]
    pub fn standing(
        &self,
        (system, component): (u8, u8),
        sender: usize,
        authority: Authority,
        now: u64,
        paths: &impl Paths,
    ) -> Standing {
        match self.entries.get(&key(system, component)) {
            None => Standing::New,
            Some(entry) => entry.clone().hear(sender, authority, now, self.silence, paths).0,
        }
    }

    /// Records whether a sender's heartbeat for an address is that of a ground station.
    pub fn note_ground_station(&mut self, (system, component): (u8, u8), sender: usize, is_station: bool) {
        if self
            .entries
            .get_mut(&key(system, component))
            .is_some_and(|entry| entry.note_ground_station(sender, is_station))
        {
            self.update_system(system);
        }
    }

    /// Records the boot time that an address sent over a sender, in milliseconds.
    pub fn note_boot_time(
        &mut self,
        (system, component): (u8, u8),
        sender: usize,
        boot_time: u32,
        now: u64,
    ) -> BootClock {
        let Some(entry) = self.entries.get_mut(&key(system, component)) else {
            return BootClock::Agrees;
        };
        let (clock, is_changed) = entry.note_boot_time(sender, boot_time, now);
        if is_changed {
            self.update_system(system);
        }
        clock
    }

    /// Returns the senders that lead to a target, whose system is not 0; `None`: its system was never heard.
    #[inline]
    #[must_use]
    pub fn routes(&self, system: u8, component: u8) -> Option<&IndexSet> {
        let entry = if component == 0 { None } else { self.entries.get(&key(system, component)) };
        entry.map(Entry::routes).or_else(|| self.systems[usize::from(system)].routes())
    }

    /// The claims on an address, the holder's first.
    pub fn claims_on(&self, system: u8, component: u8) -> impl Iterator<Item = &Claim> {
        self.entries.get(&key(system, component)).into_iter().flat_map(Entry::claims)
    }

    /// The claim of the sender that holds an address.
    #[must_use]
    pub fn holder(&self, system: u8, component: u8) -> Option<&Claim> {
        self.claims_on(system, component).next()
    }

    /// Returns whether an authenticated sender holds an address.
    #[must_use]
    pub fn is_authenticated(&self, system: u8, component: u8) -> bool {
        self.holder(system, component).is_some_and(|holder| holder.authority.is_authenticated())
    }

    /// All addresses, ordered by their ids.
    #[must_use]
    pub fn addresses(&self) -> Vec<(u8, u8)> {
        let mut keys: Vec<_> = self.entries.keys().map(|key| key.to_be_bytes().into()).collect();
        keys.sort_unstable();
        keys
    }

    /// Forgets a closed sender.
    pub fn remove(&mut self, sender: usize) {
        if !self.claimants.contains(sender) {
            return;
        }
        self.claimants.remove(sender);
        self.entries.retain(|_, entry| entry.remove(sender));
        self.update_systems();
    }

    /// Forgets what authenticated the claims of a sender: its key changed, or its session ended.
    pub fn withdraw(&mut self, sender: usize) {
        self.entries.values_mut().for_each(|entry| entry.withdraw(sender));
        self.update_systems();
    }

    // Conflicts

    /// Records that packets of an address contradict each other, the newer one from a sender.
    ///
    /// Returns whether a conflict begins. An unauthenticated sender cannot contradict an authenticated holder.
    pub fn contradict(
        &mut self,
        (system, component): (u8, u8),
        sender: usize,
        contradiction: Contradiction,
        now: u64,
    ) -> bool {
        self.entries.get_mut(&key(system, component)).is_some_and(|entry| entry.contradict(sender, contradiction, now))
    }

    /// The conflict about an address, until it ends.
    #[must_use]
    pub fn conflict(&self, system: u8, component: u8) -> Option<&Conflict> {
        self.entries.get(&key(system, component)).and_then(Entry::conflict)
    }

    /// Ends the conflicts without a contradiction in [`CONFLICT_END`] microseconds, and returns their addresses.
    pub fn end_conflicts(&mut self, now: u64) -> Vec<(u8, u8)> {
        let ended = self.entries.iter_mut().filter_map(|(key, entry)| {
            let (system, component) = key.to_be_bytes().into();
            entry.end_conflict(now).then_some((system, component))
        });
        let mut ended: Vec<_> = ended.collect();
        ended.sort_unstable();
        ended
    }

    // Upkeep

    fn make_room(&mut self) {
        let mut order: Vec<_> = self.entries.iter().map(|(&key, entry)| (entry.removal_order(), key)).collect();
        order.select_nth_unstable(FORGOTTEN_AT_ONCE);
        for &(_, key) in &order[..FORGOTTEN_AT_ONCE] {
            self.entries.remove(&key);
        }
        self.update_systems();
    }

    fn update_systems(&mut self) {
        self.systems.fill(System::default());
        for (key, entry) in &self.entries {
            add_routes(&mut self.systems[usize::from(key >> 8)], entry);
        }
    }

    fn update_system(&mut self, system: u8) {
        let mut routes = System::default();
        for component in 0..=u8::MAX {
            if let Some(entry) = self.entries.get(&key(system, component)) {
                add_routes(&mut routes, entry);
            }
        }
        self.systems[usize::from(system)] = routes;
    }
}

fn add_routes(system: &mut System, entry: &Entry) {
    system.leading.extend(entry.routes());
    if entry.is_authenticated() {
        system.authenticated.extend(entry.routes());
    }
}

#[cfg(test)]
#[path = "claims_tests.rs"]
mod tests;
