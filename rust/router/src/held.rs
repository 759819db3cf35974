//! Packets that wait for a decision of the program.

use crate::gateway::Admission;
use mavstack_core::header::Header;
use mavstack_core::layout::Dialect;
use mavstack_core::parser::Packet;
use std::collections::{BTreeMap, HashMap};

/// Packets that wait at a time; then the oldest are dropped.
const MAX_HELD: usize = 1024;
/// Packets that wait at a time from one port at another: a flood must not displace the packets of others.
const MAX_HELD_OF_PORT: usize = 128;
/// Microseconds after which a packet is dropped.
const MAX_HELD_TIME: u64 = 5_000_000;

/// A packet that waits. Ports are named by their serial numbers, since they may be removed meanwhile.
#[derive(Debug)]
pub struct Held {
    pub from: u64,
    /// The port whose rules hold it.
    pub port: u64,
    pub outgoing: bool,
    pub admission: Admission,
    pub raw: Vec<u8>,
    pub at: u64,
}

impl Held {
    pub fn is_expired(&self, now: u64) -> bool {
        self.at + MAX_HELD_TIME < now
    }

    pub fn packet(&self, dialect: &Dialect) -> Option<Packet<'_>> {
        let header = Header::parse(&self.raw)?;
        let slot = dialect.entry(header.message_id).map(|entry| entry.slot);
        Some(Packet { raw: &self.raw, header, slot, timestamp: None })
    }
}

/// All packets that wait, by token.
#[derive(Debug, Default)]
pub struct HeldPackets {
    packets: BTreeMap<u64, Held>,
    /// Their number by serial numbers of both ports.
    waiting: HashMap<(u64, u64), usize>,
    last_token: u64,
}

impl HeldPackets {
    /// Keeps a packet; returns its token, and the packets that waited for too long. `None`: too many of its port wait.
    pub fn insert(&mut self, held: Held) -> (Option<u64>, Vec<Held>) {
        let now = held.at;
        let mut expired = Vec::new();
        let mut is_full = self.packets.len() >= MAX_HELD;
        while let Some(first) = self.packets.first_entry()
            && (is_full || first.get().is_expired(now))
        {
            let first = first.remove();
            self.release(&first);
            expired.push(first);
            is_full = false;
        }
        let waiting = self.waiting.entry((held.from, held.port)).or_default();
        if *waiting >= MAX_HELD_OF_PORT {
            return (None, expired);
        }
        *waiting += 1;
        self.last_token += 1;
        self.packets.insert(self.last_token, held);
        (Some(self.last_token), expired)
    }

    /// Returns whether a packet from a port waits.
    pub fn is_waiting(&self, from: u64) -> bool {
        self.waiting.keys().any(|(sender, _)| *sender == from)
    }

    pub fn remove(&mut self, token: u64) -> Option<Held> {
        let held = self.packets.remove(&token)?;
        self.release(&held);
        Some(held)
    }

    fn release(&mut self, held: &Held) {
        let ports = (held.from, held.port);
        if let Some(waiting) = self.waiting.get_mut(&ports) {
            *waiting -= 1;
            if *waiting == 0 {
                self.waiting.remove(&ports);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(from: u64, at: u64) -> Held {
        Held { from, port: 1, outgoing: false, admission: Admission::default(), raw: vec![1], at }
    }

    #[test]
    fn packets_wait_for_a_bounded_time_and_in_a_bounded_number() {
        let mut packets = HeldPackets::default();
        let first = packets.insert(held(1, 0)).0.expect("room");
        let (second, expired) = packets.insert(held(1, 1));
        assert!(expired.is_empty() && packets.remove(first).is_some() && packets.remove(first).is_none());
        let (_, expired) = packets.insert(held(1, MAX_HELD_TIME + 2));
        assert!(expired.len() == 1 && packets.remove(second.expect("room")).is_none());
        let port = |number: usize| (number / MAX_HELD_OF_PORT) as u64 + 2;
        let dropped: usize =
            (0..2 * MAX_HELD).map(|number| packets.insert(held(port(number), MAX_HELD_TIME + 2)).1.len()).sum();
        assert_eq!((packets.packets.len(), dropped), (MAX_HELD, MAX_HELD + 1));
    }

    #[test]
    fn a_flood_displaces_no_packet_of_another_port() {
        let mut packets = HeldPackets::default();
        let command = packets.insert(held(1, 0)).0.expect("room");
        let kept = (0..10 * MAX_HELD).filter(|_| packets.insert(held(2, 1)).0.is_some()).count();
        assert_eq!((kept, packets.remove(command).is_some()), (MAX_HELD_OF_PORT, true));
        let last = packets.last_token;
        assert!(packets.remove(last).is_some() && packets.insert(held(2, 1)).0.is_some(), "one more after a decision");
    }
}
