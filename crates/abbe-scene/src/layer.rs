/// A layer of a picture: a quantity by pixel that its file may contain in addition to the colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// The albedo of the first surface on a camera ray.
    Albedo,
    /// The normal of the first surface.
    Normal,
    /// The distance to the first surface.
    Depth,
    Object,
    Material,
    Uv,
    Samples,
    /// The light of each class of paths.
    Paths,
    /// The light of each group of lights.
    Lights,
    /// The Stokes vector of the light, and its degree and angle of polarisation.
    Stokes,
}
