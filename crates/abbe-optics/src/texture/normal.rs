//! Normal maps.

use std::sync::Arc;

use super::point::{LookupRandom, TexturePoint};
use super::pyramid::ImagePattern;
use glam::{DVec3, Vec3};

/// A picture of shading normals, whose copies share their texels.
///
/// It has no reduced copies: a lookup selects a texel within the footprint, so a distant surface
/// shows the mean radiance of its texels, not the radiance of their mean normal.
#[derive(Debug, Clone, PartialEq)]
pub struct NormalMap {
    pattern: ImagePattern,
    normals: Arc<[Vec3]>,
}

impl NormalMap {
    /// Creates the map of a picture from a vector of any length for each pixel, row by row, in
    /// tangent space: x along u, y upwards in the picture, and z along the normal of the surface,
    /// which replaces vectors with z ≤ 0 or a component that is not finite.
    pub fn new(pattern: ImagePattern, normals: impl Iterator<Item = Vec3>) -> Self {
        let unit = |normal: Vec3| if normal.z > 0.0 { normal.normalize_or(Vec3::Z) } else { Vec3::Z };
        Self { pattern: pattern.without_copies(), normals: normals.map(unit).collect() }
    }

    /// Creates the map of a picture with components from 0 to 1 for −`scale` to `scale`.
    pub fn from_picture(pattern: ImagePattern, colours: &[[f32; 3]], scale: Vec3) -> Self {
        Self::new(pattern, colours.iter().map(|&colour| (2.0 * Vec3::from(colour) - 1.0) * scale))
    }

    fn sample(&self, point: &TexturePoint, random: &mut LookupRandom) -> DVec3 {
        self.normals[self.pattern.texel(point, random) as usize].as_dvec3()
    }

    /// Returns the unit shading normal at a point. `normal` is the unit normal of the surface, and
    /// `tangents` are the derivatives of the position by u and v. The tangent space is orthonormal:
    /// its first axis is ∂p/∂u made perpendicular to `normal`, and its second is on the side of
    /// −∂p/∂v, because v increases downwards.
    pub fn shading_normal(
        &self,
        point: &TexturePoint,
        random: &mut LookupRandom,
        normal: DVec3,
        [along_u, along_v]: [DVec3; 2],
    ) -> DVec3 {
        let Some(x) = (along_u - along_u.dot(normal) * normal).try_normalize() else {
            return normal;
        };
        let across = normal.cross(x);
        let y = if across.dot(along_v) > 0.0 { -across } else { across };
        let local = self.sample(point, random);
        (local.x * x + local.y * y + local.z * normal).normalize_or(normal)
    }

    /// Returns the memory of the texels in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.normals)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Filter, ImageSize, UvTransform, Wrap};
    use super::*;

    fn map(width: usize, normals: &[Vec3]) -> NormalMap {
        let size = ImageSize { width, height: normals.len() / width };
        let pattern = ImagePattern::new(size, [Wrap::Repeat; 2], Filter::Bilinear, UvTransform::IDENTITY).unwrap();
        NormalMap::new(pattern, normals.iter().copied())
    }

    /// The axes follow the texture coordinates: x along u, and y against v.
    #[test]
    fn tangent_space_follows_the_texture_coordinates() {
        let tilted = map(1, &[Vec3::new(3.0, 4.0, 12.0)]);
        let at = |tangents| {
            tilted.shading_normal(&TexturePoint::new([0.3, 0.2]), &mut LookupRandom::new(0.1), DVec3::Z, tangents)
        };
        for (tangents, expected) in [
            ([DVec3::X, -DVec3::Y], DVec3::new(3.0, 4.0, 12.0)),
            ([DVec3::X, DVec3::Y], DVec3::new(3.0, -4.0, 12.0)),
            ([5.0 * DVec3::Y, 0.1 * DVec3::X], DVec3::new(-4.0, 3.0, 12.0)),
            ([DVec3::new(2.0, 0.0, 1.0), -DVec3::Y], DVec3::new(3.0, 4.0, 12.0)),
        ] {
            assert!((at(tangents) - expected / 13.0).length() < 1e-6, "{tangents:?}: {}", at(tangents));
        }
        assert_eq!(at([DVec3::ZERO; 2]), DVec3::Z, "a surface without tangents keeps its normal");
    }

    #[test]
    fn vectors_below_the_surface_become_its_normal() {
        let bad = map(2, &[Vec3::new(0.5, 0.0, -0.1), Vec3::NAN]);
        assert_eq!(&*bad.normals, [Vec3::Z; 2]);
    }

    #[test]
    fn a_large_footprint_selects_all_texels() {
        let mut normals = vec![Vec3::Z; 64];
        normals[..16].fill(Vec3::X + Vec3::Z);
        let (map, mut random) = (map(8, &normals), LookupRandom::new(0.7));
        let point = TexturePoint { uv: [0.37, 0.81], footprint: [[1.0, 0.0], [0.0, 1.0]] };
        let lookups = 100_000;
        let tilted = (0..lookups).filter(|_| map.sample(&point, &mut random).x > 0.0).count();
        assert!((tilted as f64 / f64::from(lookups) - 0.25).abs() < 0.006, "{tilted}");
    }
}
