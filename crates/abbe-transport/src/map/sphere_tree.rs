//! A spatial index of spheres, for searches along straight parts of photon paths.

use super::box_tree::{BoxTree, Leaves};
use super::query_cone::QueryCone;
use abbe_scene::geometry::Ray;
use glam::{DVec3, Vec3};

/// A bounding volume hierarchy over the boxes around spheres. A query allocates nothing.
#[derive(Debug)]
pub struct SphereTree {
    tree: BoxTree,
    leaves: Leaves,
}

impl SphereTree {
    /// Builds the index. A sphere is a pair of its centre and its radius, both in m.
    pub fn build(spheres: impl Iterator<Item = (DVec3, f64)>) -> Self {
        // The rounding to single precision must not make a box smaller than its sphere.
        let around = |(centre, radius_m): (DVec3, f64)| {
            let half = Vec3::splat(radius_m as f32) + 4.0 * f32::EPSILON * (centre.as_vec3().abs() + radius_m as f32);
            (centre.as_vec3() - half, centre.as_vec3() + half)
        };
        let (tree, leaves) = BoxTree::build(&spheres.map(around).collect::<Vec<_>>());
        Self { tree, leaves }
    }

    /// Calls `visit` with each sphere that the first `length_m` metres of the ray may touch.
    pub fn visit(&self, ray: Ray, length_m: f64, mut visit: impl FnMut(usize)) {
        let line = QueryCone { ray, length_m, radius_m: 0.0, slope: 0.0 };
        self.tree.visit(&line, |leaf| {
            let [start, end] = [leaf, leaf + 1].map(|leaf| self.leaves.starts[leaf] as usize);
            self.leaves.boxes[start..end].iter().for_each(|&sphere| visit(sphere as usize));
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use abbe_spectra::math::warp;

    /// The index finds every sphere that a segment touches, and each of them once.
    #[test]
    fn a_query_finds_every_touched_sphere() {
        let mut stream = Stream::new(Seed::new(5), Purpose::SurveyPhoton, 0, 0);
        let mut point = || 1000.0 * (DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5);
        let spheres: Vec<(DVec3, f64)> = (0..500).map(|i| (point(), f64::from(i % 7) * 20.0)).collect();
        let tree = SphereTree::build(spheres.iter().copied());
        let mut stream = Stream::new(Seed::new(6), Purpose::SurveyPhoton, 0, 0);
        let mut touched = 0;
        for _ in 0..200 {
            let origin = 1000.0 * (DVec3::new(stream.uniform(), stream.uniform(), stream.uniform()) - 0.5);
            let (ray, length_m) = (Ray::new(origin, warp::sphere(stream.pair())), 700.0);
            let mut found = vec![0; spheres.len()];
            tree.visit(ray, length_m, |sphere| found[sphere] += 1);
            for ((centre, radius_m), found) in spheres.iter().zip(found) {
                let nearest = ray.at((*centre - origin).dot(ray.direction).clamp(0.0, length_m));
                let touches = nearest.distance(*centre) <= *radius_m;
                touched += u32::from(touches);
                assert!(found <= 1 && (found == 1 || !touches), "{centre}: {found}");
            }
        }
        assert!(touched > 100, "{touched}");
        SphereTree::build(std::iter::empty()).visit(Ray::new(DVec3::ZERO, DVec3::X), 1.0, |_| panic!("there is none"));
    }
}
