//! Bounds of the light of a cluster of emitters (Conty Estévez & Kulla 2018, section 4).

use crate::walk::SurfaceInteraction;
use abbe_scene::meter::SensorPoint;
use abbe_spectra::math::elementary::{atan2, cos, sin_cos};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// The directions into which a cluster of emitters shines (section 4.1): all normals are within the
/// angle θ_o of the axis, and all light leaves within the angle θ_e of a normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct OrientationCone {
    pub(super) axis: DVec3,
    /// The bound θ_o of the angle between the axis and a normal, in radians.
    pub(super) theta_o: f64,
    /// The bound θ_e of the angle between a normal and the emitted light, in radians.
    pub(super) theta_e: f64,
}

impl OrientationCone {
    pub(super) const ALL: Self = Self { axis: DVec3::Z, theta_o: PI, theta_e: FRAC_PI_2 };

    /// Returns the smallest cone around two cones (algorithm 1).
    fn union(self, other: Self) -> Self {
        if self.theta_o.max(other.theta_o) >= PI {
            return Self { theta_e: self.theta_e.max(other.theta_e), ..Self::ALL };
        }
        let (wide, narrow) = if self.theta_o >= other.theta_o { (self, other) } else { (other, self) };
        let theta_e = wide.theta_e.max(narrow.theta_e);
        let between = angle_between(wide.axis, narrow.axis);
        if (between + narrow.theta_o).min(PI) <= wide.theta_o {
            return Self { theta_e, ..wide };
        }
        let theta_o = 0.5 * (wide.theta_o + between + narrow.theta_o);
        let across = (narrow.axis - wide.axis.dot(narrow.axis) * wide.axis).normalize_or_zero();
        if theta_o >= PI || across == DVec3::ZERO {
            return Self { theta_e, ..Self::ALL };
        }
        let (sin, cos) = sin_cos(theta_o - wide.theta_o);
        Self { axis: (cos * wide.axis + sin * across).normalize(), theta_o, theta_e }
    }

    /// Returns the measure M_Ω, weighted by the cosine of the angle beyond θ_o (equation 1).
    fn measure(&self) -> f64 {
        let (sin_o, cos_o) = sin_cos(self.theta_o);
        let theta_w = (self.theta_o + self.theta_e).min(PI);
        let beyond = 2.0 * theta_w * sin_o - cos(self.theta_o - 2.0 * theta_w) - 2.0 * self.theta_o * sin_o + cos_o;
        2.0 * PI * (1.0 - cos_o) + FRAC_PI_2 * beyond
    }
}

/// Returns the angle between two unit vectors in radians. It is accurate for small angles too.
fn angle_between(a: DVec3, b: DVec3) -> f64 {
    atan2(a.cross(b).length(), a.dot(b))
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LightBounds {
    /// The lowest corner of a box around the emitters, in m.
    pub(super) low: DVec3,
    /// The highest corner of the box, in m.
    pub(super) high: DVec3,
    /// The sum of the largest intensities Φ, as a fraction of the power of all lights per
    /// steradian.
    pub(super) intensity: f64,
    pub(super) cone: OrientationCone,
    /// The light does not grow further below this distance in m.
    pub(super) least_distance_m: f64,
}

impl LightBounds {
    /// Bounds one emitter. An area light nearer than its own size does not grow brighter.
    pub(super) fn new((low, high): (DVec3, DVec3), intensity: f64, cone: OrientationCone) -> Self {
        Self { low, high, intensity, cone, least_distance_m: 0.5 * low.distance(high) }
    }

    pub(super) fn centre(&self) -> DVec3 {
        0.5 * (self.low + self.high)
    }

    pub(super) fn union(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            intensity: self.intensity + other.intensity,
            cone: self.cone.union(other.cone),
            least_distance_m: self.least_distance_m.min(other.least_distance_m),
        }
    }

    /// Returns the product M_A M_Ω Φ of the surface area orientation heuristic (section 4.4).
    /// `margin` (m) is added to each side of the box, because a box around emitters on a line has
    /// no area.
    pub(super) fn cost(&self, margin: f64) -> f64 {
        let size = self.high - self.low + DVec3::splat(margin);
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        area * self.cone.measure() * self.intensity
    }
}

pub(in crate::gather) trait Receiver {
    /// Returns a bound of the light from a cluster, 0 only if the place receives none.
    fn importance(&self, cluster: &Cluster) -> f64;

    /// Returns the position and the normal if the place is on one side of a surface.
    fn surface(&self) -> Option<(DVec3, DVec3)>;
}

/// The bounds of a cluster in single precision. They contain the exact bounds.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct Cluster {
    low: [f32; 3],
    high: [f32; 3],
    axis: [f32; 3],
    intensity: f32,
    sin_o: f32,
    cos_o: f32,
    cos_e: f32,
    least_distance_m: f32,
}

/// The angle (rad) by which a cone is widened, so that it contains the exact cone despite rounding.
const CONE_MARGIN: f64 = 1e-3;

impl Cluster {
    pub(super) fn new(bounds: &LightBounds) -> Self {
        let theta_o = (bounds.cone.theta_o + CONE_MARGIN).min(PI);
        let (sin_o, cos_o) = if theta_o == PI { (0.0, -1.0) } else { sin_cos(theta_o) };
        Self {
            low: bounds.low.to_array().map(|x| (x as f32).next_down()),
            high: bounds.high.to_array().map(|x| (x as f32).next_up()),
            axis: bounds.cone.axis.as_vec3().to_array(),
            intensity: (bounds.intensity as f32).max(f32::MIN_POSITIVE),
            sin_o: sin_o as f32,
            cos_o: cos_o as f32,
            cos_e: cos(bounds.cone.theta_e) as f32,
            least_distance_m: bounds.least_distance_m as f32,
        }
    }

    fn corners(&self) -> (DVec3, DVec3) {
        (self.low.map(f64::from).into(), self.high.map(f64::from).into())
    }

    /// Returns the largest height of a point above the planes of the emitters, positive if it is
    /// above any of them, and infinite if the intensity does not fall with the cosine. `offset`
    /// leads from the point to the centre of the box of the half size `half`, in m. `farthest2` is
    /// the squared distance of the farthest point of the box.
    #[inline]
    fn height_above(&self, offset: DVec3, half: DVec3, farthest2: f64) -> f64 {
        if self.cos_o <= 0.0 {
            return f64::INFINITY;
        }
        let axis = DVec3::from(self.axis.map(f64::from));
        if self.cos_e <= f32::EPSILON {
            // A point at the offset v from an emitter is above the plane of a normal within θ_o of
            // the axis a only if a·v + |v| sin θ_o > 0.
            return axis.abs().dot(half) - axis.dot(offset) + f64::from(self.sin_o) * farthest2.sqrt();
        }
        let (centre2, radius2) = (offset.length_squared(), half.length_squared());
        if centre2 <= radius2 {
            return f64::INFINITY;
        }
        let sin2_b = radius2 / centre2;
        let cos_w = -axis.dot(offset) / centre2.sqrt();
        let is_dark = self.intensity_within(cos_w, (sin2_b.sqrt(), (1.0 - sin2_b).sqrt())) <= 0.0;
        if is_dark { 0.0 } else { f64::INFINITY }
    }

    /// Returns the bound I cos θ' of the intensity in all directions within θ_b of a direction at
    /// the angle θ_w to the axis, with θ' = θ_w − θ_o − θ_b (equation 3).
    #[inline]
    fn intensity_within(&self, cos_w: f64, (sin_b, cos_b): (f64, f64)) -> f64 {
        let sin_w = sine(cos_w);
        let (sin_x, cos_x) = minus_angle((sin_w, cos_w), (f64::from(self.sin_o), f64::from(self.cos_o)));
        let (_, cos) = minus_angle((sin_x, cos_x), (sin_b, cos_b));
        if cos < f64::from(self.cos_e) { 0.0 } else { f64::from(self.intensity) * cos }
    }
}

#[inline]
fn sine(cos: f64) -> f64 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// Returns the sine and the cosine of max(0, a − b), for angles in [0, π] that are given by theirs.
#[inline]
fn minus_angle((sin_a, cos_a): (f64, f64), (sin_b, cos_b): (f64, f64)) -> (f64, f64) {
    if cos_a >= cos_b { (0.0, 1.0) } else { (sin_a * cos_b - cos_a * sin_b, cos_a * cos_b + sin_a * sin_b) }
}

#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct ReceivingPoint {
    /// The position, relative to the scene's centre, in m.
    pub(in crate::gather) position: DVec3,
    /// The normal of a surface that scatters only light from its side, or 0 for all directions.
    pub(in crate::gather) normal: DVec3,
}

impl ReceivingPoint {
    /// A point of a surface. An opaque surface scatters only light from the side of the path.
    #[inline]
    pub(in crate::gather) fn on_surface(interaction: &SurfaceInteraction<'_>) -> Self {
        let normal = interaction.hit.normal * interaction.wo.z.signum();
        let normal = if interaction.bsdf.is_transmissive() { DVec3::ZERO } else { normal };
        Self { position: interaction.hit.position, normal }
    }

    #[inline]
    pub(in crate::gather) fn on_sensor(point: &SensorPoint) -> Self {
        Self { position: point.position, normal: point.response.normal() }
    }

    /// A point in a medium, which scatters light from all directions.
    #[inline]
    pub(in crate::gather) fn in_medium(position: DVec3) -> Self {
        Self { position, normal: DVec3::ZERO }
    }
}

impl Receiver for ReceivingPoint {
    /// Returns the importance I cos θ'_i cos θ' / d² (equation 3), with the terms that the module
    /// of the light tree explains.
    #[inline]
    fn importance(&self, cluster: &Cluster) -> f64 {
        let (low, high) = cluster.corners();
        let (below, above) = (low - self.position, self.position - high);
        let (offset, half) = (0.5 * (below - above), 0.5 * (high - low));
        let least = f64::from(cluster.least_distance_m);
        let nearest2 = below.max(above).max(DVec3::ZERO).length_squared().max(least * least);
        let farthest2 = (offset.abs() + half).length_squared();
        let distance2 = (nearest2 * farthest2).sqrt().max(f64::MIN_POSITIVE);
        let above_light = cluster.height_above(offset, half, farthest2);
        let above_surface = match self.normal == DVec3::ZERO {
            true => f64::INFINITY,
            false => self.normal.dot(offset) + self.normal.abs().dot(half),
        };
        let cosines = cosine(above_light, distance2) * cosine(above_surface, distance2);
        f64::from(cluster.intensity) * cosines / distance2
    }

    #[inline]
    fn surface(&self) -> Option<(DVec3, DVec3)> {
        (self.normal != DVec3::ZERO).then_some((self.position, self.normal))
    }
}

/// Returns the cosine of the angle to a normal from a height above the plane of the normal.
#[inline]
fn cosine(height: f64, distance2: f64) -> f64 {
    if height <= 0.0 {
        0.0
    } else if height * height >= distance2 {
        1.0
    } else {
        height / distance2.sqrt()
    }
}

/// A segment of a ray through a medium. The medium scatters light along the whole segment.
#[derive(Debug, Clone, Copy)]
pub(in crate::gather) struct ReceivingSegment {
    /// The start of the segment, relative to the scene's centre, in m.
    pub(in crate::gather) from: DVec3,
    pub(in crate::gather) to: DVec3,
}

impl Receiver for ReceivingSegment {
    /// Returns a bound of the integral of the irradiance over the segment: from a point light at
    /// the distance D from the line, I (θ_b − θ_a) / D for the angle θ_b − θ_a that the light sees
    /// of the segment (Kulla & Fajardo 2012, "Importance Sampling Techniques for Path Tracing in
    /// Participating Media").
    fn importance(&self, cluster: &Cluster) -> f64 {
        let (low, high) = cluster.corners();
        let (centre, radius) = (0.5 * (low + high), 0.5 * low.distance(high));
        let (a, b) = (self.from - centre, self.to - centre);
        let (along, length) = (self.to - self.from).normalize_and_length();
        let on_line = a - a.dot(along) * along;
        let nearest = a + (-a.dot(along)).clamp(0.0, length) * along;
        let nearest_m = nearest.length();
        let from_line_m = on_line.length().max(radius).max(f64::MIN_POSITIVE);
        if nearest_m <= radius {
            return f64::from(cluster.intensity) * PI / from_line_m;
        }
        let angle = angle_between(a.normalize(), b.normalize());
        // A short segment on a line through the light has the angle 0.
        let received = (angle / from_line_m).max(length / (a.length() * b.length()));
        let sin_b = radius / nearest_m;
        let axis = DVec3::from(cluster.axis.map(f64::from));
        cluster.intensity_within(largest_cosine(axis, a, b), (sin_b, (1.0 - sin_b * sin_b).sqrt())) * received
    }

    fn surface(&self) -> Option<(DVec3, DVec3)> {
        None
    }
}

/// Returns the largest cosine of the angle between `axis` and a direction between `a` and `b`.
fn largest_cosine(axis: DVec3, a: DVec3, b: DVec3) -> f64 {
    let across = a.cross(b);
    let in_plane = axis - axis.dot(across) / across.length_squared() * across;
    let between = a.cross(in_plane).dot(across) >= 0.0 && in_plane.cross(b).dot(across) >= 0.0;
    // If the segment points at the cluster, `across` is 0 and both comparisons are false.
    let inside = if between { in_plane.length() } else { -1.0 };
    inside.max(axis.dot(a) / a.length()).max(axis.dot(b) / b.length()).min(1.0)
}
