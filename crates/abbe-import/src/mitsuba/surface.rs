//! The surface of a shape.

/// The surface of a shape.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum MitsubaSurface {
    /// A material of the scene file.
    Material {
        /// Its name.
        name: String,
        /// True if Mitsuba's surface is black from behind.
        one_sided: bool,
    },
    /// Nothing to see, because light passes unchanged.
    Invisible,
}
