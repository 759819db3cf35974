//! Python interface of the router without its engine, for programs that carry the packets themselves.

use crate::buffers::Bytes;
use crate::dialect::{AnyDialect, Dialect};
use mavstack_core::header::Header;
use mavstack_core::parser::Packet;
use mavstack_router::ports::PortId;
use mavstack_router::router::{Origin, Router, Sink, Time, Unsent};
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::sync::Arc;

/// The decision of the router where each packet goes, without sockets and threads.
///
/// Args:
///     dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
#[pyclass(module = "mavstack._core")]
pub struct PacketRouter {
    router: Router,
    dialect: Py<Dialect>,
}

/// The ports that a packet goes to.
struct Ports(Vec<PortId>);

impl Sink for Ports {
    fn send(&mut self, port: PortId, _packet: &[u8], _origin: Origin) -> Result<(), Unsent> {
        self.0.push(port);
        Ok(())
    }
}

#[pymethods]
impl PacketRouter {
    #[new]
    fn new(dialect: AnyDialect) -> Self {
        let core = Arc::clone(&dialect.0.get().core);
        Self { router: Router::new(core, 0), dialect: dialect.0 }
    }

    /// Add a place that packets come from and go to.
    ///
    /// Args:
    ///     group: Name of a group of redundant links, or None.
    ///
    /// Returns:
    ///     The number of the port; numbers of removed ports are used again.
    ///
    /// Raises:
    ///     RuntimeError: There are 4,096 ports already.
    #[pyo3(signature = (group = None))]
    fn add_port(&mut self, group: Option<String>) -> PyResult<PortId> {
        let endpoint = self.router.add_endpoint(0);
        let port = self.router.add_port(endpoint);
        if let Some(endpoint) = self.router.endpoint_mut(endpoint) {
            endpoint.group = group;
        }
        port.ok_or_else(|| PyRuntimeError::new_err("a router has at most 4096 ports"))
    }

    /// Remove a port and its routes. Idempotent.
    ///
    /// Args:
    ///     port: The port.
    fn remove_port(&mut self, port: PortId) {
        if let Some(endpoint) = self.router.endpoint_index(port) {
            self.router.remove_port(port);
            self.router.remove_endpoint(endpoint);
        }
    }

    /// Learn from a packet, and return the ports that it goes to.
    ///
    /// Args:
    ///     port: The port on which it was received.
    ///     packet: The bytes of exactly one valid packet.
    ///     now: Current time in seconds, of any clock that does not run back.
    ///
    /// Returns:
    ///     The ports; empty if the packet is dropped.
    ///
    /// Raises:
    ///     ValueError: The port is not open, or the bytes are not one packet.
    fn route(&mut self, port: PortId, packet: Bytes<'_>, now: f64) -> PyResult<Vec<PortId>> {
        let header = Header::parse(&packet).filter(|header| header.packet_length() == packet.len());
        let header = header.ok_or_else(|| PyValueError::new_err("the bytes are not exactly one packet"))?;
        if self.router.endpoint_index(port).is_none() {
            return Err(PyValueError::new_err(format!("port {port} is not open")));
        }
        let slot = self.dialect.get().core.entry(header.message_id).map(|entry| entry.slot);
        let packet = Packet { raw: &packet, header, slot, timestamp: None };
        let mut ports = Ports(Vec::new());
        let time = Time { now: (now.max(0.0) * 1e6) as u64 + 1, signing: 0 };
        self.router.route(port, &packet, time, &mut ports);
        self.router.events.take();
        Ok(ports.0)
    }
}
