//! Conversion between the bytes of a field and Python values.
//!
//! A field reads as an integer, a float, `str` for `char[n]` (up to its NUL), `bytes` for `uint8_t[n]`, or a tuple for
//! other arrays. Values outside the range of the field are refused with an error that names the range.

use crate::errors::{FieldRangeError, FieldTypeError};
use crate::message;
use mavstack_core::json;
use mavstack_core::layout::{Field, FieldType, MAX_PAYLOAD};
use pyo3::buffer::PyBuffer;
use pyo3::exceptions::{PyOverflowError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyFloat, PyInt, PyString, PyTuple};

/// Converts the bytes of `field` to a Python value.
pub fn read<'py>(py: Python<'py>, field: &Field, bytes: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    match field.kind {
        FieldType::Char => Ok(PyString::new(py, &json::text(bytes)).into_any()),
        _ if field.array_length == 0 => read_number(py, field.kind, bytes),
        FieldType::U8 => Ok(PyBytes::new(py, bytes).into_any()),
        kind => read_array(py, kind, bytes),
    }
}

fn read_array<'py>(py: Python<'py>, kind: FieldType, bytes: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    macro_rules! tuple {
        ($type:ty) => {
            PyTuple::new(py, bytes.as_chunks().0.iter().map(|element| <$type>::from_le_bytes(*element)))
        };
    }
    let tuple = match kind {
        FieldType::U8 | FieldType::Char => tuple!(u8),
        FieldType::I8 => tuple!(i8),
        FieldType::U16 => tuple!(u16),
        FieldType::I16 => tuple!(i16),
        FieldType::U32 => tuple!(u32),
        FieldType::I32 => tuple!(i32),
        FieldType::U64 => tuple!(u64),
        FieldType::I64 => tuple!(i64),
        FieldType::F32 => tuple!(f32),
        FieldType::F64 => tuple!(f64),
    };
    Ok(tuple?.into_any())
}

/// Converts bytes to a number; `bytes` must have the size of `kind`.
#[allow(
    clippy::inline_always,
    reason = "a field of each message is read: a result in memory costs as much as the number"
)]
#[inline(always)]
pub fn read_number<'py>(py: Python<'py>, kind: FieldType, bytes: &[u8]) -> PyResult<Bound<'py, PyAny>> {
    macro_rules! number {
        ($type:ty) => {
            Ok(<$type>::from_le_bytes(exactly(bytes)?).into_pyobject(py)?.into_any())
        };
    }
    match kind {
        FieldType::U8 | FieldType::Char => number!(u8),
        FieldType::I8 => number!(i8),
        FieldType::U16 => number!(u16),
        FieldType::I16 => number!(i16),
        FieldType::U32 => number!(u32),
        FieldType::I32 => number!(i32),
        FieldType::U64 => number!(u64),
        FieldType::I64 => number!(i64),
        FieldType::F32 => Ok(PyFloat::new(py, f64::from(f32::from_le_bytes(exactly(bytes)?))).into_any()),
        FieldType::F64 => Ok(PyFloat::new(py, f64::from_le_bytes(exactly(bytes)?)).into_any()),
    }
}

#[inline]
fn exactly<const SIZE: usize>(bytes: &[u8]) -> PyResult<[u8; SIZE]> {
    bytes.first_chunk().copied().ok_or_else(message::payload_mismatch)
}

/// A field as named in error texts: `Attitude.roll`.
pub struct FieldRef<'a> {
    pub class: &'a str,
    pub field: &'a Field,
}

impl FieldRef<'_> {
    fn name(&self) -> String {
        format!("{}.{}", self.class, self.field.name)
    }

    fn wrong_type(&self, wanted: &str, value: &Bound<'_, PyAny>) -> PyErr {
        let got = value.get_type().name().map_or_else(|_| "?".into(), |name| name.to_string());
        FieldTypeError::new_err(format!("{} must be {wanted}, got {got}", self.name()))
    }

    fn too_long(&self, unit: &str, length: usize) -> PyErr {
        let max = self.field.array_length.max(1);
        FieldRangeError::new_err(format!("{} holds at most {max} {unit}, got {length}", self.name()))
    }

    fn too_many(&self) -> PyErr {
        let max = self.field.array_length;
        FieldRangeError::new_err(format!("{} holds at most {max} elements, got more", self.name()))
    }

    #[cold]
    fn out_of_range(&self, kind: FieldType, value: &Bound<'_, PyAny>) -> PyErr {
        let (low, high, name) = range_text(kind);
        let value = value.repr().map_or_else(|_| "the value".into(), |text| text.to_string());
        FieldRangeError::new_err(format!("{}: {value} is outside {low}..{high} ({name})", self.name()))
    }
}

fn range_text(kind: FieldType) -> (String, String, &'static str) {
    macro_rules! range {
        ($type:ty, $name:literal) => {
            (<$type>::MIN.to_string(), <$type>::MAX.to_string(), $name)
        };
    }
    match kind {
        FieldType::U8 | FieldType::Char => range!(u8, "uint8_t"),
        FieldType::I8 => range!(i8, "int8_t"),
        FieldType::U16 => range!(u16, "uint16_t"),
        FieldType::I16 => range!(i16, "int16_t"),
        FieldType::U32 => range!(u32, "uint32_t"),
        FieldType::I32 => range!(i32, "int32_t"),
        FieldType::U64 => range!(u64, "uint64_t"),
        FieldType::I64 => range!(i64, "int64_t"),
        FieldType::F32 => ("-3.4028235e38".into(), "3.4028235e38".into(), "float"),
        FieldType::F64 => ("-1.7976931348623157e308".into(), "1.7976931348623157e308".into(), "double"),
    }
}

/// Writes `value` to the bytes of the field, which are unchanged if the value is refused.
pub fn write(field_ref: &FieldRef<'_>, bytes: &mut [u8], value: &Bound<'_, PyAny>) -> PyResult<()> {
    let field = field_ref.field;
    match field.kind {
        FieldType::Char => write_text(field_ref, bytes, value),
        kind if field.array_length == 0 => write_number(field_ref, kind, bytes, value),
        kind => write_array(field_ref, kind, bytes, value),
    }
}

fn write_text(field_ref: &FieldRef<'_>, bytes: &mut [u8], value: &Bound<'_, PyAny>) -> PyResult<()> {
    let text = if let Ok(text) = value.cast::<PyString>() {
        match text.to_cow() {
            // U+FFFD replaced one invalid byte, so it must be written as one byte.
            Ok(text) => text.replace('\u{FFFD}', "?").into_bytes(),
            Err(_) => return Err(field_ref.wrong_type("text that can be encoded as UTF-8", value)),
        }
    } else if let Ok(raw) = value.cast::<PyBytes>() {
        raw.as_bytes().to_vec()
    } else {
        return Err(field_ref.wrong_type("a string", value));
    };
    write_padded(field_ref, "bytes", bytes, &text)
}

fn write_padded(field_ref: &FieldRef<'_>, unit: &str, bytes: &mut [u8], content: &[u8]) -> PyResult<()> {
    let Some((start, rest)) = bytes.split_at_mut_checked(content.len()) else {
        return Err(field_ref.too_long(unit, content.len()));
    };
    start.copy_from_slice(content);
    rest.fill(0);
    Ok(())
}

fn write_array(field_ref: &FieldRef<'_>, kind: FieldType, bytes: &mut [u8], value: &Bound<'_, PyAny>) -> PyResult<()> {
    if kind == FieldType::U8
        && let Ok(buffer) = PyBuffer::<u8>::get(value)
    {
        return write_padded(field_ref, "elements", bytes, &buffer.to_vec(value.py())?);
    }
    if kind == FieldType::F32 && write_singles(bytes, value) {
        return Ok(());
    }
    if value.cast::<PyString>().is_ok() {
        return Err(field_ref.wrong_type("a sequence of numbers", value));
    }
    let Ok(elements) = value.try_iter() else {
        return Err(field_ref.wrong_type("a sequence of numbers", value));
    };
    // One element more than fits is enough to detect too many.
    let elements = elements.take(usize::from(field_ref.field.array_length) + 1).collect::<PyResult<Vec<_>>>()?;
    let mut content = vec![0; elements.len() * kind.size()];
    for (element, encoded) in elements.iter().zip(content.chunks_exact_mut(kind.size())) {
        write_number(field_ref, kind, encoded, element)?;
    }
    if content.len() > bytes.len() {
        return Err(field_ref.too_many());
    }
    write_padded(field_ref, "elements", bytes, &content)
}

/// Writes a tuple of floats, as covariances are; returns false if it is something else or does not fit.
fn write_singles(bytes: &mut [u8], value: &Bound<'_, PyAny>) -> bool {
    let Ok(tuple) = value.cast_exact::<PyTuple>() else {
        return false;
    };
    let mut content = [0; MAX_PAYLOAD];
    let size = tuple.len() * FieldType::F32.size();
    let (Some(content), Some((start, rest))) = (content.get_mut(..size), bytes.split_at_mut_checked(size)) else {
        return false;
    };
    for (element, encoded) in tuple.iter_borrowed().zip(content.as_chunks_mut().0) {
        let Some(single) = exact_single(&element) else {
            return false;
        };
        *encoded = single.to_le_bytes();
    }
    start.copy_from_slice(content);
    rest.fill(0);
    true
}

#[inline]
fn write_number(field_ref: &FieldRef<'_>, kind: FieldType, bytes: &mut [u8], value: &Bound<'_, PyAny>) -> PyResult<()> {
    match kind {
        FieldType::F32 => {
            let number = float(field_ref, value)?;
            if number.is_finite() && (number as f32).is_infinite() {
                return Err(field_ref.out_of_range(kind, value));
            }
            bytes.copy_from_slice(&(number as f32).to_le_bytes());
        }
        FieldType::F64 => bytes.copy_from_slice(&float(field_ref, value)?.to_le_bytes()),
        FieldType::U64 => {
            let number = integer::<u64>(field_ref, kind, value)?;
            bytes.copy_from_slice(&number.to_le_bytes());
        }
        _ => {
            let number = integer::<i64>(field_ref, kind, value)?;
            if !fits(kind, number) {
                return Err(field_ref.out_of_range(kind, value));
            }
            bytes.copy_from_slice(&number.to_le_bytes()[..kind.size()]);
        }
    }
    Ok(())
}

#[inline]
fn fits(kind: FieldType, number: i64) -> bool {
    match kind {
        FieldType::U8 | FieldType::Char => u8::try_from(number).is_ok(),
        FieldType::I8 => i8::try_from(number).is_ok(),
        FieldType::U16 => u16::try_from(number).is_ok(),
        FieldType::I16 => i16::try_from(number).is_ok(),
        FieldType::U32 => u32::try_from(number).is_ok(),
        FieldType::I32 => i32::try_from(number).is_ok(),
        _ => true,
    }
}

/// Returns a float of Python as one of 32 bits; `None` if it is another object or out of range.
#[inline]
pub fn exact_single(value: &Bound<'_, PyAny>) -> Option<f32> {
    let number = value.cast_exact::<PyFloat>().ok()?.value();
    let single = number as f32;
    (single.is_finite() || !number.is_finite()).then_some(single)
}

#[inline]
fn float(field_ref: &FieldRef<'_>, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    if let Ok(float) = value.cast_exact::<PyFloat>() {
        return Ok(float.value());
    }
    if value.cast::<PyString>().is_ok() {
        return Err(field_ref.wrong_type("a number", value));
    }
    value.extract::<f64>().map_err(|error| {
        if error.is_instance_of::<PyTypeError>(value.py()) { field_ref.wrong_type("a number", value) } else { error }
    })
}

#[inline]
fn integer<'py, T>(field_ref: &FieldRef<'_>, kind: FieldType, value: &Bound<'py, PyAny>) -> PyResult<T>
where
    T: for<'a> FromPyObject<'a, 'py, Error = PyErr>,
{
    value.extract::<T>().map_err(|error| {
        if value.cast::<PyInt>().is_ok() || error.is_instance_of::<PyOverflowError>(value.py()) {
            field_ref.out_of_range(kind, value)
        } else if error.is_instance_of::<PyTypeError>(value.py()) {
            field_ref.wrong_type("an integer", value)
        } else {
            error
        }
    })
}
