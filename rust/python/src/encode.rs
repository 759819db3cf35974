//! Python interface of the encoder.

use crate::errors::EncodeError;
use crate::message;
use crate::signing::{self, Signing};
use mavstack_core::encode::{self as core, Sender, Version};
use mavstack_core::header::MAX_PACKET;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyInt};

fn version(number: u8) -> PyResult<Version> {
    match number {
        1 => Ok(Version::V1),
        2 => Ok(Version::V2),
        _ => Err(EncodeError::new_err(format!("unknown MAVLink version {number}: must be 1 or 2"))),
    }
}

/// A system id, component id or sequence number: a Python integer that fits one byte.
pub struct Byte(u8);

impl<'a, 'py> FromPyObject<'a, 'py> for Byte {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        object.extract().map(Self).map_err(|error| {
            if object.is_instance_of::<PyInt>() {
                EncodeError::new_err(format!("{} is outside 0..255", object.as_any()))
            } else {
                error
            }
        })
    }
}

fn encode_message<'py>(
    message: &Bound<'py, PyAny>,
    version: Version,
    sender: Sender,
    signing: Option<&Py<Signing>>,
    now: Option<f64>,
    packet: &mut Vec<u8>,
) -> PyResult<Bound<'py, PyBytes>> {
    let py = message.py();
    if version == Version::V1 && signing.is_some() {
        return Err(EncodeError::new_err("MAVLink 1 cannot be signed"));
    }
    let (data, payload) = message::open(message)?;
    let now = signing::timestamp(now)?;
    let mut signing = signing.map(|signing| signing.bind(py).try_borrow_mut()).transpose()?;
    let signing = signing.as_mut().map(|signing| (&mut signing.core, now));
    core::encode(packet, version, &data.layout, payload, sender, signing)
        .map_err(|error| EncodeError::new_err(format!("{}: {error}", data.class_name)))?;
    Ok(PyBytes::new(py, packet))
}

/// Encode one message as a packet.
///
/// Args:
///     message: The message to encode.
///     system: System id of the sender, 0 to 255.
///     component: Component id of the sender, 0 to 255.
///     sequence: Sequence number of the packet, 0 to 255.
///     version: MAVLink version, 1 or 2.
///     signing: Signing state of the link, which signs the packet; None for an unsigned packet.
///     now: Current Unix time in seconds, used for signing only; None advances the signing timestamp by one unit.
///
/// Returns:
///     The bytes of the packet.
///
/// Raises:
///     EncodeError: An id is out of range, or the version cannot carry the message or the signature.
///     SigningError: `now` is not a valid time for signing.
#[pyfunction]
#[pyo3(signature = (message, *, system, component, sequence = Byte(0), version = 2, signing = None, now = None))]
pub fn encode<'py>(
    message: &Bound<'py, PyAny>,
    system: Byte,
    component: Byte,
    sequence: Byte,
    version: u8,
    signing: Option<Py<Signing>>,
    now: Option<f64>,
) -> PyResult<Bound<'py, PyBytes>> {
    let sender = Sender { system: system.0, component: component.0, sequence: sequence.0 };
    encode_message(message, self::version(version)?, sender, signing.as_ref(), now, &mut Vec::with_capacity(MAX_PACKET))
}

/// Encoder of the messages that one component sends over one link, with their sequence numbers.
///
/// Args:
///     system: System id of the sender, 0 to 255.
///     component: Component id of the sender, 0 to 255.
///     version: MAVLink version, 1 or 2.
///     signing: Signing state of the link, which signs the packets; None for unsigned packets.
///
/// Raises:
///     EncodeError: An id or the version is out of range.
#[pyclass(module = "mavstack._core")]
pub struct Encoder {
    /// System id of the sender.
    #[pyo3(get)]
    system: u8,
    /// Component id of the sender.
    #[pyo3(get)]
    component: u8,
    /// Sequence number of the next packet, 0 to 255.
    #[pyo3(get, set)]
    sequence: u8,
    version: Version,
    /// Signing state of the link, or None.
    #[pyo3(get)]
    signing: Option<Py<Signing>>,
    /// Buffer of the packet being encoded.
    packet: Vec<u8>,
}

#[pymethods]
impl Encoder {
    #[new]
    #[pyo3(signature = (system, component, *, version = 2, signing = None))]
    fn new(system: Byte, component: Byte, version: u8, signing: Option<Py<Signing>>) -> PyResult<Self> {
        let (system, component) = (system.0, component.0);
        let packet = Vec::with_capacity(MAX_PACKET);
        Ok(Self { system, component, sequence: 0, version: self::version(version)?, signing, packet })
    }

    /// MAVLink version of the packets, 1 or 2.
    #[getter]
    fn version(&self) -> u8 {
        if self.version == Version::V1 { 1 } else { 2 }
    }

    /// Encode the next message as a packet, and advance the sequence number.
    ///
    /// Args:
    ///     message: The message to encode.
    ///     now: Current Unix time in seconds, used for signing only; None advances the signing timestamp by one unit.
    ///
    /// Returns:
    ///     The bytes of the packet.
    ///
    /// Raises:
    ///     EncodeError: The version cannot carry the message or the signature.
    ///     SigningError: `now` is not a valid time for signing.
    #[pyo3(signature = (message, now = None))]
    fn encode<'py>(&mut self, message: &Bound<'py, PyAny>, now: Option<f64>) -> PyResult<Bound<'py, PyBytes>> {
        let sender = Sender { system: self.system, component: self.component, sequence: self.sequence };
        let packet = encode_message(message, self.version, sender, self.signing.as_ref(), now, &mut self.packet)?;
        self.sequence = self.sequence.wrapping_add(1);
        Ok(packet)
    }
}
