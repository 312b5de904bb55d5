//! What a scattering event does to the polarisation of light.
//!
//! A renderer samples paths by the response of surfaces to natural light. The matrices here are
//! relative to that response: their first element is 1, or the transmittance of a filter, whose
//! response to natural light the renderer takes as 1. The product of a relative matrix with light
//! gives both the factor that corrects the power and the polarisation of the leaving light.

use super::diattenuating_retarder::DiattenuatingRetarder;
use super::filter::{linear_polariser, retarder, twisted_retarder};
use super::frame::{Rotation, StokesFrame};
use super::mueller::Mueller;
use super::scattering::{AIR_DEPOLARISATION, rayleigh, spheres};
use super::sheet::Sheet;
use super::surface::SurfaceMatrices;
use abbe_optics::RefractiveIndex;
use abbe_optics::bsdf::{
    FacetResponses, FilterElement, InterfaceIors, LocalBsdf, LocalRetardance, PolarisingFilter, ScatterEvent,
};
use abbe_optics::bsdf::{ThinDielectric, TransportMode};
use abbe_optics::phase::PhaseFunction;
use abbe_optics::phase::mie::MieMatrix;
use abbe_spectra::math::complex::Complex;
use abbe_spectra::math::elementary::sin_cos;
use abbe_spectra::spectrum::Spectrum;
use glam::DVec3;
use std::f64::consts::TAU;

/// A scattering event, with all that does not depend on the wavelength.
#[derive(Debug, Clone, Copy)]
pub struct ScatteringEvent<'a> {
    element: Element<'a>,
    /// From the canonical frame of the arriving light to the frame of the element.
    arriving: Rotation,
    /// From the frame of the element to the canonical frame of the leaving light.
    leaving: Rotation,
}

#[derive(Debug, Clone, Copy)]
enum Element<'a> {
    /// Light leaves unpolarised.
    Depolariser,
    /// The matrix at the only wavelength of a path.
    Fixed([[f32; 4]; 4]),
    /// A surface or its facets, with x perpendicular to the plane of incidence.
    Surface { bsdf: LocalBsdf<'a>, sides: InterfaceIors<'a>, wo: DVec3, wi: DVec3, event: ScatterEvent, delta: bool },
    /// A pane that light crosses straight on, with x perpendicular to the plane of incidence.
    Pane { pane: &'a ThinDielectric, cosine: f64, outside: &'a RefractiveIndex },
    /// A filter, in the canonical frame of the light.
    Filter { filter: &'a PolarisingFilter, local: LocalRetardance, axes: SheetAxes, from_front: bool },
    /// A particle, with x perpendicular to the scattering plane.
    Particle { phase: &'a PhaseFunction, cos_theta: f64 },
}

/// The axes u and v of a sheet, as components along x and y of the canonical frame of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
struct SheetAxes {
    u: [f64; 2],
    v: [f64; 2],
}

/// The directions of an event at a surface in world space. Both point away from the surface.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceDirections {
    /// Towards the source of the light.
    pub to_source: DVec3,
    /// Towards its receiver.
    pub to_receiver: DVec3,
    /// The normal of the surface, which points to its front.
    pub normal: DVec3,
    /// The axis u of a filter, which lies in the surface.
    pub u: DVec3,
}

impl<'a> ScatteringEvent<'a> {
    /// Returns the event at a surface. `wo` and `wi` are the local directions, and `sides` the
    /// indices as seen from `wo`.
    pub fn at_surface(
        (bsdf, sides): (LocalBsdf<'a>, InterfaceIors<'a>),
        (wo, wi): (DVec3, DVec3),
        (event, delta): (ScatterEvent, bool),
        directions: &SurfaceDirections,
    ) -> Self {
        let SurfaceDirections { to_source, to_receiver, normal, u } = *directions;
        if let abbe_optics::bsdf::Bsdf::ThinDielectric(pane) = bsdf.model
            && let Some(filter) = pane.filter()
        {
            let from_front = to_receiver.dot(normal) < 0.0;
            return Self::at_filter((filter, bsdf.texels.retardance()), to_receiver, [normal, u], from_front);
        }
        let element = Element::Surface { bsdf, sides, wo, wi, event, delta };
        let x = if delta { plane_axis(-to_source, normal) } else { plane_axis(-to_source, to_receiver) };
        Self::between(element, [-to_source, to_receiver], x)
    }

    /// Returns the event of light that a medium scatters.
    pub fn in_medium(phase: &'a PhaseFunction, arriving: DVec3, leaving: DVec3) -> Self {
        if !phase.polarises() {
            return Self::DEPOLARISER;
        }
        let element = Element::Particle { phase, cos_theta: arriving.dot(leaving) };
        Self::between(element, [arriving, leaving], plane_axis(arriving, leaving))
    }

    /// Returns the event of light that crosses a pane in a medium of index `outside`. `normal` and
    /// `u` are those of [`SurfaceDirections`].
    pub fn through_pane(
        (pane, retardance): (&'a ThinDielectric, LocalRetardance),
        outside: &'a RefractiveIndex,
        travel: DVec3,
        [normal, u]: [DVec3; 2],
    ) -> Self {
        if let Some(filter) = pane.filter() {
            return Self::at_filter((filter, retardance), travel, [normal, u], travel.dot(normal) < 0.0);
        }
        let element = Element::Pane { pane, cosine: travel.dot(normal).abs(), outside };
        Self::between(element, [travel, travel], plane_axis(travel, normal))
    }

    /// Returns the event of light that crosses a filter. Angles run from `u` counter-clockwise as seen
    /// from the side of the `normal`, and the light meets the first layer first if `from_front`.
    pub fn at_filter(
        (filter, local): (&'a PolarisingFilter, LocalRetardance),
        travel: DVec3,
        [normal, u]: [DVec3; 2],
        from_front: bool,
    ) -> Self {
        let frame = StokesFrame::canonical(travel);
        let (x, y, v) = (frame.x, frame.y(), normal.cross(u));
        let axes = SheetAxes { u: [u.dot(x), u.dot(y)], v: [v.dot(x), v.dot(y)] };
        let element = Element::Filter { filter, local, axes, from_front };
        Self { element, arriving: Rotation::NONE, leaving: Rotation::NONE }
    }

    /// Returns the event with this relative matrix at the only wavelength of a path, for light with
    /// x along `s_axis` before and after.
    pub fn of_matrix(Mueller(matrix): Mueller, [arriving, leaving]: [DVec3; 2], s_axis: DVec3) -> Self {
        Self::between(Element::Fixed(matrix.map(|row| row.map(|part| part as f32))), [arriving, leaving], s_axis)
    }

    /// The event that makes light unpolarised.
    pub const DEPOLARISER: Self =
        Self { element: Element::Depolariser, arriving: Rotation::NONE, leaving: Rotation::NONE };

    fn between(element: Element<'a>, [arriving, leaving]: [DVec3; 2], x: DVec3) -> Self {
        Self {
            element,
            arriving: StokesFrame::canonical(arriving).rotation_to(x),
            leaving: StokesFrame::canonical(leaving).rotation_to(x).inverse(),
        }
    }

    /// Returns the relative matrix at the wavelength `nm`, for Stokes vectors in the canonical
    /// frames of the arriving and of the leaving light.
    pub fn matrix(&self, nm: f64) -> Mueller {
        match self.element {
            Element::Depolariser => Mueller::depolariser(1.0),
            Element::Fixed(matrix) => self.leaving * (Mueller(matrix.map(|row| row.map(f64::from))) * self.arriving),
            Element::Filter { filter, local, axes, from_front } => {
                filter_matrix((filter, local), &axes, from_front, nm)
            }
            Element::Surface { bsdf, sides, wo, wi, event, delta } => {
                let cos = if delta { wo.z.abs() } else { bsdf.facet_cosine(wo, wi, event, sides, nm) };
                let responses = bsdf.facet_responses(wo, cos, event, sides, nm);
                let fraction =
                    if delta { 1.0 } else { bsdf.facet_fraction(wo, wi, sides, TransportMode::Importance, nm) };
                self.turned(of_responses(responses, cos, event).map(|element| (element, fraction)))
            }
            Element::Pane { pane, cosine, outside } => {
                let responses = pane.responses(cosine, outside.n(nm), 0.0, nm);
                let element = of_responses(responses, cosine, ScatterEvent::Transmission);
                self.turned(element.map(|element| (element, 1.0)))
            }
            Element::Particle { phase, cos_theta } => {
                let matrix = match phase.polarisation(cos_theta, nm) {
                    Some([s12, s33, s34]) => spheres(MieMatrix { s11: 1.0, s12, s33, s34 }).into(),
                    None => relative(rayleigh(cos_theta, AIR_DEPOLARISATION)),
                };
                self.leaving * (matrix * self.arriving)
            }
        }
    }

    /// Returns the matrix of an element that scatters this fraction of the light, beside a
    /// depolariser that scatters the rest.
    fn turned(&self, element: Option<(DiattenuatingRetarder, f64)>) -> Mueller {
        let Some((element, fraction)) = element.filter(|(element, _)| element.mean() > 0.0) else {
            return Mueller::depolariser(1.0);
        };
        let matrix = Mueller::from(element * (fraction / element.mean()));
        let mut matrix = self.leaving * (matrix * self.arriving);
        matrix.0[0][0] = 1.0;
        matrix
    }
}

fn relative(matrix: Mueller) -> Mueller {
    matrix * (1.0 / matrix.0[0][0])
}

/// Returns the elements of reflection and of transmission of a smooth surface in the frame x = s, for
/// the local direction `wo`. Returns `None` for a filter and for a surface that depolarises.
pub fn smooth_elements(
    bsdf: LocalBsdf<'_>,
    wo: DVec3,
    sides: InterfaceIors<'_>,
    nm: f64,
) -> Option<[DiattenuatingRetarder; 2]> {
    let cos = wo.z.abs();
    let [reflected, transmitted] = [ScatterEvent::Reflection, ScatterEvent::Transmission]
        .map(|event| of_responses(bsdf.facet_responses(wo, cos, event, sides, nm), cos, event));
    Some([reflected?, transmitted?])
}

/// Returns the axis that is perpendicular to the plane of two unit vectors.
fn plane_axis(travel: DVec3, other: DVec3) -> DVec3 {
    StokesFrame::perpendicular(travel, other).x
}

/// Returns the element of a facet in the frame x = s, or `None` if it depolarises.
fn of_responses(responses: FacetResponses<'_>, cos: f64, event: ScatterEvent) -> Option<DiattenuatingRetarder> {
    let selected = |matrices: SurfaceMatrices| match event {
        ScatterEvent::Reflection => matrices.reflected,
        ScatterEvent::Transmission => matrices.transmitted,
    };
    let of_sheet = |sheet: Sheet| match event {
        ScatterEvent::Reflection => sheet.front,
        ScatterEvent::Transmission => sheet.transmitted,
    };
    Some(match responses {
        FacetResponses::Depolarising | FacetResponses::Filter(_) => return None,
        FacetResponses::Mirror => {
            DiattenuatingRetarder { cross: Complex::new(-1.0, 0.0), ..DiattenuatingRetarder::IDENTITY }
        }
        FacetResponses::Straight => DiattenuatingRetarder::IDENTITY,
        FacetResponses::Interface([here, there]) => selected(SurfaceMatrices::dielectric(cos, here, there)),
        FacetResponses::Films(response) => selected(SurfaceMatrices::of_films(&response)),
        FacetResponses::Plate { indices: [outside, inside], passage } => {
            of_sheet(Sheet::plate(cos, outside, inside, passage))
        }
        FacetResponses::CoatedPlate { front, inside, passage } => {
            let face = Sheet::films(&front, &inside);
            let back = Sheet { front: face.back, back: face.front, ..face };
            of_sheet(face.then(Sheet::absorber(passage)).then(back))
        }
    })
}

/// Returns the matrix of a filter in the canonical frame of the light.
fn filter_matrix(
    (filter, local): (&PolarisingFilter, LocalRetardance),
    axes: &SheetAxes,
    from_front: bool,
    nm: f64,
) -> Mueller {
    let layer = |matrix: Mueller, number: usize| {
        let layer = &filter.layers()[number];
        let local = if filter.varying() == Some(number) { local } else { LocalRetardance::WHOLE };
        let (sin, cos) = sin_cos(layer.axis_rad + f64::from(local.turn_rad));
        let phase = |retardance_nm: &Spectrum| TAU * f64::from(local.factor) * retardance_nm.at(nm) / nm;
        let turned = |element: Mueller, direction: [f64; 2]| element.turned(axes.rotation(direction)) * matrix;
        match &layer.element {
            // The direction that a polariser absorbs is projected, at 90° to its axis.
            FilterElement::Polariser { k1, k2 } => turned(linear_polariser(k2.at(nm), k1.at(nm)).into(), [-sin, cos]),
            FilterElement::Retarder { retardance_nm } => turned(retarder(phase(retardance_nm)).into(), [cos, sin]),
            FilterElement::TwistedRetarder { retardance_nm, twist_rad } => {
                // The light meets the axis of its own side first.
                let (turn, start) =
                    if from_front { (*twist_rad, [cos, sin]) } else { (-twist_rad, turned_by(*twist_rad, [cos, sin])) };
                turned(twisted_retarder(phase(retardance_nm), turn * axes.sense()), start)
            }
        }
    };
    let count = filter.layers().len();
    if from_front { (0..count).fold(Mueller::IDENTITY, layer) } else { (0..count).rev().fold(Mueller::IDENTITY, layer) }
}

/// Turns a direction with these components along u and v from u to v.
fn turned_by(angle: f64, [along_u, along_v]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = sin_cos(angle);
    [cos * along_u - sin * along_v, sin * along_u + cos * along_v]
}

impl SheetAxes {
    /// Returns 1 if the receiver of the light sees the turn from u to v counter-clockwise, else −1.
    fn sense(&self) -> f64 {
        (self.u[0] * self.v[1] - self.u[1] * self.v[0]).signum()
    }

    /// Returns the rotation to the projection of a direction with these components along u and v.
    fn rotation(&self, [along_u, along_v]: [f64; 2]) -> Rotation {
        let [x, y] = [0, 1].map(|i| along_u * self.u[i] + along_v * self.v[i]);
        let length2 = x * x + y * y;
        if length2 > 0.0 {
            Rotation { cos: (x * x - y * y) / length2, sin: 2.0 * x * y / length2 }
        } else {
            Rotation::NONE
        }
    }
}
