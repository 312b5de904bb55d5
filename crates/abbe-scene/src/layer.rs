//! The layers that the file of a picture may contain in addition to its colours.

/// A layer of a picture: a quantity by pixel that is not the colour of the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// The albedo of the first surface on a camera ray.
    Albedo,
    /// The normal of the first surface.
    Normal,
    /// The distance to the first surface.
    Depth,
    /// The object that the first surface belongs to.
    Object,
    /// The material of the first surface.
    Material,
    /// The texture coordinates of the first surface.
    Uv,
    /// The number of camera samples.
    Samples,
    /// The light of each class of paths.
    Paths,
    /// The light of each group of lights.
    Lights,
}
