//! One datagram per system call, where the system has no other way.

use crate::engine::datagrams::{ReceiveBuffer, SendQueue};
use mio::net::UdpSocket;
use std::io;
use std::net::SocketAddr;

/// Nothing is kept between calls.
#[derive(Debug, Default)]
pub struct Batches;

/// The system delivers each datagram.
pub fn accept_joined(_socket: &UdpSocket) {}

/// The size of the system's buffer is not known.
#[must_use]
pub fn receive_buffer(_socket: &UdpSocket) -> Option<usize> {
    None
}

/// Receives one datagram.
pub fn receive_one(socket: &UdpSocket, buffer: &mut ReceiveBuffer) -> io::Result<()> {
    Batches.receive(socket, false, 1, buffer)
}

impl Batches {
    /// Receives at most `count` datagrams, which are not more than a batch.
    pub fn receive(
        &mut self,
        socket: &UdpSocket,
        _is_v6: bool,
        count: usize,
        buffer: &mut ReceiveBuffer,
    ) -> io::Result<()> {
        buffer.received.clear();
        let (slots, received) = buffer.parts();
        for slot in slots.take(count) {
            match socket.recv_from(slot) {
                Ok(datagram) => received.push(datagram),
                Err(error) if received.is_empty() => return Err(error),
                Err(_) => break,
            }
        }
        Ok(())
    }
}

/// Sends one datagram; without an address, to the peer of a connected socket.
pub fn send_one(socket: &UdpSocket, bytes: &[u8], address: Option<SocketAddr>) -> io::Result<()> {
    address.map_or_else(|| socket.send(bytes), |address| socket.send_to(bytes, address)).map(|_| ())
}

/// Sends the first datagrams of a queue; returns how many were sent.
pub fn send(socket: &UdpSocket, queue: &SendQueue, _can_segment: &mut bool) -> io::Result<usize> {
    let mut count = 0;
    for (bytes, address) in queue.first() {
        match send_one(socket, bytes, address) {
            Ok(()) => count += 1,
            Err(error) if count == 0 => return Err(error),
            Err(_) => break,
        }
    }
    Ok(count)
}
