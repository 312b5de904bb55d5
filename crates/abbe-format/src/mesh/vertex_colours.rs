//! Vertex colours of meshes as a picture.

use super::material::{MeshMaterial, MeshTexture};
use crate::PictureFile;
use abbe_optics::texture::{Filter, ImageSize, UvTransform, Wrap};
use abbe_scene::geometry::mesh::TriangleMesh;
use abbe_spectra::error::{Error, Result};
use glam::DVec3;
use std::sync::Arc;

/// Multiplies the base colour of a material by the colours of the vertices, in linear sRGB. If the
/// colours differ, they become a picture, and the mesh gets texture coordinates into this picture.
/// If the material has textures already, the mean of the colours applies.
pub(crate) fn painted(
    mesh: &Arc<TriangleMesh>,
    material: Option<&MeshMaterial>,
    colours: &[[f32; 3]],
) -> Result<(Arc<TriangleMesh>, MeshMaterial)> {
    let white = || MeshMaterial { base_colour: [1.0; 3], ..MeshMaterial::default() };
    let mut material = material.cloned().unwrap_or_else(white);
    if colours.len() != mesh.positions().len() {
        return Err(Error::input("the mesh does not have one colour per vertex"));
    }
    let varies = colours.iter().any(|colour| *colour != colours[0]);
    if !varies || material.has_textures() {
        let mean = |i: usize| colours.iter().map(|colour| f64::from(colour[i])).sum::<f64>() / colours.len() as f64;
        material.base_colour = std::array::from_fn(|i| material.base_colour[i] * mean(i));
        return Ok((Arc::clone(mesh), material));
    }
    let ColourPicture { texture, corners } = ColourPicture::new(colours, mesh.triangles());
    let vertices: Vec<(u32, [f64; 2])> = corners.into_iter().flatten().collect();
    let of_vertices = |values: &[DVec3]| vertices.iter().map(|&(vertex, _)| values[vertex as usize]).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let uvs = vertices.iter().map(|&(_, uv)| uv).collect();
    let normals = mesh.normals().map(of_vertices);
    let painted = TriangleMesh::new(of_vertices(mesh.positions()), normals, Some(uvs), triangles)?;
    material.base_colour_texture = Some(texture);
    Ok((Arc::new(painted), material))
}

/// A picture with one cell of 2 × 2 pixels for each triangle. In a cell, bilinear interpolation of
/// the pixels equals linear interpolation of the colours of the corners.
struct ColourPicture {
    texture: MeshTexture,
    /// For each triangle, its corners by texture coordinates: the vertex and the coordinates.
    corners: Vec<[(u32, [f64; 2]); 3]>,
}

impl ColourPicture {
    /// Draws the picture of linear sRGB colours, which belong to the vertices.
    fn new(colours: &[[f32; 3]], triangles: &[[u32; 3]]) -> Self {
        let columns = (triangles.len() as f64).sqrt().ceil().max(1.0) as usize;
        let size = ImageSize { width: 2 * columns, height: 2 * triangles.len().div_ceil(columns) };
        let mut pixels = vec![[0.0; 3]; size.width * size.height];
        let corners = triangles.iter().enumerate().map(|(number, triangle)| {
            let (left, top) = (2 * (number % columns), 2 * (number / columns));
            let (turned, opposite) = cell(colours, *triangle);
            let places = [[left, top], [left + 1, top], [left, top + 1]];
            for ([x, y], vertex) in places.into_iter().zip(turned) {
                pixels[y * size.width + x] = colours[vertex as usize];
            }
            pixels[(top + 1) * size.width + left + 1] = opposite;
            let centre =
                |[x, y]: [usize; 2]| [(x as f64 + 0.5) / size.width as f64, (y as f64 + 0.5) / size.height as f64];
            std::array::from_fn(|i| (turned[i], centre(places[i])))
        });
        let corners = corners.collect();
        let texture = MeshTexture {
            picture: Arc::new(PictureFile::of_colours(size, &pixels)),
            wrap: [Wrap::Clamp; 2],
            filter: Filter::Bilinear,
            transform: UvTransform::IDENTITY,
        };
        Self { texture, corners }
    }
}

/// Returns the corners of a triangle in the order of the cell, and the colour of the fourth pixel.
/// This colour continues the plane through the colours of the corners. The order is the one for
/// which this colour is nearest to the range from 0 to 1.
fn cell(colours: &[[f32; 3]], triangle: [u32; 3]) -> ([u32; 3], [f32; 3]) {
    let orders = [0, 1, 2].map(|first| {
        let turned: [u32; 3] = std::array::from_fn(|i| triangle[(first + i) % 3]);
        let [a, b, c] = turned.map(|vertex| colours[vertex as usize]);
        let opposite: [f32; 3] = std::array::from_fn(|i| b[i] + c[i] - a[i]);
        let excess: f32 = opposite.iter().map(|x| (x - x.clamp(0.0, 1.0)).abs()).sum();
        (excess, turned, opposite)
    });
    let [first, second, third] = orders;
    type Near = (f32, [u32; 3], [f32; 3]);
    let nearer = |one: Near, other: Near| if other.0 < one.0 { other } else { one };
    let (_, turned, opposite) = nearer(nearer(first, second), third);
    (turned, opposite.map(|x| x.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use abbe_optics::texture::{ImagePattern, LookupRandom, SpectralTexture, TexturePoint};

    /// The mean of many lookups at a point of a triangle equals the interpolated colour.
    #[test]
    fn colours_are_interpolated_between_the_corners() {
        let colours = [[0.1, 0.5, 0.9], [0.8, 0.2, 0.3], [0.4, 0.6, 0.1], [0.9, 0.9, 0.2]];
        let triangles = [[0, 1, 2], [2, 1, 3]];
        let ColourPicture { texture, corners } = ColourPicture::new(&colours, &triangles);
        let pattern = ImagePattern::new(texture.picture.size, texture.wrap, texture.filter, texture.transform).unwrap();
        let picture = SpectralTexture::from_colours(pattern, texture.picture.linear_rgb(None));
        let weights = [0.5, 0.2, 0.3];
        for corners in corners {
            let at = |i: usize| corners.iter().zip(weights).map(|((_, uv), weight)| weight * uv[i]).sum();
            let point = TexturePoint::new([at(0), at(1)]);
            let expected: f64 = corners
                .iter()
                .zip(weights)
                .map(|((vertex, _), weight)| {
                    let rgb = colours[*vertex as usize].map(f64::from);
                    weight * abbe_spectra::spectrum::Spectrum::rgb_reflectance(rgb).unwrap().at(600.0)
                })
                .sum();
            let count = 20_000;
            let sum: f64 = (0..count)
                .map(|i| {
                    let mut random = LookupRandom::new((f64::from(i) + 0.5) / f64::from(count));
                    picture.at(picture.texel(&point, &mut random), 600.0)
                })
                .sum();
            let mean = sum / f64::from(count);
            assert!((mean - expected).abs() < 0.01, "{mean} instead of {expected}");
        }
    }
}
