//! A point on a surface where a path scatters.

use super::ray_state::RayState;
use abbe_optics::bsdf::{Bsdf, Grooves, InterfaceIors, LocalBsdf, ScatterEvent, Texels};
use abbe_optics::texture::{LookupRandom, TexturePoint};
use abbe_scene::camera::Camera;
use abbe_scene::geometry::{Hit, Ray, ShadingFrame, SurfaceId};
use abbe_scene::medium_stack::MediumStack;
use abbe_scene::{Material, Scene};
use abbe_spectra::math::elementary::atan2;
use abbe_spectra::math::frame::Frame;
use glam::DVec3;

/// How a path looks up the material of the next surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceLookup {
    /// A random number in [0, 1) that selects the component of a mixed material and the texels.
    pub u: f64,
    /// The diameter (m) of the ray at its origin; 0 for photons.
    pub width_m: f64,
    /// The angle (rad) by which the diameter grows with the distance; 0 for photons.
    pub spread: f64,
}

impl SurfaceLookup {
    /// Returns the lookup of a ray without extent.
    #[inline]
    pub fn of_line(u: f64) -> Self {
        Self { u, width_m: 0.0, spread: 0.0 }
    }

    /// Returns the lookup of a camera path of this length in m. The footprint is smaller than the
    /// pixel, because the samples of a pixel already average over it.
    #[inline(always)]
    pub fn of_camera(camera: &Camera, path_m: f64, u: f64) -> Self {
        const FRACTION_OF_PIXEL: f64 = 0.5;
        let spread = FRACTION_OF_PIXEL * camera.pixel_angle();
        Self { u, width_m: FRACTION_OF_PIXEL * camera.pixel_width_m(path_m), spread }
    }
}

/// A path vertex on a surface, and all data for scattering (`SurfaceInteraction` in pbrt-v4).
#[derive(Debug, Clone, Copy)]
pub struct SurfaceInteraction<'a> {
    pub hit: Hit,
    /// The distance from the previous path vertex, in m.
    pub distance_m: f64,
    pub incoming: DVec3,
    pub material: usize,
    /// The BSDF at this point. The component of a mixed material and the texels are selected.
    pub bsdf: LocalBsdf<'a>,
    /// True if a property of the material varies over the surface.
    pub textured: bool,
    pub frame: ShadingFrame,
    /// The direction back along the path, in the shading frame.
    pub wo: DVec3,
    /// The bodies on the side from which the path arrived.
    pub here: MediumStack,
    /// The bodies on the other side.
    pub there: MediumStack,
    pub sides: InterfaceIors<'a>,
    /// True if the path crossed hidden faces, inside a body of higher priority, since its previous
    /// vertex. Shadow rays stop there, so next-event estimation does not count such a path.
    pub crossed_hidden_face: bool,
}

impl<'a> SurfaceInteraction<'a> {
    /// Takes the bodies and the refractive indices on the side of arrival and on the other side.
    #[inline(always)]
    pub(super) fn new(
        scene: &'a Scene,
        incoming: DVec3,
        hit: Hit,
        [here, there]: [MediumStack; 2],
        sides: InterfaceIors<'a>,
        lookup: SurfaceLookup,
    ) -> Self {
        let material = scene.objects[hit.object as usize].material;
        let textured = scene.materials[material].is_textured();
        let mut hit = hit;
        let bsdf = if textured {
            let (bsdf, shading_normal) = textured_bsdf(scene, material, incoming, &{ hit }, lookup);
            hit.shading_normal = shading_normal;
            bsdf
        } else {
            scene.materials[material].surface.at(lookup.u)
        };
        let frame = hit.frame();
        let bsdf = if let Some(grating) = bsdf.model.grating() {
            with_axis(scene, bsdf, grating.grooves(), &hit, &frame)
        } else if bsdf.model.filter().is_some() {
            with_axis(scene, bsdf, Grooves::Parallel(0.0), &hit, &frame)
        } else {
            bsdf
        };
        Self {
            distance_m: hit.t,
            crossed_hidden_face: false,
            incoming,
            material,
            bsdf,
            textured,
            wo: frame.to_local(-incoming),
            frame,
            here,
            there,
            sides,
            hit,
        }
    }

    /// Returns a ray that starts on the surface in this direction of world space.
    #[inline]
    pub fn spawn_ray(&self, direction: DVec3, medium_stack: MediumStack) -> RayState {
        RayState { ray: Ray { origin: self.hit.position, direction }, from: Some(self.hit.surface), medium_stack }
    }

    /// Returns true if each wavelength takes other directions at this surface.
    #[inline]
    pub fn disperses(&self) -> bool {
        match self.bsdf.model {
            Bsdf::Grating(_) => true,
            Bsdf::Dielectric(_) | Bsdf::CoatedDielectric(_) => self.sides.is_dispersive(),
            Bsdf::Crystal(crystal) => self.sides.is_dispersive() || crystal.extraordinary.is_dispersive(),
            Bsdf::Absorber | Bsdf::Diffuse(_) | Bsdf::Fluorescent(_) | Bsdf::Translucent(_) | Bsdf::Mirror(_) => false,
            Bsdf::Conductor(_) | Bsdf::ThinDielectric(_) | Bsdf::ThinFilm(_) | Bsdf::Glossy(_) | Bsdf::Mix(_) => false,
        }
    }

    /// Returns true if `direction` leads back to the side from which the path arrived.
    #[inline]
    pub fn leads_back(&self, direction: DVec3) -> bool {
        self.hit.leads_back(self.incoming, direction)
    }

    /// Returns true if a scattered direction is on the side of arrival for reflection, or on the
    /// other side for transmission.
    #[inline]
    pub fn is_consistent(&self, direction: DVec3, event: ScatterEvent) -> bool {
        self.leads_back(direction) == (event == ScatterEvent::Reflection)
    }

    #[inline]
    pub fn medium_stack_after(&self, event: ScatterEvent) -> MediumStack {
        match event {
            ScatterEvent::Reflection => self.here,
            ScatterEvent::Transmission => self.there,
        }
    }

    /// Returns the refractive indices as seen from the side of `direction`.
    pub fn sides_towards(&self, direction: DVec3) -> InterfaceIors<'a> {
        if self.leads_back(direction) {
            self.sides
        } else {
            InterfaceIors { here: self.sides.there, there: self.sides.here }
        }
    }

    pub fn medium_stack_towards(&self, direction: DVec3) -> MediumStack {
        if self.leads_back(direction) { self.here } else { self.there }
    }

    /// Casts a shadow ray. Returns true if no surface except `target`, that of the light, lies
    /// within `distance` (m) along `direction`.
    #[inline(always)]
    pub fn is_unoccluded(&self, scene: &Scene, direction: DVec3, distance: f64, target: Option<SurfaceId>) -> bool {
        let ray = Ray { origin: self.hit.position, direction };
        !scene.geometry.occluded(&ray, Some(self.hit.surface), target, distance)
    }

    /// See [`Hit::adjoint_correction`].
    #[inline]
    pub fn adjoint_correction(&self, to_light: DVec3, to_camera: DVec3) -> f64 {
        self.hit.adjoint_correction(&self.frame, to_light, to_camera)
    }
}

/// Returns the BSDF of a grating or a filter with the direction across its grooves or of its axis u:
/// that of the frame if the texture coordinates do not determine one.
#[inline(never)]
fn with_axis<'a>(
    scene: &Scene,
    bsdf: LocalBsdf<'a>,
    grooves: Grooves,
    hit: &Hit,
    frame: &ShadingFrame,
) -> LocalBsdf<'a> {
    let Some([along_u, along_v]) = scene.geometry.uv_tangents(hit) else { return bsdf };
    let (across, turn) = match grooves {
        Grooves::Parallel(turn) => (along_u, turn),
        Grooves::Circular => {
            let [u, v] = scene.geometry.uv(hit);
            ((u - 0.5) * along_u + (v - 0.5) * along_v, 0.0)
        }
    };
    let local = frame.axes().to_local(across);
    // Seen from the outside, the angle runs from u towards −v, which points upwards in a picture.
    let outwards = if frame.normal().dot(along_u.cross(along_v)) > 0.0 { -turn } else { turn };
    let axis_angle = (atan2(local.y, local.x) + outwards) as f32;
    LocalBsdf { texels: Texels { axis_angle, ..bsdf.texels }, ..bsdf }
}

/// The smallest cosine of incidence for which the footprint of a ray is computed exactly. It is
/// limited at grazing incidence.
const LEAST_FOOTPRINT_COSINE: f64 = 0.01;

/// Separates the random numbers of normal maps from those of the other textures, so that the
/// component of a mixture does not depend on the texel of its normal.
const NORMAL_MAP_SEED: u64 = 0x006e_6f72_6d61_6c00;

/// Returns the BSDF and the shading normal at a hit of a surface with textures.
#[inline(never)]
fn textured_bsdf<'a>(
    scene: &'a Scene,
    material: usize,
    incoming: DVec3,
    hit: &Hit,
    lookup: SurfaceLookup,
) -> (LocalBsdf<'a>, DVec3) {
    let Material { surface, normal_map, .. } = &scene.materials[material];
    let mut point = TexturePoint::new(scene.geometry.uv(hit));
    let width_m = lookup.width_m + hit.t * lookup.spread;
    if width_m > 0.0 {
        // The ray is a cone, whose section with the tangent plane is an ellipse.
        let cosine = incoming.dot(hit.normal);
        let along = (incoming - cosine * hit.normal).normalize_or(Frame::new(hit.normal).to_world(DVec3::X));
        let across = hit.normal.cross(along);
        let edges = [along * (width_m / cosine.abs().max(LEAST_FOOTPRINT_COSINE)), across * width_m];
        point.footprint = edges.map(|edge| scene.geometry.uv_step(hit, edge));
    }
    let shading_normal = normal_map.as_ref().map_or(hit.shading_normal, |map| {
        let mut random = LookupRandom::new(lookup.u).split(NORMAL_MAP_SEED);
        let tangents = scene.geometry.uv_tangents(hit);
        tangents.map_or(hit.shading_normal, |tangents| {
            map.shading_normal(&point, &mut random, hit.shading_normal, tangents)
        })
    });
    (surface.at_point(&point, lookup.u), shading_normal)
}
