//! Python interface of the encoder.

use crate::class;
use crate::errors::EncodeError;
use crate::message;
use crate::signing::{self, Signing};
use mavstack_core::encode::{self as core, Sender, Version};
use mavstack_core::header::MAX_PACKET;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyInt, PyTuple};
use std::ffi::CString;
use std::sync::atomic::{AtomicU8, Ordering};

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
#[pyclass(frozen, module = "mavstack._core")]
pub struct Encoder {
    /// System id of the sender.
    #[pyo3(get)]
    system: u8,
    /// Component id of the sender.
    #[pyo3(get)]
    component: u8,
    sequence: AtomicU8,
    version: Version,
    /// Signing state of the link, or None.
    #[pyo3(get)]
    signing: Option<Py<Signing>>,
}

#[pymethods]
impl Encoder {
    #[new]
    #[pyo3(signature = (system, component, *, version = 2, signing = None))]
    fn new(system: Byte, component: Byte, version: u8, signing: Option<Py<Signing>>) -> PyResult<Self> {
        let (system, component, sequence) = (system.0, component.0, AtomicU8::new(0));
        Ok(Self { system, component, sequence, version: self::version(version)?, signing })
    }

    /// Sequence number of the next packet, 0 to 255.
    #[getter]
    fn sequence(&self) -> u8 {
        self.sequence.load(Ordering::Relaxed)
    }

    #[setter]
    fn set_sequence(&self, value: u8) {
        self.sequence.store(value, Ordering::Relaxed);
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
    fn encode<'py>(&self, message: &Bound<'py, PyAny>, now: Option<f64>) -> PyResult<Bound<'py, PyBytes>> {
        let mut packet = Vec::with_capacity(MAX_PACKET);
        let packet = encode_message(message, self.version, self.sender(), self.signing.as_ref(), now, &mut packet)?;
        self.advance();
        Ok(packet)
    }
}

impl Encoder {
    #[inline]
    fn sender(&self) -> Sender {
        Sender { system: self.system, component: self.component, sequence: self.sequence() }
    }

    /// Changes happen with the interpreter lock held, so that no other one comes between.
    #[inline]
    fn advance(&self) {
        self.set_sequence(self.sequence().wrapping_add(1));
    }

    /// Encodes a message without a signature in version 2; `None` if this is another encoder or object.
    ///
    /// # Safety
    /// `object` must be held through the call.
    #[inline]
    unsafe fn encode_plain<'py>(&self, py: Python<'py>, object: *mut ffi::PyObject) -> Option<Bound<'py, PyBytes>> {
        if self.signing.is_some() || self.version == Version::V1 {
            return None;
        }
        // SAFETY: the object is held, and with it its class; only messages have class data.
        let (data, payload) = unsafe { (class::direct_data(py, ffi::Py_TYPE(object))?, message::payload(object)) };
        if payload.len() < usize::from(data.layout.length) {
            return None;
        }
        let mut packet = [0; core::MAX_UNSIGNED];
        let length = core::write_v2(&mut packet, &data.layout, core::trimmed(payload), self.sender(), 0);
        self.advance();
        Some(PyBytes::new(py, &packet[..length]))
    }
}

/// The method `Encoder.encode` as PyO3 makes it, for all calls but the frequent one.
static GENERAL_ENCODE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();

/// Replaces the method by one that handles the frequent call, with a message alone, without parsing arguments.
pub fn install_fast_encode(py: Python<'_>) -> PyResult<()> {
    let class = py.get_type::<Encoder>();
    let general = class.getattr("encode")?;
    let (signature, doc) = (general.getattr("__text_signature__")?, general.getattr("__doc__")?);
    let doc = CString::new(format!("encode{signature}\n--\n\n{doc}"))?;
    let definition = Box::leak(Box::new(ffi::PyMethodDef {
        ml_name: c"encode".as_ptr(),
        ml_meth: ffi::PyMethodDefPointer { PyCFunctionFastWithKeywords: fast_encode },
        ml_flags: ffi::METH_FASTCALL | ffi::METH_KEYWORDS,
        ml_doc: doc.into_raw(),
    }));
    // SAFETY: the definition and its texts are leaked.
    let method = unsafe { Bound::from_owned_ptr_or_err(py, ffi::PyDescr_NewMethod(class.as_type_ptr(), definition)) }?;
    class.setattr("encode", method)?;
    GENERAL_ENCODE.get_or_init(py, || general.unbind());
    Ok(())
}

unsafe extern "C" fn fast_encode(
    encoder: *mut ffi::PyObject,
    args: *const *mut ffi::PyObject,
    count: ffi::Py_ssize_t,
    keyword_names: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: Python calls the method with an encoder, an array of arguments, and a tuple of names or null.
    unsafe {
        let py = Python::assume_attached();
        if keyword_names.is_null() && count == 1 {
            let encoder = Borrowed::from_ptr(py, encoder).cast_unchecked::<Encoder>();
            if let Some(packet) = encoder.get().encode_plain(py, *args) {
                return packet.into_ptr();
            }
        }
        let keywords = if keyword_names.is_null() { 0 } else { ffi::PyTuple_Size(keyword_names) as usize };
        let values = if args.is_null() { &[] } else { std::slice::from_raw_parts(args, count as usize + keywords) };
        let names = Bound::from_borrowed_ptr_or_opt(py, keyword_names);
        let encoder = Bound::from_borrowed_ptr(py, encoder);
        message::into_result_pointer(py, general_encode(&encoder, values, count as usize, names.as_ref()))
    }
}

/// Calls the general method with arguments: positional ones, then one for each name.
///
/// # Safety
/// The arguments must be held through the call.
#[cold]
unsafe fn general_encode<'py>(
    encoder: &Bound<'py, PyAny>,
    values: &[*mut ffi::PyObject],
    positional: usize,
    names: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = encoder.py();
    // SAFETY: guaranteed by the caller.
    let object = |&value: &*mut ffi::PyObject| unsafe { Bound::from_borrowed_ptr(py, value) };
    let (ordered, others) = values.split_at(positional);
    let args =
        PyTuple::new(py, std::iter::once(encoder.clone()).chain(ordered.iter().map(object)).collect::<Vec<_>>())?;
    let kwargs = PyDict::new(py);
    for (name, value) in names.map(PyAnyMethods::try_iter).transpose()?.into_iter().flatten().zip(others) {
        kwargs.set_item(name?, object(value))?;
    }
    let general = GENERAL_ENCODE.get(py).ok_or_else(message::payload_mismatch)?;
    general.bind(py).call(args, Some(&kwargs))
}
