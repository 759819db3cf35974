//! One received packet: its unchanged bytes, and its message, created on first access.
//!
//! Packets are the most frequent objects of a busy program. Like a message, each is one allocation with a layout of its
//! own: an object header, two references, and its bytes. Python's cycle collector does not track packets, because they
//! refer only to their dialect and their message, and neither can refer back to them.

use crate::buffers::Bytes;
use crate::class::{self, ClassData, slot};
use crate::dialect::{AnyDialect, Dialect};
use crate::freelist;
use crate::message::{self, into_result_pointer};
use crate::packet_getters::{self, GETTERS, Getter};
use mavstack_core::header::Header;
use mavstack_core::parser::{self, Parser};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::ffi;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyTuple, PyType};
use std::ffi::{CStr, c_int, c_uint, c_void};
use std::ptr;

/// A packet in memory; its bytes follow in the same allocation.
#[repr(C)]
struct Object {
    head: ffi::PyVarObject,
    packet: Packet,
    raw: [u8; 0],
}

/// The decoded parts of a packet.
pub struct Packet {
    pub header: Header,
    slot: Option<u16>,
    pub timestamp: Option<u64>,
    dialect: Py<Dialect>,
    message: Option<Py<PyAny>>,
}

const PACKET_DOC: &CStr = c"Packet(raw, dialect, timestamp=None)
--

A received packet with its unchanged bytes.

Args:
    raw: The bytes of exactly one packet.
    dialect: The dialect that decodes its message.
    timestamp: Recorded time in microseconds since 1970, or None.

Raises:
    ValueError: The bytes are not exactly one valid packet.";
static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// Returns the class of packets.
pub fn packet_class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    Ok(CLASS.get_or_try_init(py, || make_class(py))?.bind(py))
}

impl Packet {
    pub fn name(&self) -> Option<&str> {
        self.slot.map(|slot| self.dialect.get().core.layouts()[usize::from(slot)].name.as_str())
    }

    fn make_message<'py>(&self, py: Python<'py>, slot: u16, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
        let made = self.dialect.get().class(py, slot)?;
        let (class, payload) = (made.class.bind(py).as_type_ptr(), &raw[self.header.payload()]);
        // SAFETY: the dialect holds the class; `plain` is set for plain classes only, and the data is that of the class.
        unsafe {
            if let Some(length) = made.plain {
                return message::allocate_plain(py, class, length, payload);
            }
            match class::class_data(py, class) {
                Some(data) => message::allocate(py, class, data, payload),
                None => Err(message::payload_mismatch()),
            }
        }
    }

    fn text(&self) -> String {
        let Header { message_id, version, system, component, sequence, .. } = self.header;
        let name = self.name().map_or_else(|| format!("unknown {message_id}"), ToOwned::to_owned);
        let signed = if self.header.signed() { " signed" } else { "" };
        format!("<Packet {name} v{version} from {system}/{component} #{sequence}{signed}>")
    }
}

/// Creates a Python object for `packet`.
#[allow(clippy::inline_always, reason = "copies of a packet's parts cost as much as the object")]
#[inline(always)]
pub fn create<'py>(py: Python<'py>, packet: &parser::Packet<'_>, dialect: &Py<Dialect>) -> PyResult<Bound<'py, PyAny>> {
    let class = packet_class(py)?.as_type_ptr();
    let (length, parts) = (
        packet.raw.len(),
        Packet {
            header: packet.header,
            slot: packet.slot,
            timestamp: packet.timestamp,
            dialect: dialect.clone_ref(py),
            message: None,
        },
    );
    // SAFETY: `allocate` returns an `Object` followed by `length` bytes; its packet is written once, here, before any
    // other code can access the object, and moved out once, in `dealloc`.
    unsafe {
        let made = Bound::from_owned_ptr_or_err(py, freelist::allocate_packet(class, size_of::<Object>(), length))?;
        let object = made.as_ptr().cast::<Object>();
        (&raw mut (*object).packet).write(parts);
        (&raw mut (*object).raw).cast::<u8>().copy_from_nonoverlapping(packet.raw.as_ptr(), length);
        Ok(made)
    }
}

/// Returns the parts and the bytes of a packet.
///
/// # Safety
/// `object` must be a packet that lives as long as the result is used, and whose message is not being created.
#[inline]
unsafe fn open<'a>(object: *mut ffi::PyObject) -> (&'a Packet, &'a [u8]) {
    // SAFETY: a packet is laid out as `Object`, followed by the number of bytes in its header.
    unsafe {
        let object = object.cast::<Object>();
        let length = (*object).head.ob_size as usize;
        (&(*object).packet, std::slice::from_raw_parts((&raw const (*object).raw).cast(), length))
    }
}

/// Returns the parts and the bytes of an object, if it is a packet.
fn as_packet<'a>(object: &'a Bound<'_, PyAny>) -> Option<(&'a Packet, &'a [u8])> {
    let class = packet_class(object.py()).ok()?;
    // SAFETY: the class cannot be subclassed, so all its objects are packets.
    (object.get_type().is(class)).then(|| unsafe { open(object.as_ptr()) })
}

/// Calls a function with the data of the message class and the payload of an object, if it is a packet; with None if the
/// dialect does not define its message.
pub fn with_payload<T>(
    object: &Bound<'_, PyAny>,
    function: impl FnOnce(Option<(&ClassData, &[u8])>) -> T,
) -> PyResult<Option<T>> {
    let Some((packet, raw)) = as_packet(object) else {
        return Ok(None);
    };
    let Some(slot) = packet.slot else {
        return Ok(Some(function(None)));
    };
    let py = object.py();
    let class = packet.dialect.get().class(py, slot)?.class.bind(py).as_type_ptr();
    let data = class::class_data(py, class).ok_or_else(message::payload_mismatch)?;
    Ok(Some(function(Some((data, &raw[packet.header.payload()])))))
}

/// Calls a function with the header and the bytes of an object, if it is a packet.
pub fn with_parts<T>(object: &Bound<'_, PyAny>, function: impl FnOnce(Header, &[u8]) -> T) -> PyResult<T> {
    let (packet, raw) = as_packet(object).ok_or_else(|| PyTypeError::new_err("it is not a packet"))?;
    Ok(function(packet.header, raw))
}

fn make_class(py: Python<'_>) -> PyResult<Py<PyType>> {
    let mut getters: Vec<ffi::PyGetSetDef> =
        GETTERS.iter().map(|&(name, getter, doc)| property(name, get, doc, getter as *mut c_void)).collect();
    getters.push(property(
        c"message",
        get_message,
        c"The message, or None if its id is not in the dialect.",
        ptr::null_mut(),
    ));
    // SAFETY: an all-zero definition is the documented end of the table.
    getters.push(unsafe { std::mem::zeroed() });
    let methods = Box::leak(Box::new([
        message::method(c"__reduce__", reduce, ffi::METH_NOARGS, c"Support pickling."),
        ffi::PyMethodDef::zeroed(),
    ]));
    let mut slots = [
        slot(ffi::Py_tp_new, new as *mut c_void),
        slot(ffi::Py_tp_dealloc, dealloc as *mut c_void),
        slot(ffi::Py_tp_getattro, get_attribute as *mut c_void),
        slot(ffi::Py_tp_getset, Box::leak(getters.into_boxed_slice()).as_mut_ptr().cast()),
        slot(ffi::Py_tp_methods, methods.as_mut_ptr().cast()),
        slot(ffi::Py_tp_repr, repr as *mut c_void),
        slot(ffi::Py_tp_richcompare, compare as *mut c_void),
        slot(ffi::Py_tp_hash, hash as *mut c_void),
        slot(ffi::Py_sq_length, length as *mut c_void),
        slot(ffi::Py_tp_doc, PACKET_DOC.as_ptr().cast_mut().cast()),
        slot(0, ptr::null_mut()),
    ];
    let mut spec = ffi::PyType_Spec {
        name: c"mavstack._core.Packet".as_ptr(),
        basicsize: size_of::<Object>() as c_int,
        itemsize: 1,
        flags: ffi::Py_TPFLAGS_DEFAULT as c_uint,
        slots: slots.as_mut_ptr(),
    };
    // SAFETY: the spec and its slots live through the call; the tables are leaked.
    let class = unsafe { Bound::from_owned_ptr_or_err(py, ffi::PyType_FromSpec(&raw mut spec)) }?;
    Ok(class.cast_into::<PyType>()?.unbind())
}

fn property(name: &'static CStr, get: ffi::getter, doc: &'static CStr, closure: *mut c_void) -> ffi::PyGetSetDef {
    ffi::PyGetSetDef { name: name.as_ptr(), get: Some(get), set: None, doc: doc.as_ptr(), closure }
}

unsafe extern "C" fn get(object: *mut ffi::PyObject, closure: *mut c_void) -> *mut ffi::PyObject {
    // SAFETY: Python checked that the object is a packet; the closure is the getter set by `make_class`.
    unsafe {
        let py = Python::assume_attached();
        let getter: Getter = std::mem::transmute(closure);
        let (packet, raw) = open(object);
        into_result_pointer(py, getter(py, packet, raw))
    }
}

/// Gets an attribute: `message` and `message_id`, the most frequent ones, directly; all others generically.
unsafe extern "C" fn get_attribute(object: *mut ffi::PyObject, name: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the slot with a packet.
    unsafe {
        let py = Python::assume_attached();
        if intern!(py, "message").as_ptr() == name {
            get_message(object, ptr::null_mut())
        } else if intern!(py, "message_id").as_ptr() == name {
            into_result_pointer(py, packet_getters::object(py, open(object).0.header.message_id))
        } else {
            ffi::PyObject_GenericGetAttr(object, name)
        }
    }
}

unsafe extern "C" fn get_message(object: *mut ffi::PyObject, _: *mut c_void) -> *mut ffi::PyObject {
    // SAFETY: as in `get`. Creating the message may run Python code, even code that reads this packet's message, so the
    // parts are only read during it, and the message is stored afterwards, if none is stored yet.
    unsafe {
        let py = Python::assume_attached();
        let (packet, raw) = open(object);
        if let Some(message) = &packet.message {
            return message.clone_ref(py).into_ptr();
        }
        let Some(slot) = packet.slot else {
            return py.None().into_ptr();
        };
        match packet.make_message(py, slot, raw) {
            Ok(message) => {
                let cell = &mut (*object.cast::<Object>()).packet.message;
                cell.get_or_insert(message.unbind()).clone_ref(py).into_ptr()
            }
            Err(error) => into_result_pointer(py, Err(error)),
        }
    }
}

unsafe extern "C" fn dealloc(object: *mut ffi::PyObject) {
    // SAFETY: Python calls this once, with a packet without references, whose parts were written by `create`. Its message
    // is an object that `make_message` made.
    unsafe {
        let Packet { dialect, message, .. } = (&raw mut (*object.cast::<Object>()).packet).read();
        // Released explicitly: a drop would defer them to PyO3's pool, which does not know that Python is attached.
        let py = Python::assume_attached();
        dialect.drop_ref(py);
        if let Some(message) = message {
            message::release(py, message.into_ptr());
        }
        freelist::release_packet(object);
    }
}

unsafe extern "C" fn new(
    _class: *mut ffi::PyTypeObject,
    args: *mut ffi::PyObject,
    kwargs: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: Python calls `tp_new` with a tuple, and a dictionary or null.
    unsafe {
        let py = Python::assume_attached();
        let args = Bound::from_borrowed_ptr(py, args);
        let kwargs = Bound::from_borrowed_ptr_or_opt(py, kwargs);
        into_result_pointer(py, from_arguments(&args, kwargs.as_ref()))
    }
}

fn from_arguments<'py>(args: &Bound<'py, PyAny>, kwargs: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
    let kwargs = kwargs.map(|kwargs| kwargs.cast::<PyDict>()).transpose()?;
    let constructor = pyo3::wrap_pyfunction!(packet_from_bytes, args.py())?;
    constructor.call(args.cast::<PyTuple>()?, kwargs)
}

/// Creates a packet from its bytes.
#[pyfunction(name = "Packet")]
#[pyo3(signature = (raw, dialect, timestamp = None))]
fn packet_from_bytes<'py>(
    py: Python<'py>,
    raw: Bytes<'py>,
    dialect: AnyDialect,
    timestamp: Option<u64>,
) -> PyResult<Bound<'py, PyAny>> {
    let dialect = dialect.0;
    let (mut parser, mut made) = (Parser::new(false), None);
    parser.feed(&dialect.get().core, &raw, |packet| {
        if packet.raw.len() == raw.len() {
            made = Some(create(py, &parser::Packet { timestamp, ..packet }, &dialect));
        }
    });
    made.unwrap_or_else(|| Err(PyValueError::new_err("raw must be the bytes of exactly one valid MAVLink packet")))
}

unsafe extern "C" fn reduce(object: *mut ffi::PyObject, _: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the method with a packet.
    unsafe {
        let py = Python::assume_attached();
        let (packet, raw) = open(object);
        into_result_pointer(py, reduced(py, packet, raw))
    }
}

fn reduced<'py>(py: Python<'py>, packet: &Packet, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let arguments = (PyBytes::new(py, raw), packet.dialect.get().owner(py)?, packet.timestamp);
    packet_getters::object(py, (packet_class(py)?, arguments))
}

unsafe extern "C" fn repr(object: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the slot with a packet.
    unsafe {
        let py = Python::assume_attached();
        into_result_pointer(py, packet_getters::object(py, open(object).0.text()))
    }
}

unsafe extern "C" fn hash(object: *mut ffi::PyObject) -> ffi::Py_hash_t {
    // SAFETY: Python calls the slot with a packet.
    let (py, raw) = unsafe { (Python::assume_attached(), open(object).1) };
    PyBytes::new(py, raw).hash().unwrap_or(0)
}

unsafe extern "C" fn length(object: *mut ffi::PyObject) -> ffi::Py_ssize_t {
    // SAFETY: Python calls the slot with a packet.
    unsafe { open(object).1.len() as ffi::Py_ssize_t }
}

unsafe extern "C" fn compare(
    left: *mut ffi::PyObject,
    right: *mut ffi::PyObject,
    operator: c_int,
) -> *mut ffi::PyObject {
    // SAFETY: Python holds both objects through the call.
    let (py, left, right) = unsafe {
        let py = Python::assume_attached();
        (py, Bound::from_borrowed_ptr(py, left), Bound::from_borrowed_ptr(py, right))
    };
    let (Some((_, left)), Some((_, right))) = (as_packet(&left), as_packet(&right)) else {
        return py.NotImplemented().into_ptr();
    };
    let answer = match operator {
        ffi::Py_EQ => left == right,
        ffi::Py_NE => left != right,
        _ => return py.NotImplemented().into_ptr(),
    };
    into_result_pointer(py, answer.into_pyobject(py).map(|answer| answer.to_owned().into_any()).map_err(Into::into))
}
