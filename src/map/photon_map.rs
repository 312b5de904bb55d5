//! The photon map of surfaces: an immutable kd-tree over the photons of a pass. The tree accepts
//! any number of coplanar or coincident photons.

use super::photon::Photon;
use kiddo::leaf_strategies::VecOfArenas;
use kiddo::stem_strategies::Eytzinger;
use kiddo::{KdTree, SquaredEuclidean};
use std::num::NonZero;

/// Photons per leaf. Measurements showed that 8 photons per leaf give the fastest queries.
const LEAF: usize = 8;

type PhotonTree = KdTree<f32, Photon, Eytzinger, VecOfArenas<f32, Photon, 3, LEAF>, 3, LEAF>;

/// A spatial index that finds photons by their position. Positions are in m, relative to the
/// scene's centre.
#[derive(Debug, Default)]
pub struct PhotonMap {
    tree: Option<PhotonTree>,
}

/// A photon found by a query.
#[derive(Debug, Clone, Copy)]
pub struct NearbyPhoton {
    /// The photon.
    pub photon: Photon,
    /// The photon's position in m, relative to the scene's centre.
    pub position: [f32; 3],
    /// The squared distance from the query's centre, in m².
    pub distance2: f32,
}

impl PhotonMap {
    /// Builds the map from photons and their positions. The threads of the current thread pool
    /// share the work. The result does not depend on the number of threads.
    pub fn build(photons: &[(Photon, [f32; 3])]) -> Self {
        if photons.is_empty() {
            return Self::default();
        }
        let tree = PhotonTree::new_from_entries_parallel(photons)
            .expect("photon positions are finite and their leaves can grow");
        Self { tree: Some(tree) }
    }

    /// Returns the number of photons.
    pub fn len(&self) -> usize {
        self.tree.as_ref().map_or(0, KdTree::size)
    }

    /// Returns true if the map has no photons.
    pub fn is_empty(&self) -> bool {
        self.tree.is_none()
    }

    /// Calls `visit` for each photon within `radius` (m) of `centre`. Allocates nothing.
    #[inline]
    pub fn within(&self, centre: [f32; 3], radius: f32, mut visit: impl FnMut(NearbyPhoton)) {
        if let Some(tree) = &self.tree {
            tree.query(&centre).within::<SquaredEuclidean<f32>>(radius * radius).unsorted().with_points().visit(
                |found| {
                    visit(NearbyPhoton { photon: found.item, position: found.point, distance2: found.distance });
                },
            );
        }
    }

    /// Returns the distance (m) from `centre` to the `k`-th nearest photon. Returns `None` if fewer
    /// than `k` photons are within `farthest` (m). The search ends at this distance.
    pub fn kth_distance(&self, centre: [f32; 3], k: NonZero<usize>, farthest: f32) -> Option<f32> {
        let query = self.tree.as_ref()?.query(&centre);
        let found = query.nearest_n::<SquaredEuclidean<f32>>(k).within(farthest * farthest).execute();
        found.get(k.get() - 1).map(|kth| kth.distance.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::photon::PhotonPower;
    use crate::math::random::{Purpose, Stream};
    use crate::spectrum::Wavelengths;
    use glam::DVec3;

    fn numbered(i: usize) -> Photon {
        let load = PhotonPower::new(&Wavelengths::new([i as f64; 4]), [0.0; 4], None);
        Photon::new(load, DVec3::Y, DVec3::Y)
    }

    fn found(index: &PhotonMap, place: [f32; 3], radius: f32) -> Vec<usize> {
        let mut hits = Vec::new();
        index.within(place, radius, |f| hits.extend(f.photon.power.lanes().next().map(|(nm, _)| nm as usize)));
        hits.sort_unstable();
        hits
    }

    /// Queries among 100,000 coplanar photons find the same photons as a brute-force search.
    #[test]
    fn coplanar_photons_are_found_like_by_brute_force() {
        let mut stream = Stream::new(1, Purpose::Pilot, 0, 0);
        let photons: Vec<_> = (0..100_000)
            .map(|i| (numbered(i), [stream.uniform() as f32 - 0.5, 0.0, stream.uniform() as f32 - 0.5]))
            .collect();
        let index = PhotonMap::build(&photons);
        assert_eq!(index.len(), photons.len());
        for _ in 0..50 {
            let place = [stream.uniform() as f32 - 0.5, 0.001, stream.uniform() as f32 - 0.5];
            let radius = 0.02_f32;
            let distance2 = |p: [f32; 3]| (0..3).map(|a| (p[a] - place[a]).powi(2)).sum::<f32>();
            let expected: Vec<usize> =
                (0..photons.len()).filter(|&i| distance2(photons[i].1) <= radius * radius).collect();
            assert_eq!(found(&index, place, radius), expected);
            let mut all: Vec<f32> = photons.iter().map(|p| distance2(p.1)).collect();
            all.sort_by(f32::total_cmp);
            let kth = |farthest| index.kth_distance(place, NonZero::new(60).unwrap(), farthest);
            assert!((kth(1.0).unwrap() - all[59].sqrt()).abs() < 1e-6);
            assert_eq!(kth(0.99 * all[59].sqrt()), None, "the search ends before the 60th photon");
        }
    }

    /// If 10,000 photons are at one position, a query finds all of them.
    #[test]
    fn coincident_photons_are_all_found() {
        let photons: Vec<_> = (0..10_000).map(|i| (numbered(i), [0.25, -1.0, 3.0])).collect();
        let index = PhotonMap::build(&photons);
        assert_eq!(found(&index, [0.25, -1.0, 3.0], 1e-3).len(), 10_000);
        assert!(found(&index, [0.25, -1.1, 3.0], 1e-3).is_empty());
        assert_eq!(index.kth_distance([0.25, -1.0, 3.0], NonZero::new(50).unwrap(), 1e-3), Some(0.0));
    }

    /// A map with one photon and a map without photons answer all queries.
    #[test]
    fn maps_of_one_photon_and_of_none() {
        let one = PhotonMap::build(&[(numbered(7), [1.0, 2.0, 3.0])]);
        assert_eq!(found(&one, [1.0, 2.0, 3.0], 0.1), [7]);
        let kth = |k, farthest| one.kth_distance([1.0, 2.0, 4.0], NonZero::new(k).unwrap(), farthest);
        assert_eq!([kth(1, 2.0), kth(1, 0.5), kth(2, 2.0)], [Some(1.0), None, None]);
        let none = PhotonMap::build(&[]);
        assert!(none.is_empty() && found(&none, [0.0; 3], 10.0).is_empty());
        assert_eq!(none.kth_distance([0.0; 3], NonZero::<usize>::MIN, 1.0), None);
    }
}
