//! Python interface of a socket that sends many datagrams at a time; see `mavstack.links.udp_outbox`.

use crate::buffers::Bytes;
use crate::intake_values::address;
use crate::router_descriptors::udp_of;
use mavstack_router::engine::sender;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::io::ErrorKind;
use std::net::SocketAddr;
use std::sync::{Mutex, PoisonError};

/// A UDP socket that sends several datagrams per system call, where the system can.
///
/// Args:
///     descriptor: The descriptor of the socket, which is duplicated.
///
/// Raises:
///     OSError: The descriptor is not open.
#[pyclass(frozen, module = "mavstack._core")]
pub struct DatagramSender {
    core: Mutex<sender::DatagramSender>,
}

#[pymethods]
impl DatagramSender {
    #[new]
    fn new(descriptor: i64) -> PyResult<Self> {
        Ok(Self { core: Mutex::new(sender::DatagramSender::new(udp_of(descriptor)?)?) })
    }

    /// Send datagrams in order until the system refuses one.
    ///
    /// Args:
    ///     datagrams: The datagrams, each with the address of its receiver.
    ///
    /// Returns:
    ///     The number of datagrams that were sent; and True if the system accepts no more at the moment, False if it sent
    ///     all or refused the next one for another reason.
    fn send(&self, py: Python<'_>, datagrams: Vec<(Bytes<'_>, Bound<'_, PyTuple>)>) -> PyResult<(usize, bool)> {
        let mut parts: Vec<(&[u8], SocketAddr)> = Vec::with_capacity(datagrams.len());
        let mut last: Option<(&Bound<'_, PyTuple>, SocketAddr)> = None;
        for (data, receiver) in &datagrams {
            let known = last.filter(|(before, _)| before.is(receiver)).map(|(_, known)| known);
            let Some(known) = known.map_or_else(|| address(receiver), |known| Ok(Some(known)))? else {
                break;
            };
            last = Some((receiver, known));
            parts.push((data, known));
        }
        let (sent, error) = py.detach(|| self.core.lock().unwrap_or_else(PoisonError::into_inner).send(&parts));
        Ok((sent, error.is_some_and(|error| error.kind() == ErrorKind::WouldBlock)))
    }

    /// The number of system calls so far.
    #[getter]
    fn calls(&self) -> u64 {
        self.core.lock().unwrap_or_else(PoisonError::into_inner).calls
    }
}
