//! What was done to a drum, and a seal that a fit cannot read by accident.

use serde::{Deserialize, Serialize};

/// The truth of one case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Truth {
    /// Name of the case.
    pub(crate) case: String,
    /// `null`, `single`, `removed` or `pair`.
    pub(crate) kind: String,
    /// Code that made the data.
    pub(crate) code: String,
    /// Frictions of the drum.
    pub(crate) frictions: Vec<(String, f64)>,
    /// Effects with their strengths.
    pub(crate) effects: Vec<(String, f64)>,
}

/// Scramble a text with a key stream: enough that nothing reads it by accident.
pub(crate) fn seal(text: &str, key: &[u8; 32]) -> String {
    let mut stream = vec![0; text.len()];
    blake3::Hasher::new_keyed(key).finalize_xof().fill(&mut stream);
    text.bytes().zip(stream).map(|(a, b)| format!("{:02x}", a ^ b)).collect()
}

/// Undo [`seal`].
pub(crate) fn open(sealed: &str, key: &[u8; 32]) -> anyhow::Result<String> {
    anyhow::ensure!(sealed.len().is_multiple_of(2), "a sealed truth is cut short");
    let bytes = (0..sealed.len() / 2)
        .map(|k| Ok(u8::from_str_radix(&sealed[2 * k..2 * k + 2], 16)?))
        .collect::<anyhow::Result<Vec<u8>>>()?;
    let mut stream = vec![0; bytes.len()];
    blake3::Hasher::new_keyed(key).finalize_xof().fill(&mut stream);
    Ok(String::from_utf8(bytes.iter().zip(stream).map(|(a, b)| a ^ b).collect())?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seal_opens_with_its_key_alone() {
        let key = [7; 32];
        let sealed = seal("rolling.pp = 0.08", &key);
        assert!(!sealed.contains("rolling"));
        assert_eq!(open(&sealed, &key).unwrap(), "rolling.pp = 0.08");
        assert_ne!(open(&sealed, &[8; 32]).unwrap_or_default(), "rolling.pp = 0.08");
    }
}
