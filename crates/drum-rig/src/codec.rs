//! Numbers as bytes, little-endian, and the container that holds a checkpoint.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `drumrig` and the version of the format |
//! | 32 | BLAKE3 of the rig and options (threads left out) |
//! | 8 | length of the script, then the script |
//! | 8 | length of the world, then the world's own snapshot |
//! | 32 | BLAKE3 of everything before |

use dem_core::glam::{DQuat, DVec3};

use crate::error::Error;

/// Something that is stored in a checkpoint.
pub(crate) trait Stored: Sized {
    fn put(&self, out: &mut Vec<u8>);
    fn take(input: &mut Reader<'_>) -> Result<Self, Error>;
}

/// Bytes that are read from the front.
#[derive(Debug)]
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    fn next(&mut self, count: usize) -> Result<&'a [u8], Error> {
        let end = self.at.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or(Error::Checkpoint { what: "a value cut short", offset: self.at })?;
        let slice = &self.bytes[self.at..end];
        self.at = end;
        Ok(slice)
    }
}

impl Stored for u64 {
    fn put(&self, out: &mut Vec<u8>) {
        out.extend_from_slice(&self.to_le_bytes());
    }
    fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(input.next(8)?);
        Ok(Self::from_le_bytes(bytes))
    }
}

impl Stored for f64 {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_bits().put(out);
    }
    fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(Self::from_bits(u64::take(input)?))
    }
}

impl Stored for DVec3 {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_array().iter().for_each(|x| x.put(out));
    }
    fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
        Ok(Self::new(f64::take(input)?, f64::take(input)?, f64::take(input)?))
    }
}

impl Stored for DQuat {
    fn put(&self, out: &mut Vec<u8>) {
        self.to_array().iter().for_each(|x| x.put(out));
    }
    fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
        let mut next = || f64::take(input);
        Ok(Self::from_xyzw(next()?, next()?, next()?, next()?))
    }
}

impl<T: Stored> Stored for Vec<T> {
    fn put(&self, out: &mut Vec<u8>) {
        (self.len() as u64).put(out);
        self.iter().for_each(|x| x.put(out));
    }
    fn take(input: &mut Reader<'_>) -> Result<Self, Error> {
        let offset = input.at;
        let count = u64::take(input)?;
        // Every element takes at least one byte: a larger count is a lie, not a reason to allocate.
        if count > (input.bytes.len() - input.at) as u64 {
            return Err(Error::Checkpoint { what: "a count beyond the end", offset });
        }
        (0..count).map(|_| T::take(input)).collect()
    }
}

const MAGIC: [u8; 8] = *b"drumrig\x03";
const HASH: usize = 32;

/// Pack a script and a world's snapshot.
pub(crate) fn pack<T: Stored>(fingerprint: blake3::Hash, script: &T, world: &[u8]) -> Vec<u8> {
    let mut out = MAGIC.to_vec();
    out.extend_from_slice(fingerprint.as_bytes());
    let mut own = Vec::new();
    script.put(&mut own);
    for part in [own.as_slice(), world] {
        (part.len() as u64).put(&mut out);
        out.extend_from_slice(part);
    }
    let sum = blake3::hash(&out);
    out.extend_from_slice(sum.as_bytes());
    out
}

/// Unpack what [`pack`] packed: the script, and the bytes of the world.
pub(crate) fn unpack<T: Stored>(
    fingerprint: blake3::Hash,
    bytes: &[u8],
) -> Result<(T, &[u8]), Error> {
    let wrong = |what, offset| Err(Error::Checkpoint { what, offset });
    if bytes.get(..MAGIC.len()) != Some(&MAGIC) {
        return wrong("another format or version", 0);
    }
    let body = match bytes.len().checked_sub(HASH) {
        Some(body) if body >= MAGIC.len() + HASH => body,
        _ => return wrong("too few bytes", bytes.len()),
    };
    if blake3::hash(&bytes[..body]).as_bytes() != &bytes[body..] {
        return wrong("a checksum that does not match: cut short or altered", body);
    }
    let mut input = Reader { bytes: &bytes[..body], at: MAGIC.len() };
    let mut found = [0; HASH];
    found.copy_from_slice(input.next(HASH)?);
    let found = blake3::Hash::from_bytes(found);
    if found != fingerprint {
        let short = |h: blake3::Hash| h.to_hex()[..16].to_owned();
        return Err(Error::OtherRig { found: short(found), expected: short(fingerprint) });
    }
    let length = u64::take(&mut input)? as usize;
    let own = input.next(length)?;
    let mut reader = Reader { bytes: own, at: 0 };
    let script = T::take(&mut reader)?;
    if reader.at != own.len() {
        return wrong("bytes left over", reader.at);
    }
    let length = u64::take(&mut input)? as usize;
    let world = input.next(length)?;
    if input.at != body {
        return wrong("bytes left over", input.at);
    }
    Ok((script, world))
}
