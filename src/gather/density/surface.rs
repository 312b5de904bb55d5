//! Light from photons at surfaces on a camera path.

use super::gather_point::GatherPoint;
use super::outline::{Outline, PixelOutline};
use crate::gather::camera::path::CameraPath;
use crate::gather::camera::throughput::SpectralMode;
use crate::gather::camera_pass::{CameraPass, MissingLight, PathContext};
use crate::map::kernel::BoundaryCorrection;
use crate::map::{SetMaps, radius};
use crate::optics::bsdf::BsdfClass;
use crate::plan::IndirectPlan;
use crate::plan::partition::PhotonClass;
use crate::plan::partition::{Estimator, View, estimator};
use crate::walk::{BodyMode, LostLight, Sink, SurfaceInteraction};

impl<'a> CameraPass<'a> {
    /// Gathers the photons around a surface point. Only photons of some path classes are gathered:
    /// the partition assigns these classes to the photon map.
    #[inline(always)]
    pub(in crate::gather) fn gather_photons<M: BodyMode, S: Sink>(
        &self,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        bsdf_class: BsdfClass,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let set = path.spectral_mode.photon_set();
        self.gather_set::<M, S>(self.maps[set], path, interaction, bsdf_class, context);
        if let Some(MissingLight { maps, factor }) = self.missing {
            context.with_lost_light(factor, |lost| {
                self.gather_set::<M, LostLight<'_>>(maps[set], path, interaction, bsdf_class, lost);
            });
        }
    }

    /// Gathers the photons of one set around a surface point.
    #[inline(always)]
    fn gather_set<M: BodyMode, S: Sink>(
        &self,
        maps: &SetMaps,
        path: &CameraPath,
        interaction: &SurfaceInteraction<'a>,
        bsdf_class: BsdfClass,
        context: &mut PathContext<'_, 'a, S>,
    ) {
        let set = path.spectral_mode.photon_set();
        // Only free photons are connected to the camera. Therefore, even if a shared camera path
        // sees the surface directly, it uses the photon map.
        let view = match path.spectral_mode {
            SpectralMode::Free => path.view,
            SpectralMode::Shared { .. } => View::Indirect,
        };
        for class in PhotonClass::ALL {
            let planned = match class {
                PhotonClass::Indirect => self.plan.indirect != IndirectPlan::Absent,
                PhotonClass::Caustic => true,
            };
            let map = &maps[class].surface;
            if map.is_empty() || !planned || estimator(class.light_path(), bsdf_class, view) != Estimator::PhotonMap {
                continue;
            }
            context.tally.map_queries += 1;
            let radius = f64::from(context.radii.surface[set][class]) * self.scales.surface;
            let radius = radius.max(radius::least(interaction.hit.position));
            let measured;
            let outline = match path.view {
                _ if self.outlines.is_empty() => None,
                View::Direct => {
                    let point = self.visible_point(path, interaction);
                    match self.outlines.find(context.pixel as usize, &point) {
                        PixelOutline::Stored(outline) => Some(outline),
                        PixelOutline::Varies => {
                            measured = Outline::around(&self.scene.geometry, &point, radius);
                            measured.as_ref()
                        }
                        PixelOutline::Absent => None,
                    }
                }
                View::Indirect => None,
            };
            let correction = outline.map_or(BoundaryCorrection::WHOLE, |outline| outline.correction(radius));
            let gather_point = GatherPoint::new(interaction, radius, correction, path, &context.buffers.factors);
            map.within(interaction.hit.position.as_vec3().to_array(), radius as f32, |nearby| {
                if outline.is_none_or(|outline| outline.contains(nearby.position)) {
                    gather_point.add::<M, S>(&nearby, context.sink);
                }
            });
        }
    }
}
