//! The shares of the endpoints in a queue, in bytes or in packets.
//!
//! An endpoint may fill as much of a queue as it leaves free, so that there is always room for others: one that floods
//! has half of the queue, two have a third each. Packets with a target, and heartbeats, may fill four times as much as
//! they leave free.

use crate::router::{Origin, QueueFull};

/// The part of a queue that an endpoint may have for each part that is free.
const SHARE: usize = 1;
const URGENT_SHARE: usize = 4;

/// How much of a queue each endpoint has, by its index.
#[derive(Debug, Default)]
pub struct Shares {
    used: Vec<usize>,
}

impl Shares {
    /// Adds a packet to a queue with `free` room, if the share of its endpoint allows it.
    #[inline]
    pub fn add(&mut self, origin: Origin, amount: usize, free: usize) -> Result<(), QueueFull> {
        if self.used.len() <= origin.endpoint {
            self.used.resize(origin.endpoint + 1, 0);
        }
        let used = &mut self.used[origin.endpoint];
        let share = if origin.is_urgent { URGENT_SHARE } else { SHARE };
        if amount > free || *used + amount > free.saturating_mul(share) {
            return Err(QueueFull);
        }
        *used += amount;
        Ok(())
    }

    /// Removes what was sent.
    #[inline]
    pub fn remove(&mut self, endpoint: usize, amount: usize) {
        if let Some(used) = self.used.get_mut(endpoint) {
            *used = used.saturating_sub(amount);
        }
    }

    /// Removes everything.
    pub fn clear(&mut self) {
        self.used.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FLOOD: Origin = Origin { endpoint: 1, is_urgent: false };
    const OTHER: Origin = Origin { endpoint: 2, is_urgent: false };
    const COMMAND: Origin = Origin { endpoint: 3, is_urgent: true };

    /// Fills a queue of 1,000 bytes, of which `used` are taken; returns the bytes that fitted.
    fn fill(shares: &mut Shares, origin: Origin, used: usize) -> usize {
        (0..).step_by(10).find(|added| shares.add(origin, 10, 1000 - used - added).is_err()).unwrap_or(0)
    }

    #[test]
    fn a_flood_leaves_room_for_others_and_commands_have_a_reserve() {
        let mut shares = Shares::default();
        assert_eq!(fill(&mut shares, FLOOD, 0), 500);
        assert_eq!(fill(&mut shares, OTHER, 500), 250);
        assert_eq!(fill(&mut shares, FLOOD, 750), 0);
        assert_eq!(fill(&mut shares, COMMAND, 750), 200);
        assert_eq!(shares.add(COMMAND, 60, 50), Err(QueueFull));
        shares.remove(FLOOD.endpoint, 300);
        assert_eq!(fill(&mut shares, FLOOD, 650), 80);
        shares.clear();
        assert_eq!(fill(&mut shares, FLOOD, 0), 500);
    }

    #[test]
    fn a_queue_of_one_packet_takes_one() {
        let mut shares = Shares::default();
        assert_eq!((shares.add(FLOOD, 1, 1), shares.add(OTHER, 1, 0)), (Ok(()), Err(QueueFull)));
    }
}
