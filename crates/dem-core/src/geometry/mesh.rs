//! Walls made of triangles.
//!
//! A sphere that touches several facets of one surface touches it once: of all nearest points the
//! deepest counts, then the next that points another way (by more than 25 degrees) and is not
//! merely the border of a facet that counts already. So a sphere rolls over the edges of a flat or
//! finely divided surface as over the surface itself, and still feels both sides of a corner.
//! Facets act from both sides. The search tree is that of `parry3d`; the nearest point is our own,
//! since the library's is off by 1e-5 of the distance above an edge, which shows in a rebound.
//!
//! Compare Hu, Schäfer & Peiró, Comput. Part. Mech. (2017) on duplicate contacts; the rule by
//! directions is ours.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::DVec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::shape::TriMesh;

use super::Nearest;
use crate::error::Error;

/// Most contacts that one sphere can have with one mesh.
pub(crate) const CONTACTS_PER_SPHERE: usize = 4;

/// Cosine of the angle below which two contacts count as one.
const SAME_DIRECTION: f64 = 0.906;

/// A surface of triangles; cheap to clone.
#[derive(Clone)]
pub struct Mesh {
    inner: Arc<TriMesh>,
}

impl std::fmt::Debug for Mesh {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Mesh")
            .field("vertices", &self.inner.vertices().len())
            .field("triangles", &self.triangles())
            .finish()
    }
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Self) -> bool {
        self.inner.vertices() == other.inner.vertices()
            && self.inner.indices() == other.inner.indices()
    }
}

impl Mesh {
    /// A mesh of `vertices` (m) and `triangles` (three vertex numbers each).
    ///
    /// Vertices at the same place become one; facets without area are left out.
    ///
    /// # Errors
    /// [`Error::Mesh`] for a vertex that is not finite or does not exist, and for a mesh in which
    /// no facet has an area.
    ///
    /// ```
    /// # use dem_core::geometry::Mesh;
    /// # use glam::DVec3;
    /// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    /// let mesh = Mesh::new(&corners, &[[0, 1, 2], [1, 3, 2], [1, 1, 2]])?;
    /// assert_eq!(mesh.triangles(), 2);
    /// # Ok::<(), dem_core::error::Error>(())
    /// ```
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, Error> {
        if let Some(k) = vertices.iter().position(|v| !v.is_finite()) {
            return Err(Error::Mesh { what: "a vertex is not finite", value: k });
        }
        if let Some(k) = triangles.iter().flatten().find(|&&v| v as usize >= vertices.len()) {
            return Err(Error::Mesh { what: "a facet names no vertex", value: *k as usize });
        }
        let mut welded: Vec<DVec3> = Vec::new();
        let mut known = BTreeMap::new();
        let number: Vec<u32> = vertices
            .iter()
            .map(|v| {
                // Adding zero turns -0 into 0, which is the same place.
                let key = (*v + DVec3::ZERO).to_array().map(f64::to_bits);
                *known.entry(key).or_insert_with(|| {
                    welded.push(*v);
                    (welded.len() - 1) as u32
                })
            })
            .collect();
        let facets: Vec<[u32; 3]> = triangles
            .iter()
            .map(|t| t.map(|v| number[v as usize]))
            .filter(|t| {
                let [a, b, c] = t.map(|v| welded[v as usize]);
                let (u, v) = (b - a, c - a);
                u.cross(v).length() > 1e-12 * u.length_squared().max(v.length_squared())
            })
            .collect();
        if facets.is_empty() {
            return Err(Error::Mesh { what: "no facet has an area", value: triangles.len() });
        }
        let inner = TriMesh::new(welded, facets)
            .map_err(|_| Error::Mesh { what: "it has no facets", value: 0 })?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// A mesh from the bytes of an STL file, ASCII or binary; `scale` turns its unit into metres.
    ///
    /// # Errors
    /// [`Error::MeshRead`] for bytes that are no STL; those of [`Mesh::new`].
    pub fn from_stl(bytes: &[u8], scale: f64) -> Result<Self, Error> {
        let mut cursor = std::io::Cursor::new(bytes);
        let stl = stl_io::read_stl(&mut cursor)
            .map_err(|e| Error::MeshRead { format: "STL", reason: e.to_string() })?;
        let vertices: Vec<DVec3> = (stl.vertices.iter())
            .map(|v| DVec3::new(f64::from(v[0]), f64::from(v[1]), f64::from(v[2])) * scale)
            .collect();
        let faces: Vec<[u32; 3]> = stl.faces.iter().map(|f| f.vertices.map(|v| v as u32)).collect();
        Self::new(&vertices, &faces)
    }

    /// A mesh from the bytes of a Wavefront OBJ file (all its objects together); polygons are cut
    /// into triangles. `scale` turns its unit into metres.
    ///
    /// # Errors
    /// [`Error::MeshRead`] for bytes that are no OBJ; those of [`Mesh::new`].
    pub fn from_obj(bytes: &[u8], scale: f64) -> Result<Self, Error> {
        let options = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
        let mut reader = bytes;
        let (models, _) =
            tobj::load_obj_buf(&mut reader, &options, |_| Err(tobj::LoadError::OpenFileFailed))
                .map_err(|e| Error::MeshRead { format: "OBJ", reason: e.to_string() })?;
        let (mut vertices, mut faces) = (Vec::new(), Vec::new());
        for model in &models {
            let first = vertices.len() as u32;
            let points = model.mesh.positions.chunks_exact(3);
            vertices.extend(points.map(|p| DVec3::new(p[0], p[1], p[2]) * scale));
            let triples = model.mesh.indices.chunks_exact(3);
            faces.extend(triples.map(|t| [t[0] + first, t[1] + first, t[2] + first]));
        }
        Self::new(&vertices, &faces)
    }

    /// Number of facets.
    pub fn triangles(&self) -> usize {
        self.inner.indices().len()
    }

    /// Append the facets whose boxes come within `reach` of `x` (in the mesh's own frame).
    pub(crate) fn facets_near(&self, x: DVec3, reach: f64, facets: &mut Vec<u32>) {
        let begin = facets.len();
        let around = Aabb::new(x - DVec3::splat(reach), x + DVec3::splat(reach));
        facets.extend(self.inner.bvh().intersect_aabb(&around));
        // The order in which the tree is walked is no business of the forces.
        facets[begin..].sort_unstable();
    }

    /// The contacts of a sphere at `x` (own frame) that reach within `reach`, deepest first.
    pub(crate) fn contacts(&self, x: DVec3, reach: f64, facets: &[u32]) -> MeshContacts {
        let mut kept = MeshContacts::default();
        // As many passes as contacts can be: each takes the deepest that is still allowed.
        while kept.len < CONTACTS_PER_SPHERE {
            let mut best: Option<MeshContact> = None;
            for &facet in facets {
                let Some(candidate) = self.nearest_on(facet, x, reach) else { continue };
                let nearer = best.is_none_or(|b| candidate.distance < b.distance);
                if nearer && !kept.iter().any(|k| self.same(k, &candidate)) {
                    best = Some(candidate);
                }
            }
            match best {
                Some(contact) => {
                    kept.list[kept.len] = contact;
                    kept.len += 1;
                }
                None => break,
            }
        }
        kept
    }

    fn nearest_on(&self, facet: u32, x: DVec3, reach: f64) -> Option<MeshContact> {
        let triangle = self.inner.triangle(facet);
        let corners = [triangle.a, triangle.b, triangle.c];
        let (point, border) = closest_point(corners, x);
        let to_wall = point - x;
        let distance = to_wall.length();
        if distance >= reach || distance == 0.0 {
            return None;
        }
        let numbers = self.inner.indices()[facet as usize];
        let border = border.map(|k| numbers.get(k).copied().unwrap_or(u32::MAX));
        Some(MeshContact { facet, distance, direction: to_wall / distance, border })
    }

    /// Whether `new` is the same contact as `kept`, or merely the border of its facet.
    fn same(&self, kept: &MeshContact, new: &MeshContact) -> bool {
        if kept.direction.dot(new.direction) > SAME_DIRECTION {
            return true;
        }
        let corners = self.inner.indices()[kept.facet as usize];
        new.border[0] != u32::MAX && new.border.iter().all(|v| corners.contains(v))
    }

    /// Whether two facets share a corner.
    pub(crate) fn adjacent(&self, a: u32, b: u32) -> bool {
        let (a, b) = (self.inner.indices()[a as usize], self.inner.indices()[b as usize]);
        a.iter().any(|v| b.contains(v))
    }
}

/// No corner: the nearest point lies inside the facet.
const INSIDE: usize = 3;

/// Nearest point of a triangle, and between which corners it lies (twice the same: on a corner).
///
/// Voronoi regions as in Ericson, Real-Time Collision Detection (2005), section 5.1.5.
fn closest_point([a, b, c]: [DVec3; 3], x: DVec3) -> (DVec3, [usize; 2]) {
    let (ab, ac, ax) = (b - a, c - a, x - a);
    let (d1, d2) = (ab.dot(ax), ac.dot(ax));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (a, [0, 0]);
    }
    let bx = x - b;
    let (d3, d4) = (ab.dot(bx), ac.dot(bx));
    if d3 >= 0.0 && d4 <= d3 {
        return (b, [1, 1]);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * (d1 / (d1 - d3)), [0, 1]);
    }
    let cx = x - c;
    let (d5, d6) = (ab.dot(cx), ac.dot(cx));
    if d6 >= 0.0 && d5 <= d6 {
        return (c, [2, 2]);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * (d2 / (d2 - d6)), [0, 2]);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        return (b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), [1, 2]);
    }
    let inverse = 1.0 / (va + vb + vc);
    (a + ab * (vb * inverse) + ac * (vc * inverse), [INSIDE; 2])
}

/// One contact of a sphere with a mesh, in the mesh's frame.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct MeshContact {
    pub(crate) facet: u32,
    pub(crate) distance: f64,
    pub(crate) direction: DVec3,
    /// Corners of the edge (twice the same for a vertex) on which the nearest point lies.
    border: [u32; 2],
}

/// The contacts of one sphere with a mesh.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct MeshContacts {
    list: [MeshContact; CONTACTS_PER_SPHERE],
    len: usize,
}

impl MeshContacts {
    pub(crate) fn iter(&self) -> impl Iterator<Item = &MeshContact> {
        self.list[..self.len].iter()
    }
}

impl MeshContact {
    pub(crate) fn nearest(&self, to_space: glam::DQuat) -> Nearest {
        Nearest {
            normal_to_wall: to_space * self.direction,
            distance: self.distance,
            wall_radius: f64::INFINITY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn above_an_edge_the_nearest_point_is_straight_below() {
        let h = 1e-3;
        let corners = [
            DVec3::new(2.0 * h, 0.0, 0.0),
            DVec3::new(2.0 * h, 2.0 * h, 0.0),
            DVec3::new(0.0, 2.0 * h, 0.0),
        ];
        let x = DVec3::new(h, h, 3.0 * h);
        let (p, _) = closest_point(corners, x);
        assert!((p - DVec3::new(h, h, 0.0)).length() < 1e-18, "{p}");
        let corners = [DVec3::ZERO, DVec3::new(2.0 * h, 0.0, 0.0), DVec3::new(0.0, 2.0 * h, 0.0)];
        let (p, _) = closest_point(corners, x);
        assert!((p - DVec3::new(h, h, 0.0)).length() < 1e-18, "{p}");
    }
}
