//! Message objects: an object header followed by the payload, in one allocation.
//!
//! The payload always has the full length of the message's class, zero-filled, so that a field is read
//! where its layout says. Nothing in a message refers to another Python object but its class.

use crate::buffers::Bytes;
use crate::class::{self, ClassData, slot};
use crate::construct;
use crate::values;
use mavstack_core::encode::trimmed;
use mavstack_core::layout::{FieldType, Layout};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyType};
use std::ffi::{c_int, c_uint, c_void};
use std::ptr;

/// A message in memory; Python allocates the payload behind it.
#[repr(C)]
struct Object {
    header: ffi::PyVarObject,
    payload: [u8; 0],
}

static BASE: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// The base class of all message classes.
pub fn base_class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    Ok(BASE.get_or_try_init(py, || make_base_class(py))?.bind(py))
}

fn make_base_class(py: Python<'_>) -> PyResult<Py<PyType>> {
    let methods = Box::leak(Box::new([
        method(c"to_payload", to_payload, ffi::METH_VARARGS, c"The payload as the given protocol version sends it."),
        method(c"from_payload", from_payload, ffi::METH_O | ffi::METH_CLASS, c"A message over a payload."),
        ffi::PyMethodDef::zeroed(),
    ]));
    let mut slots = [
        slot(ffi::Py_tp_new, construct::new as *mut c_void),
        slot(ffi::Py_tp_getattro, get_attribute as *mut c_void),
        slot(ffi::Py_tp_richcompare, compare as *mut c_void),
        slot(ffi::Py_tp_hash, ffi::PyObject_HashNotImplemented as *mut c_void),
        slot(ffi::Py_tp_methods, methods.as_mut_ptr().cast()),
        slot(ffi::Py_tp_doc, c"Base of message classes: a typed view over a payload.".as_ptr().cast_mut().cast()),
        slot(0, ptr::null_mut()),
    ];
    let mut spec = ffi::PyType_Spec {
        name: c"mavstack._core.MessageBase".as_ptr(),
        basicsize: size_of::<Object>() as c_int,
        itemsize: 1,
        flags: (ffi::Py_TPFLAGS_DEFAULT | ffi::Py_TPFLAGS_BASETYPE) as c_uint,
        slots: slots.as_mut_ptr(),
    };
    // SAFETY: the spec and its slots live through the call, the methods table for ever.
    let class = unsafe { Bound::from_owned_ptr_or_err(py, ffi::PyType_FromSpec(&raw mut spec)) }?;
    Ok(class.cast_into::<PyType>()?.unbind())
}

pub fn method(
    name: &'static std::ffi::CStr,
    function: ffi::PyCFunction,
    flags: c_int,
    doc: &'static std::ffi::CStr,
) -> ffi::PyMethodDef {
    let ml_meth = ffi::PyMethodDefPointer { PyCFunction: function };
    ffi::PyMethodDef { ml_name: name.as_ptr(), ml_meth, ml_flags: flags, ml_doc: doc.as_ptr() }
}

/// The payload of a message.
///
/// # Safety
/// `object` must be an instance of a class derived from `MessageBase`, and live as long as the result is used.
#[inline]
pub unsafe fn payload<'a>(object: *mut ffi::PyObject) -> &'a [u8] {
    // SAFETY: such an object is laid out as `Object`, with as many bytes behind it as its size says.
    unsafe { std::slice::from_raw_parts((&raw const (*object.cast::<Object>()).payload).cast(), size(object)) }
}

/// The payload of a message, to be written.
///
/// # Safety
/// As [`payload`]; and no other reference to the payload may exist.
#[inline]
pub unsafe fn payload_mut<'a>(object: *mut ffi::PyObject) -> &'a mut [u8] {
    // SAFETY: as in `payload`; the caller holds the interpreter, so no one else writes.
    unsafe { std::slice::from_raw_parts_mut((&raw mut (*object.cast::<Object>()).payload).cast(), size(object)) }
}

#[inline]
unsafe fn size(object: *mut ffi::PyObject) -> usize {
    // SAFETY: by the callers' promise the object begins with a variable-size header.
    unsafe { (*object.cast::<ffi::PyVarObject>()).ob_size as usize }
}

/// The error for an object whose payload is not that of the class (after an assignment to `__class__`).
#[cold]
pub fn foreign_object() -> PyErr {
    PyTypeError::new_err("this object's payload is not that of its class")
}

/// Hands a result to Python, as a new reference or a raised error.
#[inline]
pub fn give(py: Python<'_>, result: PyResult<Bound<'_, PyAny>>) -> *mut ffi::PyObject {
    match result {
        Ok(value) => value.into_ptr(),
        Err(error) => {
            error.restore(py);
            ptr::null_mut()
        }
    }
}

/// Payload length of a class whose instances may be allocated by hand: one that `new_message_class` made.
pub fn plain_length(class: &Bound<'_, PyType>) -> Option<u8> {
    // SAFETY: the class is held.
    let data = unsafe { class::direct_data(class.py(), class.as_type_ptr()) }?;
    data.collected.then_some(data.layout.length)
}

/// A new message over `payload`, zero-filled if short, cut if longer than known.
///
/// # Safety
/// `length` must be the plain length of `class`.
#[inline]
pub unsafe fn allocate_plain<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    length: u8,
    payload: &[u8],
) -> PyResult<Bound<'py, PyAny>> {
    let known = payload.len().min(length.into());
    // SAFETY: a plain class derives from `MessageBase`, has a header for the collector and no members of its own; the
    // object stays untracked, and its payload is all written here before anyone sees it.
    unsafe {
        let object = ffi::PyObject_GC_NewVar::<ffi::PyObject>(class, length.into());
        let object = Bound::from_owned_ptr_or_err(py, object)?;
        let (start, rest) = payload_mut(object.as_ptr()).split_at_mut(known);
        start.copy_from_slice(&payload[..known]);
        rest.fill(0);
        Ok(object)
    }
}

/// A new message of `class`, all zero, not yet known to the cycle collector.
///
/// # Safety
/// `class` must be a class for which `data` is the class data.
#[inline]
pub unsafe fn allocate_zeroed<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    data: &ClassData,
) -> PyResult<Bound<'py, PyAny>> {
    let length = data.layout.length.into();
    // SAFETY: the class derives from `MessageBase`: its own class is plain, any other is allocated generically.
    unsafe {
        if data.collected && class == data.class {
            return allocate_plain(py, class, data.layout.length, &[]);
        }
        let object = Bound::from_owned_ptr_or_err(py, ffi::PyType_GenericAlloc(class, length))?;
        if data.collected {
            ffi::PyObject_GC_UnTrack(object.as_ptr().cast());
        }
        Ok(object)
    }
}

/// Gives a finished message to the cycle collector if it may refer to other objects: if it is of a user's class.
///
/// # Safety
/// `object` must come from `allocate_zeroed` with the same class and data.
#[inline]
pub unsafe fn finish<'py>(
    object: Bound<'py, PyAny>,
    class: *mut ffi::PyTypeObject,
    data: &ClassData,
) -> Bound<'py, PyAny> {
    if data.collected && class != data.class {
        // SAFETY: the object has a collector's header and is not tracked.
        unsafe { ffi::PyObject_GC_Track(object.as_ptr().cast()) };
    }
    object
}

/// A new message of `class` over `payload`, zero-filled if short, cut if longer than known.
///
/// # Safety
/// `class` must be a class for which `data` is the class data.
#[inline]
pub unsafe fn allocate<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    data: &ClassData,
    payload: &[u8],
) -> PyResult<Bound<'py, PyAny>> {
    let known = payload.len().min(usize::from(data.layout.length));
    // SAFETY: by the caller's promise; the object was just made and no one else has it.
    unsafe {
        let object = allocate_zeroed(py, class, data)?;
        payload_mut(object.as_ptr())[..known].copy_from_slice(&payload[..known]);
        Ok(finish(object, class, data))
    }
}

/// The class data and the payload of any object that is a message.
pub fn open<'a>(object: &'a Bound<'_, PyAny>) -> PyResult<(&'a ClassData, &'a [u8])> {
    let py = object.py();
    let Some(data) = class::class_data(py, object.get_type_ptr()) else {
        let name = object.get_type().name()?;
        return Err(PyTypeError::new_err(format!("a MAVLink message is needed, not {name}")));
    };
    // SAFETY: only classes that derive from `MessageBase` have class data.
    let payload = unsafe { payload(object.as_ptr()) };
    if payload.len() < usize::from(data.layout.length) {
        return Err(foreign_object());
    }
    // SAFETY: the class, and with it the data, lives as long as the object, which the caller holds for 'a.
    Ok((unsafe { &*ptr::from_ref(data) }, payload))
}

/// Attributes: the fields of the object's own class at once, all else the ordinary way.
unsafe extern "C" fn get_attribute(object: *mut ffi::PyObject, name: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the slot with a message, which holds its class and with it the class's data.
    unsafe {
        let py = Python::assume_attached();
        let class = ffi::Py_TYPE(object);
        let Some(named) = class::direct_names(py, class).and_then(|names| class::find(names, name)) else {
            return ffi::PyObject_GenericGetAttr(object, name);
        };
        let Some(kind) = named.plain else {
            return give(py, read_field(py, class, named, payload(object)));
        };
        let start = usize::from(named.offset);
        match payload(object).get(start..start + kind.size()) {
            Some(bytes) => give(py, values::read_number(py, kind, bytes)),
            None => give(py, Err(foreign_object())),
        }
    }
}

/// Reads a field that is more than a plain number.
///
/// # Safety
/// `class` must be a live message class.
unsafe fn read_field<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    named: &class::Named,
    payload: &[u8],
) -> PyResult<Bound<'py, PyAny>> {
    // SAFETY: by the caller's promise.
    match unsafe { class::direct_data(py, class) } {
        Some(data) => data.fields[usize::from(named.field)].read(py, payload),
        None => Err(foreign_object()),
    }
}

unsafe extern "C" fn compare(
    left: *mut ffi::PyObject,
    right: *mut ffi::PyObject,
    operator: c_int,
) -> *mut ffi::PyObject {
    // SAFETY: Python holds both objects through the call.
    unsafe {
        let py = Python::assume_attached();
        let (left, right) = (Bound::from_borrowed_ptr(py, left), Bound::from_borrowed_ptr(py, right));
        let (Ok((data, left)), Ok((other, right))) = (open(&left), open(&right)) else {
            return py.NotImplemented().into_ptr();
        };
        let equal = data.layout == other.layout && same_fields(&data.layout, left, right);
        let answer = match operator {
            ffi::Py_EQ => equal,
            ffi::Py_NE => !equal,
            _ => return py.NotImplemented().into_ptr(),
        };
        give(py, answer.into_pyobject(py).map(|answer| answer.to_owned().into_any()).map_err(Into::into))
    }
}

/// Whether two payloads hold the same: byte for byte, but for the junk behind the NUL of a text.
fn same_fields(layout: &Layout, left: &[u8], right: &[u8]) -> bool {
    layout.fields.iter().all(|field| {
        let (left, right) = (&left[field.range()], &right[field.range()]);
        let text = |bytes: &[u8]| bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
        left == right || (field.kind == FieldType::Char && left[..text(left)] == right[..text(right)])
    })
}

unsafe extern "C" fn to_payload(object: *mut ffi::PyObject, args: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the method with a message and a tuple of arguments.
    unsafe {
        let py = Python::assume_attached();
        let object = Bound::from_borrowed_ptr(py, object);
        give(py, payload_of_version(&object, &Bound::from_borrowed_ptr(py, args)))
    }
}

fn payload_of_version<'py>(object: &Bound<'py, PyAny>, args: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let version = if args.len()? == 0 { 2 } else { args.extract::<(u8,)>()?.0 };
    let (data, payload) = open(object)?;
    let sent = match version {
        1 => &payload[..usize::from(data.layout.base_length)],
        2 => trimmed(payload),
        _ => return Err(PyValueError::new_err(format!("there is no MAVLink version {version}"))),
    };
    Ok(PyBytes::new(object.py(), sent).into_any())
}

unsafe extern "C" fn from_payload(class: *mut ffi::PyObject, argument: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the class method with the class, which derives from `MessageBase`, and one argument.
    unsafe {
        let py = Python::assume_attached();
        let argument = Bound::from_borrowed_ptr(py, argument);
        let Some(data) = class::class_data(py, class.cast()) else {
            return give(
                py,
                Err(PyTypeError::new_err("payloads are read by a message's class, such as common.Attitude")),
            );
        };
        let result = argument.extract::<Bytes<'_>>().and_then(|payload| allocate(py, class.cast(), data, &payload));
        give(py, result)
    }
}
