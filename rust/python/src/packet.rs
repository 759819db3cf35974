//! One received packet: its bytes as they came, and its message when asked for.
//!
//! A packet is the object that a busy program makes most of, so, like a message, it is one allocation laid out
//! by hand: a header, the two objects that it refers to, and its bytes. Python's cycle collector does not know
//! it; a packet refers to its dialect and its message, and neither can refer back to it.

use crate::buffers::Bytes;
use crate::class::{self, slot};
use crate::dialect::{AnyDialect, Dialect};
use crate::message::{self, give};
use crate::spare;
use mavstack_core::header::{CHECKSUM, Header, SIGNATURE};
use mavstack_core::parser::{self, Parser};
use mavstack_core::signing::link_and_timestamp;
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::ffi;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyTuple, PyType};
use std::ffi::{CStr, c_int, c_uint, c_void};
use std::ptr;

/// A packet in memory; Python allocates its bytes behind it.
#[repr(C)]
struct Object {
    head: ffi::PyVarObject,
    packet: Packet,
    raw: [u8; 0],
}

/// What a packet knows beside its bytes.
struct Packet {
    header: Header,
    slot: Option<u16>,
    timestamp: Option<u64>,
    dialect: Py<Dialect>,
    message: Option<Py<PyAny>>,
}

static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// The class of packets.
pub fn packet_class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    Ok(CLASS.get_or_try_init(py, || make_class(py))?.bind(py))
}

/// A property of a packet: it is given the packet's parts and its bytes.
type Getter = for<'py> fn(Python<'py>, &Packet, &[u8]) -> PyResult<Bound<'py, PyAny>>;

/// Name, getter, documentation.
const GETTERS: &[(&CStr, Getter, &CStr)] = &[
    (c"name", name, c"Official name of the message, or None if the dialect does not have its id."),
    (c"version", |py, packet, _| object(py, packet.header.version), c"MAVLink version, 1 or 2."),
    (c"message_id", |py, packet, _| object(py, packet.header.message_id), c"Id of the message."),
    (c"system", |py, packet, _| object(py, packet.header.system), c"System id of the sender."),
    (c"component", |py, packet, _| object(py, packet.header.component), c"Component id of the sender."),
    (c"sequence", |py, packet, _| object(py, packet.header.sequence), c"Place in the sender's sequence."),
    (c"incompat_flags", |py, packet, _| object(py, packet.header.incompat_flags), c"Incompatibility flags."),
    (c"compat_flags", |py, packet, _| object(py, packet.header.compat_flags), c"Compatibility flags."),
    (
        c"signed",
        |py, packet, _| Ok(packet.header.signed().into_pyobject(py)?.to_owned().into_any()),
        c"Whether it is signed.",
    ),
    (
        c"link_id",
        |py, packet, raw| signature(py, packet, || link_and_timestamp(raw).0),
        c"Link id of the signature, or None.",
    ),
    (
        c"signature_timestamp",
        |py, packet, raw| signature(py, packet, || link_and_timestamp(raw).1),
        c"Timestamp of the signature in 10 us since 2015, or None.",
    ),
    (c"signature", signature_bytes, c"The 13 bytes of the signature, or None."),
    (
        c"timestamp",
        |py, packet, _| object(py, packet.timestamp),
        c"Microseconds since 1970 recorded before it, or None.",
    ),
    (c"checksum", checksum, c"The CRC as it came."),
    (
        c"payload",
        |py, packet, raw| Ok(PyBytes::new(py, &raw[packet.header.payload()]).into_any()),
        c"The payload as it came.",
    ),
    (c"raw", |py, _, raw| Ok(PyBytes::new(py, raw).into_any()), c"The whole packet as it came."),
];

fn object<'py, T: IntoPyObject<'py>>(py: Python<'py>, value: T) -> PyResult<Bound<'py, PyAny>> {
    value.into_bound_py_any(py)
}

fn signature<'py, T: IntoPyObject<'py>>(
    py: Python<'py>,
    packet: &Packet,
    value: impl Fn() -> T,
) -> PyResult<Bound<'py, PyAny>> {
    object(py, packet.header.signed().then(value))
}

fn name<'py>(py: Python<'py>, packet: &Packet, _: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    object(py, packet.name())
}

fn signature_bytes<'py>(py: Python<'py>, packet: &Packet, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    object(py, packet.header.signed().then(|| PyBytes::new(py, &raw[raw.len() - SIGNATURE..])))
}

fn checksum<'py>(py: Python<'py>, packet: &Packet, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let end = packet.header.payload().end;
    object(py, u16::from_le_bytes([raw[end], raw[end + CHECKSUM - 1]]))
}

impl Packet {
    fn name(&self) -> Option<&str> {
        self.slot.map(|slot| self.dialect.get().core.layouts()[usize::from(slot)].name.as_str())
    }

    fn make_message<'py>(&self, py: Python<'py>, slot: u16, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
        let made = self.dialect.get().class(py, slot)?;
        let (class, payload) = (made.class.bind(py).as_type_ptr(), &raw[self.header.payload()]);
        // SAFETY: the dialect holds the class; it is plain if it says so, and otherwise the data is that of the class.
        unsafe {
            if let Some(length) = made.plain {
                return message::allocate_plain(py, class, length, payload);
            }
            match class::class_data(py, class) {
                Some(data) => message::allocate(py, class, data, payload),
                None => Err(message::foreign_object()),
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

/// A new Python object for `packet`.
#[inline]
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
    // SAFETY: `allocate` gives an `Object` with room for `length` bytes behind it; its packet is written once, here,
    // before anyone sees the object, and taken out once, in `dealloc`.
    unsafe {
        let made = Bound::from_owned_ptr_or_err(py, spare::allocate(class, size_of::<Object>(), length))?;
        let object = made.as_ptr().cast::<Object>();
        (&raw mut (*object).packet).write(parts);
        (&raw mut (*object).raw).cast::<u8>().copy_from_nonoverlapping(packet.raw.as_ptr(), length);
        Ok(made)
    }
}

/// The parts and the bytes of a packet.
///
/// # Safety
/// `object` must be a packet, alive as long as the result is used, whose message is not being made.
#[inline]
unsafe fn open<'a>(object: *mut ffi::PyObject) -> (&'a Packet, &'a [u8]) {
    // SAFETY: a packet is laid out as `Object`, with as many bytes behind it as its size says.
    unsafe {
        let object = object.cast::<Object>();
        let length = (*object).head.ob_size as usize;
        (&(*object).packet, std::slice::from_raw_parts((&raw const (*object).raw).cast(), length))
    }
}

/// The parts of any object, if it is a packet.
fn as_packet<'a>(object: &'a Bound<'_, PyAny>) -> Option<(&'a Packet, &'a [u8])> {
    let class = packet_class(object.py()).ok()?;
    // SAFETY: the class cannot be derived from, so its objects are exactly the packets.
    (object.get_type().is(class)).then(|| unsafe { open(object.as_ptr()) })
}

fn make_class(py: Python<'_>) -> PyResult<Py<PyType>> {
    let mut getters: Vec<ffi::PyGetSetDef> =
        GETTERS.iter().map(|&(name, getter, doc)| property(name, get, doc, getter as *mut c_void)).collect();
    getters.push(property(c"message", get_message, c"The message, or None if its id is unknown.", ptr::null_mut()));
    // SAFETY: an all-zero definition is the documented end of the table.
    getters.push(unsafe { std::mem::zeroed() });
    let methods = Box::leak(Box::new([
        message::method(c"__reduce__", reduce, ffi::METH_NOARGS, c"For pickle."),
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
        slot(ffi::Py_tp_doc, c"A packet, byte for byte as it came.".as_ptr().cast_mut().cast()),
        slot(0, ptr::null_mut()),
    ];
    let mut spec = ffi::PyType_Spec {
        name: c"mavstack._core.Packet".as_ptr(),
        basicsize: size_of::<Object>() as c_int,
        itemsize: 1,
        flags: ffi::Py_TPFLAGS_DEFAULT as c_uint,
        slots: slots.as_mut_ptr(),
    };
    // SAFETY: the spec and its slots live through the call, the tables for ever.
    let class = unsafe { Bound::from_owned_ptr_or_err(py, ffi::PyType_FromSpec(&raw mut spec)) }?;
    Ok(class.cast_into::<PyType>()?.unbind())
}

fn property(name: &'static CStr, get: ffi::getter, doc: &'static CStr, closure: *mut c_void) -> ffi::PyGetSetDef {
    ffi::PyGetSetDef { name: name.as_ptr(), get: Some(get), set: None, doc: doc.as_ptr(), closure }
}

unsafe extern "C" fn get(object: *mut ffi::PyObject, closure: *mut c_void) -> *mut ffi::PyObject {
    // SAFETY: Python checked that the object is a packet; the closure is the getter that `make_class` gave.
    unsafe {
        let py = Python::assume_attached();
        let getter: Getter = std::mem::transmute(closure);
        let (packet, raw) = open(object);
        give(py, getter(py, packet, raw))
    }
}

/// Attributes: `message` at once, as it is asked for most; all else the ordinary way.
unsafe extern "C" fn get_attribute(object: *mut ffi::PyObject, name: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the slot with a packet.
    unsafe {
        let is_message = intern!(Python::assume_attached(), "message").as_ptr() == name;
        if is_message { get_message(object, ptr::null_mut()) } else { ffi::PyObject_GenericGetAttr(object, name) }
    }
}

unsafe extern "C" fn get_message(object: *mut ffi::PyObject, _: *mut c_void) -> *mut ffi::PyObject {
    // SAFETY: as in `get`. Making the message may run Python code, even code that asks this packet for its message:
    // so the packet's parts are only read meanwhile, and the cell is written after, if it is still empty.
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
            Err(error) => give(py, Err(error)),
        }
    }
}

unsafe extern "C" fn dealloc(object: *mut ffi::PyObject) {
    // SAFETY: Python calls this once, with a packet that no one refers to. Its parts were written by `create`,
    // and the class, of which each object holds a reference, is released last.
    unsafe {
        let class = ffi::Py_TYPE(object);
        let Packet { dialect, message, .. } = (&raw mut (*object.cast::<Object>()).packet).read();
        // Released by hand: dropped, they would wait in PyO3's pool, which does not know that Python is attached.
        let py = Python::assume_attached();
        dialect.drop_ref(py);
        if let Some(message) = message {
            message.drop_ref(py);
        }
        spare::release(object);
        ffi::Py_DECREF(class.cast());
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
        give(py, from_arguments(&args, kwargs.as_ref()))
    }
}

fn from_arguments<'py>(args: &Bound<'py, PyAny>, kwargs: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
    let kwargs = kwargs.map(|kwargs| kwargs.cast::<PyDict>()).transpose()?;
    let maker = pyo3::wrap_pyfunction!(packet_from_bytes, args.py())?;
    maker.call(args.cast::<PyTuple>()?, kwargs)
}

/// The one packet that `raw` holds, read by `dialect`; raises ValueError if it holds none or more.
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
    made.unwrap_or_else(|| Err(PyValueError::new_err("these bytes are not one whole MAVLink packet")))
}

unsafe extern "C" fn reduce(object: *mut ffi::PyObject, _: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the method with a packet.
    unsafe {
        let py = Python::assume_attached();
        let (packet, raw) = open(object);
        give(py, reduced(py, packet, raw))
    }
}

fn reduced<'py>(py: Python<'py>, packet: &Packet, raw: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    let arguments = (PyBytes::new(py, raw), packet.dialect.get().owner(py)?, packet.timestamp);
    object(py, (packet_class(py)?, arguments))
}

unsafe extern "C" fn repr(object: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the slot with a packet.
    unsafe {
        let py = Python::assume_attached();
        give(py, self::object(py, open(object).0.text()))
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
    give(py, answer.into_pyobject(py).map(|answer| answer.to_owned().into_any()).map_err(Into::into))
}
