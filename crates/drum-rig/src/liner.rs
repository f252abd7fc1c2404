//! An inner surface of the drum from an STL file, and the search for holes in it.

use std::collections::BTreeMap;

use dem_core::geometry::Mesh;
use dem_core::glam::DVec3;
use rig_schema::Ends;

use crate::error::Error;

/// A liner that holds.
#[derive(Debug, Clone)]
pub(crate) struct Liner {
    pub(crate) mesh: Mesh,
    /// Least and largest distance of the surface from the axis, m.
    pub(crate) inner: f64,
    pub(crate) outer: f64,
}

/// Read a liner: STL bytes in metres, axis along z, centred like the drum of `length` m.
///
/// Its borders (edges of one facet only) must lie at or beyond both ends, where the end plates
/// close the drum: any other border is a hole.
pub(crate) fn read(bytes: &[u8], length: f64, ends: Ends) -> Result<Liner, Error> {
    let mut cursor = std::io::Cursor::new(bytes);
    let stl = stl_io::read_stl(&mut cursor)
        .map_err(|e| Error::Liner { problem: format!("the liner is no STL: {e}") })?;
    let vertices: Vec<DVec3> = (stl.vertices.iter())
        .map(|v| DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2])))
        .collect();
    let faces: Vec<[u32; 3]> = stl.faces.iter().map(|f| f.vertices.map(|v| v as u32)).collect();
    let mesh = Mesh::new(&vertices, &faces)?;
    // Half a thousandth of the length: STL numbers have seven digits.
    let end = 0.5 * length * (1.0 - 1e-3);
    let reaches = |sign: f64| vertices.iter().any(|v| v.z * sign >= end);
    if ends == Ends::Periodic || !(reaches(1.0) && reaches(-1.0)) {
        let problem = if ends == Ends::Periodic {
            "a liner needs end plates: expected ends = turning or still".into()
        } else {
            format!("the liner does not reach both ends: expected z from {} to {end} m", -end)
        };
        return Err(Error::Liner { problem });
    }
    let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for f in &faces {
        for (a, b) in [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])] {
            *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let at = |v: u32| vertices[v as usize];
    let open: Vec<DVec3> = edges
        .iter()
        .filter(|&(_, &n)| n == 1)
        .map(|(&[a, b], _)| [at(a), at(b)])
        .filter(|[a, b]| !(a.z.min(b.z) >= end || a.z.max(b.z) <= -end))
        .map(|[a, b]| 0.5 * (a + b))
        .collect();
    if let Some(p) = open.first() {
        return Err(Error::Leak { edges: open.len(), x: p.x, y: p.y, z: p.z });
    }
    let outer = vertices.iter().map(|v| v.x.hypot(v.y)).fold(0.0, f64::max);
    let inner = faces.iter().map(|f| nearest_to_axis(f.map(at))).fold(f64::INFINITY, f64::min);
    Ok(Liner { mesh, inner, outer })
}

/// Least distance of a facet's edges from the axis: of the facet itself unless the axis pierces it.
fn nearest_to_axis(corners: [DVec3; 3]) -> f64 {
    let flat = corners.map(|c| c.truncate());
    let edge = |a: usize, b: usize| {
        let (p, d) = (flat[a], flat[b] - flat[a]);
        let length2 = d.length_squared();
        let t = if length2 > 0.0 { (-p.dot(d) / length2).clamp(0.0, 1.0) } else { 0.0 };
        (p + d * t).length()
    };
    edge(0, 1).min(edge(1, 2)).min(edge(2, 0))
}
