//! Several datagrams per system call, on Linux.

use crate::engine::datagrams::{BATCH, ReceiveBuffer, Run, SendQueue};
use mio::net::UdpSocket;
use nix::errno::Errno;
use nix::sys::socket::{
    ControlMessage, MsgFlags, MultiHeaders, SockaddrIn, SockaddrIn6, SockaddrLike, SockaddrStorage, getsockopt,
    recvmmsg, sendmsg, setsockopt, sockopt,
};
use rustix::net::addr::SocketAddrArg;
use rustix::net::{MMsgHdr, RecvFlags, SendAncillaryBuffer, SendFlags, SocketAddrAny, recvfrom, sendmmsg, sendto};
use std::io::{self, IoSlice, IoSliceMut};
use std::net::{SocketAddr, SocketAddrV4, SocketAddrV6};
use std::os::fd::AsRawFd;

/// Datagrams whose memory is prepared while few come.
const FEW: usize = 8;

/// The headers of received datagrams. Those of both families differ in length, which the kernel stores in them.
pub struct Batches {
    headers_v4: MultiHeaders<SockaddrIn>,
    headers_v6: MultiHeaders<SockaddrIn6>,
}

impl Default for Batches {
    fn default() -> Self {
        Self { headers_v4: MultiHeaders::preallocate(BATCH, None), headers_v6: MultiHeaders::preallocate(BATCH, None) }
    }
}

/// Lets the system deliver datagrams of one sender that came together as one, where it can: parsers need no boundaries.
pub fn accept_joined(socket: &UdpSocket) {
    // Older kernels lack the option, and deliver each datagram.
    let _ = setsockopt(socket, sockopt::UdpGroSegment, &true);
}

/// Returns the bytes that the system keeps for datagrams that were not read yet, with its own overhead.
#[must_use]
pub fn receive_buffer(socket: &UdpSocket) -> Option<usize> {
    getsockopt(socket, sockopt::RcvBuf).ok()
}

/// Receives one datagram.
pub fn receive_one(socket: &UdpSocket, buffer: &mut ReceiveBuffer) -> io::Result<()> {
    buffer.received.clear();
    let (length, _, address) = recvfrom(socket, buffer.stream(), RecvFlags::DONTWAIT)?;
    if let Some(address) = address.and_then(|address| SocketAddr::try_from(address).ok()) {
        buffer.received.push((length, address));
    }
    Ok(())
}

impl Batches {
    /// Receives at most `count` datagrams, which are not more than a batch.
    pub fn receive(
        &mut self,
        socket: &UdpSocket,
        is_v6: bool,
        count: usize,
        buffer: &mut ReceiveBuffer,
    ) -> io::Result<()> {
        buffer.received.clear();
        match (is_v6, count <= FEW) {
            (true, true) => receive::<_, FEW>(socket, &mut self.headers_v6, count, buffer, from_v6),
            (true, false) => receive::<_, BATCH>(socket, &mut self.headers_v6, count, buffer, from_v6),
            (false, true) => receive::<_, FEW>(socket, &mut self.headers_v4, count, buffer, from_v4),
            (false, false) => receive::<_, BATCH>(socket, &mut self.headers_v4, count, buffer, from_v4),
        }
    }
}

fn from_v4(address: SockaddrIn) -> SocketAddr {
    SocketAddrV4::from(address).into()
}

fn from_v6(address: SockaddrIn6) -> SocketAddr {
    SocketAddrV6::from(address).into()
}

/// Receives at most `count` datagrams, which are not more than `N`.
fn receive<S: SockaddrLike + Copy, const N: usize>(
    socket: &UdpSocket,
    headers: &mut MultiHeaders<S>,
    count: usize,
    buffer: &mut ReceiveBuffer,
    to_address: impl Fn(S) -> SocketAddr,
) -> io::Result<()> {
    let (mut slots, received) = buffer.parts();
    let mut slices: [[IoSliceMut<'_>; 1]; N] =
        std::array::from_fn(|_| [IoSliceMut::new(slots.next().unwrap_or_default())]);
    let slices = slices.iter_mut().take(count);
    let messages = recvmmsg(socket.as_raw_fd(), headers, slices, MsgFlags::MSG_DONTWAIT, None)?;
    for message in messages {
        if let Some(address) = message.address {
            received.push((message.bytes, to_address(address)));
        }
    }
    Ok(())
}

/// Sends one datagram; without an address, to the peer of a connected socket.
#[inline]
pub fn send_one(socket: &UdpSocket, bytes: &[u8], address: Option<SocketAddr>) -> io::Result<()> {
    match address {
        None => rustix::net::send(socket, bytes, SendFlags::DONTWAIT)?,
        Some(address) => sendto(socket, bytes, SendFlags::DONTWAIT, &address)?,
    };
    Ok(())
}

/// Sends the first datagrams of a queue; returns how many were sent.
///
/// Datagrams of one length for one address pass the network stack together, as long as the system can divide them
/// again (`can_segment`).
pub fn send(socket: &UdpSocket, queue: &SendQueue, can_segment: &mut bool) -> io::Result<usize> {
    if let Some((bytes, address)) = queue.only() {
        return send_one(socket, bytes, address).map(|()| 1);
    }
    if *can_segment && let Some(run) = queue.first_run() {
        match send_run(socket, &run) {
            Ok(()) => return Ok(run.count),
            Err(Errno::EAGAIN) => return Err(io::ErrorKind::WouldBlock.into()),
            // Devices without checksums, and paths with a small MTU: one by one, as for any other error.
            Err(Errno::EIO | Errno::EINVAL | Errno::EMSGSIZE | Errno::EOPNOTSUPP) => *can_segment = false,
            Err(_) => {}
        }
    }
    send_each(socket, queue)
}

/// Sends datagrams of one length; the last one may be shorter.
fn send_run(socket: &UdpSocket, run: &Run<'_>) -> nix::Result<()> {
    let (slice, length) = ([IoSlice::new(run.bytes)], run.length);
    let control = [ControlMessage::UdpGsoSegments(&length)];
    let (descriptor, flags) = (socket.as_raw_fd(), MsgFlags::MSG_DONTWAIT);
    match run.address {
        None => sendmsg::<()>(descriptor, &slice, &control, flags, None),
        Some(address) => sendmsg(descriptor, &slice, &control, flags, Some(&SockaddrStorage::from(address))),
    }?;
    Ok(())
}

fn send_each(socket: &UdpSocket, queue: &SendQueue) -> io::Result<usize> {
    let mut slices: [[IoSlice<'_>; 1]; BATCH] = std::array::from_fn(|_| [IoSlice::new(&[])]);
    let mut addresses: [Option<SocketAddrAny>; BATCH] = [const { None }; BATCH];
    let mut controls: [SendAncillaryBuffer<'_, '_, '_>; BATCH] =
        std::array::from_fn(|_| SendAncillaryBuffer::default());
    let mut count = 0;
    for (index, (bytes, address)) in queue.first().enumerate() {
        slices[index] = [IoSlice::new(bytes)];
        addresses[index] = address.map(|address| address.as_any());
        count = index + 1;
    }
    let parts = slices.iter().zip(&addresses).zip(&mut controls).take(count);
    let mut headers: Vec<MMsgHdr<'_>> = parts
        .map(|((slice, address), control)| match address {
            Some(address) => MMsgHdr::new_with_addr(address, slice, control),
            None => MMsgHdr::new(slice, control),
        })
        .collect();
    Ok(sendmmsg(socket, &mut headers, SendFlags::DONTWAIT)?)
}
