//! Python interface of the router's engine. The typed face is `mavstack.router.engine`.

use crate::buffers::Bytes;
use crate::dialect::AnyDialect;
use crate::router_descriptors::{stream_of, udp_of};
use crate::router_events::to_tuple;
use crate::router_rules::{PeerTuple, RuleTuple, action, address, peer_ranges, rules};
use crate::router_statistics::Statistics;
use crate::signing::Signing;
use mavstack_router::engine::stream::Framing;
use mavstack_router::engine::udp::UdpOptions;
use mavstack_router::engine::{Engine, RuleSet};
use mavstack_router::gateway::Gateway;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use std::sync::Arc;

/// A router on a thread of its own; see `mavstack.router.RouterEngine`.
///
/// Args:
///     dialect: A `mavstack.Dialect` or a dialect module, which defines the messages.
///     duplicate_window: Seconds within which copies of a packet on other endpoints are dropped.
///
/// Raises:
///     OSError: The system has no more threads or descriptors.
#[pyclass(frozen, module = "mavstack._core")]
pub struct RouterCore {
    engine: Engine,
}

fn microseconds(seconds: f64) -> u64 {
    (seconds.max(0.0) * 1e6) as u64
}

#[pymethods]
impl RouterCore {
    #[new]
    fn new(dialect: AnyDialect, duplicate_window: f64) -> PyResult<Self> {
        let dialect = Arc::clone(&dialect.0.get().core);
        Ok(Self { engine: Engine::start(dialect, microseconds(duplicate_window))? })
    }

    /// Add a UDP socket, whose descriptor is duplicated; return the number of the endpoint.
    fn add_udp(
        &self,
        descriptor: i64,
        peer: Option<(String, u16)>,
        idle: f64,
        max_peers: usize,
        trusts_senders: bool,
    ) -> PyResult<u32> {
        let peer = peer.map(|(host, port)| address(&host, port)).transpose()?;
        let options = UdpOptions { peer, idle: microseconds(idle), max_peers, trusts_senders };
        Ok(self.engine.add_udp(udp_of(descriptor)?, options)?)
    }

    /// Add a stream, whose descriptor is duplicated; return the number of the endpoint.
    fn add_stream(&self, descriptor: i64, has_lengths: bool, queue_bytes: usize) -> PyResult<u32> {
        let framing = if has_lengths { Framing::Length } else { Framing::None };
        Ok(self.engine.add_stream(stream_of(descriptor)?, framing, queue_bytes))
    }

    /// Add an endpoint whose bytes the program carries; return its number.
    fn add_queue(&self, capacity: usize) -> u32 {
        self.engine.add_queue(capacity)
    }

    /// Open an endpoint that was added; nothing passes it before.
    fn start(&self, endpoint: u32) {
        self.engine.start_endpoint(endpoint);
    }

    /// Route bytes from the program; return whether there was room, or None if the endpoint is no queue.
    fn push(&self, endpoint: u32, data: Bytes<'_>) -> Option<bool> {
        self.engine.push(endpoint, &data)
    }

    /// Return the packets for the program, oldest first, or None if the endpoint is no queue.
    fn pull<'py>(&self, py: Python<'py>, endpoint: u32) -> PyResult<Option<Bound<'py, PyList>>> {
        let Some(packets) = self.engine.pull(endpoint) else {
            return Ok(None);
        };
        PyList::new(py, packets.iter().map(|packet| PyBytes::new(py, packet))).map(Some)
    }

    /// Remove an endpoint.
    fn remove(&self, endpoint: u32) {
        self.engine.remove(endpoint);
    }

    /// Pause an endpoint, or let it continue.
    fn pause(&self, endpoint: u32, paused: bool) {
        self.engine.pause(endpoint, paused);
    }

    /// Set the rules of an endpoint.
    fn set_rules(
        &self,
        endpoint: u32,
        incoming: Vec<RuleTuple>,
        outgoing: Vec<RuleTuple>,
        default_incoming: &str,
        default_outgoing: &str,
        bytes_per_second: Option<f64>,
    ) -> PyResult<()> {
        let rules = RuleSet {
            incoming: rules(incoming)?,
            outgoing: rules(outgoing)?,
            default_incoming: action(default_incoming)?,
            default_outgoing: action(default_outgoing)?,
            bytes_per_second,
        };
        self.engine.set_rules(endpoint, rules);
        Ok(())
    }

    /// Set the group of an endpoint.
    fn set_group(&self, endpoint: u32, group: Option<String>) {
        self.engine.set_group(endpoint, group);
    }

    /// Drop packets from an endpoint, or accept them.
    fn set_listen_only(&self, endpoint: u32, listen_only: bool) {
        self.engine.set_listen_only(endpoint, listen_only);
    }

    /// Give an endpoint a copy of every accepted packet, or no longer.
    fn set_monitor(&self, endpoint: u32, monitor: bool) {
        self.engine.set_monitor(endpoint, monitor);
    }

    /// Set the ranges of peers that a listening socket accepts.
    fn set_allowed_peers(&self, endpoint: u32, ranges: Option<Vec<PeerTuple>>) -> PyResult<()> {
        self.engine.set_allowed_peers(endpoint, ranges.map(peer_ranges).transpose()?);
        Ok(())
    }

    /// Cut off peers of a listening socket, and free all others.
    fn set_blocked_peers(&self, endpoint: u32, peers: Vec<(String, u16)>) -> PyResult<()> {
        let peers = peers.iter().map(|(host, port)| address(host, *port)).collect::<PyResult<_>>()?;
        self.engine.set_blocked_peers(endpoint, peers);
        Ok(())
    }

    /// Set how the identity of the peer of an endpoint is proven, 0 to 4.
    fn set_authority(&self, endpoint: u32, authority: u8) -> PyResult<()> {
        self.engine.set_authority(endpoint, crate::claims::authority_of(authority)?);
        Ok(())
    }

    /// Set the signing of an endpoint; the state of the keys is shared with the given objects.
    fn set_signing(
        &self,
        endpoint: u32,
        incoming: Option<PyRef<'_, Signing>>,
        outgoing: Option<PyRef<'_, Signing>>,
        allow_unsigned: Vec<u32>,
        strip: bool,
    ) {
        let shared = |signing: PyRef<'_, Signing>| signing.core.for_link(signing.core.link_id());
        let (incoming, outgoing) = (incoming.map(shared), outgoing.map(shared));
        self.engine.set_gateway(endpoint, Gateway { incoming, outgoing, allow_unsigned, strip });
    }

    /// Pass or drop a packet that waits for a decision.
    fn decide(&self, token: u64, passed: bool) {
        self.engine.decide(token, passed);
    }

    /// Return the counters of all endpoints and the learned routes.
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let snapshot = py.detach(|| self.engine.statistics());
        let snapshot = snapshot.map_err(|_| PyRuntimeError::new_err("the router engine is closed"))?;
        Statistics(&snapshot).to_dict(py)
    }

    /// Return the events since the last call, oldest first, as tuples.
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let tuples = self.engine.events().iter().map(|event| to_tuple(py, event)).collect::<PyResult<Vec<_>>>()?;
        PyList::new(py, tuples)
    }

    /// Return the descriptor that is readable while events wait.
    fn fileno(&self) -> i64 {
        self.engine.event_descriptor()
    }

    /// End the engine, and close all endpoints.
    fn close(&self, py: Python<'_>) {
        py.detach(|| self.engine.close());
    }
}
