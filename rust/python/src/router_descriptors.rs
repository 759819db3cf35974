//! Descriptors from Python, duplicated: the engine owns its own, and Python may close its.

use mavstack_router::engine::stream::RawStream;
use pyo3::prelude::*;
use std::net::UdpSocket;

#[cfg(unix)]
type Owned = std::os::fd::OwnedFd;
#[cfg(windows)]
type Owned = std::os::windows::io::OwnedSocket;

#[cfg(unix)]
fn duplicate(descriptor: i64) -> PyResult<Owned> {
    use std::os::fd::BorrowedFd;
    let descriptor = i32::try_from(descriptor).ok().filter(|&descriptor| descriptor >= 0);
    let descriptor = descriptor.ok_or_else(|| std::io::Error::from_raw_os_error(9))?; // EBADF
    // SAFETY: the descriptor is not -1, and is used for one call only, which fails if it is not open.
    Ok(unsafe { BorrowedFd::borrow_raw(descriptor) }.try_clone_to_owned()?)
}

#[cfg(windows)]
fn duplicate(descriptor: i64) -> PyResult<Owned> {
    use std::os::windows::io::BorrowedSocket;
    // SAFETY: the socket is used for one call only, which fails if it is not open.
    Ok(unsafe { BorrowedSocket::borrow_raw(descriptor as u64) }.try_clone_to_owned()?)
}

pub fn udp_of(descriptor: i64) -> PyResult<UdpSocket> {
    Ok(UdpSocket::from(duplicate(descriptor)?))
}

pub fn stream_of(descriptor: i64) -> PyResult<RawStream> {
    Ok(RawStream::new(duplicate(descriptor)?)?)
}
