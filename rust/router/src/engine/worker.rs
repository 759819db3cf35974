//! The thread of the engine.

use crate::counters::Cause;
use crate::engine::RuleSet;
use crate::engine::clock::Clock;
use crate::engine::command::{Command, Shared, TURN_INTERVAL};
use crate::engine::links::{Link, Links, Transport};
use crate::engine::moderation::{Moderation, REST};
use crate::engine::polling::{Events, Polling};
use crate::engine::reading::Reading;
use crate::engine::snapshot::{EndpointSnapshot, PeerSnapshot, Snapshot, routes};
use crate::engine::udp::UdpLink;
use crate::event::{EndpointNumber, Event};
use crate::ports::PortId;
use crate::router::{Router, Time};
use crate::rules::Rules;
use mavstack_core::layout::Dialect;
use mavstack_core::parser::Parser;
use std::collections::HashMap;
use std::io;
use std::sync::Arc;
use std::sync::mpsc::SyncSender;

/// Events of the system taken at a time.
const MAX_EVENTS: usize = 256;
/// Microseconds between two searches for silent peers: each turn of an idle thread makes one.
const EXPIRY_INTERVAL: u64 = TURN_INTERVAL.as_micros() as u64 * 9 / 10;

/// The state of the thread.
pub struct Worker {
    pub(super) poll: Polling,
    shared: Arc<Shared>,
    pub(super) router: Router,
    pub(super) links: Links,
    pub(super) parsers: Vec<Option<Parser>>,
    pub(super) dialect: Arc<Dialect>,
    /// Memory for reading, `None` while it is in use.
    pub(super) reading: Option<Box<Reading>>,
    pub(super) numbers: HashMap<EndpointNumber, usize>,
    pub(super) ready: Vec<usize>,
    /// Memory for the next list of these.
    pub(super) spare: Vec<usize>,
    /// Datagrams that this turn received.
    pub(super) datagrams: usize,
    moderation: Moderation,
    /// Answered when what was pushed before is routed.
    requests: Vec<SyncSender<Snapshot>>,
    clock: Clock,
    expiry_at: u64,
}

impl Worker {
    pub fn new(poll: Polling, shared: Arc<Shared>, dialect: Arc<Dialect>, duplicate_window: u64, clock: Clock) -> Self {
        Self {
            poll,
            shared,
            router: Router::new(Arc::clone(&dialect), duplicate_window),
            dialect,
            links: Links::default(),
            parsers: Vec::new(),
            reading: None,
            numbers: HashMap::new(),
            ready: Vec::new(),
            spare: Vec::new(),
            datagrams: 0,
            moderation: Moderation::default(),
            requests: Vec::new(),
            clock,
            expiry_at: EXPIRY_INTERVAL,
        }
    }

    pub(super) fn time(&mut self) -> Time {
        self.clock.time()
    }

    /// Runs until the engine is closed.
    pub fn run(mut self) {
        let mut events = Events::with_capacity(MAX_EVENTS);
        while self.turn(&mut events) {}
        self.links.all.iter().for_each(|(_, link)| {
            if let Transport::Queue(queue) = &link.transport {
                queue.shared.close();
            }
        });
    }

    /// Waits for something to do and does it; returns false when the engine ends.
    pub(super) fn turn(&mut self, events: &mut Events) -> bool {
        let is_idle = self.ready.is_empty() && self.requests.is_empty();
        if let Err(error) = self.poll.wait(events, is_idle)
            && error.kind() != io::ErrorKind::Interrupted
        {
            return false;
        }
        for (index, is_writable) in events.links() {
            if is_writable {
                self.unblock(index);
            }
            self.mark_ready(index);
        }
        if self.shared.has_commands() && !self.execute_commands() {
            return false;
        }
        let (ready, requests) = (self.take_ready(), self.requests.len());
        // Immediately before reading: a packet that came after a command finds its effect.
        if self.shared.has_commands() && !self.execute_commands() {
            return false;
        }
        let time = self.time(); // one look at the clocks for each turn: a vehicle's packets come one by one
        self.read_links(&ready, time);
        self.spare = ready;
        self.note_progress(time.now);
        self.flush();
        self.expire_peers(time.now);
        if !self.router.events.is_empty() {
            self.shared.emit(self.router.events.take());
        }
        if requests > 0 {
            self.answer(requests, time.now);
        }
        if self.moderation.needs_rest(std::mem::take(&mut self.datagrams), time.now) {
            std::thread::sleep(REST);
        }
        true
    }

    /// Answers the oldest requests.
    #[cold]
    fn answer(&mut self, count: usize, now: u64) {
        for request in self.requests.drain(..count).collect::<Vec<_>>() {
            // A program that does not wait any more has no use for it.
            let _ = request.try_send(self.snapshot(now));
        }
    }

    /// Sends on a link that accepts bytes again.
    #[cold]
    fn unblock(&mut self, index: usize) {
        let Some(link) = self.links.all.get_mut(index).filter(|link| link.is_blocked) else {
            return;
        };
        link.is_blocked = false;
        self.flush_link(index);
        if let Some(link) = self.links.all.get_mut(index).filter(|link| !link.is_blocked) {
            self.poll.await_writable(link, index, false);
        }
    }

    pub(super) fn mark_ready(&mut self, index: usize) {
        if let Some(link) = self.links.all.get_mut(index)
            && link.is_started
            && !link.is_ready
        {
            link.is_ready = true;
            self.ready.push(index);
        }
    }

    // Commands

    /// Executes what the program commanded; returns false when the engine ends.
    #[cold]
    fn execute_commands(&mut self) -> bool {
        let Some(commands) = self.shared.take_commands() else {
            return false;
        };
        for command in commands {
            self.execute(command);
        }
        true
    }

    fn execute(&mut self, command: Command) {
        match command {
            Command::AddUdp(number, socket, options) => self.add_udp(number, socket, options),
            Command::AddStream(number, stream, framing, limit) => self.add_stream(number, stream, framing, limit),
            Command::AddQueue(number, queue) => self.add_queue(number, queue),
            Command::Start(number) => self.start(number),
            Command::Pushed(number) => {
                if let Some(&index) = self.numbers.get(&number) {
                    self.mark_ready(index);
                }
            }
            Command::Remove(number) => self.remove_read(number),
            Command::Decide(token, passed) => {
                let time = self.time();
                self.router.decide(token, passed, time, &mut self.links);
            }
            Command::Statistics(sender) => self.requests.push(sender),
            change => self.change(change),
        }
    }

    /// Changes the options of an endpoint.
    fn change(&mut self, command: Command) {
        match command {
            Command::Pause(number, paused) => self.with(number, |endpoint| endpoint.paused = paused),
            Command::SetGroup(number, group) => self.with(number, |endpoint| endpoint.group = group),
            Command::SetListenOnly(number, only) => self.with(number, |endpoint| endpoint.listen_only = only),
            Command::SetMonitor(number, monitor) => {
                if let Some(&index) = self.numbers.get(&number) {
                    self.router.set_monitor(self.links.all[index].endpoint, monitor);
                }
            }
            Command::SetRules(number, rules) => self.set_rules(number, *rules),
            Command::SetGateway(number, gateway) => {
                if let Some(&index) = self.numbers.get(&number) {
                    self.router.unverify(self.links.all[index].endpoint);
                }
                self.with(number, |endpoint| endpoint.gateway = *gateway);
            }
            Command::SetAllowedPeers(number, ranges) => self.with_udp(number, |udp| udp.allowed = ranges),
            Command::SetBlockedPeers(number, addresses) => self.with_udp(number, |udp| udp.blocked = addresses),
            Command::SetAuthority(number, authority) => {
                if let Some(&index) = self.numbers.get(&number) {
                    self.router.set_authority(self.links.all[index].endpoint, authority);
                }
            }
            _ => {}
        }
    }

    /// Changes the peers that a UDP socket accepts.
    fn with_udp(&mut self, number: EndpointNumber, change: impl FnOnce(&mut UdpLink)) {
        if let Some(&index) = self.numbers.get(&number)
            && let Transport::Udp(udp) = &mut self.links.all[index].transport
        {
            change(udp);
            self.expiry_at = 0;
        }
    }

    fn with(&mut self, number: EndpointNumber, change: impl FnOnce(&mut crate::endpoint::Endpoint)) {
        let index = self.numbers.get(&number).map(|&index| self.links.all[index].endpoint);
        if let Some(endpoint) = index.and_then(|index| self.router.endpoint_mut(index)) {
            change(endpoint);
        }
    }

    fn set_rules(&mut self, number: EndpointNumber, rules: RuleSet) {
        let dialect = Arc::clone(self.router.dialect());
        self.with(number, |endpoint| {
            endpoint.incoming = Rules::new(rules.incoming, rules.default_incoming, &dialect);
            endpoint.outgoing = Rules::new(rules.outgoing, rules.default_outgoing, &dialect);
            endpoint.limit(rules.bytes_per_second);
        });
    }

    // Sending

    fn flush(&mut self) {
        let dirty = self.links.take_dirty();
        for &index in &dirty {
            self.flush_link(index);
        }
        self.links.return_dirty(dirty);
    }

    fn flush_link(&mut self, index: usize) {
        let Some(link) = self.links.all.get_mut(index).filter(|link| !link.is_blocked) else {
            return;
        };
        match &mut link.transport {
            Transport::Udp(udp) => {
                link.is_blocked = udp.flush();
                let refused = std::mem::take(&mut udp.refused);
                if refused > 0
                    && let Some(endpoint) = self.router.endpoint_mut(link.endpoint)
                {
                    endpoint.counters.dropped[Cause::NotSent as usize] += refused;
                    endpoint.counters.sent = endpoint.counters.sent.saturating_sub(refused);
                }
            }
            Transport::Stream(stream) => match stream.flush() {
                Ok(()) => link.is_blocked = stream.queued() > 0,
                Err(error) => {
                    let number = link.number;
                    return self.remove(number, Some(error.to_string()));
                }
            },
            Transport::Queue(_) => {
                if std::mem::take(&mut link.became_readable) {
                    self.router.events.push(Event::Readable { endpoint: link.number });
                }
            }
        }
        if link.is_blocked {
            self.poll.await_writable(link, index, true);
        }
    }

    // Time and statistics

    fn expire_peers(&mut self, now: u64) {
        if now < self.expiry_at {
            return;
        }
        self.expiry_at = now + EXPIRY_INTERVAL;
        self.router.end_conflicts(now);
        for index in self.links.all.iter().map(|(index, _)| index).collect::<Vec<_>>() {
            let expired = match &self.links.all[index].transport {
                Transport::Udp(udp) => udp.expired(now),
                _ => Vec::new(),
            };
            for address in expired {
                self.close_peer(index, address);
            }
            // An error that ended a batch early can hide datagrams behind it.
            self.mark_ready(index);
        }
    }

    fn snapshot(&self, now: u64) -> Snapshot {
        let endpoints = self.links.all.iter().filter_map(|(index, link)| self.endpoint_snapshot(index, link, now));
        let mut endpoints: Vec<_> = endpoints.collect();
        endpoints.sort_unstable_by_key(|endpoint| endpoint.number);
        let dropped_events = self.shared.dropped_events() + self.router.events.dropped;
        Snapshot { endpoints, routes: routes(&self.router, now), dropped_events }
    }

    fn endpoint_snapshot(&self, index: usize, link: &Link, now: u64) -> Option<EndpointSnapshot> {
        let mut snapshot = EndpointSnapshot::new(self.router.endpoint(link.endpoint)?, &self.router);
        for parser in self.links.ports_of(index).iter().filter_map(|&port| self.parsers[port].as_ref()) {
            snapshot.add_parser(parser);
        }
        match &link.transport {
            Transport::Udp(udp) => {
                snapshot.queued = udp.queue.len();
                let age = |heard_at: u64| now.saturating_sub(heard_at) as f64 * 1e-6;
                let bad_bytes = |port: PortId| {
                    let parser = self.parsers[port].as_ref().filter(|_| !self.router.is_verifying(port));
                    parser.map_or(0, |parser| parser.statistics().bad_bytes)
                };
                let peers = udp.peers.iter().filter(|(_, peer)| peer.is_accepted);
                snapshot.peers = peers
                    .map(|(&address, peer)| PeerSnapshot {
                        address,
                        age: age(peer.heard_at),
                        accepted: self.router.accepted(peer.port),
                        bad_bytes: bad_bytes(peer.port),
                    })
                    .collect();
                snapshot.peers.sort_unstable_by_key(|peer| peer.address);
            }
            Transport::Stream(stream) => snapshot.queued = stream.queued(),
            Transport::Queue(queue) => snapshot.queued = queue.shared.queued(),
        }
        Some(snapshot)
    }
}

#[cfg(all(test, unix))]
#[path = "worker_tests.rs"]
mod tests;
