//! Events of the router as tuples, whose first item is the kind of the event.

use mavstack_router::event::{Event, Notice};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use std::net::SocketAddr;

fn host_and_port(address: &SocketAddr) -> (String, u16) {
    (address.ip().to_string(), address.port())
}

pub fn to_tuple<'py>(py: Python<'py>, event: &Event) -> PyResult<Bound<'py, PyTuple>> {
    match event {
        Event::Closed { endpoint, reason } => ("closed", *endpoint, reason).into_pyobject(py),
        Event::Ended => ("ended",).into_pyobject(py),
        Event::Readable { endpoint } => ("readable", *endpoint).into_pyobject(py),
        Event::Inspect { token, endpoint, outgoing, peer, verified, packet } => {
            let kind = if *outgoing { "inspect_out" } else { "inspect" };
            let peer = peer.as_ref().map(host_and_port);
            (kind, *token, *endpoint, PyBytes::new(py, packet), peer, *verified).into_pyobject(py)
        }
        Event::PeerOpened { endpoint, address } => ("peer", *endpoint, host_and_port(address)).into_pyobject(py),
        Event::PeerClosed { endpoint, address } => ("peer_closed", *endpoint, host_and_port(address)).into_pyobject(py),
        Event::Notice { endpoint, notice, system, component, message_id } => {
            let packet = (*system, *component, *message_id);
            match notice {
                Notice::Rule { name, outgoing, dry_run, .. } => {
                    ("rule", *endpoint, packet, name, *outgoing, *dry_run).into_pyobject(py)
                }
                Notice::Loop => ("loop", *endpoint, packet).into_pyobject(py),
                Notice::Spoofed => ("spoofed", *endpoint, packet).into_pyobject(py),
                Notice::Contested => ("contested", *endpoint, packet).into_pyobject(py),
                Notice::SigningKey => ("signing_key", *endpoint, packet).into_pyobject(py),
                Notice::Refused(reason) => ("refused", *endpoint, packet, *reason).into_pyobject(py),
                Notice::Rebooted => ("rebooted", *endpoint, packet).into_pyobject(py),
            }
        }
    }
}
