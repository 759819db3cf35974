//! Message objects: an object header followed by the payload, in one allocation.
//!
//! The payload always has the full length of the message's class, zero-filled, so that every field can be read at its
//! offset. A message refers to no other Python object than its class.

use crate::buffers::Bytes;
use crate::class::{self, ClassData, slot};
use crate::construct;
use crate::freelist;
use crate::values;
use mavstack_core::encode::trimmed;
use mavstack_core::layout::{FieldType, Layout};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyType};
use std::ffi::{CStr, c_int, c_uint, c_void};
use std::ptr;

/// A message in memory; its payload follows in the same allocation.
#[repr(C)]
struct Object {
    header: ffi::PyVarObject,
    payload: [u8; 0],
}

static BASE: PyOnceLock<Py<PyType>> = PyOnceLock::new();

/// Returns the base class of all message classes.
pub fn base_class(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    Ok(BASE.get_or_try_init(py, || make_base_class(py))?.bind(py))
}

const BASE_DOC: &CStr = c"Base of the message classes: a typed view over a payload.

Fields are given as positional or keyword arguments; fields not given are zero.

Raises:
    FieldNameError: The message has no field of that name, or fewer fields than arguments.
    FieldTypeError: A value has a wrong type.
    FieldRangeError: A value is outside the range of its field.";
const TO_PAYLOAD_DOC: &CStr = c"to_payload($self, version=2, /)
--

Return the payload as sent on the wire.

Args:
    version: MAVLink version: 2 trims trailing zero bytes, 1 leaves the extension fields out.

Returns:
    The payload bytes.

Raises:
    ValueError: The version is neither 1 nor 2.";
const FROM_PAYLOAD_DOC: &CStr = c"from_payload($type, payload, /)
--

Create a message from its payload.

Args:
    payload: The payload bytes: missing bytes are zero, bytes beyond the known fields are ignored.

Returns:
    A message of this class.";

fn make_base_class(py: Python<'_>) -> PyResult<Py<PyType>> {
    let methods = Box::leak(Box::new([
        method(c"to_payload", to_payload, ffi::METH_VARARGS, TO_PAYLOAD_DOC),
        method(c"from_payload", from_payload, ffi::METH_O | ffi::METH_CLASS, FROM_PAYLOAD_DOC),
        ffi::PyMethodDef::zeroed(),
    ]));
    let mut slots = [
        slot(ffi::Py_tp_new, construct::new as *mut c_void),
        slot(ffi::Py_tp_dealloc, dealloc as *mut c_void),
        slot(ffi::Py_tp_getattro, get_attribute as *mut c_void),
        slot(ffi::Py_tp_richcompare, compare as *mut c_void),
        slot(ffi::Py_tp_hash, ffi::PyObject_HashNotImplemented as *mut c_void),
        slot(ffi::Py_tp_methods, methods.as_mut_ptr().cast()),
        slot(ffi::Py_tp_doc, BASE_DOC.as_ptr().cast_mut().cast()),
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

pub fn method(name: &'static CStr, function: ffi::PyCFunction, flags: c_int, doc: &'static CStr) -> ffi::PyMethodDef {
    let ml_meth = ffi::PyMethodDefPointer { PyCFunction: function };
    ffi::PyMethodDef { ml_name: name.as_ptr(), ml_meth, ml_flags: flags, ml_doc: doc.as_ptr() }
}

/// Returns the payload of a message.
///
/// # Safety
/// `object` must be an instance of a class derived from `MessageBase`, and must live as long as the result is used.
#[inline]
pub unsafe fn payload<'a>(object: *mut ffi::PyObject) -> &'a [u8] {
    // SAFETY: the object is laid out as `Object`, followed by the number of bytes in its header.
    unsafe { std::slice::from_raw_parts((&raw const (*object.cast::<Object>()).payload).cast(), size(object)) }
}

/// Returns the payload of a message for writing.
///
/// # Safety
/// As [`payload`]; and no other reference to the payload may exist.
#[inline]
pub unsafe fn payload_mut<'a>(object: *mut ffi::PyObject) -> &'a mut [u8] {
    // SAFETY: as in `payload`; the caller holds the interpreter, so nothing else writes.
    unsafe { std::slice::from_raw_parts_mut((&raw mut (*object.cast::<Object>()).payload).cast(), size(object)) }
}

#[inline]
unsafe fn size(object: *mut ffi::PyObject) -> usize {
    // SAFETY: guaranteed by the caller: the object begins with a variable-size header.
    unsafe { (*object.cast::<ffi::PyVarObject>()).ob_size as usize }
}

/// The error for an object whose payload does not belong to its class (after an assignment to `__class__`).
#[cold]
pub fn payload_mismatch() -> PyErr {
    PyTypeError::new_err("the payload of this object does not belong to its class")
}

/// Converts a result to a new reference, or to null with the error raised.
#[inline]
pub fn into_result_pointer(py: Python<'_>, result: PyResult<Bound<'_, PyAny>>) -> *mut ffi::PyObject {
    match result {
        Ok(value) => value.into_ptr(),
        Err(error) => {
            error.restore(py);
            ptr::null_mut()
        }
    }
}

/// Returns the payload length of a class whose instances `allocate_plain` may create: one made by `new_message_class`.
pub fn plain_length(class: &Bound<'_, PyType>) -> Option<u8> {
    // SAFETY: the class is held.
    let data = unsafe { class::direct_data(class.py(), class.as_type_ptr()) }?;
    data.has_gc_header.then_some(data.layout.length)
}

/// Creates a message over `payload`: missing bytes are zero, excess bytes are ignored.
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
    // object stays untracked, and its whole payload is written here before any other code can access it.
    unsafe {
        let object = Bound::from_owned_ptr_or_err(py, freelist::allocate_message(class, length.into()))?;
        let (start, rest) = payload_mut(object.as_ptr()).split_at_mut(known);
        start.copy_from_slice(&payload[..known]);
        rest.fill(0);
        Ok(object)
    }
}

/// Frees a message. Python's own function for classes calls this one last, after it untracked the object.
unsafe extern "C" fn dealloc(object: *mut ffi::PyObject) {
    // SAFETY: Python calls this once, with a message without references. All objects with the memory layout of a class made
    // by `new_message_class` have room for their capacity, also if their class was assigned; the class, of which each
    // object holds a reference, is released last.
    unsafe {
        let class = ffi::Py_TYPE(object);
        if class::direct_data(Python::assume_attached(), class).is_some_and(|data| data.has_gc_header) {
            freelist::release_message(object);
        } else {
            let free: ffi::freefunc = std::mem::transmute(ffi::PyType_GetSlot(class, ffi::Py_tp_free));
            free(object.cast());
        }
        ffi::Py_DECREF(class.cast());
    }
}

/// Releases a reference to a message. The last reference to a message of a class made by `new_message_class` frees it at
/// once: Python's function for classes would only look for weak references, members and a finalizer, and find none.
///
/// # Safety
/// `object` must be a message, and the caller must own the reference.
#[inline]
pub unsafe fn release(py: Python<'_>, object: *mut ffi::PyObject) {
    // SAFETY: guaranteed by the caller. Such a class has no room for weak references and members, so that a message
    // without a finalizer is only its memory and its reference to the class.
    unsafe {
        let class = ffi::Py_TYPE(object);
        if ffi::Py_REFCNT(object) == 1
            && class::direct_data(py, class).is_some_and(|data| data.has_gc_header)
            && ffi::PyType_GetSlot(class, ffi::Py_tp_finalize).is_null()
        {
            ffi::PyObject_GC_UnTrack(object.cast());
            freelist::release_message(object);
            ffi::Py_DECREF(class.cast());
        } else {
            ffi::Py_DECREF(object);
        }
    }
}

/// Creates a message over `payload`, as [`allocate`], that the cycle collector does not track yet.
///
/// # Safety
/// `class` must be a class for which `data` is the class data.
#[inline]
pub unsafe fn allocate_untracked<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    data: &ClassData,
    payload: &[u8],
) -> PyResult<Bound<'py, PyAny>> {
    let length = data.layout.length;
    // SAFETY: the class derives from `MessageBase`: a plain class is allocated here, any other generically, as zeros.
    unsafe {
        if data.has_gc_header && class == data.class {
            return allocate_plain(py, class, length, payload);
        }
        // An object whose class is assigned later may be pooled, so that it needs the capacity too.
        let capacity = freelist::message_capacity(length.into());
        let object = Bound::from_owned_ptr_or_err(py, ffi::PyType_GenericAlloc(class, capacity as isize))?;
        (*object.as_ptr().cast::<ffi::PyVarObject>()).ob_size = length.into();
        if data.has_gc_header {
            ffi::PyObject_GC_UnTrack(object.as_ptr().cast());
        }
        let known = payload.len().min(length.into());
        payload_mut(object.as_ptr())[..known].copy_from_slice(&payload[..known]);
        Ok(object)
    }
}

/// Tracks a complete message for the cycle collector if it is of a user's class, which may refer to other objects.
///
/// # Safety
/// `object` must come from `allocate_untracked` with the same class and data.
#[inline]
pub unsafe fn finish<'py>(
    object: Bound<'py, PyAny>,
    class: *mut ffi::PyTypeObject,
    data: &ClassData,
) -> Bound<'py, PyAny> {
    if data.has_gc_header && class != data.class {
        // SAFETY: the object has a collector's header and is not tracked.
        unsafe { ffi::PyObject_GC_Track(object.as_ptr().cast()) };
    }
    object
}

/// Creates a message of `class` over `payload`: missing bytes are zero, excess bytes are ignored.
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
    // SAFETY: guaranteed by the caller.
    unsafe { Ok(finish(allocate_untracked(py, class, data, payload)?, class, data)) }
}

/// Returns the class data and the payload of an object, if it is a message.
pub fn open<'a>(object: &'a Bound<'_, PyAny>) -> PyResult<(&'a ClassData, &'a [u8])> {
    let py = object.py();
    let Some(data) = class::class_data(py, object.get_type_ptr()) else {
        let name = object.get_type().name()?;
        return Err(PyTypeError::new_err(format!("expected a MAVLink message, got {name}")));
    };
    // SAFETY: only classes that derive from `MessageBase` have class data.
    let payload = unsafe { payload(object.as_ptr()) };
    if payload.len() < usize::from(data.layout.length) {
        return Err(payload_mismatch());
    }
    // SAFETY: the class, and with it the data, lives as long as the object, which the caller holds for 'a.
    Ok((unsafe { &*ptr::from_ref(data) }, payload))
}

/// Gets an attribute: fields of the object's class directly, all others generically.
unsafe extern "C" fn get_attribute(object: *mut ffi::PyObject, name: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the slot with a message, which holds its class and with it the class's data.
    unsafe {
        let py = Python::assume_attached();
        let class = ffi::Py_TYPE(object);
        let Some(named) = class::direct_names(py, class).and_then(|names| class::find(names, name)) else {
            return ffi::PyObject_GenericGetAttr(object, name);
        };
        let Some(kind) = named.plain else {
            return into_result_pointer(py, read_field(py, class, named, payload(object)));
        };
        let start = usize::from(named.offset);
        match payload(object).get(start..start + kind.size()) {
            Some(bytes) => into_result_pointer(py, values::read_number(py, kind, bytes)),
            None => into_result_pointer(py, Err(payload_mismatch())),
        }
    }
}

/// Reads a field that is not a plain number.
///
/// # Safety
/// `class` must be a live message class.
unsafe fn read_field<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    named: &class::NameEntry,
    payload: &[u8],
) -> PyResult<Bound<'py, PyAny>> {
    // SAFETY: guaranteed by the caller.
    match unsafe { class::direct_data(py, class) } {
        Some(data) => data.fields[usize::from(named.field)].read(py, payload),
        None => Err(payload_mismatch()),
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
        into_result_pointer(py, answer.into_pyobject(py).map(|answer| answer.to_owned().into_any()).map_err(Into::into))
    }
}

/// Returns whether two payloads are equal, ignoring the bytes after the NUL of a text.
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
        into_result_pointer(py, payload_of_version(&object, &Bound::from_borrowed_ptr(py, args)))
    }
}

fn payload_of_version<'py>(object: &Bound<'py, PyAny>, args: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let version = if args.len()? == 0 { 2 } else { args.extract::<(u8,)>()?.0 };
    let (data, payload) = open(object)?;
    let sent = match version {
        1 => &payload[..usize::from(data.layout.base_length)],
        2 => trimmed(payload),
        _ => return Err(PyValueError::new_err(format!("unknown MAVLink version {version}: must be 1 or 2"))),
    };
    Ok(PyBytes::new(object.py(), sent).into_any())
}

unsafe extern "C" fn from_payload(class: *mut ffi::PyObject, argument: *mut ffi::PyObject) -> *mut ffi::PyObject {
    // SAFETY: Python calls the class method with the class, which derives from `MessageBase`, and one argument.
    unsafe {
        let py = Python::assume_attached();
        let argument = Bound::from_borrowed_ptr(py, argument);
        let Some(data) = class::class_data(py, class.cast()) else {
            return into_result_pointer(
                py,
                Err(PyTypeError::new_err("MessageBase has no fields: use a message class such as common.Attitude")),
            );
        };
        let result = argument.extract::<Bytes<'_>>().and_then(|payload| allocate(py, class.cast(), data, &payload));
        into_result_pointer(py, result)
    }
}
