//! State that the handle and the thread share: commands in one direction, events in the other.

use crate::engine::RuleSet;
use crate::engine::notify::Notifier;
use crate::engine::peer_range::PeerRange;
use crate::engine::polling::{Polling, Waker};
use crate::engine::queue::Queue;
use crate::engine::snapshot::Snapshot;
use crate::engine::stream::{Framing, RawStream};
use crate::engine::udp::UdpOptions;
use crate::event::{EndpointNumber, Event, Events};
use crate::gateway::Gateway;
use mavstack_core::claims::Authority;
use std::collections::{HashSet, VecDeque};
use std::io;
use std::net::SocketAddr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// The longest time between two turns of the thread.
pub const TURN_INTERVAL: Duration = Duration::from_secs(1);

#[derive(Debug)]
pub enum Command {
    AddUdp(EndpointNumber, mio::net::UdpSocket, UdpOptions),
    AddStream(EndpointNumber, RawStream, Framing, usize),
    AddQueue(EndpointNumber, Arc<Queue>),
    /// Open the ports of an endpoint, and read it.
    Start(EndpointNumber),
    /// A queue has bytes from the program.
    Pushed(EndpointNumber),
    Remove(EndpointNumber),
    Pause(EndpointNumber, bool),
    SetRules(EndpointNumber, Box<RuleSet>),
    SetGroup(EndpointNumber, Option<String>),
    SetListenOnly(EndpointNumber, bool),
    SetMonitor(EndpointNumber, bool),
    SetGateway(EndpointNumber, Box<Gateway>),
    SetAllowedPeers(EndpointNumber, Option<Vec<PeerRange>>),
    SetBlockedPeers(EndpointNumber, HashSet<SocketAddr>),
    SetAuthority(EndpointNumber, Authority),
    Decide(u64, bool),
    Statistics(SyncSender<Snapshot>),
}

#[derive(Debug, Default)]
struct Commands {
    list: Vec<Command>,
    closed: bool,
}

/// The state that the handle and the thread share.
#[derive(Debug)]
pub struct Shared {
    commands: Mutex<Commands>,
    /// The thread has something to take: it looks at this for each packet.
    has_commands: AtomicBool,
    waker: Waker,
    events: Mutex<Events>,
    pub notifier: Notifier,
}

/// Closes the state when the thread ends, also by a panic: a program that waits for an answer or for events learns it.
#[derive(Debug)]
pub struct CloseAtEnd(pub Arc<Shared>);

impl Drop for CloseAtEnd {
    fn drop(&mut self) {
        let is_closed = lock(&self.0.commands).closed;
        if !is_closed {
            self.0.emit(VecDeque::from([Event::Ended]));
            self.0.close();
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    pub fn new() -> io::Result<(Self, Polling)> {
        let (poll, waker) = Polling::new(TURN_INTERVAL)?;
        let (commands, has_commands, events) = (Mutex::default(), AtomicBool::new(false), Mutex::default());
        Ok((Self { commands, has_commands, waker, events, notifier: Notifier::new()? }, poll))
    }

    /// Gives the thread a command; an engine that has ended drops it.
    pub fn send(&self, command: Command) {
        let mut commands = lock(&self.commands);
        if commands.closed {
            return;
        }
        commands.list.push(command);
        if commands.list.len() == 1 {
            self.has_commands.store(true, Ordering::SeqCst);
            self.waker.wake();
        }
    }

    pub fn close(&self) {
        let mut commands = lock(&self.commands);
        commands.closed = true;
        commands.list.clear();
        self.has_commands.store(true, Ordering::SeqCst);
        self.waker.wake();
    }

    /// Returns whether there are commands, or the engine ends.
    #[inline]
    pub fn has_commands(&self) -> bool {
        self.has_commands.load(Ordering::SeqCst)
    }

    /// Returns the commands since the last call; `None`: the engine ends.
    pub fn take_commands(&self) -> Option<Vec<Command>> {
        let mut commands = lock(&self.commands);
        self.has_commands.store(commands.closed, Ordering::SeqCst);
        (!commands.closed).then(|| std::mem::take(&mut commands.list))
    }

    /// Passes events to the program.
    pub fn emit(&self, emitted: VecDeque<Event>) {
        let mut events = lock(&self.events);
        let was_empty = events.is_empty();
        for event in emitted {
            events.push(event);
        }
        if was_empty {
            self.notifier.set();
        }
    }

    pub fn take_events(&self) -> VecDeque<Event> {
        let mut events = lock(&self.events);
        self.notifier.clear();
        events.take()
    }

    /// Events that were dropped because the program did not take them.
    pub fn dropped_events(&self) -> u64 {
        lock(&self.events).dropped
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_waits_for_a_thread_that_ended_gets_an_error() {
        let (shared, _poll) = Shared::new().expect("an event queue");
        let shared = Arc::new(shared);
        let end = CloseAtEnd(Arc::clone(&shared));
        let (sender, receiver) = std::sync::mpsc::sync_channel(1);
        shared.send(Command::Statistics(sender.clone()));
        drop(end);
        shared.send(Command::Statistics(sender));
        assert!(receiver.recv().is_err());
        assert_eq!(shared.take_events(), [Event::Ended]);
        drop(CloseAtEnd(Arc::clone(&shared)));
        assert!(shared.take_events().is_empty(), "closed by the program");
    }
}
