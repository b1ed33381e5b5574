//! One NumPy array in its file format, version 1.0: doubles and text, rows first.

use std::io::{self, Write};

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// An array that was read.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub(super) shape: Vec<usize>,
    pub(super) content: Content,
}

/// Its entries, rows first.
#[derive(Clone, Debug)]
pub(super) enum Content {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
}

/// Writes doubles.
pub(super) fn write_numbers(out: &mut dyn Write, shape: &[usize], values: &[f64]) -> io::Result<()> {
    write_header(out, "<f8", shape)?;
    let mut bytes = Vec::with_capacity(8 * 1024);
    for part in values.chunks(1024) {
        bytes.clear();
        bytes.extend(part.iter().flat_map(|value| value.to_le_bytes()));
        out.write_all(&bytes)?;
    }
    Ok(())
}

/// Writes text: every entry as long as the longest, in UCS-4.
pub(super) fn write_texts(out: &mut dyn Write, shape: &[usize], values: &[&str]) -> io::Result<()> {
    let longest = values.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
    write_header(out, &format!("<U{longest}"), shape)?;
    for text in values {
        let codes = text.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest);
        out.write_all(&codes.flat_map(u32::to_le_bytes).collect::<Vec<u8>>())?;
    }
    Ok(())
}

fn write_header(out: &mut dyn Write, descr: &str, shape: &[usize]) -> io::Result<()> {
    let sizes: Vec<String> = shape.iter().map(|size| format!("{size},")).collect();
    let mut header =
        format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': ({}), }}", sizes.join(" "));
    // The entries begin at a multiple of 64 bytes; before them are the magic, a version and the header's length.
    let before = MAGIC.len() + 4;
    let length = (before + header.len() + 1).next_multiple_of(64) - before;
    header.extend(std::iter::repeat_n(' ', length - header.len() - 1));
    header.push('\n');
    out.write_all(MAGIC)?;
    out.write_all(&[1, 0])?;
    out.write_all(&(length as u16).to_le_bytes())?;
    out.write_all(header.as_bytes())
}

impl Array {
    /// Reads an array; the error says what is wrong with it.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, String> {
        let short = || "it ends too early".to_owned();
        let rest = bytes.strip_prefix(MAGIC.as_slice()).ok_or("it is no NumPy array")?;
        let (version, rest) = rest.split_first_chunk::<2>().ok_or_else(short)?;
        let (length, rest) = if version[0] == 1 {
            let (length, rest) = rest.split_first_chunk::<2>().ok_or_else(short)?;
            (usize::from(u16::from_le_bytes(*length)), rest)
        } else {
            let (length, rest) = rest.split_first_chunk::<4>().ok_or_else(short)?;
            (u32::from_le_bytes(*length) as usize, rest)
        };
        let (header, data) = rest.split_at_checked(length).ok_or_else(short)?;
        let header = std::str::from_utf8(header).map_err(|_| "its header is not text")?;
        let value = |key: &str| header.split(&format!("'{key}':")).nth(1).map(str::trim_start);
        let descr =
            value("descr").and_then(|rest| rest.split('\'').nth(1)).ok_or("its header has no type")?;
        if value("fortran_order").is_some_and(|rest| rest.starts_with("True")) {
            return Err("its columns come first; save numpy.ascontiguousarray of it".to_owned());
        }
        let shape =
            value("shape").and_then(|rest| rest.split(['(', ')']).nth(1)).ok_or("its header has no shape")?;
        let sizes = shape.split(',').map(str::trim).filter(|size| !size.is_empty()).map(str::parse::<usize>);
        let shape: Vec<usize> =
            sizes.collect::<Result<_, _>>().map_err(|_| "its shape is no list of sizes")?;
        let count = shape.iter().try_fold(1_usize, |all, &size| all.checked_mul(size)).ok_or_else(short)?;
        Ok(Self { content: Content::of(descr, data, count)?, shape })
    }
}

impl Content {
    fn of(descr: &str, data: &[u8], count: usize) -> Result<Self, String> {
        let wide = |width: usize| {
            let length = width.checked_mul(count).filter(|&length| length <= data.len());
            length
                .map(|length| data[..length].chunks_exact(width.max(1)))
                .ok_or("it ends too early".to_owned())
        };
        match descr {
            "<f8" => {
                let eight = |part: &[u8]| part.try_into().map_or(f64::NAN, f64::from_le_bytes);
                Ok(Self::Numbers(wide(8)?.map(eight).collect()))
            }
            "<f4" => {
                let four = |part: &[u8]| part.try_into().map_or(f32::NAN, f32::from_le_bytes);
                Ok(Self::Numbers(wide(4)?.map(|part| f64::from(four(part))).collect()))
            }
            _ => {
                let length = descr.strip_prefix("<U").and_then(|length| length.parse::<usize>().ok());
                let length = length
                    .filter(|&length| length < 1 << 20)
                    .ok_or_else(|| format!("its type is {descr}; expected are doubles (<f8) or text (<U)"))?;
                Ok(Self::Texts(wide(4 * length)?.map(text).collect()))
            }
        }
    }
}

fn text(part: &[u8]) -> String {
    let codes = part.chunks_exact(4).map(|code| code.try_into().map_or(0, u32::from_le_bytes));
    codes.take_while(|&code| code != 0).map(|code| char::from_u32(code).unwrap_or('\u{fffd}')).collect()
}
