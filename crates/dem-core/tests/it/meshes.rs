//! Walls of triangles act like the analytic walls that they stand for.

use dem_core::geometry::Mesh;
use dem_core::prelude::*;

use crate::scenes::{Model, bead_material, model};

fn builder(friction: f64, restitution: f64) -> (WorldBuilder<Model>, MaterialId) {
    let mut b = WorldBuilder::new(5e-6);
    let m = b.material(bead_material());
    // No constant rolling torque: it chatters at spins of rounding size, and so would differ.
    b.pair_law(m, m, model(friction, restitution, 0.0));
    b.domain(DVec3::splat(-0.2), DVec3::splat(0.2));
    (b, m)
}

/// A square in the plane z = 0, `n` by `n` cells of two triangles.
fn square(n: u32, half: f64) -> Mesh {
    let at = |k: u32| -half + 2.0 * half * f64::from(k) / f64::from(n);
    let vertices: Vec<DVec3> =
        (0..=n).flat_map(|i| (0..=n).map(move |j| DVec3::new(at(i), at(j), 0.0))).collect();
    let number = |i: u32, j: u32| i * (n + 1) + j;
    let facets: Vec<[u32; 3]> = (0..n)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b, c, d] =
                [number(i, j), number(i + 1, j), number(i, j + 1), number(i + 1, j + 1)];
            [[a, b, c], [b, d, c]]
        })
        .collect();
    Mesh::new(&vertices, &facets).unwrap()
}

#[test]
fn rebound_from_a_mesh_equals_that_from_a_plane_at_faces_edges_and_vertices() {
    let shots = [
        DVec3::new(0.0, 0.0, 3.2e-3),
        DVec3::new(1e-3, 1e-3, 3.2e-3),
        DVec3::new(0.7e-3, 0.4e-3, 3.2e-3),
        DVec3::new(2e-3, 0.0, 3.2e-3),
    ];
    for start in shots {
        for v in [DVec3::new(0.0, 0.0, -0.5), DVec3::new(0.6, 0.3, -0.4)] {
            let run = |mesh: bool| {
                let (mut b, m) = builder(0.3, 0.7);
                if mesh {
                    b.wall(Wall::mesh(square(40, 0.04), m));
                } else {
                    b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
                }
                let id = b.sphere(Sphere::at(start, 3e-3, m).with_velocity(v));
                let mut w = b.build().unwrap();
                w.run(600).unwrap();
                (w.velocity(id), w.spin(id))
            };
            let (plane, mesh) = (run(false), run(true));
            assert!(plane.0.z > 0.2);
            // The same law at the same distance: rounding of the nearest point only.
            assert!((plane.0 - mesh.0).length() < 1e-9, "{start} {v}: {plane:?} {mesh:?}");
            assert!((plane.1 - mesh.1).length() < 1e-5);
        }
    }
}

#[test]
fn a_sphere_rolls_across_the_edges_of_a_mesh_as_on_a_plane() {
    let run = |mesh: bool| {
        let (mut b, m) = builder(0.5, 0.5);
        b.gravity(DVec3::new(2.0, 0.7, -9.5));
        if mesh {
            b.wall(Wall::mesh(square(30, 0.06), m));
        } else {
            b.wall(Wall::plane(DVec3::ZERO, DVec3::Z, m));
        }
        let id = b.sphere(Sphere::at(DVec3::new(-0.02, -0.02, 2.999e-3), 3e-3, m));
        let mut w = b.build().unwrap();
        w.run(40_000).unwrap();
        (w.position(id), w.spin(id))
    };
    let (plane, mesh) = (run(false), run(true));
    assert!(plane.0.x > 0.0 && plane.1.length() > 10.0);
    assert!((plane.0 - mesh.0).length() < 1e-8, "{plane:?} {mesh:?}");
}

#[test]
fn a_corner_of_two_faces_holds_a_sphere_by_both() {
    let (mut b, m) = builder(0.0, 0.3);
    let half = DVec3::new(0.05, 0.05, 0.05);
    let v = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * half;
    // A valley along x: two faces at 45 degrees.
    let vertices = [
        v(-1., 0., 0.),
        v(1., 0., 0.),
        v(-1., 1., 1.),
        v(1., 1., 1.),
        v(-1., -1., 1.),
        v(1., -1., 1.),
    ];
    let mesh = Mesh::new(&vertices, &[[0, 1, 2], [1, 3, 2], [0, 4, 1], [1, 4, 5]]).unwrap();
    let wall = b.wall(Wall::mesh(mesh, m));
    b.gravity(DVec3::NEG_Z * 9.81);
    let id = b.sphere(Sphere::at(DVec3::Z * 3e-3 * 2f64.sqrt(), 3e-3, m));
    let mut w = b.build().unwrap();
    w.run(60_000).unwrap();
    let load = w.wall_load(wall).unwrap();
    assert_eq!(load.contacts, 2);
    let weight = w.mass(id) * 9.81;
    assert!((load.force.z / -weight - 1.0).abs() < 1e-3 && load.force.y.abs() < 1e-6 * weight);
}

#[test]
fn a_mesh_drum_of_many_facets_turns_its_bed_like_the_cylinder() {
    let run = |facets: Option<u32>| {
        let (mut b, m) = builder(0.5, 0.5);
        let turning = Motion::rotating(DVec3::ZERO, DVec3::Z, 3.0);
        match facets {
            None => {
                b.wall(Wall::drum(DVec3::ZERO, DVec3::Z, 0.03, m).with_motion(turning));
            }
            Some(n) => {
                // Flats whose middle lies on the cylinder: the vertices lie outside it.
                let r = 0.03 / (std::f64::consts::PI / f64::from(n)).cos();
                let vertices: Vec<DVec3> = (0..n)
                    .flat_map(|k| {
                        let a = std::f64::consts::TAU * f64::from(k) / f64::from(n);
                        [-0.05, 0.05].map(|z| DVec3::new(r * a.cos(), r * a.sin(), z))
                    })
                    .collect();
                let facets: Vec<[u32; 3]> = (0..n)
                    .flat_map(|k| {
                        let (a, b) = (2 * k, 2 * ((k + 1) % n));
                        [[a, b, a + 1], [b, b + 1, a + 1]]
                    })
                    .collect();
                let mesh = Mesh::new(&vertices, &facets).unwrap();
                b.wall(Wall::mesh(mesh, m).with_motion(turning));
            }
        }
        b.gravity(DVec3::NEG_Y * 9.81);
        let id = b.sphere(Sphere::at(DVec3::Y * -0.0269, 3e-3, m));
        let mut w = b.build().unwrap();
        w.run(40_000).unwrap();
        let mut mean = DVec3::ZERO;
        for _ in 0..400 {
            w.run(100).unwrap();
            mean += w.position(id) / 400.0;
        }
        (mean, w.spin(id))
    };
    let (cylinder, mesh) = (run(None), run(Some(180)));
    // One sphere rolls at the bottom; flats of 1 mm move it by R (1/cos(pi/n) - 1) = 5 um.
    assert!((cylinder.0 - mesh.0).length() < 3e-4, "{cylinder:?} {mesh:?}");
    assert!((cylinder.1.z / mesh.1.z - 1.0).abs() < 0.05, "{cylinder:?} {mesh:?}");
}

#[test]
fn stl_and_obj_bytes_become_the_same_mesh() {
    let stl = "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
               endloop\nendfacet\nendsolid t\n";
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let a = Mesh::from_stl(stl.as_bytes(), 0.001).unwrap();
    let b = Mesh::from_obj(obj.as_bytes(), 0.001).unwrap();
    assert_eq!(a, b);
    assert!(Mesh::from_stl(b"nonsense", 1.0).is_err());
    assert!(Mesh::from_obj(b"f 1 2 3\n", 1.0).is_err());
    assert!(Mesh::new(&[DVec3::ZERO], &[[0, 0, 1]]).is_err());
    assert!(Mesh::new(&[DVec3::ZERO, DVec3::X, DVec3::X * 2.0], &[[0, 1, 2]]).is_err());
}
