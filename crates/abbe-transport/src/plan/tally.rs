//! Event counters for the planned effects. If an effect is not in the plan, its counter stays 0.

use serde::{Deserialize, Serialize};
use std::iter::Sum;

/// Counts of events. Integer sums do not depend on the order of the threads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    pub photons: u64,
    /// Photon paths emitted at the pass's shared wavelengths. `photons` includes these paths.
    pub shared_photons: u64,
    pub stored: u64,
    /// Photon arrivals connected to the camera.
    pub connections: u64,
    pub camera_samples: u64,
    pub photon_segments: u64,
    pub camera_segments: u64,
    /// Photons within the kernels of camera paths at surfaces, evaluated at each wavelength.
    pub gathered: u64,
    /// Photons within the kernels of camera paths at diffuse surfaces with tabulated responses.
    pub tabulated: u64,
    /// Photons within the kernels of camera paths in media.
    pub volume_gathered: u64,
    pub map_queries: u64,
    /// Camera paths that continued at a diffuse surface.
    #[serde(default)]
    pub final_gathers: u64,
    /// Dispersive refractions that split a camera path, plus surface arrivals of photons that carry
    /// one wavelength after a dispersive refraction.
    pub dispersions: u64,
    /// Ribbons of photons that reached a dispersive surface.
    pub ribbons: u64,
    /// Wavelengths that ribbons traced.
    pub ribbon_nodes: u64,
    /// Pixels that the lines between nodes crossed.
    pub ribbon_pixels: u64,
    /// Camera paths that continued at one of the pass's shared wavelengths.
    pub shared_paths: u64,
    pub shadow_rays: u64,
    /// Rays that left the scene and evaluated the lights at infinity.
    pub environment_rays: u64,
    /// Rays through a lens of finite aperture.
    pub lens_rays: u64,
    #[serde(rename = "receptor_samples", default)]
    pub sensor_samples: u64,
    #[serde(default)]
    pub texture_lookups: u64,
    #[serde(default)]
    pub ghost_rays: u64,
    /// Scattering of camera paths at thin films, and camera paths through a coated lens.
    #[serde(default)]
    pub film_events: u64,
    /// Scattering of polarised camera paths, camera paths through a filter of the camera, and photons
    /// that were stored with their polarisation.
    #[serde(default)]
    pub polarised_events: u64,
    /// Arrivals of camera paths at fluorescent surfaces and in fluorescent media.
    #[serde(default)]
    pub fluorescent_events: u64,
    /// Emitted photon paths with at least one wavelength below 360 nm.
    #[serde(default)]
    pub ultraviolet_photons: u64,
    pub rough_events: u64,
    /// Arrivals at the faces of bodies and at gratings, and segments of camera paths inside bodies.
    pub body_events: u64,
    /// Segments of camera paths in absorbing glass or liquid.
    pub absorptions: u64,
    /// Segments of camera paths in participating media.
    #[serde(rename = "media_stretches")]
    pub medium_segments: u64,
    pub volume_points: u64,
    pub volume_beams: u64,
    #[serde(rename = "light_map_looks")]
    pub light_map_lookups: u64,
    pub aimed: u64,
    /// Passes for which the scene was posed at a sampled shutter time.
    pub moments: u64,
    /// Camera paths that ended at the cap of the number of events.
    #[serde(default)]
    pub capped_paths: u64,
    /// Discarded contributions (NaN, infinite or negative): 0 unless the program has an error.
    pub rejected: u64,
}

impl Sum for Tally {
    fn sum<I: Iterator<Item = Self>>(tallies: I) -> Self {
        tallies.fold(Self::default(), |mut sum, tally| {
            sum.add(&tally);
            sum
        })
    }
}

impl Tally {
    pub fn add(&mut self, other: &Self) {
        self.photons += other.photons;
        self.shared_photons += other.shared_photons;
        self.stored += other.stored;
        self.connections += other.connections;
        self.camera_samples += other.camera_samples;
        self.photon_segments += other.photon_segments;
        self.camera_segments += other.camera_segments;
        self.gathered += other.gathered;
        self.tabulated += other.tabulated;
        self.volume_gathered += other.volume_gathered;
        self.map_queries += other.map_queries;
        self.final_gathers += other.final_gathers;
        self.dispersions += other.dispersions;
        self.ribbons += other.ribbons;
        self.ribbon_nodes += other.ribbon_nodes;
        self.ribbon_pixels += other.ribbon_pixels;
        self.shared_paths += other.shared_paths;
        self.shadow_rays += other.shadow_rays;
        self.environment_rays += other.environment_rays;
        self.lens_rays += other.lens_rays;
        self.sensor_samples += other.sensor_samples;
        self.texture_lookups += other.texture_lookups;
        self.ghost_rays += other.ghost_rays;
        self.film_events += other.film_events;
        self.polarised_events += other.polarised_events;
        self.fluorescent_events += other.fluorescent_events;
        self.ultraviolet_photons += other.ultraviolet_photons;
        self.rough_events += other.rough_events;
        self.body_events += other.body_events;
        self.absorptions += other.absorptions;
        self.medium_segments += other.medium_segments;
        self.volume_points += other.volume_points;
        self.volume_beams += other.volume_beams;
        self.light_map_lookups += other.light_map_lookups;
        self.aimed += other.aimed;
        self.moments += other.moments;
        self.capped_paths += other.capped_paths;
        self.rejected += other.rejected;
    }
}
