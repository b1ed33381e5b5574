//! Messages of the Robot Operating System in their common data representation: little-endian, every number at a multiple of
//! its own size.

use super::clock::Stamp;
use super::error::Problem;

/// What stands before every message: plain, little-endian, no options. Places count from behind it.
const HEADER: [u8; 4] = [0, 1, 0, 0];

/// A message while it is written.
#[derive(Clone, Debug)]
pub(super) struct Cdr {
    bytes: Vec<u8>,
}

impl Cdr {
    pub(super) fn new() -> Self {
        Self { bytes: HEADER.to_vec() }
    }

    /// Begins another message in the same memory.
    pub(super) fn restart(&mut self) {
        self.bytes.truncate(HEADER.len());
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    fn align(&mut self, size: usize) {
        let length = (self.bytes.len() - HEADER.len()).next_multiple_of(size) + HEADER.len();
        self.bytes.resize(length, 0);
    }

    pub(super) fn flag(&mut self, value: bool) {
        self.bytes.push(u8::from(value));
    }

    /// A count of what follows, or another number without a sign.
    pub(super) fn count(&mut self, value: usize) {
        self.align(4);
        self.bytes.extend((value as u32).to_le_bytes());
    }

    pub(super) fn real(&mut self, value: f64) {
        self.align(8);
        self.bytes.extend(value.to_le_bytes());
    }

    pub(super) fn reals(&mut self, values: impl IntoIterator<Item = f64>) {
        values.into_iter().for_each(|value| self.real(value));
    }

    /// A sequence: its length, and its entries.
    pub(super) fn list(&mut self, values: impl Iterator<Item = f64> + Clone) {
        self.count(values.clone().count());
        self.reals(values);
    }

    pub(super) fn text(&mut self, text: &str) {
        self.count(text.len() + 1);
        self.bytes.extend(text.as_bytes());
        self.bytes.push(0);
    }

    pub(super) fn texts<'t>(&mut self, texts: impl ExactSizeIterator<Item = &'t str>) {
        self.count(texts.len());
        texts.for_each(|text| self.text(text));
    }

    /// A time or a duration.
    pub(super) fn stamp(&mut self, stamp: Stamp) {
        self.align(4);
        self.bytes.extend(stamp.sec.to_le_bytes());
        self.bytes.extend(stamp.nanosec.to_le_bytes());
    }

    /// `std_msgs/Header`.
    pub(super) fn header(&mut self, stamp: Stamp, frame: &str) {
        self.stamp(stamp);
        self.text(frame);
    }
}

/// A message while it is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct CdrReader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> CdrReader<'a> {
    pub(super) fn new(message: &'a [u8]) -> Result<Self, Problem> {
        match message.split_first_chunk::<4>() {
            Some(([0, 1, ..], bytes)) => Ok(Self { bytes, at: 0 }),
            _ => Err(Problem::new("a message is not in little-endian CDR (header 00 01)")),
        }
    }

    fn take<const N: usize>(&mut self, size: usize) -> Result<[u8; N], Problem> {
        self.at = self.at.next_multiple_of(size);
        let part = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        self.at += N;
        part.copied().ok_or_else(|| Problem::new("a message ends too early"))
    }

    pub(super) fn count(&mut self) -> Result<usize, Problem> {
        self.take::<4>(4).map(|bytes| u32::from_le_bytes(bytes) as usize)
    }

    pub(super) fn list(&mut self) -> Result<Vec<f64>, Problem> {
        let count = self.count()?;
        // A count that lies ends with the message, before memory does.
        let mut values = Vec::with_capacity(count.min(self.bytes.len() / 8));
        for _ in 0..count {
            values.push(f64::from_le_bytes(self.take::<8>(8)?));
        }
        Ok(values)
    }

    pub(super) fn text(&mut self) -> Result<String, Problem> {
        let length = self.count()?;
        let part = self.at.checked_add(length).and_then(|end| self.bytes.get(self.at..end));
        let part = part.ok_or_else(|| Problem::new("a message ends too early"))?;
        self.at += length;
        Ok(String::from_utf8_lossy(part.strip_suffix(&[0]).unwrap_or(part)).into_owned())
    }

    pub(super) fn texts(&mut self) -> Result<Vec<String>, Problem> {
        (0..self.count()?).map(|_| self.text()).collect()
    }

    pub(super) fn stamp(&mut self) -> Result<Stamp, Problem> {
        let sec = i32::from_le_bytes(self.take(4)?);
        Ok(Stamp { sec, nanosec: u32::from_le_bytes(self.take(4)?) })
    }

    /// `std_msgs/Header`; returns its stamp.
    pub(super) fn header(&mut self) -> Result<Stamp, Problem> {
        let stamp = self.stamp()?;
        self.text()?;
        Ok(stamp)
    }
}
