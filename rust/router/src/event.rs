//! Events for the program. The queue is bounded, and frequent notices of one kind are reported once a second.

use std::collections::{HashMap, HashSet, VecDeque};
use std::net::SocketAddr;

/// Number of an endpoint, never used again.
pub type EndpointNumber = u32;

/// Events that are kept for the program; more are dropped. Of links that closed, or have something to read, more are kept:
/// a program that misses those never opens or reads the link again.
const MAX_EVENTS: usize = 4096;
const MAX_LINK_EVENTS: usize = 16 * MAX_EVENTS;
/// Microseconds between two notices of one kind, and how many kinds are told apart.
pub(crate) const NOTICE_INTERVAL: u64 = 1_000_000;
const MAX_KINDS: usize = 1024;

/// Something that happened on an endpoint.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    Closed {
        endpoint: EndpointNumber,
        reason: String,
    },
    /// The engine ended by an internal error: nothing is forwarded any more.
    Ended,
    /// A queue endpoint has packets to pull.
    Readable {
        endpoint: EndpointNumber,
    },
    /// A packet waits for a decision.
    Inspect {
        token: u64,
        endpoint: EndpointNumber,
        outgoing: bool,
        /// The remote address of its sender, if that is a peer of a listening socket.
        peer: Option<SocketAddr>,
        /// It has a valid signature.
        verified: bool,
        packet: Vec<u8>,
    },
    PeerOpened {
        endpoint: EndpointNumber,
        address: SocketAddr,
    },
    PeerClosed {
        endpoint: EndpointNumber,
        address: SocketAddr,
    },
    Notice {
        endpoint: EndpointNumber,
        notice: Notice,
        system: u8,
        component: u8,
        message_id: u32,
    },
}

/// A report about a packet, at most one a second for each endpoint and kind.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Notice {
    /// A rule dropped it, or would have dropped it.
    Rule {
        index: usize,
        name: String,
        outgoing: bool,
        dry_run: bool,
    },
    Loop,
    /// From an address that an authenticated sender holds.
    Spoofed,
    /// Another sender, which is no better proven, holds its address: there is a conflict.
    Contested,
    SigningKey,
    Refused(&'static str),
    Rebooted,
}

/// The events that the program has not taken yet.
#[derive(Debug, Default)]
pub struct Events {
    queue: VecDeque<Event>,
    /// The endpoints with a `Readable` in the queue.
    readable: HashSet<EndpointNumber>,
    reported: HashMap<(EndpointNumber, Notice), u64>,
    /// Events dropped because the queue was full.
    pub dropped: u64,
}

impl Events {
    pub fn push(&mut self, event: Event) {
        let limit = match event {
            Event::Readable { endpoint } if !self.readable.insert(endpoint) => return,
            Event::Readable { .. } | Event::Closed { .. } | Event::Ended => MAX_LINK_EVENTS,
            _ => MAX_EVENTS,
        };
        if self.queue.len() < limit {
            self.queue.push_back(event);
        } else {
            self.dropped += 1;
        }
    }

    /// Reports a notice about a packet from `(system, component)`, unless the last one of its kind was just before.
    #[cold]
    pub fn notice(&mut self, endpoint: EndpointNumber, notice: Notice, source: (u8, u8), message_id: u32, now: u64) {
        let key = (endpoint, notice.clone());
        if self.reported.get(&key).is_some_and(|at| now.saturating_sub(*at) < NOTICE_INTERVAL) {
            return;
        }
        if self.reported.len() >= MAX_KINDS {
            self.reported.clear();
        }
        self.reported.insert(key, now);
        self.push(Event::Notice { endpoint, notice, system: source.0, component: source.1, message_id });
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.queue.is_empty()
    }

    /// Removes and returns all events, oldest first.
    pub fn take(&mut self) -> VecDeque<Event> {
        self.readable.clear();
        std::mem::take(&mut self.queue)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notices_of_one_kind_come_once_a_second() {
        let mut events = Events::default();
        for step in 0..20 {
            events.notice(1, Notice::Loop, (1, 1), 0, step * 100_000);
        }
        events.notice(2, Notice::Loop, (1, 1), 0, 0);
        assert_eq!(events.take().len(), 3);
    }

    #[test]
    fn the_queue_is_bounded() {
        let mut events = Events::default();
        let peer = Event::PeerOpened { endpoint: 1, address: ([127, 0, 0, 1], 1).into() };
        (0..5000).for_each(|_| events.push(peer.clone()));
        let link_events = [Event::Readable { endpoint: 2 }, Event::Closed { endpoint: 3, reason: String::new() }];
        for event in &link_events {
            events.push(event.clone());
        }
        events.push(Event::Readable { endpoint: 2 });
        assert_eq!((events.queue.len(), events.dropped), (MAX_EVENTS + 2, 5000 - MAX_EVENTS as u64));
        assert_eq!(events.take().range(MAX_EVENTS..).cloned().collect::<Vec<_>>(), link_events);
        events.push(Event::Readable { endpoint: 2 });
        assert_eq!(events.take().len(), 1);
    }
}
