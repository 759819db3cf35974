//! The claims on one address.

use super::conflict::{Conflict, Contradiction};
use super::{Authority, BootClock, MEMORY, Paths, Standing};
use crate::index_set::IndexSet;

/// Claims on one address.
pub const MAX_CLAIMS: usize = 32;
/// Microseconds for which a sender that was heard more than once is heard at least.
const MIN_HEARD: u64 = 1_000_000;
/// Milliseconds by which boot times of one source may differ: packets of redundant links overtake each other.
const BOOT_TIME_SLACK: u64 = 2_000;

/// The claim of one sender on one address.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Claim {
    pub sender: usize,
    /// The best proof of its packets.
    pub authority: Authority,
    /// The time of its first packet; a silence longer than [`MEMORY`] counts as the end of an earlier claim.
    pub since: u64,
    pub heard_at: u64,
    /// Packets for the address go to this sender.
    pub leads: bool,
    /// Its boot clock is that of the holder.
    pub has_clock: bool,
    /// Its last heartbeat was that of a ground station.
    pub is_station: bool,
}

impl Claim {
    pub(super) fn new(sender: usize, authority: Authority, now: u64) -> Self {
        Self { sender, authority, since: now, heard_at: now, leads: true, has_clock: false, is_station: false }
    }

    fn is_authenticated(&self) -> bool {
        self.authority.is_authenticated()
    }

    /// Orders claims that are to be forgotten first to the front.
    fn removal_order(&self) -> (bool, bool, bool, std::cmp::Reverse<u64>) {
        let is_brief = self.heard_at - self.since < MIN_HEARD;
        (self.is_authenticated(), self.leads, !is_brief, std::cmp::Reverse(self.since))
    }
}

/// The boot time of a source, in milliseconds, and the time of the packet that carried it.
#[derive(Clone, Copy, Debug)]
struct BootTime {
    value: u32,
    at: u64,
}

/// All claims on one address.
#[derive(Clone, Debug)]
pub(super) struct Entry {
    holder: Claim,
    others: Vec<Claim>,
    routes: IndexSet,
    boot_time: Option<BootTime>,
    conflict: Option<Box<Conflict>>,
}

impl Entry {
    pub fn new(holder: Claim) -> Self {
        let mut entry =
            Self { holder, others: Vec::new(), routes: IndexSet::default(), boot_time: None, conflict: None };
        entry.update_routes();
        entry
    }

    pub fn claims(&self) -> impl Iterator<Item = &Claim> {
        std::iter::once(&self.holder).chain(&self.others)
    }

    pub fn claim_mut(&mut self, sender: usize) -> Option<&mut Claim> {
        std::iter::once(&mut self.holder).chain(&mut self.others).find(|claim| claim.sender == sender)
    }

    #[inline]
    pub fn routes(&self) -> &IndexSet {
        &self.routes
    }

    pub fn is_authenticated(&self) -> bool {
        self.holder.is_authenticated()
    }

    pub fn removal_order(&self) -> (bool, bool, u64) {
        let holder = &self.holder;
        (holder.is_authenticated(), holder.heard_at - holder.since >= MIN_HEARD, holder.heard_at)
    }

    /// Records a packet of the holder; returns false if the sender is another one, or better proven than before.
    #[inline]
    pub fn hear_holder(&mut self, sender: usize, authority: Authority, now: u64) -> bool {
        let is_holder = self.holder.sender == sender && authority <= self.holder.authority;
        if is_holder {
            self.holder.heard_at = now;
        }
        is_holder
    }

    /// Records a packet; returns its standing, and whether the routes changed.
    pub fn hear(
        &mut self,
        sender: usize,
        authority: Authority,
        now: u64,
        silence: u64,
        paths: &impl Paths,
    ) -> (Standing, bool) {
        if self.holder.sender == sender {
            self.holder.heard_at = now;
            self.holder.authority = self.holder.authority.max(authority);
            return (Standing::Held, self.settle(paths));
        }
        let index = self.find_or_add(sender, now);
        let mine = &mut self.others[index];
        // An unproven packet gains nothing from earlier proven ones of its sender, whose address it may have forged.
        if mine.is_authenticated() && !authority.is_authenticated() && self.holder.is_authenticated() {
            return (if mine.leads { Standing::Shared } else { Standing::Contested }, false);
        }
        if now.saturating_sub(mine.heard_at) > MEMORY {
            (mine.since, mine.has_clock) = (now, false);
        }
        mine.heard_at = now;
        mine.authority = mine.authority.max(authority);
        let standing = self.standing_of(index, now, silence, paths);
        match standing {
            Standing::Held => std::mem::swap(&mut self.holder, &mut self.others[index]),
            Standing::Shared => {}
            // A refused claim gains no place for the time after the authenticated one.
            Standing::Outranked => drop(self.others.swap_remove(index)),
            _ => self.others[index].leads = false,
        }
        self.holder.leads = true;
        (standing, self.settle(paths))
    }

    fn find_or_add(&mut self, sender: usize, now: u64) -> usize {
        if let Some(index) = self.others.iter().position(|claim| claim.sender == sender) {
            return index;
        }
        if self.others.len() + 1 >= MAX_CLAIMS {
            let order = self.others.iter().enumerate().min_by_key(|(_, claim)| claim.removal_order());
            if let Some((index, _)) = order {
                self.others.swap_remove(index);
            }
        }
        self.others.push(Claim { leads: false, ..Claim::new(sender, Authority::None, now) });
        self.others.len() - 1
    }

    /// Judges a claim that is not the holder's, and marks it if it leads to the address; `Held`: it is the holder's now.
    fn standing_of(&mut self, index: usize, now: u64, silence: u64, paths: &impl Paths) -> Standing {
        let (mine, holder) = (&self.others[index], &self.holder);
        match (mine.is_authenticated(), holder.is_authenticated()) {
            (true, false) => return Standing::Held,
            (false, true) => return Standing::Outranked,
            _ => {}
        }
        let is_shared = self.shares(mine, paths);
        let is_senior = mine.since < holder.since;
        if is_shared && !is_senior {
            self.others[index].leads = true;
            return Standing::Shared;
        }
        let heard_at = self.claims().filter(|claim| claim.leads).map(|claim| claim.heard_at).max();
        if is_senior || heard_at.is_none_or(|at| now.saturating_sub(at) >= silence) {
            return Standing::Held;
        }
        if mine.has_clock { Standing::Shared } else { Standing::Contested }
    }

    /// Returns whether a claim is that of a redundant link of the holder.
    fn shares(&self, mine: &Claim, paths: &impl Paths) -> bool {
        let holder = &self.holder;
        let is_key = |claim: &Claim| claim.authority == Authority::Key;
        if (is_key(mine) && is_key(holder)) || (mine.is_station && holder.is_station) {
            return true;
        }
        // A group has one sender at each of its places: another peer of a socket is a stranger.
        let place = paths.place(mine.sender);
        let is_first = |other: &Claim| {
            other.sender == mine.sender
                || paths.place(other.sender) != place
                || other.since > mine.since
                || !other.leads
        };
        paths.shares_group(mine.sender, holder.sender) && self.claims().all(is_first)
    }

    /// Withdraws what no longer leads to the address; returns whether the routes changed.
    fn settle(&mut self, paths: &impl Paths) -> bool {
        for index in 0..self.others.len() {
            let (mine, holder) = (&self.others[index], &self.holder);
            let is_equal = mine.is_authenticated() == holder.is_authenticated();
            // A sender that was here before the holder, and is silent, may be heard again.
            let leads = mine.leads && is_equal && (mine.since < holder.since || self.shares(mine, paths));
            self.others[index].leads = leads;
        }
        self.update_routes()
    }

    fn update_routes(&mut self) -> bool {
        let mut routes = IndexSet::default();
        self.claims().filter(|claim| claim.leads).for_each(|claim| {
            routes.insert(claim.sender);
        });
        let is_changed = routes != self.routes;
        self.routes = routes;
        is_changed
    }

    /// Forgets a sender; returns false if no claim is left.
    pub fn remove(&mut self, sender: usize) -> bool {
        self.others.retain(|claim| claim.sender != sender);
        if let Some(conflict) = &mut self.conflict {
            conflict.senders.retain(|known| *known != sender);
        }
        if self.holder.sender == sender {
            if self.others.is_empty() {
                return false;
            }
            let heir = self.heir();
            self.holder = self.others.swap_remove(heir);
            self.holder.leads = true;
        }
        self.update_routes();
        true
    }

    /// The claim, other than the holder's, with the best right to the address.
    fn heir(&self) -> usize {
        let right = |claim: &Claim| (!claim.is_authenticated(), !claim.leads, claim.since);
        let first = self.others.iter().enumerate().min_by_key(|(_, claim)| right(claim));
        first.map_or(0, |(index, _)| index)
    }

    /// Forgets what authenticated a sender.
    pub fn withdraw(&mut self, sender: usize) {
        let Some(claim) = self.claim_mut(sender) else {
            return;
        };
        claim.authority = Authority::None;
        if self.holder.sender == sender
            && let Some(best) = self.others.get(self.heir())
            && best.is_authenticated()
        {
            let heir = self.heir();
            std::mem::swap(&mut self.holder, &mut self.others[heir]);
            self.others[heir].leads = false;
            self.holder.leads = true;
        }
        self.update_routes();
    }

    /// Records whether a sender is a ground station; returns whether the routes changed.
    ///
    /// One beside a holder that is one too leads to the address from this heartbeat on, not from its next packet.
    pub fn note_ground_station(&mut self, sender: usize, is_station: bool) -> bool {
        let (holder_is_station, is_authenticated) = (self.holder.is_station, self.is_authenticated());
        let Some(claim) = self.claim_mut(sender) else {
            return false;
        };
        let is_new = is_station && !claim.is_station;
        claim.is_station = is_station;
        if !is_new || claim.leads || !holder_is_station || claim.is_authenticated() != is_authenticated {
            return false;
        }
        claim.leads = true;
        self.update_routes()
    }

    /// Compares a boot time with those before; returns whether the routes changed too.
    pub fn note_boot_time(&mut self, sender: usize, value: u32, now: u64) -> (BootClock, bool) {
        let Some(mine) = self.claim_mut(sender) else {
            return (BootClock::Differs, false);
        };
        if value == 0 {
            return (BootClock::Agrees, false); // its sender has no clock
        }
        if !mine.leads {
            let agrees = self.boot_time.is_some_and(|known| known.agrees(value, now));
            if let Some(mine) = self.claim_mut(sender) {
                mine.has_clock = agrees;
            }
            return (if agrees { BootClock::Agrees } else { BootClock::Differs }, false);
        }
        let last = self.boot_time.map_or(0, |known| known.value);
        let has_rebooted = u64::from(value) + BOOT_TIME_SLACK < u64::from(last);
        if has_rebooted || value >= last {
            self.boot_time = Some(BootTime { value, at: now });
        }
        if !has_rebooted {
            return (BootClock::Agrees, false);
        }
        let is_changed = !self.is_authenticated() && self.lead_alone(sender);
        (BootClock::Rebooted, is_changed)
    }

    /// Makes a sender the only one that leads to the address, since its source moved; returns whether that is new.
    fn lead_alone(&mut self, sender: usize) -> bool {
        if let Some(index) = self.others.iter().position(|claim| claim.sender == sender) {
            std::mem::swap(&mut self.holder, &mut self.others[index]);
        }
        self.others.iter_mut().for_each(|claim| (claim.leads, claim.has_clock) = (false, false));
        self.update_routes()
    }

    /// Records a contradiction; returns whether a conflict begins.
    pub fn contradict(&mut self, sender: usize, contradiction: Contradiction, now: u64) -> bool {
        let holder = self.holder.sender;
        let is_proven = self.claims().any(|claim| claim.sender == sender && claim.is_authenticated());
        if self.is_authenticated() && !is_proven {
            return false;
        }
        let is_new = self.conflict.as_ref().is_none_or(|known| known.has_ended(now));
        if is_new {
            self.conflict = Some(Box::new(Conflict::new(now)));
        }
        if let Some(conflict) = &mut self.conflict {
            conflict.record(contradiction, [holder, sender], now);
        }
        is_new
    }

    pub fn conflict(&self) -> Option<&Conflict> {
        self.conflict.as_deref()
    }

    /// Forgets a conflict that has ended; returns whether there was one.
    pub fn end_conflict(&mut self, now: u64) -> bool {
        self.conflict.take_if(|conflict| conflict.has_ended(now)).is_some()
    }
}

impl BootTime {
    fn agrees(&self, value: u32, now: u64) -> bool {
        let expected = u64::from(self.value) + now.saturating_sub(self.at) / 1000;
        expected.abs_diff(u64::from(value)) <= BOOT_TIME_SLACK
    }
}
