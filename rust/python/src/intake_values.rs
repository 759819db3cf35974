//! Values of the input of a node: addresses, levels, places of fields, and activities.

use crate::dialect::Dialect;
use crate::packet;
use mavstack_intake::channel::{Activity, Boot};
use mavstack_intake::fields::{HeadingFields, PositionFields};
use mavstack_intake::intake::Peer;
use mavstack_intake::messages::Interest;
use mavstack_intake::queue::{Datagrams, PacketRun};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList, PyString, PyTuple};
use std::net::{IpAddr, SocketAddr, SocketAddrV6};

/// The packets of a channel: those for the engine, those for listeners, and whether they were kept.
pub type Run<'py> = (u32, Bound<'py, PyList>, Bound<'py, PyList>, bool);

pub fn to_run<'py>(py: Python<'py>, run: &PacketRun, dialect: &Py<Dialect>) -> PyResult<Run<'py>> {
    let (for_engine, for_listeners) = (PyList::empty(py), PyList::empty(py));
    for (one, takers) in run.packets() {
        let packet = packet::create(py, &one, dialect)?;
        if takers.engine {
            for_engine.append(&packet)?;
        }
        if takers.listeners && run.is_kept {
            for_listeners.append(packet)?;
        }
    }
    Ok((run.channel, for_engine, for_listeners, run.is_kept))
}

pub fn to_position([message_id, latitude, longitude, north, east]: [usize; 5]) -> PositionFields {
    PositionFields { message_id: message_id as u32, latitude, longitude, speeds: [north, east] }
}

pub fn to_heading([message_id, roll, pitch, yaw, yaw_speed]: [usize; 5]) -> HeadingFields {
    HeadingFields { message_id: message_id as u32, roll, pitch, yaw, yaw_speed }
}

/// The last expected boot time in milliseconds, and the time of its packet; `None`: none is expected.
pub type LastBoot = Option<(u32, f64)>;

pub fn to_boot(boot: Option<Boot>) -> LastBoot {
    boot.map(|boot| (boot.boot_ms, boot.seen_at))
}

pub fn interest(level: u8) -> PyResult<Interest> {
    [Interest::Unknown, Interest::Nothing, Interest::NewBoot, Interest::Soon, Interest::Now]
        .get(usize::from(level))
        .copied()
        .ok_or_else(|| PyValueError::new_err(format!("there is no interest {level}")))
}

/// The address of a peer as sockets of Python give it; port 0: any port of the host.
pub fn peer(address: &Bound<'_, PyTuple>) -> PyResult<Option<Peer>> {
    let known = self::address(address)?;
    Ok(known.map(|known| if known.port() == 0 { Peer::Host(known.ip()) } else { Peer::Address(known) }))
}

/// An address as sockets of Python give it; `None`: its host is not an IP address.
pub fn address(address: &Bound<'_, PyTuple>) -> PyResult<Option<SocketAddr>> {
    let (host, port) = (address.get_item(0)?.cast_into::<PyString>()?, address.get_item(1)?.extract()?);
    // The name of a scope follows the address; its number is in the tuple.
    let Ok(ip) = host.to_str()?.split('%').next().unwrap_or_default().parse::<IpAddr>() else {
        return Ok(None);
    };
    Ok(Some(match ip {
        IpAddr::V6(v6) if address.len() == 4 => {
            let (flow, scope): (u32, u32) = (address.get_item(2)?.extract()?, address.get_item(3)?.extract()?);
            SocketAddr::V6(SocketAddrV6::new(v6, port, flow, scope))
        }
        _ => SocketAddr::new(ip, port),
    }))
}

fn to_tuple(py: Python<'_>, address: SocketAddr) -> PyResult<Bound<'_, PyTuple>> {
    match address {
        SocketAddr::V4(v4) => (v4.ip().to_string(), v4.port()).into_pyobject(py),
        SocketAddr::V6(v6) => (v6.ip().to_string(), v6.port(), v6.flowinfo(), v6.scope_id()).into_pyobject(py),
    }
}

pub fn datagrams<'py>(py: Python<'py>, one: &Datagrams) -> PyResult<Bound<'py, PyTuple>> {
    (one.socket, to_tuple(py, one.address)?, PyBytes::new(py, &one.data), one.count).into_pyobject(py)
}

pub fn to_activity(activity: Activity) -> (u64, u64, f64, f64) {
    (activity.bytes, activity.datagrams, activity.received_at, activity.valid_at)
}
