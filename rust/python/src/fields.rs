//! Field descriptors: getters and setters with a pointer to the layout of their field.

use crate::message;
use crate::values::{self, FieldRef};
use mavstack_core::layout::{Field, FieldType};
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString, PyType};
use std::ffi::{CString, c_int, c_void};
use std::ptr;
use std::sync::OnceLock;

/// The enum of a field: its members by value, and a function for other values, if there is one.
struct EnumValues {
    members: Py<PyDict>,
    fallback: Option<Py<PyAny>>,
}

/// The data of a field's descriptor, owned by the class data.
pub struct FieldAccess {
    pub field: Field,
    /// True for one number of 32 bits with a fraction, the most frequent kind of field.
    is_single_float: bool,
    /// The name as an interned string, so that keywords are compared by identity.
    pub name: Py<PyString>,
    class_name: String,
    /// The owning class; borrowed, because it outlives the data of its descriptors.
    class: *mut ffi::PyObject,
    enum_values: OnceLock<EnumValues>,
    c_name: CString,
    definition: ffi::PyGetSetDef,
}

impl FieldAccess {
    pub fn new(py: Python<'_>, field: &Field, class_name: &str, class: &Bound<'_, PyType>) -> PyResult<Self> {
        Ok(Self {
            name: PyString::intern(py, &field.name).unbind(),
            c_name: CString::new(field.name.as_str())?,
            is_single_float: field.kind == FieldType::F32 && field.array_length == 0,
            field: field.clone(),
            class_name: class_name.into(),
            class: class.as_ptr(),
            enum_values: OnceLock::new(),
            definition: ffi::PyGetSetDef {
                name: ptr::null(),
                get: Some(get),
                set: Some(set),
                doc: ptr::null(),
                closure: ptr::null_mut(),
            },
        })
    }

    /// Adds the descriptor to the class; `self` must not move afterwards.
    pub fn install(&mut self, class: &Bound<'_, PyType>) -> PyResult<()> {
        self.definition.name = self.c_name.as_ptr();
        self.definition.closure = ptr::from_mut(self).cast();
        let py = class.py();
        // SAFETY: the definition and its name do not move during the life of the class, and the descriptor holds the
        // class.
        let descriptor = unsafe {
            let definition = &raw mut self.definition;
            Bound::from_owned_ptr_or_err(py, ffi::PyDescr_NewGetSet(class.as_ptr().cast(), definition))
        }?;
        class.setattr(self.name.bind(py), descriptor)
    }

    /// The references that the cycle collector must visit.
    pub fn references(&self) -> impl Iterator<Item = *mut ffi::PyObject> {
        self.enum_values.get().into_iter().flat_map(|known| {
            let fallback = known.fallback.as_ref().map(Py::as_ptr);
            [Some(known.members.as_ptr()), fallback].into_iter().flatten()
        })
    }

    /// The field as named in error texts.
    pub fn field_ref(&self) -> FieldRef<'_> {
        FieldRef { class: &self.class_name, field: &self.field }
    }

    /// Reads the field from a full payload, as an enum member if it has an enum.
    #[inline]
    pub fn read<'py>(&self, py: Python<'py>, payload: &[u8]) -> PyResult<Bound<'py, PyAny>> {
        let Some(bytes) = payload.get(self.field.range()) else {
            return Err(message::payload_mismatch());
        };
        let value = values::read(py, &self.field, bytes)?;
        if self.field.enumerated { self.as_member(value) } else { Ok(value) }
    }

    /// Writes the field into a full payload.
    #[inline]
    pub fn write(&self, payload: &mut [u8], value: &Bound<'_, PyAny>) -> PyResult<()> {
        if self.is_single_float
            && let Some(single) = values::exact_single(value)
            && let Some(bytes) = payload.get_mut(self.field.range())
        {
            bytes.copy_from_slice(&single.to_le_bytes());
            return Ok(());
        }
        match payload.get_mut(self.field.range()) {
            Some(bytes) => values::write(&self.field_ref(), bytes, value),
            None => Err(message::payload_mismatch()),
        }
    }

    fn as_member<'py>(&self, value: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = value.py();
        let known = if let Some(known) = self.enum_values.get() {
            known
        } else {
            let loaded = self.load_enum_values(py)?;
            self.enum_values.get_or_init(|| loaded)
        };
        if self.field.array_length > 0 {
            let members = value.try_iter()?.map(|element| known.member(element?));
            let members = members.collect::<PyResult<Vec<_>>>()?;
            return Ok(pyo3::types::PyTuple::new(py, members)?.into_any());
        }
        known.member(value)
    }

    #[cold]
    fn load_enum_values(&self, py: Python<'_>) -> PyResult<EnumValues> {
        // SAFETY: a field is read through its class or an instance of it, so the class is alive.
        let class = unsafe { Bound::from_borrowed_ptr(py, self.class) };
        let (members, fallback) = class.call_method1("_enum_values", (self.name.bind(py),))?.extract()?;
        Ok(EnumValues { members, fallback })
    }
}

impl EnumValues {
    #[inline]
    fn member<'py>(&self, value: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = value.py();
        if let Some(member) = self.members.bind(py).get_item(&value)? {
            return Ok(member);
        }
        match &self.fallback {
            Some(fallback) => fallback.bind(py).call1((value,)),
            None => Ok(value),
        }
    }
}

unsafe extern "C" fn get(object: *mut ffi::PyObject, closure: *mut c_void) -> *mut ffi::PyObject {
    // SAFETY: Python checked that the object is of the descriptor's class, so it is a message, and the closure
    // is the access that `install` gave.
    unsafe {
        let py = Python::assume_attached();
        let access = &*closure.cast::<FieldAccess>();
        message::into_result_pointer(py, access.read(py, message::payload(object)))
    }
}

unsafe extern "C" fn set(object: *mut ffi::PyObject, value: *mut ffi::PyObject, closure: *mut c_void) -> c_int {
    // SAFETY: as in `get`; a null value means deletion.
    unsafe {
        let py = Python::assume_attached();
        let access = &*closure.cast::<FieldAccess>();
        let result = if value.is_null() {
            Err(pyo3::exceptions::PyAttributeError::new_err("a message field cannot be deleted"))
        } else {
            access.write_to_object(object, &Bound::from_borrowed_ptr(py, value))
        };
        match result {
            Ok(()) => 0,
            Err(error) => {
                error.restore(py);
                -1
            }
        }
    }
}

impl FieldAccess {
    /// Writes the field through a copy of its bytes, because converting `value` may run Python code that reads the message.
    ///
    /// # Safety
    /// `object` must be a message.
    unsafe fn write_to_object(&self, object: *mut ffi::PyObject, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let mut scratch = [0u8; mavstack_core::layout::MAX_PAYLOAD];
        let range = self.field.range();
        let bytes = &mut scratch[..range.len()];
        values::write(&self.field_ref(), bytes, value)?;
        // SAFETY: guaranteed by the caller; no other reference to the payload exists while this one does.
        match unsafe { message::payload_mut(object) }.get_mut(range) {
            Some(target) => {
                target.copy_from_slice(bytes);
                Ok(())
            }
            None => Err(message::payload_mismatch()),
        }
    }
}
