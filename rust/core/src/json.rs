//! The fields of a message as a JSON object, written from its payload.
//!
//! Numbers are exact: integers have all digits, and floats are the text that Python's `repr` gives, which reads back to
//! the same value. JSON has neither NaN nor infinities; each [`Form`] has a replacement.

use crate::layout::{Field, FieldType, MAX_PAYLOAD};
use std::io::Write;

/// The text in place of the value of a secret field.
const HIDDEN: &[u8] = b"\"(hidden)\"";
/// Candidates from this magnitude on may not fit a float32.
const MAX_SHORTENED: f64 = 3.4e38;
/// Digits from which a float may lie in the middle of two shortest numbers: all numbers of 15 digits differ.
const TIE_DIGITS: usize = 16;

/// The form of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// No spaces, null for numbers that are not finite, and float32 values with all digits of their value as a double.
    /// Otherwise a space after commas and colons, the strings "NaN", "Infinity" and "-Infinity", and float32 values with
    /// the fewest digits that read back to the same float32.
    pub strict: bool,
    /// Characters outside ASCII are escaped.
    pub ascii: bool,
}

impl Form {
    fn comma(self) -> &'static [u8] {
        if self.strict { b"," } else { b", " }
    }
}

/// A member of the object: its key, and whether its value is hidden.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    /// The name in quotes, escaped.
    key: Vec<u8>,
    hidden: bool,
}

impl Member {
    /// Creates the member of a field.
    #[must_use]
    pub fn new(name: &str, hidden: bool) -> Self {
        let mut key = Vec::with_capacity(name.len() + 2);
        write_text(&mut key, name, true);
        Self { key, hidden }
    }
}

/// Appends the object with the fields of a message; missing bytes of the payload are zero.
pub fn write_fields(out: &mut Vec<u8>, form: Form, fields: &[Field], members: &[Member], payload: &[u8]) {
    let mut full = [0; MAX_PAYLOAD];
    let known = payload.len().min(MAX_PAYLOAD);
    full[..known].copy_from_slice(&payload[..known]);
    out.push(b'{');
    for (number, (field, member)) in fields.iter().zip(members).enumerate() {
        if number > 0 {
            out.extend_from_slice(form.comma());
        }
        out.extend_from_slice(&member.key);
        out.extend_from_slice(if form.strict { b":" } else { b": " });
        if member.hidden {
            out.extend_from_slice(HIDDEN);
        } else {
            write_value(out, form, field, &full[field.range()]);
        }
    }
    out.push(b'}');
}

fn write_value(out: &mut Vec<u8>, form: Form, field: &Field, bytes: &[u8]) {
    if field.kind == FieldType::Char {
        return write_text(out, &text(bytes), form.ascii);
    }
    if field.array_length == 0 {
        return write_number(out, form, field.kind, bytes);
    }
    out.push(b'[');
    for (number, element) in bytes.chunks_exact(field.kind.size()).enumerate() {
        if number > 0 {
            out.extend_from_slice(form.comma());
        }
        write_number(out, form, field.kind, element);
    }
    out.push(b']');
}

fn write_number(out: &mut Vec<u8>, form: Form, kind: FieldType, bytes: &[u8]) {
    macro_rules! number {
        ($type:ty) => {
            <$type>::from_le_bytes(bytes.try_into().unwrap_or_default())
        };
    }
    match kind {
        FieldType::U8 | FieldType::Char => write_unsigned(out, u64::from(number!(u8))),
        FieldType::U16 => write_unsigned(out, u64::from(number!(u16))),
        FieldType::U32 => write_unsigned(out, u64::from(number!(u32))),
        FieldType::U64 => write_unsigned(out, number!(u64)),
        FieldType::I8 => write_signed(out, i64::from(number!(i8))),
        FieldType::I16 => write_signed(out, i64::from(number!(i16))),
        FieldType::I32 => write_signed(out, i64::from(number!(i32))),
        FieldType::I64 => write_signed(out, number!(i64)),
        FieldType::F32 => {
            let value = number!(f32);
            let is_shortened = !form.strict && value.is_finite();
            write_float(out, form, if is_shortened { shortest(value) } else { f64::from(value) });
        }
        FieldType::F64 => write_float(out, form, number!(f64)),
    }
}

fn write_signed(out: &mut Vec<u8>, value: i64) {
    if value < 0 {
        out.push(b'-');
    }
    write_unsigned(out, value.unsigned_abs());
}

fn write_unsigned(out: &mut Vec<u8>, mut value: u64) {
    let (mut digits, mut start) = ([0; 20], 20);
    loop {
        start -= 1;
        digits[start] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[start..]);
}

/// Appends a float as Python's `repr`: Rust chooses the same digits and the same notation, but writes exponents
/// without a plus and with one digit.
fn write_float(out: &mut Vec<u8>, form: Form, value: f64) {
    if !value.is_finite() {
        let name: &[u8] = match value {
            _ if form.strict => b"null",
            _ if value.is_nan() => b"\"NaN\"",
            _ if value > 0.0 => b"\"Infinity\"",
            _ => b"\"-Infinity\"",
        };
        return out.extend_from_slice(name);
    }
    let start = out.len();
    append(out, format_args!("{value:?}"));
    round_tie(&mut out[start..], value);
    let Some(mark) = out[start..].iter().position(|&byte| byte == b'e') else {
        return;
    };
    let exponent = out.split_off(start + mark + 1);
    let digits = exponent.strip_prefix(b"-").unwrap_or(&exponent);
    out.push(if digits.len() < exponent.len() { b'-' } else { b'+' });
    if digits.len() == 1 {
        out.push(b'0');
    }
    out.extend_from_slice(digits);
}

/// Corrects the last digit of a float that lies in the middle of two shortest numbers: Python takes the even one, Rust
/// the larger one.
fn round_tie(text: &mut [u8], value: f64) {
    let end = text.iter().position(|&byte| byte == b'e').unwrap_or(text.len());
    let significant = text[..end].iter().filter(|byte| byte.is_ascii_digit()).skip_while(|&&byte| byte == b'0').count();
    let last = text[end - 1];
    if significant < TIE_DIGITS || last.is_multiple_of(2) {
        return;
    }
    let mut exact = Vec::with_capacity(32);
    append(&mut exact, format_args!("{:.*e}", significant - 1, value));
    let mark = exact.iter().position(|&byte| byte == b'e').unwrap_or(exact.len());
    if exact[mark - 1] + 1 == last && parsed(&exact) == Some(value) {
        text[end - 1] = last - 1;
    }
}

fn parsed(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

fn append(out: &mut Vec<u8>, text: std::fmt::Arguments<'_>) {
    // Writing to a vector cannot fail.
    let _ = out.write_fmt(text);
}

/// The number with the fewest of 6 to 8 digits that is the same float32; otherwise the value itself.
fn shortest(value: f32) -> f64 {
    let mut text = Vec::with_capacity(32);
    append(&mut text, format_args!("{value:e}"));
    let digits = text.iter().take_while(|&&byte| byte != b'e').filter(|byte| byte.is_ascii_digit()).count();
    // A float32 distinguishes all numbers of 6 digits, so that rounding to 6 digits gives these; not if it is subnormal.
    let first = if digits <= 6 && (value.is_normal() || value == 0.0) { 0 } else { 5 };
    let is_same = |candidate: f64| (candidate as f32).to_bits() == value.to_bits();
    for precision in first..8 {
        if precision > 0 {
            text.clear();
            append(&mut text, format_args!("{:.precision$e}", f64::from(value)));
        }
        match parsed(&text) {
            Some(candidate) if candidate.abs() < MAX_SHORTENED && is_same(candidate) => return candidate,
            _ => {}
        }
    }
    f64::from(value)
}

/// The text in the bytes of a `char` array, up to its NUL: a truncated last character is dropped, other invalid UTF-8
/// becomes U+FFFD.
#[must_use]
pub fn text(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    let mut text = bytes.split(|&byte| byte == 0).next().unwrap_or(&[]);
    let last_start = text.iter().rposition(|&byte| byte & 0xC0 != 0x80).unwrap_or(0);
    if std::str::from_utf8(&text[last_start..]).is_err_and(|error| error.error_len().is_none()) {
        text = &text[..last_start];
    }
    String::from_utf8_lossy(text)
}

fn write_text(out: &mut Vec<u8>, text: &str, ascii: bool) {
    out.push(b'"');
    for character in text.chars() {
        match character {
            '"' => out.extend_from_slice(b"\\\""),
            '\\' => out.extend_from_slice(b"\\\\"),
            '\n' => out.extend_from_slice(b"\\n"),
            '\r' => out.extend_from_slice(b"\\r"),
            '\t' => out.extend_from_slice(b"\\t"),
            '\u{8}' => out.extend_from_slice(b"\\b"),
            '\u{c}' => out.extend_from_slice(b"\\f"),
            ' '..='~' => out.push(character as u8),
            '\0'..' ' => write_escape(out, character as u16),
            _ if ascii => character.encode_utf16(&mut [0; 2]).iter().for_each(|&unit| write_escape(out, unit)),
            _ => out.extend_from_slice(character.encode_utf8(&mut [0; 4]).as_bytes()),
        }
    }
    out.push(b'"');
}

fn write_escape(out: &mut Vec<u8>, unit: u16) {
    append(out, format_args!("\\u{unit:04x}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    const STRICT: Form = Form { strict: true, ascii: true };
    const SPACED: Form = Form { strict: false, ascii: true };

    fn number(form: Form, value: f32) -> String {
        let mut out = Vec::new();
        write_number(&mut out, form, FieldType::F32, &value.to_le_bytes());
        String::from_utf8(out).expect("ASCII")
    }

    #[test]
    fn floats_are_those_of_python() {
        let expected = [
            (0.1, "0.10000000149011612", "0.1"),
            (-0.0, "-0.0", "-0.0"),
            (1e16, "1.0000000272564224e+16", "1e+16"),
            (1e-5, "9.999999747378752e-06", "1e-05"),
            (0.000_103_473_66, "0.00010347366333007812", "0.00010347366"),
            (16_777_216.0, "16777216.0", "16777216.0"),
            (f32::MAX, "3.4028234663852886e+38", "3.4028234663852886e+38"),
            (f32::from_bits(1), "1.401298464324817e-45", "1.4013e-45"),
            (f32::NAN, "null", "\"NaN\""),
            (f32::NEG_INFINITY, "null", "\"-Infinity\""),
        ];
        for (value, strict, spaced) in expected {
            assert_eq!((number(STRICT, value).as_str(), number(SPACED, value).as_str()), (strict, spaced));
        }
    }

    #[test]
    fn texts_are_escaped() {
        let mut out = Vec::new();
        write_text(&mut out, "a\"\\\n\u{1}\u{7f}é\u{1f600}", true);
        write_text(&mut out, "\u{7f}é", false);
        assert_eq!(out, "\"a\\\"\\\\\\n\\u0001\\u007f\\u00e9\\ud83d\\ude00\"\"\u{7f}é\"".as_bytes());
    }

    #[test]
    fn an_object_has_all_fields_and_hides_secrets() {
        let field = |name: &str, kind, array_length, offset| Field {
            name: name.into(),
            kind,
            array_length,
            offset,
            enumerated: false,
        };
        let fields = [
            field("id", FieldType::U16, 0, 0),
            field("values", FieldType::I8, 3, 2),
            field("text", FieldType::Char, 4, 5),
            field("key", FieldType::U8, 2, 9),
        ];
        let members = fields.each_ref().map(|field| Member::new(&field.name, field.name == "key"));
        let payload = [1, 2, 255, 3, 0, b'a', 0xC3, 0, b'x', 9];
        let mut out = Vec::new();
        write_fields(&mut out, STRICT, &fields, &members, &payload);
        assert_eq!(out, br#"{"id":513,"values":[-1,3,0],"text":"a","key":"(hidden)"}"#);
        out.clear();
        write_fields(&mut out, SPACED, &fields, &members, &[]);
        assert_eq!(out, br#"{"id": 0, "values": [0, 0, 0], "text": "", "key": "(hidden)"}"#);
    }
}
