//! The packets that wait for a slow stream: a lane for each endpoint that they come from.
//!
//! The lanes take turns, [`QUANTUM`] bytes each, so that a packet waits for the packets of its own endpoint, and for one
//! turn of each other: a flood delays a command of another endpoint by one packet. Within a lane the order stays.

use crate::engine::shares::Shares;
use crate::router::{Origin, QueueFull};
use std::collections::VecDeque;

/// Bytes of a turn: at least those of the longest packet in a frame.
const QUANTUM: usize = 300;

/// The packets of one endpoint.
#[derive(Debug, Default)]
struct Lane {
    bytes: Vec<u8>,
    start: usize,
    lengths: VecDeque<usize>,
    credit: usize,
}

impl Lane {
    /// Moves the packets of one turn to `out`; returns their bytes.
    fn take_turn(&mut self, out: &mut Vec<u8>) -> usize {
        self.credit += QUANTUM;
        let mut end = self.start;
        while let Some(&length) = self.lengths.front()
            && length <= self.credit
        {
            self.lengths.pop_front();
            self.credit -= length;
            end += length;
        }
        let taken = end - self.start;
        out.extend_from_slice(&self.bytes[self.start..end]);
        self.start = end;
        if self.lengths.is_empty() {
            self.bytes.clear();
            (self.start, self.credit) = (0, 0);
        } else if self.start > self.bytes.len() / 2 {
            self.bytes.drain(..self.start);
            self.start = 0;
        }
        taken
    }
}

/// All packets that wait for one stream.
#[derive(Debug, Default)]
pub struct Lanes {
    /// By the index of the endpoint.
    all: Vec<Lane>,
    /// The lanes with packets, the next one first.
    turns: VecDeque<usize>,
    shares: Shares,
    waiting: usize,
}

impl Lanes {
    /// Number of bytes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.waiting
    }

    /// Adds a packet after its prefix, if `free` bytes leave room for it and its endpoint has no more than its share.
    #[inline]
    pub fn push(&mut self, origin: Origin, prefix: &[u8], packet: &[u8], free: usize) -> Result<(), QueueFull> {
        let length = prefix.len() + packet.len();
        self.shares.add(origin, length, free)?;
        if self.all.len() <= origin.endpoint {
            self.all.resize_with(origin.endpoint + 1, Lane::default);
        }
        let lane = &mut self.all[origin.endpoint];
        if lane.lengths.is_empty() {
            self.turns.push_back(origin.endpoint);
        }
        lane.bytes.extend_from_slice(prefix);
        lane.bytes.extend_from_slice(packet);
        lane.lengths.push_back(length);
        self.waiting += length;
        Ok(())
    }

    /// Moves packets to `out` until that has `enough` bytes.
    pub fn take(&mut self, out: &mut Vec<u8>, enough: usize) {
        while out.len() < enough
            && let Some(endpoint) = self.turns.pop_front()
        {
            let lane = &mut self.all[endpoint];
            let taken = lane.take_turn(out);
            if !lane.lengths.is_empty() {
                self.turns.push_back(endpoint);
            }
            self.shares.remove(endpoint, taken);
            self.waiting -= taken;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMIT: usize = 100_000;

    fn push(lanes: &mut Lanes, endpoint: usize, packet: &[u8]) -> Result<(), QueueFull> {
        let free = LIMIT - lanes.len();
        lanes.push(Origin { endpoint, is_urgent: false }, b"", packet, free)
    }

    #[test]
    fn a_command_waits_for_one_turn_of_a_flood() {
        let mut lanes = Lanes::default();
        while push(&mut lanes, 1, &[1; 100]).is_ok() {}
        assert_eq!(lanes.len(), LIMIT / 2);
        assert_eq!(push(&mut lanes, 2, &[2; 50]), Ok(()));
        let mut sent = Vec::new();
        lanes.take(&mut sent, 350);
        assert_eq!(sent, [vec![1; 300], vec![2; 50]].concat());
    }

    #[test]
    fn lanes_share_the_bytes_and_keep_their_order() {
        let length_of = |endpoint: u8| if endpoint == 1 { 250 } else { 10 };
        let mut lanes = Lanes::default();
        for number in 0..60 {
            for endpoint in [1, 2] {
                let mut packet = vec![0; length_of(endpoint)];
                packet[..2].copy_from_slice(&[endpoint, number]);
                push(&mut lanes, usize::from(endpoint), &packet).expect("room");
            }
        }
        let mut sent = Vec::new();
        while lanes.len() > 0 {
            let enough = sent.len() + 1;
            lanes.take(&mut sent, enough);
        }
        let mut order = Vec::new();
        let mut rest = &sent[..];
        while let [endpoint, number, ..] = *rest {
            order.push((endpoint, number));
            rest = &rest[length_of(endpoint)..];
        }
        let of = |wanted: u8| order.iter().filter(move |(endpoint, _)| *endpoint == wanted).map(|(_, number)| *number);
        assert!(of(1).eq(0..60) && of(2).eq(0..60));
        let last_short = order.iter().rposition(|packet| *packet == (2, 59)).expect("sent");
        assert!(last_short < 64, "600 short bytes leave with 600 long ones");
    }
}
