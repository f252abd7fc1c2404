//! The search for spheres near walls, run by run of bodies.

use crate::contact::model::ContactLaw;
use crate::integrate::Integrator;
use crate::neighbour::wall_gaps::told;
use crate::neighbour::wall_list::NearWalls;
use crate::threads::{PART, cut, part};
use crate::world::World;

impl<M: ContactLaw + 'static, I: Integrator> World<M, I> {
    /// List the spheres near walls.
    pub(crate) fn list_walls(&mut self, sorted: bool) {
        let mut list = std::mem::take(&mut self.state.wall_list);
        let mut near = std::mem::take(&mut self.scratch.near_walls);
        let bodies = self.len();
        near.resize_with(bodies.div_ceil(PART), NearWalls::default);
        self.team.each(near.len(), cut(&mut near, 1), |c, near| {
            self.find_walls(part(c, bodies), &mut near[0]);
        });
        list.clear(self.make.slots);
        near.iter().for_each(|near| list.append(near));
        list.close(self.sphere_positions().len());
        let old_place = sorted.then_some(&self.scratch.old_sphere_place[..]);
        list.take_over(&self.scratch.old_walls, old_place);
        let (members, gaps) = (&self.state.members, &mut self.scratch.wall_gaps);
        if members.body.is_empty() {
            gaps.forget();
        } else {
            let of = near.iter().flat_map(NearWalls::gaps);
            gaps.make(of.map(|(gap, sphere)| (gap, members.body[sphere as usize])));
        }
        self.scratch.near_walls = near;
        self.state.wall_list = list;
    }

    /// Find the walls near the spheres of some bodies.
    fn find_walls(&self, bodies: std::ops::Range<usize>, near: &mut NearWalls) {
        let range = self.make.skin + self.make.range;
        let (position, members) = (self.sphere_positions(), &self.state.members);
        let (walls, seats) = (&self.scratch.placed, members.seats());
        near.begin(bodies.len());
        near.in_reach.extend(0..walls.len());
        let spheres = seats.first(bodies.start)..seats.first(bodies.end);
        for (k, p) in spheres.clone().zip(&position[spheres]) {
            // Walls out of reach of a clump as a whole are out of reach of its spheres.
            if let Some(&body) = members.body.get(k)
                && members.first[body as usize] as usize == k
            {
                let whole = &self.state.bodies.position[body as usize];
                let misses = |w: &usize| walls[*w].misses(whole.vector(), whole.w + range);
                near.in_reach.clear();
                near.in_reach.extend((0..walls.len()).filter(|w| !misses(w)));
            }
            for nth in 0..near.in_reach.len() {
                let w = near.in_reach[nth];
                let wall = &walls[w];
                if wall.misses(p.vector(), p.w + range) {
                    continue;
                }
                if let Some(nearest) = wall.nearest(p.vector()) {
                    // A centre further behind the surface than its diameter is on the other side.
                    if nearest.distance < p.w + range && nearest.distance > -(p.w + range) {
                        let gap = if wall.is_steady() { nearest.distance - p.w } else { -range };
                        near.push(k as u32, w as u16, told(gap, range), None);
                    }
                }
                #[cfg(feature = "mesh")]
                if let crate::geometry::Shape::Mesh(mesh) = &self.make.walls[w].shape {
                    let local = wall.pose.inverse_point(p.vector());
                    let begin = near.facets.len() as u32;
                    mesh.facets_near(local, p.w + range, &mut near.facets);
                    let end = near.facets.len() as u32;
                    if end > begin {
                        for _ in 0..crate::geometry::mesh::CONTACTS_PER_SPHERE {
                            near.push(k as u32, w as u16, -1.0, Some([begin, end]));
                        }
                    }
                }
            }
        }
    }
}
