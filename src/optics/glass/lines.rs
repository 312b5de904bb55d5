//! The Fraunhofer lines at which indices are quoted: wavelengths in air, in nm (ISO 7944 and Schott's technical information 29).

/// Mercury, violet.
pub const H_NM: f64 = 404.6561;
/// Mercury, blue.
pub const G_NM: f64 = 435.8343;
/// Hydrogen, blue-green (F).
pub const F_NM: f64 = 486.1327;
/// Mercury, green.
pub const E_NM: f64 = 546.074;
/// Helium, yellow: the index without further word, n_d.
pub const D_NM: f64 = 587.5618;
/// Sodium, yellow: the centre of the doublet (D).
pub const SODIUM_NM: f64 = 589.2938;
/// Hydrogen, red (C).
pub const C_NM: f64 = 656.2725;
/// Helium, red.
pub const R_NM: f64 = 706.5188;
