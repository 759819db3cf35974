//! Conflicts: several sources with one address.

/// Microseconds without a contradiction after which a conflict has ended.
pub const CONFLICT_END: u64 = 30_000_000;
/// Senders that a conflict names.
const MAX_NAMED: usize = 4;

/// A property in which two packets of one address contradict each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Contradiction {
    /// They came from different senders at the same time, which do not share the address.
    Sender = 1,
    BootTime = 2,
    UniqueId = 4,
    Type = 8,
    Position = 16,
}

impl Contradiction {
    /// All contradictions.
    pub const ALL: [Self; 5] = [Self::Sender, Self::BootTime, Self::UniqueId, Self::Type, Self::Position];
}

/// A conflict about one address.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Conflict {
    pub began_at: u64,
    pub contradicted_at: u64,
    /// The senders that it is between, at most four, the holder first.
    pub senders: Vec<usize>,
    kinds: u8,
}

impl Conflict {
    pub(super) fn new(now: u64) -> Self {
        Self { began_at: now, ..Self::default() }
    }

    pub(super) fn record(&mut self, kind: Contradiction, senders: [usize; 2], now: u64) {
        self.contradicted_at = now;
        self.kinds |= kind as u8;
        for sender in senders {
            if self.senders.len() < MAX_NAMED && !self.senders.contains(&sender) {
                self.senders.push(sender);
            }
        }
    }

    /// The contradictions since it began.
    pub fn contradictions(&self) -> impl Iterator<Item = Contradiction> {
        let kinds = self.kinds;
        Contradiction::ALL.into_iter().filter(move |kind| kinds & *kind as u8 != 0)
    }

    pub(super) fn has_ended(&self, now: u64) -> bool {
        now.saturating_sub(self.contradicted_at) >= CONFLICT_END
    }
}
