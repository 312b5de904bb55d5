//! The types of colours.

/// Tristimulus values X, Y, Z.
pub type Xyz = [f64; 3];

/// Linear red, green and blue components.
pub type Rgb = [f64; 3];
