//! The photon map of surfaces: a kd-tree for any number of coplanar or coincident photons.

use super::photon::Photon;
use super::point_tree::PointTree;
use super::polarisation::StoredPolarisation;
use std::num::NonZero;

/// Finds photons by their position in m, relative to the scene's centre.
#[derive(Debug, Default)]
pub struct PhotonMap {
    photons: Vec<Photon>,
    /// The number of surface events of each photon. Empty if the scene does not limit it.
    events: Vec<u16>,
    /// The polarisation of each photon. Empty if the plan does not contain it.
    polarisation: Vec<StoredPolarisation>,
    tree: Option<PointTree>,
}

#[derive(Debug, Clone, Copy)]
pub struct NearbyPhoton<'m> {
    pub photon: &'m Photon,
    /// The number of the photon in the map.
    pub number: usize,
    /// The photon's position in m, relative to the scene's centre.
    pub position: [f32; 3],
    /// The squared distance from the query's centre, in m².
    pub distance2: f32,
}

impl PhotonMap {
    /// Builds the map on the current thread pool, with the same result for any number of threads.
    pub fn build(photons: &[(Photon, [f32; 3])]) -> Self {
        Self::build_with(photons, &[], &[])
    }

    /// Builds the map of photons with these numbers of surface events and this polarisation. Both may
    /// be empty.
    pub fn build_with(photons: &[(Photon, [f32; 3])], events: &[u16], polarisation: &[StoredPolarisation]) -> Self {
        if photons.is_empty() {
            return Self::default();
        }
        let (tree, order) = PointTree::build(photons.iter().map(|(_, position)| *position));
        let (events, polarisation) = (ordered(events, &order), ordered(polarisation, &order));
        let photons = order.iter().map(|&i| photons[i as usize].0).collect();
        Self { photons, events, polarisation, tree: Some(tree) }
    }

    /// Returns the number of surface events of the photon with this number, its arrival included.
    /// The map must have been built with these numbers.
    #[inline]
    pub fn events(&self, number: usize) -> u32 {
        u32::from(self.events[number])
    }

    /// Returns the polarisation of the photon with this number. The map must have been built with it.
    #[inline]
    pub fn polarisation(&self, number: usize) -> &StoredPolarisation {
        &self.polarisation[number]
    }

    pub fn len(&self) -> usize {
        self.photons.len()
    }

    pub fn is_empty(&self) -> bool {
        self.photons.is_empty()
    }

    /// Calls `visit` for each photon within `radius` (m) of `centre`. Allocates nothing.
    #[inline]
    pub fn within(&self, centre: [f32; 3], radius: f32, mut visit: impl FnMut(NearbyPhoton<'_>)) {
        if let Some(tree) = &self.tree {
            tree.within(centre, radius * radius, |number, position, distance2| {
                visit(NearbyPhoton { photon: &self.photons[number], number, position, distance2 });
            });
        }
    }

    /// Returns the distance (m) from `centre` to the `k`-th nearest photon, or `None` if it is
    /// beyond `farthest` (m), where the search ends.
    pub fn kth_distance(&self, centre: [f32; 3], k: NonZero<usize>, farthest: f32) -> Option<f32> {
        self.tree.as_ref()?.kth_distance2(centre, k, farthest * farthest).map(f32::sqrt)
    }
}

/// Returns the items in an order, or no items if there are none.
fn ordered<T: Copy>(items: &[T], order: &[u32]) -> Vec<T> {
    if items.is_empty() { Vec::new() } else { order.iter().map(|&i| items[i as usize]).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{PhotonPower, WavelengthCode};
    use abbe_spectra::math::random::{Purpose, Seed, Stream};
    use glam::DVec3;
    use kiddo::leaf_strategies::VecOfArenas;
    use kiddo::stem_strategies::Eytzinger;
    use kiddo::{KdTree, SquaredEuclidean};

    /// The kd-tree of another library, with the same photons.
    type OtherTree = KdTree<f32, usize, Eytzinger, VecOfArenas<f32, usize, 3, 8>, 3, 8>;

    /// Returns a photon whose first power is its number. Numbers below 256 are stored exactly.
    fn numbered(i: usize) -> Photon {
        let power = PhotonPower::new(WavelengthCode::default(), [i as f64; 4], None, 0.0);
        Photon::new(power, DVec3::Y, DVec3::Y)
    }

    fn found(index: &PhotonMap, place: [f32; 3], radius: f32) -> Vec<[u32; 3]> {
        let mut hits = Vec::new();
        index.within(place, radius, |found| hits.push(found.position.map(f32::to_bits)));
        hits.sort_unstable();
        hits
    }

    /// Queries find the same photons as a kd-tree of another library: among photons on a plane, in
    /// a cube, on a line, and around one point, for all sizes of a map.
    #[test]
    fn queries_find_the_photons_that_another_tree_finds() {
        let mut stream = Stream::new(Seed::new(1), Purpose::SurveyPhoton, 0, 0);
        for (count, shape) in [
            (100_000, [1.0, 0.0, 1.0]),
            (20_000, [1.0, 0.7, 1.3]),
            (5_000, [0.0, 1.0, 0.0]),
            (1_000, [0.01, 0.01, 0.02]),
            (33, [1.0, 1.0, 1.0]),
            (32, [1.0, 1.0, 1.0]),
        ] {
            let mut place = || shape.map(|extent| ((stream.uniform() - 0.5) * extent) as f32);
            let places: Vec<[f32; 3]> = (0..count).map(|_| place()).collect();
            let photons: Vec<_> = places.iter().map(|&place| (numbered(1), place)).collect();
            let index = PhotonMap::build(&photons);
            assert_eq!(index.len(), photons.len());
            let entries: Vec<_> = places.iter().copied().zip(0..).map(|(place, number)| (number, place)).collect();
            let other = OtherTree::new_from_entries_parallel(&entries).unwrap();
            for _ in 0..50 {
                let (centre, radius) = (place().map(|x| x + 1e-3), 0.05_f32);
                let near = other.query(&centre).within::<SquaredEuclidean<f32>>(radius * radius).unsorted().execute();
                let mut expected: Vec<_> = near.iter().map(|n| places[n.item].map(f32::to_bits)).collect();
                expected.sort_unstable();
                assert_eq!(found(&index, centre, radius), expected);
                let k = NonZero::new(30).unwrap();
                let nearest = other.query(&centre).nearest_n::<SquaredEuclidean<f32>>(k).execute();
                let kth = nearest.last().unwrap().distance.sqrt();
                assert!((index.kth_distance(centre, k, f32::INFINITY).unwrap() - kth).abs() <= 1e-6 * kth);
                assert_eq!(index.kth_distance(centre, k, 0.99 * kth), None, "the search ends before the photon");
            }
        }
    }

    #[test]
    fn photons_and_positions_stay_together() {
        let position = |i: usize| [(i * 37 % 101) as f32, 0.0, i as f32];
        let photons: Vec<_> = (0..200).map(|i| (numbered(i), position(i))).collect();
        let mut seen = 0;
        PhotonMap::build(&photons).within([50.0, 0.0, 100.0], 1e4, |found| {
            assert_eq!(found.photon.power.powers()[0], found.position[2]);
            seen += 1;
        });
        assert_eq!(seen, 200);
    }

    #[test]
    fn photons_and_their_events_stay_together() {
        let photons: Vec<_> = (0..200).map(|i| (numbered(i), [(i * 37 % 101) as f32, 0.0, i as f32])).collect();
        let events: Vec<u16> = (0..200).collect();
        let map = PhotonMap::build_with(&photons, &events, &[]);
        map.within([50.0, 0.0, 100.0], 1e4, |found| assert_eq!(map.events(found.number) as f32, found.position[2]));
    }

    #[test]
    fn coincident_photons_are_all_found() {
        let photons: Vec<_> = (0..10_000).map(|_| (numbered(1), [0.25, -1.0, 3.0])).collect();
        let index = PhotonMap::build(&photons);
        assert_eq!(found(&index, [0.25, -1.0, 3.0], 1e-3).len(), 10_000);
        assert!(found(&index, [0.25, -1.1, 3.0], 1e-3).is_empty());
        assert_eq!(index.kth_distance([0.25, -1.0, 3.0], NonZero::new(50).unwrap(), 1e-3), Some(0.0));
    }

    #[test]
    fn maps_of_one_photon_and_of_none() {
        let one = PhotonMap::build(&[(numbered(7), [1.0, 2.0, 3.0])]);
        assert_eq!(found(&one, [1.0, 2.0, 3.0], 0.1), [[1.0_f32, 2.0, 3.0].map(f32::to_bits)]);
        let kth = |k, farthest| one.kth_distance([1.0, 2.0, 4.0], NonZero::new(k).unwrap(), farthest);
        assert_eq!([kth(1, 2.0), kth(1, 0.5), kth(2, 2.0)], [Some(1.0), None, None]);
        let none = PhotonMap::build(&[]);
        assert!(none.is_empty() && found(&none, [0.0; 3], 10.0).is_empty());
        assert_eq!(none.kth_distance([0.0; 3], NonZero::<usize>::MIN, 1.0), None);
    }
}
