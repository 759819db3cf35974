//! Construction of messages from arguments, such as `Attitude(roll=0.1)`: by vectorcall, and by `tp_new`.

use crate::class::{self, ClassData};
use crate::errors::FieldNameError;
use crate::fields::FieldAccess;
use crate::message::{allocate_untracked, finish, into_result_pointer, payload_mismatch, payload_mut};
use pyo3::exceptions::PyTypeError;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

/// Creates a message by Python's vectorcall protocol: arguments in an array, keyword names in a tuple.
///
/// # Safety
/// Must be called by Python only, for a class made by `new_message_class`.
pub unsafe extern "C" fn vectorcall(
    class: *mut ffi::PyObject,
    args: *const *mut ffi::PyObject,
    flagged_count: usize,
    keyword_names: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: Python's calling convention: positional arguments first, then one value for each keyword name,
    // the top bit of the count being a flag of its own; the class has its data.
    unsafe {
        let py = Python::assume_attached();
        let Some(data) = class::own_data(py, class) else {
            return into_result_pointer(py, Err(payload_mismatch()));
        };
        let positional = flagged_count & (usize::MAX >> 1);
        let keywords = if keyword_names.is_null() { 0 } else { ffi::PyTuple_Size(keyword_names) as usize };
        let values = if args.is_null() { &[] } else { std::slice::from_raw_parts(args, positional + keywords) };
        into_result_pointer(py, construct(py, class.cast(), data, values, positional, keyword_names))
    }
}

unsafe fn construct<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    data: &ClassData,
    values: &[*mut ffi::PyObject],
    positional: usize,
    keyword_names: *mut ffi::PyObject,
) -> PyResult<Bound<'py, PyAny>> {
    if positional > data.fields.len() {
        return Err(too_many(data, positional));
    }
    // SAFETY: the class's data was looked up by the caller.
    let object = unsafe { allocate_untracked(py, class, data, &data.template) }?;
    // SAFETY: no Python code can reach the object before it is complete, although the conversion of a value may run any code.
    let payload = unsafe { payload_mut(object.as_ptr()) };
    // SAFETY: Python holds the arguments and the names through the call.
    if unsafe { data.keywords.write_numbers(py, data, payload, values, positional, keyword_names) } {
        // SAFETY: the object was allocated above.
        return Ok(unsafe { finish(object, class, data) });
    }
    for (access, &value) in data.fields.iter().zip(&values[..positional]) {
        // SAFETY: Python holds the arguments through the call.
        let value = unsafe { Bound::from_borrowed_ptr(py, value) };
        access.write(payload, &value)?;
    }
    let mut next = positional;
    for (index, &value) in values[positional..].iter().enumerate() {
        // SAFETY: the tuple of names has one for each keyword value.
        let name = unsafe { ffi::PyTuple_GetItem(keyword_names, index as isize) };
        // SAFETY: the name and the value are held by Python through the call.
        let (name, value) = unsafe { (Bound::from_borrowed_ptr(py, name), Bound::from_borrowed_ptr(py, value)) };
        let position = find_field(data, next, &name)?;
        if position < positional {
            return Err(FieldNameError::new_err(format!("{} got {name} twice", data.class_name)));
        }
        data.fields[position].write(payload, &value)?;
        next = position + 1;
    }
    // SAFETY: the object was allocated above.
    Ok(unsafe { finish(object, class, data) })
}

/// Finds a field by name, first at `guess`: keywords are usually given in the order of the definition.
#[inline]
fn find_field(data: &ClassData, guess: usize, name: &Bound<'_, PyAny>) -> PyResult<usize> {
    let matches_name = |access: &FieldAccess| access.name.as_ptr() == name.as_ptr();
    if data.fields.get(guess).is_some_and(matches_name) {
        return Ok(guess);
    }
    if let Some(position) = data.fields.iter().position(matches_name) {
        return Ok(position);
    }
    for (position, access) in data.fields.iter().enumerate() {
        if access.name.bind(name.py()).as_any().eq(name)? {
            return Ok(position);
        }
    }
    let fields: Vec<_> = data.fields.iter().map(|access| access.field.name.as_str()).collect();
    Err(FieldNameError::new_err(format!(
        "{} has no field {name}; known fields: {}",
        data.class_name,
        fields.join(", ")
    )))
}

#[cold]
fn too_many(data: &ClassData, given: usize) -> PyErr {
    FieldNameError::new_err(format!("{} has {} fields, got {given} arguments", data.class_name, data.fields.len()))
}

/// Creates a message by `tp_new`: for a user's subclasses and for calls with packed arguments.
///
/// # Safety
/// Must be called by Python only, for a class that derives from `MessageBase`.
pub unsafe extern "C" fn new(
    class: *mut ffi::PyTypeObject,
    args: *mut ffi::PyObject,
    kwargs: *mut ffi::PyObject,
) -> *mut ffi::PyObject {
    // SAFETY: Python calls `tp_new` with a class that derives from `MessageBase`, a tuple, and a dictionary or null.
    unsafe {
        let py = Python::assume_attached();
        let args = Bound::from_borrowed_ptr(py, args);
        let kwargs = Bound::from_borrowed_ptr_or_opt(py, kwargs);
        into_result_pointer(py, new_from_collections(py, class, &args, kwargs.as_ref()))
    }
}

unsafe fn new_from_collections<'py>(
    py: Python<'py>,
    class: *mut ffi::PyTypeObject,
    args: &Bound<'py, PyAny>,
    kwargs: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let Some(data) = class::class_data(py, class) else {
        return Err(PyTypeError::new_err(
            "MessageBase cannot be instantiated: use a message class such as common.Attitude",
        ));
    };
    let args = args.cast::<PyTuple>()?;
    let mut values: Vec<Bound<'py, PyAny>> = args.iter().collect();
    let mut names = Vec::new();
    if let Some(kwargs) = kwargs {
        for (name, value) in kwargs.cast::<PyDict>()?.iter() {
            names.push(name);
            values.push(value);
        }
    }
    let names = PyTuple::new(py, names)?;
    let pointers: Vec<_> = values.iter().map(Bound::as_ptr).collect();
    // SAFETY: `values` and `names` are held here, and there is one name for each value after the positional ones.
    unsafe { construct(py, class, data, &pointers, args.len(), names.as_ptr()) }
}
