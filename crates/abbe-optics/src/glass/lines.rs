//! Spectral lines (nm, in air) of published indices (ISO 7944; Schott, technical information 29).

/// The h line: mercury, violet.
pub const H_NM: f64 = 404.6561;
/// The g line: mercury, blue.
pub const G_NM: f64 = 435.8343;
/// The F line: hydrogen, blue-green.
pub const F_NM: f64 = 486.1327;
/// The e line: mercury, green.
pub const E_NM: f64 = 546.074;
/// The d line: helium, yellow. An index without a named line is n_d, the index at this line.
pub const D_NM: f64 = 587.5618;
/// The D line: the centre of the sodium doublet, yellow.
pub const SODIUM_NM: f64 = 589.2938;
/// The C line: hydrogen, red.
pub const C_NM: f64 = 656.2725;
/// The r line: helium, red.
pub const R_NM: f64 = 706.5188;
