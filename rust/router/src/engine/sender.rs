//! A UDP socket on which a program sends many datagrams at a time.

use crate::engine::batch;
use crate::engine::datagrams::{BATCH, SendQueue};
use crate::router::Origin;
use mio::net::UdpSocket;
use std::io;
use std::net::SocketAddr;

/// The endpoint of all datagrams: they come from one program.
const ORIGIN: Origin = Origin { endpoint: 0, is_urgent: false };

/// The socket, and the memory of a batch.
#[derive(Debug)]
pub struct DatagramSender {
    socket: UdpSocket,
    batch: SendQueue,
    can_segment: bool,
    /// System calls so far.
    pub calls: u64,
}

impl DatagramSender {
    /// Takes over a socket; it becomes non-blocking.
    pub fn new(socket: std::net::UdpSocket) -> io::Result<Self> {
        socket.set_nonblocking(true)?;
        Ok(Self { socket: UdpSocket::from_std(socket), batch: SendQueue::default(), can_segment: true, calls: 0 })
    }

    /// Sends datagrams in order until the system refuses one; returns how many were sent, and the error.
    pub fn send(&mut self, datagrams: &[(&[u8], SocketAddr)]) -> (usize, Option<io::Error>) {
        let mut sent = 0;
        for batch in datagrams.chunks(BATCH) {
            for &(data, address) in batch {
                // A batch is smaller than the share of an endpoint: there is room.
                let _ = self.batch.push(data, Some(address), ORIGIN);
            }
            while !self.batch.is_empty() {
                match self.send_batch() {
                    Ok(count) => {
                        sent += count;
                        self.batch.remove(count);
                    }
                    Err(error) => {
                        self.batch.remove(BATCH);
                        return (sent, Some(error));
                    }
                }
            }
        }
        (sent, None)
    }

    /// Sends the batch or its first part. Datagrams of one length are divided by the system only if they are the whole
    /// batch: it needs one system call either way.
    fn send_batch(&mut self) -> io::Result<usize> {
        self.calls += 1;
        let is_one_run = self.batch.first_run().is_some_and(|run| run.count == self.batch.len());
        let mut can_segment = self.can_segment && is_one_run;
        let result = batch::send(&self.socket, &self.batch, &mut can_segment);
        self.can_segment &= can_segment || !is_one_run;
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::UdpSocket as StdSocket;

    fn pair() -> (DatagramSender, StdSocket, SocketAddr) {
        let bind = || StdSocket::bind("127.0.0.1:0").expect("a port");
        let receiver = bind();
        let address = receiver.local_addr().expect("an address");
        (DatagramSender::new(bind()).expect("a socket"), receiver, address)
    }

    fn receive(socket: &StdSocket) -> Vec<u8> {
        let mut buffer = [0; 2048];
        let length = socket.recv(&mut buffer).expect("a datagram");
        buffer[..length].to_vec()
    }

    #[test]
    fn datagrams_leave_in_order_by_one_system_call_for_each_batch() {
        let (mut sender, receiver, address) = pair();
        for lengths in [vec![1, 2, 3, 200, 7], vec![20; 64], (0..130).map(|number| 1 + number % 9).collect()] {
            let datagrams: Vec<Vec<u8>> =
                lengths.iter().enumerate().map(|(number, &length)| vec![number as u8; length]).collect();
            let parts: Vec<(&[u8], SocketAddr)> = datagrams.iter().map(|data| (&data[..], address)).collect();
            let before = sender.calls;
            let (sent, error) = sender.send(&parts);
            assert!(error.is_none());
            assert_eq!(sent, datagrams.len());
            let expected = if cfg!(target_os = "linux") { datagrams.len().div_ceil(BATCH) } else { sent };
            assert!((sender.calls - before) as usize <= expected);
            for data in datagrams {
                assert_eq!(receive(&receiver), data);
            }
        }
    }

    #[test]
    fn a_datagram_that_the_system_refuses_ends_the_sending_before_it() {
        let (mut sender, receiver, address) = pair();
        let oversized = vec![0; 70_000];
        let parts: [(&[u8], SocketAddr); 3] = [(b"one", address), (&oversized, address), (b"two", address)];
        let (sent, _) = sender.send(&parts);
        assert_eq!(sent, 1);
        let (sent, error) = sender.send(&parts[1..]);
        assert_eq!((sent, error.is_some()), (0, true));
        assert_eq!(sender.send(&parts[2..]).0, 1);
        assert_eq!([receive(&receiver), receive(&receiver)], [b"one", b"two"]);
    }
}
