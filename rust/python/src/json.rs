//! Messages as JSON, from the bytes of packets and of message objects.

use crate::class::ClassData;
use crate::{message, packet};
use mavstack_core::json::{self, Form};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// Mean length of the JSON text of a message.
const MEAN_LENGTH: usize = 512;

/// Return the fields of a packet or of a message as a JSON object, written from its bytes.
///
/// Enum values are integers, byte arrays are arrays of numbers, secret values are "(hidden)".
///
/// Args:
///     source: The packet or the message.
///     strict: No spaces, null for numbers that are not finite, and floats as Python shows them. Otherwise a space after
///         commas and colons, the strings "NaN", "Infinity" and "-Infinity", and float32 values with the fewest digits
///         that read back to the same float32.
///     ascii: Escape the characters outside ASCII.
///
/// Returns:
///     The JSON text; None for a packet whose message is not in its dialect.
///
/// Raises:
///     TypeError: The object is neither a packet nor a message.
#[pyfunction]
#[pyo3(signature = (source, *, strict = false, ascii = true))]
pub fn fields_json<'py>(
    source: &Bound<'py, PyAny>,
    strict: bool,
    ascii: bool,
) -> PyResult<Option<Bound<'py, PyString>>> {
    let form = Form { strict, ascii };
    let found = packet::with_payload(source, |parts| parts.map(|(data, payload)| text(form, data, payload)))?;
    let text = match found {
        Some(text) => text,
        None => message::open(source).map(|(data, payload)| Some(text(form, data, payload)))?,
    };
    // All parts of the text are UTF-8: escaped or copied characters.
    Ok(text.map(|text| PyString::new(source.py(), &String::from_utf8_lossy(&text))))
}

fn text(form: Form, data: &ClassData, payload: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(MEAN_LENGTH);
    json::write_fields(&mut out, form, &data.layout.fields, &data.members, payload);
    out
}
