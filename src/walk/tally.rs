//! Event counters: how often each effect was at work. An effect that the plan leaves out counts zero.

use serde::{Deserialize, Serialize};

/// Counts of events, summed over threads in any order.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// Photon paths emitted.
    pub photons: u64,
    /// Those of them on the pass's shared wavelengths.
    pub shared_photons: u64,
    /// Photons stored in maps.
    pub stored: u64,
    /// Photon hits connected to the camera.
    pub connections: u64,
    /// Queries of photon maps.
    pub map_queries: u64,
    /// Refractions that sent a camera path's wavelengths each its own way, and photons that arrived after one.
    pub dispersions: u64,
    /// Camera paths that went on at one of the pass's shared wavelengths.
    pub shared_paths: u64,
    /// Shadow rays.
    pub shadow_rays: u64,
    /// Rays that left the scene and looked at the surroundings.
    pub environment_rays: u64,
    /// Rays through a lens of finite aperture.
    pub lens_rays: u64,
    /// Scatterings by rough or coated surfaces.
    pub rough_events: u64,
    /// Faces of bodies that paths came to, and stretches of camera paths inside of some.
    pub body_events: u64,
    /// Stretches of absorbing glass or liquid.
    pub absorptions: u64,
    /// Stretches of media that camera paths crossed.
    pub media_stretches: u64,
    /// Photons kept in media, as points.
    pub volume_points: u64,
    /// Photons kept in media, as beams.
    pub volume_beams: u64,
    /// Places that looked into a light map.
    pub light_map_looks: u64,
    /// Photons sent by a learned aim.
    pub aimed: u64,
    /// Passes with a moment of their own.
    pub moments: u64,
    /// Contributions that were not finite or negative and were dropped; 0 unless there is a bug.
    pub rejected: u64,
}

impl Tally {
    /// Adds another's counts.
    pub fn add(&mut self, other: &Self) {
        self.photons += other.photons;
        self.shared_photons += other.shared_photons;
        self.stored += other.stored;
        self.connections += other.connections;
        self.map_queries += other.map_queries;
        self.dispersions += other.dispersions;
        self.shared_paths += other.shared_paths;
        self.shadow_rays += other.shadow_rays;
        self.environment_rays += other.environment_rays;
        self.lens_rays += other.lens_rays;
        self.rough_events += other.rough_events;
        self.body_events += other.body_events;
        self.absorptions += other.absorptions;
        self.media_stretches += other.media_stretches;
        self.volume_points += other.volume_points;
        self.volume_beams += other.volume_beams;
        self.light_map_looks += other.light_map_looks;
        self.aimed += other.aimed;
        self.moments += other.moments;
        self.rejected += other.rejected;
    }
}
