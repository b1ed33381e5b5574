//! The records of an MCAP file, read with care: whatever the bytes are, there is an answer. (The crate that writes the files
//! trusts the lengths in them when it reads, and panics where they lie.)

use std::collections::{BTreeMap, HashMap};

use super::error::Problem;

/// What every file begins with.
pub(super) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// A stream of messages of one kind.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    /// The name of the messages, `package/msg/Name`; empty where it is not known.
    pub(super) message: String,
    pub(super) metadata: BTreeMap<String, String>,
}

/// What a file holds beside its messages, as far as it has been read.
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    schemas: HashMap<u16, String>,
    channels: HashMap<u16, Channel>,
    /// Records of metadata, by name.
    pub(super) metadata: BTreeMap<String, BTreeMap<String, String>>,
}

/// What is done with a message: its channel, the time of its record [ns], its bytes.
pub(super) type Visit<'v> = dyn FnMut(&Channel, u64, &[u8]) -> Result<(), Problem> + 'v;

impl Contents {
    /// Reads all records in the order of the file, and hands every message on.
    pub(super) fn read(bytes: &[u8], visit: &mut Visit<'_>) -> Result<Self, Problem> {
        let rest =
            bytes.strip_prefix(MAGIC).ok_or_else(|| Problem::new("it does not begin like an MCAP file"))?;
        let mut contents = Self::default();
        contents.records(rest, false, visit)?;
        Ok(contents)
    }

    fn records(&mut self, bytes: &[u8], is_chunk: bool, visit: &mut Visit<'_>) -> Result<(), Problem> {
        let mut rest = Bytes(bytes);
        while !rest.0.is_empty() {
            let [kind] = rest.array()?;
            let length = rest.long()?;
            let mut body = Bytes(rest.take(length)?);
            match kind {
                // The end of the data: what follows says again what was said.
                0x0f if !is_chunk => return Ok(()),
                0x03 => {
                    let id = body.short()?;
                    self.schemas.insert(id, body.text()?);
                }
                0x04 => self.channel(&mut body)?,
                0x05 => self.message(&mut body, visit)?,
                0x06 if !is_chunk => self.records(chunk(&mut body)?, true, visit)?,
                0x0c => {
                    let name = body.text()?;
                    self.metadata.insert(name, body.map()?);
                }
                _ => {}
            }
        }
        if is_chunk { Ok(()) } else { Err(Problem::new("it ends too early: the recording was cut short")) }
    }

    fn channel(&mut self, body: &mut Bytes<'_>) -> Result<(), Problem> {
        let (id, schema) = (body.short()?, body.short()?);
        let topic = body.text()?;
        let encoding = body.text()?;
        // Messages in another encoding are none that are known here.
        let message = self.schemas.get(&schema).filter(|_| encoding == "cdr").cloned().unwrap_or_default();
        self.channels.insert(id, Channel { topic, message, metadata: body.map()? });
        Ok(())
    }

    fn message(&self, body: &mut Bytes<'_>, visit: &mut Visit<'_>) -> Result<(), Problem> {
        let id = body.short()?;
        body.take(4)?;
        let time = body.long()? as u64;
        body.take(8)?;
        let channel = self.channels.get(&id);
        let channel =
            channel.ok_or_else(|| Problem::new(format!("a message belongs to no channel (number {id})")))?;
        visit(channel, time, body.0)
    }
}

/// Returns the records of a chunk.
fn chunk<'a>(body: &mut Bytes<'a>) -> Result<&'a [u8], Problem> {
    body.take(24)?;
    let checksum = u32::from_le_bytes(body.array()?);
    let compression = body.text()?;
    if !compression.is_empty() {
        let message = format!(
            "its chunks are compressed ({compression}); write it without, as `mcap compress` with `none` does"
        );
        return Err(Problem::new(message));
    }
    let length = body.long()?;
    let records = body.take(length)?;
    if checksum != 0 && checksum != crc32fast::hash(records) {
        return Err(Problem::new(
            "a chunk does not have the checksum that it should have; the file is damaged",
        ));
    }
    Ok(records)
}

/// Bytes that are still to be read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, length: usize) -> Result<&'a [u8], Problem> {
        let (part, rest) =
            self.0.split_at_checked(length).ok_or_else(|| Problem::new("a record ends too early"))?;
        self.0 = rest;
        Ok(part)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let part = self.take(N)?;
        part.try_into().map_err(|_| Problem::new("a record ends too early"))
    }

    fn short(&mut self) -> Result<u16, Problem> {
        self.array().map(u16::from_le_bytes)
    }

    fn long(&mut self) -> Result<usize, Problem> {
        self.array().map(|bytes| u64::from_le_bytes(bytes) as usize)
    }

    fn block(&mut self) -> Result<&'a [u8], Problem> {
        let length = u32::from_le_bytes(self.array()?);
        self.take(length as usize)
    }

    fn text(&mut self) -> Result<String, Problem> {
        self.block().map(|bytes| String::from_utf8_lossy(bytes).into_owned())
    }

    fn map(&mut self) -> Result<BTreeMap<String, String>, Problem> {
        let mut entries = Bytes(self.block()?);
        let mut map = BTreeMap::new();
        while !entries.0.is_empty() {
            let key = entries.text()?;
            map.insert(key, entries.text()?);
        }
        Ok(map)
    }
}
