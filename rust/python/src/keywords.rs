//! Fast construction of messages from numbers given by keywords, without a look-up for each name.
//!
//! Calls at one place of a program pass the same tuple of names each time. The fields of the last one are kept with the
//! class, and the tuple is held, so that its address means the same names as long as they are kept.

use crate::class::ClassData;
use crate::fields::FieldAccess;
use mavstack_core::layout::FieldType;
use pyo3::ffi;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyTuple};
use std::cell::UnsafeCell;
use std::ptr;

/// A field that is one number; `None` for all others.
type Number = Option<(FieldType, u8)>;

/// The fields of a tuple of keyword names.
struct Plan {
    names: Py<PyTuple>,
    fields: Box<[u8]>,
    /// The first of these fields in definition order; more positional arguments would give one twice.
    first: usize,
}

#[derive(Default)]
struct State {
    plan: Option<Plan>,
    /// The last tuple of names that was not that of the plan; only compared.
    missed: *const ffi::PyObject,
}

/// The plan of a class, and its fields that are numbers.
pub struct Keywords {
    numbers: Box<[Number]>,
    state: UnsafeCell<State>,
}

impl Keywords {
    pub fn new(fields: &[FieldAccess]) -> Self {
        let number = |access: &FieldAccess| {
            let field = &access.field;
            (field.array_length == 0 && field.kind != FieldType::Char).then_some((field.kind, field.offset))
        };
        Self { numbers: fields.iter().map(number).collect(), state: UnsafeCell::default() }
    }

    /// Writes arguments to a payload if all are plain floats and integers for fields that are numbers, and in range.
    /// Returns false if another one is found; then the payload may contain some of the values.
    ///
    /// # Safety
    /// The interpreter must be held; the values and `keyword_names`, null or a tuple with a name for each value after the
    /// positional ones, must be held through the call; and `self` must belong to `data`.
    #[inline]
    pub unsafe fn write_numbers(
        &self,
        py: Python<'_>,
        data: &ClassData,
        payload: &mut [u8],
        values: &[*mut ffi::PyObject],
        positional: usize,
        keyword_names: *mut ffi::PyObject,
    ) -> bool {
        let (ordered, named) = values.split_at(positional);
        let numbers = &*self.numbers;
        // SAFETY: the values are held by the caller.
        let store = |payload: &mut [u8], field: usize, value| unsafe { write(py, payload, numbers[field], value) };
        if !ordered.iter().enumerate().all(|(field, &value)| store(payload, field, value).is_some()) {
            return false;
        }
        if named.is_empty() {
            return true;
        }
        // SAFETY: guaranteed by the caller; no Python code runs as long as the reference is used.
        let state = unsafe { &mut *self.state.get() };
        let Some(plan) = state.plan.as_ref().filter(|plan| plan.names.as_ptr() == keyword_names) else {
            // SAFETY: guaranteed by the caller.
            unsafe { self.note(py, data, keyword_names) };
            return false;
        };
        plan.first >= positional
            && plan.fields.iter().zip(named).all(|(&field, &value)| store(payload, field.into(), value).is_some())
    }

    /// Makes a plan of names that are passed for the second time in a row.
    ///
    /// # Safety
    /// As [`Self::write_numbers`].
    #[cold]
    unsafe fn note(&self, py: Python<'_>, data: &ClassData, keyword_names: *mut ffi::PyObject) {
        // SAFETY: guaranteed by the caller: the reference ends before Python code can run, when the old plan is dropped.
        let state = unsafe { &mut *self.state.get() };
        if !ptr::eq(std::mem::replace(&mut state.missed, keyword_names), keyword_names) {
            return;
        }
        // SAFETY: guaranteed by the caller: it is a tuple.
        let names = unsafe { Bound::from_borrowed_ptr(py, keyword_names).cast_into_unchecked::<PyTuple>() };
        let find = |name: Bound<'_, PyAny>| {
            let position = data.fields.iter().position(|access| access.name.as_ptr() == name.as_ptr())?;
            u8::try_from(position).ok()
        };
        let Some(fields) = names.iter().map(find).collect::<Option<Box<[u8]>>>() else {
            return;
        };
        let first = fields.iter().copied().min().unwrap_or_default().into();
        let before = state.plan.replace(Plan { names: names.unbind(), fields, first });
        drop(before);
    }

    /// The references that the cycle collector must visit.
    pub fn references(&self) -> Option<*mut ffi::PyObject> {
        // SAFETY: the collector holds the interpreter, and changes nothing.
        unsafe { (*self.state.get()).plan.as_ref().map(|plan| plan.names.as_ptr()) }
    }
}

/// Writes a number as its field needs it; `None` if it is not a plain float or integer, or out of range.
///
/// # Safety
/// The value must be held through the call.
#[inline]
unsafe fn write(py: Python<'_>, payload: &mut [u8], number: Number, value: *mut ffi::PyObject) -> Option<()> {
    let (kind, offset) = number?;
    let bytes = payload.get_mut(usize::from(offset)..)?;
    macro_rules! store {
        ($type:ty, $value:expr) => {
            *bytes.first_chunk_mut()? = <$type>::try_from($value).ok()?.to_le_bytes()
        };
    }
    // SAFETY: the value is held by the caller.
    unsafe {
        match kind {
            FieldType::F32 => {
                let wide = real(py, value)?;
                let single = wide as f32;
                if single.is_infinite() && wide.is_finite() {
                    return None;
                }
                *bytes.first_chunk_mut()? = single.to_le_bytes();
            }
            FieldType::F64 => *bytes.first_chunk_mut()? = real(py, value)?.to_le_bytes(),
            FieldType::U8 | FieldType::Char => store!(u8, integer(value)?),
            FieldType::I8 => store!(i8, integer(value)?),
            FieldType::U16 => store!(u16, integer(value)?),
            FieldType::I16 => store!(i16, integer(value)?),
            FieldType::U32 => store!(u32, integer(value)?),
            FieldType::I32 => store!(i32, integer(value)?),
            FieldType::U64 => store!(u64, integer(value)?),
            FieldType::I64 => store!(i64, integer(value)?),
        }
    }
    Some(())
}

/// Returns the value of a plain float.
///
/// # Safety
/// As [`write`].
#[inline]
unsafe fn real(py: Python<'_>, value: *mut ffi::PyObject) -> Option<f64> {
    // SAFETY: the value is held by the caller.
    unsafe { Borrowed::from_ptr(py, value) }.cast_exact::<PyFloat>().ok().map(|float| float.value())
}

/// Returns the value of a plain integer that fits 64 bits with a sign.
///
/// # Safety
/// As [`write`].
#[inline]
unsafe fn integer(value: *mut ffi::PyObject) -> Option<i64> {
    let mut overflow = 0;
    // SAFETY: the value is held by the caller; a plain integer is converted without any other code, and without an error.
    unsafe {
        if ffi::Py_TYPE(value) != &raw mut ffi::PyLong_Type {
            return None;
        }
        let number = ffi::PyLong_AsLongLongAndOverflow(value, &raw mut overflow);
        (overflow == 0).then_some(number)
    }
}
