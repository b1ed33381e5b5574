//! Bytes to text: UTF-8 only, and a sentence that names what else it is.

use super::UrdfError;
use crate::robot::places::Places;

/// Returns the bytes as text.
pub(super) fn decode(bytes: &[u8]) -> Result<&str, UrdfError> {
    if let Some((_, what)) = BINARY.iter().find(|(begin, _)| bytes.starts_with(begin)) {
        let remedy =
            if what.contains("compressed") || what.contains("archive") { "; unpack it first" } else { "" };
        return Err(UrdfError::whole_file(format!("this is {what}, not a URDF{remedy}")));
    }
    if let Some(name) = wide_encoding(bytes) {
        return Err(UrdfError::whole_file(format!(
            "the file is encoded as {name}; save it as UTF-8, for example with `iconv -f {name} -t UTF-8`"
        )));
    }
    if std::str::from_utf8(bytes).is_err() && bytes.iter().any(|&byte| is_of_no_text(byte)) {
        return Err(UrdfError::whole_file(
            "the file is binary: it is no text in any encoding, and no URDF".to_owned(),
        ));
    }
    std::str::from_utf8(bytes).map_err(|error| not_utf8(bytes, error.valid_up_to()))
}

/// How files begin that people name in place of a URDF, and what they are.
const BINARY: [(&[u8], &str); 11] = [
    (b"\x7fELF", "a program (ELF)"),
    (b"\x1f\x8b", "a compressed file (gzip)"),
    (b"BZh", "a compressed file (bzip2)"),
    (b"\xfd7zXZ", "a compressed file (xz)"),
    (b"\x28\xb5\x2f\xfd", "a compressed file (zstd)"),
    (b"PK\x03\x04", "an archive (zip)"),
    (b"7z\xbc\xaf", "an archive (7z)"),
    (b"\x89PNG", "a picture (PNG)"),
    (b"\xff\xd8\xff", "a picture (JPEG)"),
    (b"%PDF-", "a PDF"),
    (b"glTF", "a mesh (glTF)"),
];

/// Whether no text of any one-byte encoding holds this byte.
fn is_of_no_text(byte: u8) -> bool {
    byte < b' ' && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c | 0x1a)
}

/// Returns the name of a two- or four-byte encoding that the first bytes give away.
fn wide_encoding(bytes: &[u8]) -> Option<&'static str> {
    match bytes {
        [0xFF, 0xFE, 0, 0, ..] | [0, 0, 0xFE, 0xFF, ..] => Some("UTF-32"),
        [0xFF, 0xFE, ..] | [b'<', 0, ..] => Some("UTF-16LE"),
        [0xFE, 0xFF, ..] | [0, b'<', ..] => Some("UTF-16BE"),
        _ => None,
    }
}

fn not_utf8(bytes: &[u8], valid: usize) -> UrdfError {
    let text = std::str::from_utf8(&bytes[..valid]).unwrap_or_default();
    let (line, column) = Places::new(text).at(text.len());
    let byte = bytes[valid];
    let message = match declared(text) {
        Some(name) => format!(
            "the file is encoded as {name} (its first line says so; here stands byte 0x{byte:02X}); \
             save it as UTF-8, for example with `iconv -f {name} -t UTF-8`"
        ),
        None => format!(
            "byte 0x{byte:02X} is not UTF-8; the file may be encoded as Latin-1 (ISO-8859-1): save it as UTF-8, \
             for example with `iconv -f ISO-8859-1 -t UTF-8`"
        ),
    };
    UrdfError::at(line, column, message)
}

/// Returns the encoding that an XML declaration names, unless it is UTF-8 itself.
pub(super) fn declared(text: &str) -> Option<&str> {
    let declaration = text.trim_start_matches('\u{feff}').strip_prefix("<?xml")?;
    let declaration = &declaration[..declaration.find("?>")?];
    let value = declaration.split_once("encoding")?.1.trim_start().strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|&c| c == '"' || c == '\'')?;
    let name = value[1..].split(quote).next()?;
    (!name.eq_ignore_ascii_case("utf-8") && !name.eq_ignore_ascii_case("utf8")).then_some(name)
}
