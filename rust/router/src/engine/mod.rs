//! The engine: a router on a thread of its own, over sockets, streams and queues.
//!
//! [`Engine`] is the handle of the program. Its methods return at once: they put a command into a list and wake the
//! thread. Only [`Engine::statistics`] waits, for the end of the turn. A turn of the thread reads one batch from each
//! endpoint that has something, so that a flood on one delays the others by no more than its batch, and then sends
//! what was routed, several packets per system call.

mod attaching;
#[cfg(target_os = "linux")]
#[path = "batch_linux.rs"]
pub mod batch;
#[cfg(not(target_os = "linux"))]
#[path = "batch_std.rs"]
pub mod batch;
mod clock;
mod command;
pub mod datagrams;
mod framing;
mod lanes;
mod links;
mod moderation;
pub mod notify;
mod peer_hasher;
pub mod peer_range;
#[cfg(target_os = "linux")]
#[path = "polling_linux.rs"]
mod polling;
#[cfg(not(target_os = "linux"))]
#[path = "polling_mio.rs"]
mod polling;
pub mod queue;
mod reading;
pub mod sender;
mod shares;
pub mod snapshot;
pub mod stream;
pub mod udp;
mod worker;

use crate::event::{EndpointNumber, Event};
use crate::gateway::Gateway;
use crate::rules::{Action, Rule};
use clock::{Clock, SystemClock};
use command::{CloseAtEnd, Command, Shared};
use mavstack_core::claims::Authority;
use mavstack_core::layout::Dialect;
use peer_range::PeerRange;
use queue::Queue;
use snapshot::Snapshot;
use std::collections::{HashMap, HashSet, VecDeque};
use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::thread::JoinHandle;
use stream::{Framing, RawStream};
use udp::UdpOptions;
use worker::Worker;

/// The rules of one endpoint, and its byte rate.
#[derive(Clone, Debug, Default)]
pub struct RuleSet {
    pub incoming: Vec<Rule>,
    pub outgoing: Vec<Rule>,
    pub default_incoming: Action,
    pub default_outgoing: Action,
    pub bytes_per_second: Option<f64>,
}

/// The engine has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Closed;

/// The handle of a running engine. Dropping it ends the engine.
#[derive(Debug)]
pub struct Engine {
    shared: Arc<Shared>,
    numbers: AtomicU32,
    queues: Mutex<HashMap<EndpointNumber, Arc<Queue>>>,
    thread: Mutex<Option<JoinHandle<()>>>,
}

impl Engine {
    /// Starts an engine; `duplicate_window` in microseconds, 0: only within groups.
    pub fn start(dialect: Arc<Dialect>, duplicate_window: u64) -> io::Result<Self> {
        let (shared, poll) = Shared::new()?;
        let shared = Arc::new(shared);
        let for_thread = Arc::clone(&shared);
        let run = move || {
            let _end = CloseAtEnd(Arc::clone(&for_thread));
            Worker::new(poll, for_thread, dialect, duplicate_window, Clock::System(SystemClock::default())).run();
        };
        let thread = std::thread::Builder::new().name("mavstack-router".into()).spawn(run)?;
        let (numbers, queues) = (AtomicU32::new(0), Mutex::default());
        Ok(Self { shared, numbers, queues, thread: Mutex::new(Some(thread)) })
    }

    fn add(&self, command: impl FnOnce(EndpointNumber) -> Command) -> EndpointNumber {
        let number = self.numbers.fetch_add(1, Ordering::Relaxed);
        self.shared.send(command(number));
        number
    }

    /// Lets packets pass through an endpoint that was added; those that came before wait in its socket or queue.
    pub fn start_endpoint(&self, endpoint: EndpointNumber) {
        self.shared.send(Command::Start(endpoint));
    }

    /// Adds a UDP socket. It, as any endpoint, does nothing before [`Engine::start_endpoint`].
    pub fn add_udp(&self, socket: UdpSocket, options: UdpOptions) -> io::Result<EndpointNumber> {
        socket.set_nonblocking(true)?;
        let socket = mio::net::UdpSocket::from_std(socket);
        Ok(self.add(|number| Command::AddUdp(number, socket, options)))
    }

    /// Adds a stream; at most `limit` bytes wait to be sent on it.
    pub fn add_stream(&self, stream: RawStream, framing: Framing, limit: usize) -> EndpointNumber {
        self.add(|number| Command::AddStream(number, stream, framing, limit))
    }

    /// Adds an endpoint whose bytes the program carries; at most `capacity` packets wait for it.
    pub fn add_queue(&self, capacity: usize) -> EndpointNumber {
        let queue = Arc::new(Queue::new(capacity));
        let number = self.add(|number| Command::AddQueue(number, Arc::clone(&queue)));
        self.queues().insert(number, queue);
        number
    }

    fn queues(&self) -> std::sync::MutexGuard<'_, HashMap<EndpointNumber, Arc<Queue>>> {
        self.queues.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn queue(&self, endpoint: EndpointNumber) -> Option<Arc<Queue>> {
        self.queues().get(&endpoint).cloned()
    }

    /// Routes bytes from the program; returns whether there was room for them. `None`: the endpoint is no queue.
    pub fn push(&self, endpoint: EndpointNumber, data: &[u8]) -> Option<bool> {
        let pushed = self.queue(endpoint)?.push(data);
        if pushed == Ok(true) {
            self.shared.send(Command::Pushed(endpoint));
        }
        Some(pushed.is_ok())
    }

    /// Returns the packets for the program; `None`: the endpoint is no queue.
    pub fn pull(&self, endpoint: EndpointNumber) -> Option<VecDeque<Vec<u8>>> {
        self.queue(endpoint).map(|queue| queue.pull())
    }

    /// Removes an endpoint, after what was pushed to it is routed. One that is not known has no effect.
    pub fn remove(&self, endpoint: EndpointNumber) {
        self.queues().remove(&endpoint);
        self.shared.send(Command::Remove(endpoint));
    }

    pub fn pause(&self, endpoint: EndpointNumber, paused: bool) {
        self.shared.send(Command::Pause(endpoint, paused));
    }

    pub fn set_rules(&self, endpoint: EndpointNumber, rules: RuleSet) {
        self.shared.send(Command::SetRules(endpoint, Box::new(rules)));
    }

    pub fn set_group(&self, endpoint: EndpointNumber, group: Option<String>) {
        self.shared.send(Command::SetGroup(endpoint, group));
    }

    pub fn set_listen_only(&self, endpoint: EndpointNumber, listen_only: bool) {
        self.shared.send(Command::SetListenOnly(endpoint, listen_only));
    }

    /// Gives an endpoint a copy of every accepted packet, and drops those from it; or no longer.
    pub fn set_monitor(&self, endpoint: EndpointNumber, monitor: bool) {
        self.shared.send(Command::SetMonitor(endpoint, monitor));
    }

    pub fn set_gateway(&self, endpoint: EndpointNumber, gateway: Gateway) {
        self.shared.send(Command::SetGateway(endpoint, Box::new(gateway)));
    }

    /// Accepts only peers of these ranges on a listening socket; `None`: all.
    pub fn set_allowed_peers(&self, endpoint: EndpointNumber, ranges: Option<Vec<PeerRange>>) {
        self.shared.send(Command::SetAllowedPeers(endpoint, ranges));
    }

    /// Cuts off peers of a listening socket; those of an earlier call that are not among them are free again.
    pub fn set_blocked_peers(&self, endpoint: EndpointNumber, addresses: HashSet<SocketAddr>) {
        self.shared.send(Command::SetBlockedPeers(endpoint, addresses));
    }

    /// Sets how the identity of the peer of an endpoint is proven.
    pub fn set_authority(&self, endpoint: EndpointNumber, authority: Authority) {
        self.shared.send(Command::SetAuthority(endpoint, authority));
    }

    /// Decides about a packet that waits for a decision.
    pub fn decide(&self, token: u64, passed: bool) {
        self.shared.send(Command::Decide(token, passed));
    }

    /// Returns the counters of all endpoints and the learned routes.
    pub fn statistics(&self) -> Result<Snapshot, Closed> {
        let (sender, receiver) = mpsc::sync_channel(1);
        self.shared.send(Command::Statistics(sender));
        receiver.recv().map_err(|_| Closed)
    }

    /// Returns the events since the last call, oldest first.
    #[must_use]
    pub fn events(&self) -> VecDeque<Event> {
        self.shared.take_events()
    }

    /// A descriptor (a socket on Windows) that is readable while events wait.
    #[must_use]
    pub fn event_descriptor(&self) -> i64 {
        self.shared.notifier.descriptor()
    }

    /// Ends the engine: closes all endpoints. Idempotent.
    pub fn close(&self) {
        self.shared.close();
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(thread) = thread {
            // A thread that panicked has ended too.
            let _ = thread.join();
        }
        self.queues().clear();
    }
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.close();
    }
}

#[cfg(test)]
#[path = "../engine_tests.rs"]
mod tests;
