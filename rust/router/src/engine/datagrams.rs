//! Datagrams that wait to be sent on one socket, and the datagrams that were received together.

use crate::engine::shares::Shares;
use crate::router::{Origin, QueueFull};
use std::collections::VecDeque;
use std::net::SocketAddr;

/// Datagrams of one system call.
pub const BATCH: usize = 64;
/// Bytes of one turn of a link; larger datagrams are received fewer at a time.
pub const TURN_BYTES: usize = 1 << 16;
/// Longest datagram.
pub const MAX_DATAGRAM: usize = 65_536;
/// Distance of received datagrams in memory: not a power of two, so that they do not displace each other in caches.
const STRIDE: usize = MAX_DATAGRAM + 320;

/// Datagrams and bytes that wait when a socket accepts no more.
const MAX_WAITING: usize = 2048;
const MAX_WAITING_BYTES: usize = 1 << 20;

/// A datagram to send; its bytes are those of the queue from `start` on.
#[derive(Clone, Copy, Debug)]
pub struct Outgoing {
    pub start: usize,
    pub length: usize,
    /// `None`: the peer of a connected socket.
    pub address: Option<SocketAddr>,
    /// Index of the endpoint that it came from.
    endpoint: usize,
}

/// Datagrams of one length for one address; the last one may be shorter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run<'a> {
    pub bytes: &'a [u8],
    pub length: u16,
    pub count: usize,
    pub address: Option<SocketAddr>,
}

/// Longest sum of datagrams that are sent together.
const MAX_RUN: usize = 60_000;
/// Fewest datagrams that are worth it.
const MIN_RUN: usize = 3;

/// Datagrams to send, oldest first.
#[derive(Debug, Default)]
pub struct SendQueue {
    bytes: Vec<u8>,
    datagrams: VecDeque<Outgoing>,
    shares: Shares,
}

impl SendQueue {
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.datagrams.is_empty()
    }

    #[must_use]
    pub fn len(&self) -> usize {
        self.datagrams.len()
    }

    /// Adds a packet, if there is room and its endpoint has no more than its share.
    #[inline]
    pub fn push(&mut self, data: &[u8], address: Option<SocketAddr>, origin: Origin) -> Result<(), QueueFull> {
        let free = if self.bytes.len() < MAX_WAITING_BYTES { MAX_WAITING - self.datagrams.len() } else { 0 };
        self.shares.add(origin, 1, free)?;
        let (start, endpoint) = (self.bytes.len(), origin.endpoint);
        self.datagrams.push_back(Outgoing { start, length: data.len(), address, endpoint });
        self.bytes.extend_from_slice(data);
        Ok(())
    }

    /// The datagram that waits alone.
    #[must_use]
    pub fn only(&self) -> Option<(&[u8], Option<SocketAddr>)> {
        let first = self.datagrams.front().filter(|_| self.datagrams.len() == 1)?;
        Some((&self.bytes[first.start..first.start + first.length], first.address))
    }

    /// The first datagrams, up to a batch.
    pub fn first(&self) -> impl Iterator<Item = (&[u8], Option<SocketAddr>)> {
        let part = |sent: &Outgoing| (&self.bytes[sent.start..sent.start + sent.length], sent.address);
        self.datagrams.iter().take(BATCH).map(part)
    }

    /// The datagrams at the front that can be sent together, if there are several; one is never empty.
    #[must_use]
    pub fn first_run(&self) -> Option<Run<'_>> {
        let first = *self.datagrams.front()?;
        let (mut count, mut end) = (0, first.start);
        for next in self.datagrams.iter().take(BATCH) {
            let fits = next.length <= first.length && next.length > 0 && end + next.length - first.start <= MAX_RUN;
            if !fits || next.address != first.address {
                break;
            }
            (count, end) = (count + 1, next.start + next.length);
            if next.length < first.length {
                break;
            }
        }
        let length = u16::try_from(first.length).ok()?;
        let run = Run { bytes: &self.bytes[first.start..end], length, count, address: first.address };
        (count >= MIN_RUN).then_some(run)
    }

    /// Removes the first datagrams.
    pub fn remove(&mut self, count: usize) {
        for sent in self.datagrams.drain(..count.min(self.datagrams.len())) {
            self.shares.remove(sent.endpoint, 1);
        }
        match self.datagrams.front().map(|next| next.start) {
            None => self.bytes.clear(),
            Some(start) if start > self.bytes.len() / 2 => {
                self.bytes.drain(..start);
                self.datagrams.iter_mut().for_each(|waiting| waiting.start -= start);
            }
            Some(_) => {}
        }
    }
}

/// The memory of received datagrams.
#[derive(Debug)]
pub struct ReceiveBuffer {
    bytes: Vec<u8>,
    pub received: Vec<(usize, SocketAddr)>,
}

impl Default for ReceiveBuffer {
    fn default() -> Self {
        Self { bytes: vec![0; BATCH * STRIDE], received: Vec::with_capacity(BATCH) }
    }
}

impl ReceiveBuffer {
    /// The memory of each datagram of a batch, and the list of what is received.
    pub fn parts(&mut self) -> (impl Iterator<Item = &mut [u8]>, &mut Vec<(usize, SocketAddr)>) {
        (self.bytes.chunks_mut(STRIDE).map(|slot| &mut slot[..MAX_DATAGRAM]), &mut self.received)
    }

    /// Bytes and sender of a received datagram.
    #[must_use]
    pub fn datagram(&self, index: usize) -> (&[u8], SocketAddr) {
        let (length, address) = self.received[index];
        (&self.bytes[index * STRIDE..index * STRIDE + length], address)
    }

    /// Memory for the bytes of a stream.
    pub fn stream(&mut self) -> &mut [u8] {
        &mut self.bytes[..MAX_DATAGRAM]
    }

    /// The first bytes of the memory.
    #[must_use]
    pub fn first(&self, length: usize) -> &[u8] {
        &self.bytes[..length]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORIGIN: Origin = Origin { endpoint: 1, is_urgent: false };

    #[test]
    fn datagrams_of_one_length_form_a_run_that_a_shorter_one_ends() {
        let mut queue = SendQueue::default();
        for part in [&b"aaa"[..], b"bbb", b"ccc", b"d", b"eee"] {
            queue.push(part, None, ORIGIN).expect("room");
        }
        assert_eq!(queue.first_run().map(|run| (run.bytes, run.count)), Some((&b"aaabbbcccd"[..], 4)));
        queue.remove(2);
        assert_eq!(queue.first_run(), None, "two are sent as others");
        let mut queue = SendQueue::default();
        for port in [1, 1, 1, 2] {
            let address = SocketAddr::from(([127, 0, 0, 1], port));
            queue.push(b"aaa", Some(address), ORIGIN).expect("room");
        }
        assert_eq!(queue.first_run().map(|run| run.count), Some(3));
    }

    #[test]
    fn datagrams_leave_in_order_whatever_is_sent_at_once() {
        let mut queue = SendQueue::default();
        let mut sent = Vec::new();
        for number in 0..1000u32 {
            queue.push(&number.to_le_bytes(), None, ORIGIN).expect("room");
            if number % 7 == 0 {
                let batch: Vec<_> = queue.first().take(5).map(|(bytes, _)| bytes.to_vec()).collect();
                queue.remove(batch.len());
                sent.extend(batch);
            }
        }
        while !queue.is_empty() {
            sent.extend(queue.first().map(|(bytes, _)| bytes.to_vec()));
            queue.remove(BATCH);
        }
        assert!((0..1000u32).map(|number| number.to_le_bytes().to_vec()).eq(sent));
        assert!(queue.bytes.is_empty());
    }

    #[test]
    fn an_endpoint_that_floods_leaves_room_for_others() {
        let mut queue = SendQueue::default();
        let fill = |queue: &mut SendQueue, origin| {
            (0..=MAX_WAITING).take_while(|_| queue.push(b"packet", None, origin).is_ok()).count()
        };
        assert_eq!(fill(&mut queue, ORIGIN), MAX_WAITING / 2);
        assert_eq!(fill(&mut queue, Origin { endpoint: 2, is_urgent: false }), MAX_WAITING / 4);
        queue.remove(MAX_WAITING / 2);
        assert!(fill(&mut queue, ORIGIN) > MAX_WAITING / 4);
    }
}
