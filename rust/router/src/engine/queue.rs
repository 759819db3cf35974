//! Endpoints whose bytes the program carries: an inbox and an outbox, shared with the engine's thread.

use crate::engine::shares::Shares;
use crate::ports::PortId;
use crate::router::{Origin, QueueFull};
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Bytes in the inbox; more are refused.
const MAX_INBOX: usize = 4 << 20;

#[derive(Debug, Default)]
struct Inbox {
    chunks: Vec<Vec<u8>>,
    bytes: usize,
}

#[derive(Debug, Default)]
struct Outbox {
    packets: VecDeque<Vec<u8>>,
    shares: Shares,
}

/// The two directions of a queue endpoint.
#[derive(Debug)]
pub struct Queue {
    inbox: Mutex<Inbox>,
    outbox: Mutex<Outbox>,
    capacity: usize,
    closed: AtomicBool,
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Queue {
    /// Creates a queue whose outbox holds `capacity` packets.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        Self { inbox: Mutex::default(), outbox: Mutex::default(), capacity, closed: AtomicBool::new(false) }
    }

    /// Takes bytes from the program; returns whether the inbox was empty. An empty inbox takes any number of bytes.
    pub fn push(&self, data: &[u8]) -> Result<bool, QueueFull> {
        let mut inbox = lock(&self.inbox);
        let is_full = inbox.bytes > 0 && inbox.bytes + data.len() > MAX_INBOX;
        if is_full || self.closed.load(Ordering::Relaxed) {
            return Err(QueueFull);
        }
        inbox.bytes += data.len();
        inbox.chunks.push(data.to_vec());
        Ok(inbox.chunks.len() == 1)
    }

    /// Removes and returns the bytes from the program; they count until they are routed.
    fn take_inbox(&self) -> Vec<Vec<u8>> {
        std::mem::take(&mut lock(&self.inbox).chunks)
    }

    /// Makes room for as many bytes as were routed.
    fn make_room(&self, routed: usize) {
        lock(&self.inbox).bytes -= routed;
    }

    /// Adds a packet for the program; returns whether the outbox was empty.
    pub(super) fn send(&self, packet: &[u8], origin: Origin) -> Result<bool, QueueFull> {
        let mut outbox = lock(&self.outbox);
        let free = self.capacity.saturating_sub(outbox.packets.len());
        outbox.shares.add(origin, 1, free)?;
        outbox.packets.push_back(packet.to_vec());
        Ok(outbox.packets.len() == 1)
    }

    /// Removes and returns the packets for the program, oldest first.
    pub fn pull(&self) -> VecDeque<Vec<u8>> {
        let mut outbox = lock(&self.outbox);
        outbox.shares.clear();
        std::mem::take(&mut outbox.packets)
    }

    /// Number of packets for the program.
    #[must_use]
    pub fn queued(&self) -> usize {
        lock(&self.outbox).packets.len()
    }

    pub(super) fn close(&self) {
        self.closed.store(true, Ordering::Relaxed);
    }
}

/// A queue endpoint in the engine.
#[derive(Debug)]
pub struct QueueLink {
    pub shared: Arc<Queue>,
    pub port: PortId,
    /// Bytes from the program, of which `routed` bytes of the first chunk are routed already.
    chunks: VecDeque<Vec<u8>>,
    routed: usize,
}

impl QueueLink {
    #[must_use]
    pub fn new(shared: Arc<Queue>) -> Self {
        Self { shared, port: 0, chunks: VecDeque::new(), routed: 0 }
    }

    /// Takes what the program pushed. Later pushes are not read before the next call, so that the commands that came
    /// before them are executed first.
    pub fn collect(&mut self) {
        self.chunks.extend(self.shared.take_inbox());
    }

    /// Appends the next collected bytes, at most `limit`, to `content`; returns whether there are more.
    pub fn read(&mut self, limit: usize, content: &mut Vec<u8>) -> bool {
        let before = content.len();
        while let Some(first) = self.chunks.front() {
            let rest = &first[self.routed..];
            let part = &rest[..rest.len().min(limit - (content.len() - before))];
            content.extend_from_slice(part);
            if part.len() < rest.len() {
                self.routed += part.len();
                break;
            }
            self.chunks.pop_front();
            self.routed = 0;
        }
        self.shared.make_room(content.len() - before);
        !self.chunks.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_outbox_refuses_and_an_inbox_is_bounded() {
        let queue = Queue::new(2);
        let from = |endpoint| Origin { endpoint, is_urgent: true };
        assert_eq!(queue.send(b"1", from(0)), Ok(true));
        assert_eq!(queue.send(b"2", from(1)), Ok(false));
        assert_eq!(queue.send(b"3", from(2)), Err(QueueFull));
        assert_eq!(queue.pull(), [b"1".to_vec(), b"2".to_vec()]);
        let large = vec![0; MAX_INBOX];
        assert_eq!((queue.push(&large), queue.push(b"too much")), (Ok(true), Err(QueueFull)));
    }

    #[test]
    fn bytes_are_read_in_parts_and_count_until_then() {
        let mut link = QueueLink::new(Arc::new(Queue::new(1)));
        let large = vec![7; MAX_INBOX - 2];
        assert_eq!((link.shared.push(b"in"), link.shared.push(&large)), (Ok(true), Ok(false)));
        let mut content = Vec::new();
        assert!(!link.read(1000, &mut content) && content.is_empty(), "nothing is collected");
        link.collect();
        assert!(link.read(1000, &mut content));
        assert_eq!(content, [&b"in"[..], &[7; 998]].concat());
        assert_eq!((link.shared.push(&[8; 1001]), link.shared.push(&[8; 1000])), (Err(QueueFull), Ok(true)));
        content.clear();
        while link.read(1 << 16, &mut content) {}
        assert_eq!((content.len(), content.last()), (MAX_INBOX - 1000, Some(&7)));
        link.collect();
        assert!(!link.read(1 << 16, &mut content));
        assert_eq!((content.len(), content.last()), (MAX_INBOX, Some(&8)));
    }
}
