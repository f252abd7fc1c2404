//! An unstructured grid of vertices or lines as XML.
//!
//! Format: VTK XML, serial, version 1.0 with 64-bit headers. Inline data is either text or base64 of the
//! number of bytes (`u64`, little-endian) followed by the bytes themselves, uncompressed.

use std::fmt::Write;

use drum_rig::dem_core::glam::DVec3;

/// How numbers stand in the file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Encoding {
    /// As text, to the last bit.
    Ascii,
    /// As base64 of their bytes: shorter, and quicker to read.
    #[default]
    Base64,
}

/// What a cell is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Cell {
    /// One point.
    Vertex,
    /// Two points.
    Line,
}

impl Cell {
    fn points(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Line => 2,
        }
    }

    /// Number of the type in VTK.
    fn number(self) -> u8 {
        match self {
            Self::Vertex => 1,
            Self::Line => 3,
        }
    }
}

/// Numbers of one kind.
#[derive(Debug, Clone, PartialEq)]
enum Numbers {
    Float(Vec<f64>),
    Integer(Vec<i64>),
    Byte(Vec<u8>),
}

/// A named array of scalars or vectors.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Array {
    name: &'static str,
    components: usize,
    numbers: Numbers,
}

impl Array {
    pub(crate) fn scalars(name: &'static str, values: impl Iterator<Item = f64>) -> Self {
        Self { name, components: 1, numbers: Numbers::Float(values.collect()) }
    }

    pub(crate) fn vectors(name: &'static str, values: impl Iterator<Item = DVec3>) -> Self {
        let numbers = values.flat_map(|v| v.to_array()).collect();
        Self { name, components: 3, numbers: Numbers::Float(numbers) }
    }

    pub(crate) fn integers(name: &'static str, values: impl Iterator<Item = i64>) -> Self {
        Self { name, components: 1, numbers: Numbers::Integer(values.collect()) }
    }

    fn bytes(name: &'static str, values: Vec<u8>) -> Self {
        Self { name, components: 1, numbers: Numbers::Byte(values) }
    }

    fn put(&self, encoding: Encoding, out: &mut String) {
        let kind = match &self.numbers {
            Numbers::Float(_) => "Float64",
            Numbers::Integer(_) => "Int64",
            Numbers::Byte(_) => "UInt8",
        };
        let format = match encoding {
            Encoding::Ascii => "ascii",
            Encoding::Base64 => "binary",
        };
        // One component goes unsaid: readers then take the array as a list.
        let width = match self.components {
            1 => String::new(),
            n => format!(" NumberOfComponents=\"{n}\""),
        };
        out.push_str(&format!(
            "<DataArray type=\"{kind}\" Name=\"{}\"{width} format=\"{format}\">",
            self.name
        ));
        match encoding {
            Encoding::Ascii => self.put_text(out),
            Encoding::Base64 => {
                let data = self.data();
                let mut bytes = (data.len() as u64).to_le_bytes().to_vec();
                bytes.extend_from_slice(&data);
                base64(&bytes, out);
            }
        }
        out.push_str("</DataArray>\n");
    }

    fn put_text(&self, out: &mut String) {
        fn list<T: std::fmt::Display>(values: &[T], out: &mut String) {
            for v in values {
                // Writing to a text does not fail.
                let _ = write!(out, "{v} ");
            }
        }
        match &self.numbers {
            Numbers::Float(v) => list(v, out),
            Numbers::Integer(v) => list(v, out),
            Numbers::Byte(v) => list(v, out),
        }
    }

    fn data(&self) -> Vec<u8> {
        match &self.numbers {
            Numbers::Float(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Numbers::Integer(v) => v.iter().flat_map(|x| x.to_le_bytes()).collect(),
            Numbers::Byte(v) => v.clone(),
        }
    }
}

/// Points with cells of one kind, in the order of the points.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grid {
    pub(crate) points: Vec<DVec3>,
    pub(crate) cell: Cell,
    pub(crate) point_data: Vec<Array>,
    pub(crate) cell_data: Vec<Array>,
    pub(crate) time_s: f64,
}

impl Grid {
    /// The text of a `.vtu` file.
    pub(crate) fn text(&self, encoding: Encoding) -> String {
        let each = self.cell.points();
        let cells = self.points.len() / each;
        let mut out = String::from(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n",
        );
        // Readers take the time from here where there is no series.
        out.push_str(&format!(
            "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{}</DataArray></FieldData>\n",
            self.time_s
        ));
        out.push_str(&format!(
            "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">\n",
            self.points.len()
        ));
        let section = |name: &str, arrays: &[Array], out: &mut String| {
            out.push_str(&format!("<{name}>\n"));
            arrays.iter().for_each(|a| a.put(encoding, out));
            out.push_str(&format!("</{name}>\n"));
        };
        section("PointData", &self.point_data, &mut out);
        section("CellData", &self.cell_data, &mut out);
        section("Points", &[Array::vectors("Points", self.points.iter().copied())], &mut out);
        let number = |n: usize| i64::try_from(n).unwrap_or(i64::MAX);
        let topology = [
            Array::integers("connectivity", (0..cells * each).map(number)),
            Array::integers("offsets", (1..=cells).map(|k| number(k * each))),
            Array::bytes("types", vec![self.cell.number(); cells]),
        ];
        section("Cells", &topology, &mut out);
        out.push_str("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
        out
    }
}

/// Bytes as base64 (RFC 4648), padded.
fn base64(bytes: &[u8], out: &mut String) {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    out.reserve(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let three = [group[0], *group.get(1).unwrap_or(&0), *group.get(2).unwrap_or(&0)];
        let word = u32::from_be_bytes([0, three[0], three[1], three[2]]);
        for k in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * k)) as usize & 63];
            out.push(if k <= group.len() { char::from(letter) } else { '=' });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_gives_the_vectors_of_rfc_4648() {
        let cases = [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ];
        for (plain, coded) in cases {
            let mut out = String::new();
            base64(plain.as_bytes(), &mut out);
            assert_eq!(out, coded);
        }
    }

    #[test]
    fn numbers_as_text_keep_every_bit() {
        let values = [0.1, 1.0 / 3.0, -6.02e23, 5e-324];
        let mut out = String::new();
        Array::scalars("x", values.into_iter()).put(Encoding::Ascii, &mut out);
        let inside = out.split(['>', '<']).nth(2).unwrap();
        let back: Vec<f64> = inside.split_whitespace().map(|t| t.parse().unwrap()).collect();
        assert!(back.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()));
    }
}
