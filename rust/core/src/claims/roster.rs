//! The senders themselves, for programs that have no ports of their own: place, group, proof, and who makes room.

use super::{Authority, Paths};
use std::cmp::Reverse;
use std::collections::HashMap;

/// Senders at a time.
pub const MAX_SENDERS: usize = 4096;
/// Microseconds for which a sender that was heard more than once is heard at least.
const MIN_HEARD: u64 = 1_000_000;
/// Microseconds of silence after which any unauthenticated sender makes room.
const IDLE: u64 = 10_000_000;
/// Senders of one host that are no crowd.
const FAIR_SHARE: usize = 8;

/// A sender.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Party {
    /// The link that it belongs to.
    pub place: usize,
    /// The group of redundant links that its link belongs to; 0: none.
    pub group: usize,
    /// The host that it comes from, as any number; senders of one host have a common share of the room.
    pub host: u64,
    pub authority: Authority,
    pub opened_at: u64,
    pub heard_at: u64,
}

/// All open senders, by their index.
#[derive(Debug, Default)]
pub struct Roster {
    parties: Vec<Option<Party>>,
    free: Vec<usize>,
}

impl Roster {
    /// Adds a sender and returns its index, which may be that of a closed one; `None`: there are [`MAX_SENDERS`].
    pub fn open(&mut self, party: Party) -> Option<usize> {
        let party = Some(party);
        if let Some(index) = self.free.pop() {
            self.parties[index] = party;
            return Some(index);
        }
        (self.parties.len() < MAX_SENDERS).then(|| {
            self.parties.push(party);
            self.parties.len() - 1
        })
    }

    /// Removes a sender; returns whether it was open.
    pub fn close(&mut self, sender: usize) -> bool {
        let is_open = self.parties.get_mut(sender).is_some_and(|party| party.take().is_some());
        if is_open {
            self.free.push(sender);
        }
        is_open
    }

    #[must_use]
    pub fn get(&self, sender: usize) -> Option<&Party> {
        self.parties.get(sender)?.as_ref()
    }

    pub fn get_mut(&mut self, sender: usize) -> Option<&mut Party> {
        self.parties.get_mut(sender)?.as_mut()
    }

    /// Returns the sender that makes room for a newcomer; `None`: no sender does, and the newcomer is refused.
    ///
    /// Unauthenticated senders make room first: of these the ones of a host with more than its share, then those that
    /// were heard for a moment only, then those that have been silent for longest. One that is no better proven than the
    /// newcomer makes room only if its host is more crowded, or after some silence.
    #[must_use]
    pub fn first_to_evict(&self, newcomer: &Party, place: Option<usize>, now: u64) -> Option<usize> {
        let is_here = |party: &Party| place.is_none_or(|place| party.place == place);
        let open = || {
            let all = self.parties.iter().enumerate();
            all.filter_map(|(index, party)| Some((index, party.as_ref()?))).filter(|(_, party)| is_here(party))
        };
        let mut of_host: HashMap<u64, usize> = HashMap::new();
        open().filter(|(_, party)| !party.is_proven()).for_each(|(_, party)| {
            *of_host.entry(party.host).or_default() += 1;
        });
        let crowd = |party: &Party| of_host.get(&party.host).map_or(0, |count| count.saturating_sub(FAIR_SHARE));
        let order = |party: &Party| (party.is_proven(), Reverse(crowd(party)), !party.is_brief(), party.heard_at);
        let (index, party) = open().min_by_key(|(index, party)| (order(party), *index))?;
        let silence = now.saturating_sub(party.heard_at);
        let is_gone = silence >= if party.is_brief() { MIN_HEARD } else { IDLE };
        let may_replace = match (newcomer.is_proven(), party.is_proven()) {
            (true, false) => true,
            (true, true) => silence >= IDLE,
            (false, true) => false,
            (false, false) => is_gone || crowd(party) > crowd(newcomer),
        };
        may_replace.then_some(index)
    }
}

impl Party {
    fn is_proven(&self) -> bool {
        self.authority.is_authenticated()
    }

    fn is_brief(&self) -> bool {
        self.heard_at.saturating_sub(self.opened_at) < MIN_HEARD
    }
}

impl Paths for Roster {
    fn place(&self, sender: usize) -> usize {
        self.get(sender).map_or(usize::MAX, |party| party.place)
    }

    fn shares_group(&self, one: usize, other: usize) -> bool {
        let group = |sender| self.get(sender).map_or(0, |party| party.group);
        group(one) != 0 && group(one) == group(other)
    }
}
